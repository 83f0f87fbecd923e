#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the twelve covers of the open benchmark: they are those of the generator, the table is that of the entries, the
checker accepts every entry and rejects a hundred that were tampered with. Usage: benchmark_covers_test.py SOURCE"""
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HOME = pathlib.Path(sys.argv[1]) / "docs/benchmark"
sys.path.insert(0, str(HOME))
import check_cover  # noqa: E402

SEED, TAMPERED = 20261129, 100
KINDS = ["count", "missing", "twice", "lifted", "sunk", "slid", "turned over", "stretched", "tilted", "away", "cover"]


def moved(module, by):
    return [tuple(a + b for a, b in zip(corner, by)) for corner in module]


def scaled(vector, factor):
    return tuple(factor * v for v in vector)


def normal_of(m):
    return check_cover.unit(check_cover.cross(check_cover.sub(m[1], m[0]), check_cover.sub(m[2], m[0])))


def middle_of(m):
    return check_cover.mixed((1 / 3,) * 3, m)


def tampered(draw, kind, entry):
    """The entry with one claim that does not hold any more; the module that was changed stands first."""
    name, count, modules = entry[0], entry[1], list(entry[2])
    k = draw.randrange(len(modules))
    m = modules.pop(k)
    if kind == "count":
        return name, count + draw.choice([-1, 1]), [m] + modules
    if kind == "missing":
        return name, count, modules
    if kind == "twice":
        return name, count, [m, m] + modules[1:]
    if kind == "lifted":
        return name, count, [moved(m, scaled(normal_of(m), 10.0))] + modules
    if kind == "sunk":
        return name, count, [moved(m, scaled(normal_of(m), -10.0))] + modules
    if kind == "slid":  # by 3 mm towards the nearest module, from which it is at most 2 mm away
        near = min(modules, key=lambda o: check_cover.norm(check_cover.sub(middle_of(o), middle_of(m))))
        return name, count, [moved(m, scaled(check_cover.unit(check_cover.sub(middle_of(near), middle_of(m))), 3.0))] + modules
    if kind == "turned over":
        return name, count, [[m[0], m[2], m[1]]] + modules
    if kind == "stretched":
        along = check_cover.unit(check_cover.sub(m[1], m[0]))
        return name, count, [[m[0], tuple(a + 0.001 * b for a, b in zip(m[1], along)), m[2]]] + modules
    if kind == "tilted":  # by 30 degrees about a side: the opposite corner rises by 13 mm
        angle = math.radians(30.0) * draw.choice([-1, 1])
        height = check_cover.sub(m[2], scaled(tuple(a + b for a, b in zip(m[0], m[1])), 0.5))
        length = check_cover.norm(height)
        up = scaled(normal_of(m), length * math.sin(angle))
        foot = scaled(tuple(a + b for a, b in zip(m[0], m[1])), 0.5)
        return name, count, [[m[0], m[1], tuple(f + math.cos(angle) * h + u for f, h, u in zip(foot, height, up))]] + modules
    if kind == "away":
        return name, count, [moved(m, (500.0, 0.0, 0.0))] + modules
    return name + "-other", count, [m] + modules


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, HOME / "generate_covers.py", folder], check=True)
        made = {f.name: f.read_text() for f in pathlib.Path(folder).glob("*.obj")}
    there = {f.name: f.read_text() for f in (HOME / "covers").glob("*.obj")}
    assert len(there) == 12 and made == there, "the covers are not those of generate_covers.py"
    subprocess.run([sys.executable, HOME / "table.py", "--check"], check=True)

    covers = {name[:-4]: check_cover.Cover(HOME / "covers" / name) for name in there}
    entries = {stem: check_cover.read_entry(HOME / "cover_entries" / f"{stem}.txt") for stem in covers}
    for stem, entry in entries.items():
        found = list(check_cover.faults(covers[stem], stem, entry))
        assert not found, f"{stem}: {found[0]}"

    draw = random.Random(SEED)
    for k in range(TAMPERED):
        kind, stem = KINDS[k % len(KINDS)], draw.choice(sorted(entries))
        found = next(check_cover.faults(covers[stem], stem, tampered(draw, kind, entries[stem])), None)
        assert found, f"accepted: {kind} of {stem} (seed {SEED}, number {k})"

    with tempfile.TemporaryDirectory() as folder:
        for number, text in enumerate(["", "skin-cover-entry 2\ncover cap\nmodules 0\n", "skin-cover-entry 1\ncover cap\n",
                                       "skin-cover-entry 1\ncover cap\nmodules 1\nmodule 0 0 nan 0 0 0 0 0 0\n",
                                       "skin-cover-entry 1\ncover cap\nmodules 1\nmodule 0 0 0\n"]):
            file = pathlib.Path(folder) / f"{number}.txt"
            file.write_text(text)
            done = subprocess.run([sys.executable, HOME / "check_cover.py", HOME / "covers/cap.obj", file], stdout=subprocess.DEVNULL)
            assert done.returncode == 2, f"unreadable entry {number}: status {done.returncode}"
    print(f"{len(entries)} entries accepted, {TAMPERED} tampered ones rejected, 5 unreadable ones refused (seed {SEED})")


if __name__ == "__main__":
    main()
