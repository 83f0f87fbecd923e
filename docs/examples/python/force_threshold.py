# SPDX-License-Identifier: GPL-3.0-or-later
"""Says when somebody presses harder than a threshold, and when no longer: with hysteresis, so that noise does not toggle it.
Usage: force_threshold.py DESIGN [SCENE]   the real skin: triskin.open(design, link="can:can0")"""
import sys

import triskin

ON_COUNTS, OFF_COUNTS, SECONDS = 300.0, 150.0, 5.0

pressed, passed_s = False, 0.0
with triskin.simulate(sys.argv[1], scene=sys.argv[2] if sys.argv[2:] else None) as skin:
    for _ in skin.blocks(0.1):
        passed_s += 0.1
        strongest = skin.change_counts().max()
        if not pressed and strongest > ON_COUNTS or pressed and strongest < OFF_COUNTS:
            pressed = not pressed
            print(f"{passed_s:4.1f} s: {'pressed' if pressed else 'free'} ({strongest:.0f} counts)")
        if passed_s > SECONDS:
            break
print("pressed at the end" if pressed else "free at the end")
