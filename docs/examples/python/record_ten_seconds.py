# SPDX-License-Identifier: GPL-3.0-or-later
"""Records ten seconds with the program, which loses nothing and keeps the design in the file, and reads them.
Usage: record_ten_seconds.py DESIGN [LINK [SECONDS]]"""
import subprocess
import sys

import triskin

design, link, seconds = (sys.argv[1:] + ["sim", "10"][len(sys.argv) - 2:])[:3]
if link == "sim":
    triskin.simulate(design).close()  # gives the simulated boards their tables
subprocess.run(["triskin", "record", design, "--link", link, "-o", "touch.mcap", "--seconds", seconds], check=True)
recording = triskin.read("touch.mcap")
samples = recording.samples
print(f"{len(samples)} samples of {recording.modules} modules in {samples['time_s'].max() - samples['time_s'].min():.1f} s")
