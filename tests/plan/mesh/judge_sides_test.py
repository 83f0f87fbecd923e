# SPDX-License-Identifier: GPL-3.0-or-later
"""A tray with a wall of 2 mm, designed from both sides: tools/judge_sides must accept the outer side and refuse the inner.

usage: judge_sides_test.py TRISKIN JUDGE   (ends with 77, skipped, without numpy)
"""
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)

OUTER = (160.0, 120.0, 40.0)
WALL_MM = 2.0


def tray():
    """Open below; the outer box and the inner one are joined by the rim."""
    corners, faces = [], []
    for inset in (0.0, WALL_MM):
        for z in (-OUTER[2], -inset):
            for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corners.append((inset + x * (OUTER[0] - 2 * inset), inset + y * (OUTER[1] - 2 * inset), z))

    def quad(a, b, c, d):
        faces.extend([(a, b, c), (a, c, d)])
    for k in range(4):
        n = (k + 1) % 4
        quad(k, n, 4 + n, 4 + k)  # outer side
        quad(8 + n, 8 + k, 12 + k, 12 + n)  # inner side
        quad(n, k, 8 + k, 8 + n)  # rim
    quad(4, 5, 6, 7)
    quad(15, 14, 13, 12)
    return corners, faces


def main():
    program, judge = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        part = pathlib.Path(folder) / "tray.obj"
        corners, faces = tray()
        part.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) +
                        "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
        for side, wanted in (("outer", 0), ("inner", 1)):
            design = pathlib.Path(folder) / f"{side}.json"
            subprocess.run([program, "design", part, "--side", side, "--iterations", "20", "--threads", "1", "-o", design],
                           check=True, stdout=subprocess.DEVNULL)
            judged = subprocess.run([sys.executable, judge, design, part], stdout=subprocess.PIPE, text=True)
            print(side, judged.stdout.splitlines()[-1:])
            if judged.returncode != wanted:
                sys.exit(f"{side}: status {judged.returncode}, wanted {wanted}\n{judged.stdout}")


main()
