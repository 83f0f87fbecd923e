# SPDX-License-Identifier: GPL-3.0-or-later
"""Calibrates with the program by known pressures of an air bag, here on simulated boards, and reads pressures in kPa. On
hardware the same command asks for each step (docs/calibration.md). Usage: calibrate.py DESIGN"""
import subprocess
import sys

import numpy as np
import triskin

design = sys.argv[1]
triskin.simulate(design).close()  # gives the simulated boards their tables
subprocess.run(["triskin", "calibrate", design, "--link", "sim", "--steps", "5", "10", "20"], check=True)
with triskin.open(design, link="sim") as skin:
    counts_per_kpa, area_mm2 = skin.calibration()
    skin.read(2.0)
    print(f"{np.nanmedian(counts_per_kpa):.1f} counts for 1 kPa, a taxel stands for {area_mm2.mean():.0f} mm2")
    print(f"now at most {np.nanmax(skin.pressure_kpa()):.2f} kPa")
