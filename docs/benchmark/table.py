#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Writes the tables of entries into README.md beside this file, between their marks.
Usage: table.py [--check]     --check: only says whether the table there is that of the entries"""
import math
import pathlib
import re
import sys

HOME = pathlib.Path(__file__).parent
MARKED = re.compile(r"(<!-- benchmark -->\n).*?(<!-- /benchmark -->)", re.S)
COVERS_MARKED = re.compile(r"(<!-- covers -->\n).*?(<!-- /covers -->)", re.S)
MODULE_MM2 = 15.0 * 15.0 * math.sqrt(3.0)


def area_mm2(ring):
    return 0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:] + ring[:1])))


def row(entry):
    rings, fact, letters = [], {"bound": "open"}, 0
    for line in (HOME / "outlines" / entry.name).read_text().splitlines():
        key, *words = line.split()
        if key == "ring":
            rings.append(list(zip(map(float, words[::2]), map(float, words[1::2]))))
    for line in entry.read_text().splitlines():
        key, _, rest = line.partition(" ")
        if key == "proof":
            letters += len(rest)
        elif line.startswith("# by "):
            fact["by"] = line[5:]
        else:
            fact[key] = rest
    cm2 = (area_mm2(rings[0]) - sum(area_mm2(hole) for hole in rings[1:])) / 100.0
    state = "optimum" if fact["bound"] == fact["modules"] else f"bound {fact['bound']}"
    return (f"| {entry.stem} | {cm2:.0f} | {sum(map(len, rings))} | {fact['modules']} | {state} | {letters:,} "
            f"| {fact['by']} |")


def table():
    head = ["| outline | area, cm² | corners | modules | proved | letters | by |", "|---|---|---|---|---|---|---|"]
    return "\n".join(head + [row(entry) for entry in sorted((HOME / "entries").glob("*.txt"))]) + "\n"


def triangle_mm2(a, b, c):
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    return 0.5 * math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def cover_row(entry):
    points, mm2, faces, fact = [], 0.0, 0, {}
    for line in (HOME / "covers" / f"{entry.stem}.obj").read_text().splitlines():
        key, *words = line.split()
        if key == "v":
            points.append(list(map(float, words)))
        elif key == "f":
            faces += 1
            mm2 += triangle_mm2(*(points[int(w) - 1] for w in words))
    for line in entry.read_text().splitlines():
        key, _, rest = line.partition(" ")
        fact["by" if line.startswith("# by ") else key] = line[5:] if line.startswith("# by ") else rest
    by_area = int(mm2 / MODULE_MM2)
    return f"| {entry.stem} | {mm2 / 100.0:.0f} | {faces} | {fact['modules']} | {by_area} | {100 * int(fact['modules']) / by_area:.0f} % | {fact['by']} |"


def cover_table():
    head = ["| cover | area, cm² | faces | modules | area / 3.897 cm² | share | by |", "|---|---|---|---|---|---|---|"]
    return "\n".join(head + [cover_row(entry) for entry in sorted((HOME / "cover_entries").glob("*.txt"))]) + "\n"


def main(check):
    page = HOME / "README.md"
    before = page.read_text()
    after = MARKED.sub(lambda found: found[1] + table() + found[2], before)
    after = COVERS_MARKED.sub(lambda found: found[1] + cover_table() + found[2], after)
    if check:
        sys.exit(0 if before == after else "README.md: the table is not that of the entries; run table.py")
    page.write_text(after)


if __name__ == "__main__":
    main("--check" in sys.argv[1:])
