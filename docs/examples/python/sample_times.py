# SPDX-License-Identifier: GPL-3.0-or-later
"""Says how regularly modules are sampled and how well the times are known. Usage: sample_times.py DESIGN"""
import sys

import numpy as np
import triskin

with triskin.simulate(sys.argv[1]) as skin:
    samples = skin.read(5.0)
    counts = skin.counts()
periods_s = np.concatenate([np.diff(np.sort(samples["time_s"][samples["module"] == m])) for m in range(skin.modules)])
bounded = samples["error_s"][np.isfinite(samples["error_s"])]
print(f"period {1e3 * np.median(periods_s):.1f} ms, longest {1e3 * periods_s.max():.1f} ms")
print(f"times are known within {1e6 * np.median(bounded):.0f} us; {counts['lost']} samples lost")
