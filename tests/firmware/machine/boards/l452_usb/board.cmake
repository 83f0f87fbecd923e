# SPDX-License-Identifier: GPL-3.0-or-later
set(triskin_board_chip stm32l452)
set(triskin_board_kind 9)
set(triskin_board_switched OFF)
