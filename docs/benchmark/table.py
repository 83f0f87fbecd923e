#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Writes the table of entries into README.md beside this file, between its marks.
Usage: table.py [--check]     --check: only says whether the table there is that of the entries"""
import pathlib
import re
import sys

HOME = pathlib.Path(__file__).parent
MARKED = re.compile(r"(<!-- benchmark -->\n).*?(<!-- /benchmark -->)", re.S)


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


def main(check):
    page = HOME / "README.md"
    before = page.read_text()
    after = MARKED.sub(lambda found: found[1] + table() + found[2], before)
    if check:
        sys.exit(0 if before == after else "README.md: the table is not that of the entries; run table.py")
    page.write_text(after)


if __name__ == "__main__":
    main("--check" in sys.argv[1:])
