#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Makes the entries of Triskin: each outline is placed by `triskin place`, then `check --search` looks for a proof that
stands alone. Where none of at most MAX_LETTERS is found for its bound, a larger bound is proved, or none.
Usage: make_entries.py TRISKIN CHECK [NAME ...]"""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

HOME = pathlib.Path(__file__).parent
MAX_LETTERS = 100_000
MAX_GAP = 3  # modules by which a proof may be weaker than that of Triskin


def rings_of(file):
    for line in file.read_text().splitlines():
        key, *words = line.split()
        if key == "ring":
            numbers = [float(word) for word in words]
            yield list(zip(numbers[::2], numbers[1::2]))


def entry(triskin, check, name, folder):
    outline, polygon, log, file = HOME / "outlines" / f"{name}.txt", folder / "p.json", folder / "log", folder / "entry"
    polygon.write_text(json.dumps({"type": "Polygon", "coordinates": [ring + ring[:1] for ring in rings_of(outline)]}))
    before_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    placed = subprocess.run([triskin, "place", polygon, "--proof", log, "--no-clearance", "--threads", "1",
                             "--time-limit-s", "0"], stdout=subprocess.DEVNULL)
    assert placed.returncode in (0, 1), placed  # 1: no module fits
    used_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before_s
    proof = json.loads(log.read_text())
    lines = [f"outline {name}", f"modules {proof['modules']}", f"tolerance_mm {proof['tolerance_mm']!r}",
             "pivot_mm {!r} {!r}".format(*proof["pivot"]), "motion {!r} {!r} {!r}".format(*proof["motion"])]
    lines += [f"tile {i} {j} {'up' if up else 'down'}" for i, j, up in proof["tiles"]]
    head = ["skin-placement-entry 1", f"# by Triskin, {used_s:.2f} s"]
    for bound in range(proof["upper_bound"], proof["upper_bound"] + MAX_GAP + 1):
        file.write_text("\n".join(head + [f"bound {bound}"] + lines) + "\n")
        found = subprocess.run([check, "--search", str(MAX_LETTERS), outline, file], capture_output=True, text=True)
        if found.returncode == 0:
            return file.read_text() + found.stdout
    return "\n".join(head + lines) + "\n"


def main(triskin, check, names):
    for name in names or sorted(file.stem for file in (HOME / "outlines").glob("*.txt")):
        with tempfile.TemporaryDirectory() as folder:
            (HOME / "entries" / f"{name}.txt").write_text(entry(triskin, check, name, pathlib.Path(folder)))
        print(name, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
