# Last character of the part number: an image for another kind of board is refused.
set(triskin_board_kind 1)
