# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns a recording into frames at a fixed rate for learning, with the last samples of each taxel in every frame, and writes
them with a file of geometry. Usage: learning_frames.py FILE.mcap FOLDER [RATE_HZ]"""
import json
import pathlib
import sys

import numpy as np
import triskin

file, folder, *rate = sys.argv[1:]
grid = triskin.write_frames(triskin.read(file), folder, float(rate[0]) if rate else 30.0, window=4)
frames, window, taxels = grid.window_counts.shape
print(f"{frames} frames of {taxels} taxels at {grid.rate_hz:g} Hz, the last {window} samples in each")
# What others read:
tables = np.load(pathlib.Path(folder) / "frames.npz")
geometry = json.loads((pathlib.Path(folder) / "geometry.json").read_text(encoding="utf-8"))
strongest = int(tables["change_counts"].max(axis=0).argmax())
print(f"column {strongest} is taxel {geometry['taxel'][strongest]} of module {geometry['module'][strongest]} at "
      f"{geometry['position'][strongest]} m")
