# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks whether the hardware is the design; the exit status says it to a script. Usage: verify.py DESIGN [LINK]"""
import sys

import triskin

design, *link = sys.argv[1:]
with triskin.open(design, link=link[0]) if link else triskin.simulate(design) as skin:
    good, report = skin.verify()
print(report)
sys.exit(0 if good else 1)
