# Last character of the part number: an image for another kind of board is refused.
set(triskin_board_kind 3)
# The chain's pins are not led out together with those of the lines, so the image reads strapped modules.
set(triskin_board_switched OFF)
