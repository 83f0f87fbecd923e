# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints contacts as they are, ten times a second. Usage: live_contacts.py DESIGN [SCENE]"""
import itertools
import sys

import triskin

with triskin.simulate(sys.argv[1], scene=sys.argv[2] if sys.argv[2:] else None) as skin:
    for _ in itertools.islice(skin.blocks(period_s=0.1), 30):
        for contact in skin.contacts():
            x, y, z = contact["position_mm"]
            print(f"module {skin.numbers[contact['module']]}: {contact['change_counts']:.0f} counts on "
                  f"{contact['area_mm2']:.0f} mm2 at {x:.0f}, {y:.0f}, {z:.0f} mm")
