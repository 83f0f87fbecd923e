# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots where the skin is pressed. Usage: plot_touch.py DESIGN [LINK [SCENE]]   without LINK simulated boards"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import triskin

design, *more = sys.argv[1:]
skin = triskin.open(design, link=more[0]) if more and more[0] != "sim" else triskin.simulate(design, scene=more[1] if more[1:] else None)
with skin:
    skin.read(3.0)  # press now
    places_mm, change_counts = skin.positions_mm.reshape(-1, 3), skin.change_counts().ravel()
axes = plt.figure().add_subplot(projection="3d")
points = axes.scatter(*places_mm.T, c=change_counts, cmap="inferno")
axes.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)")
plt.colorbar(points, label="counts below rest")
plt.savefig("touch.png", dpi=110)
print(f"touch.png: strongest {change_counts.max():.0f} counts")
