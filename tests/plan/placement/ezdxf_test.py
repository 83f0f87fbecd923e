#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes drawings with ezdxf, a writer that is not ours, and holds the area that `triskin place` reads against that of
ezdxf's own curves. Usage: ezdxf_test.py TRISKIN
Exit status: 0 equal, 1 not, 77 ezdxf is missing."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import ezdxf
    from ezdxf import path
except ImportError:
    print("ezdxf is not installed: nothing is drawn")
    sys.exit(77)


def area(points):
    return abs(sum(a.x * b.y - b.x * a.y for a, b in zip(points, points[1:] + points[:1]))) / 2


def read(drawing, folder, name):
    file = folder / f"{name}.dxf"
    drawing.saveas(file)
    run = subprocess.run([sys.argv[1], "place", file, "--method", "r2", "--json"], capture_output=True, text=True, check=False)
    assert run.returncode == 0, (name, run.stderr)
    return json.loads(run.stdout)


def draw(version, units):
    drawing = ezdxf.new(version)
    drawing.units = units
    return drawing, drawing.modelspace()


def main():
    with tempfile.TemporaryDirectory() as top:
        top, worst = pathlib.Path(top), 0.0
        shapes = {
            "bulges": lambda m: m.add_lwpolyline([(0, 0, 0, 0, 0.3), (150, 0), (150, 120, 0, 0, -0.2), (0, 120)], close=True),
            "circle": lambda m: m.add_circle((20, 30), 90),
            "ellipse": lambda m: m.add_ellipse((0, 0), (120, 50), 0.4),
            # Closed by a line.
            "spline": lambda m: (m.add_line((40, 160), (0, 0)), m.add_open_spline([(0, 0), (150, 20), (270, 130), (40, 160)], degree=3))[1],
        }
        for version in ("R2000", "R2018"):
            for name, shape in shapes.items():
                drawing, space = draw(version, ezdxf.units.MM)
                entity = shape(space)
                # ezdxf has circles and ellipses as cubic curves, which are 0.03 % off; theirs are known.
                known = {"circle": math.pi * 90 ** 2, "ellipse": math.pi * 0.4 * (120 ** 2 + 50 ** 2)}
                exact = known.get(name) or area(list(path.make_path(entity).flattening(0.0005)))
                mine = 100.0 * read(drawing, top, f"{name}_{version}")["area_cm2"]
                worst = max(worst, abs(mine / exact - 1))
                # 0.01 mm along a border of some 500 mm, of some 15,000 mm².
                assert abs(mine - exact) < 0.01 * 800, (name, mine, exact)
        # Inches, and a slot of lines and arcs drawn in any order.
        drawing, space = draw("R2010", ezdxf.units.IN)
        space.add_arc((0, 0), 2, 90, 270)
        space.add_line((6, -2), (0, -2))
        space.add_arc((6, 0), 2, 270, 90)
        space.add_line((0, 2), (6, 2))
        slot = read(drawing, top, "slot")
        assert abs(slot["area_cm2"] - (24 + 4 * math.pi) * 25.4 ** 2 / 100) < 0.08, slot
        assert all(abs(a - b) < 0.02 for a, b in zip(slot["size_mm"], (254.0, 101.6))), slot["size_mm"]
    print(f"nine drawings of ezdxf are read; areas differ by at most {worst:.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
