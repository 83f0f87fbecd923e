# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the open benchmark: outlines are those of the generator and cross nowhere, the table is that of the entries,
the checker accepts every entry and rejects a hundred that were tampered with.
Usage: benchmark_test.py SOURCE COMPILER [FOLDER]     FOLDER: keeps the tampered entries there, for another checker"""
import pathlib
import random
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1])
HOME = ROOT / "docs/benchmark"
SEED, TAMPERED = 20261128, 100
KINDS = ["bound", "count", "module", "twice", "missing", "motion", "merged", "cut", "left over", "outline", "nan", "word"]
UNREADABLE = {"nan", "word"}
HALVED = re.compile(r"[xya]\.\.")


def value(lines, key):
    return next((line.split()[1] for line in lines if line.startswith(key + " ")), None)


def replaced(lines, key, text):
    return [f"{key} {text}" if line.startswith(key + " ") else line for line in lines]


def proof_of(lines):
    return "".join(line[6:] for line in lines if line.startswith("proof "))


def with_proof(lines, proof):
    return [line for line in lines if not line.startswith("proof ")] + [f"proof {proof}"]


def is_rich(lines):
    modules = value(lines, "modules")
    return value(lines, "bound") == modules and 6 <= int(modules) <= 250 and 2 < len(proof_of(lines)) < 10_000


def without_one(draw, lines):
    lines = list(lines)
    del lines[draw.choice([k for k, line in enumerate(lines) if line.startswith("tile ")])]
    return lines


def tampered(draw, kind, lines, names):
    """The lines of an entry with one claim that does not hold any more."""
    proof, modules = proof_of(lines), int(value(lines, "modules"))
    tiles = [line for line in lines if line.startswith("tile ")]
    if kind == "bound":  # a module fewer, and a bound that only just is not below it
        lines = replaced(without_one(draw, lines), "modules", modules - 1)
        return replaced(lines, "bound", int(value(lines, "bound")) - 1)
    if kind == "count":
        return replaced(lines, "modules", modules + draw.choice([-1, 1]))
    if kind == "module":  # to the nearest place at which none is
        k = lines.index(draw.choice(tiles))
        _, i, j, way = lines[k].split()
        step = next(n for n in range(1, 99) if f"tile {int(i) + n} {j} {way}" not in tiles)
        return lines[:k] + [f"tile {int(i) + step} {j} {way}"] + lines[k + 1:]
    if kind == "twice":
        one, other = draw.sample(tiles, 2)
        return [other if line == one else line for line in lines]
    if kind == "missing":
        return without_one(draw, lines)
    if kind == "motion":
        x, y, angle = map(float, next(line.split()[1:] for line in lines if line.startswith("motion ")))
        return replaced(lines, "motion", f"{x + 1.0!r} {y!r} {angle + draw.choice([-0.1, 0.1])!r}")
    if kind == "merged":  # two cells become the one of which they are halves
        at = draw.choice([found.start() for found in HALVED.finditer(proof)])
        return with_proof(lines, proof[:at] + "." + proof[at + 3:])
    if kind == "cut":
        at = draw.choice([k for k, letter in enumerate(proof) if letter == "."])
        return with_proof(lines, proof[:at] + proof[at + 1:])
    if kind == "left over":
        return with_proof(lines, proof + draw.choice([".", "x.."]))
    if kind == "outline":  # handed in as the answer to another outline
        return replaced(lines, "outline", draw.choice([name for name in names if name != value(lines, "outline")]))
    if kind == "nan":
        key, words = draw.choice([("motion", "nan 0 0"), ("motion", "0 0 nan"), ("pivot_mm", "0 nan"),
                                  ("tolerance_mm", "nan"), ("tolerance_mm", "inf")])
        return replaced(lines, key, words)
    at = draw.randrange(len(lines))
    return lines[:at] + [draw.choice(["proved yes", f"modules {modules}", "tile 1 2", "bound 1 2"])] + lines[at:]



def side(a, b, p):
    """Of twice the area of a b p, the sign; coordinates are whole micrometres."""
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def require_simple(file):
    edges = []
    for line in file.read_text().splitlines():
        if line.startswith("ring "):
            numbers = [round(1000.0 * float(word)) for word in line.split()[1:]]
            ring = list(zip(numbers[::2], numbers[1::2]))
            edges += list(zip(ring, ring[1:] + ring[:1]))
    for k, (a, b) in enumerate(edges):
        for c, d in edges[:k]:
            cross = side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
            assert not cross, f"{file.name}: the edges {a} {b} and {c} {d} cross"


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([sys.executable, HOME / "generate.py", folder], check=True)
        made = {file.name: file.read_text() for file in folder.glob("*.txt")}
        kept = {file.name: file.read_text() for file in (HOME / "outlines").glob("*.txt")}
        assert made == kept and len(kept) == 40, "outlines differ from those of generate.py"
        for file in (HOME / "outlines").glob("*.txt"):
            require_simple(file)
        subprocess.run([sys.executable, HOME / "table.py", "--check"], check=True)

        checker = folder / "check"
        subprocess.run([sys.argv[2], "-std=c++17", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror",
                        HOME / "check.cpp", "-o", checker], check=True)

        def status(entry):
            return subprocess.run([checker, HOME / "outlines" / f"{entry.stem.split('.')[0]}.txt", entry],
                                  capture_output=True).returncode

        entries = sorted((HOME / "entries").glob("*.txt"))
        assert [entry.stem for entry in entries] == sorted(name.removesuffix(".txt") for name in kept)
        for entry in entries:
            assert status(entry) == 0, f"{entry.stem} is not accepted"

        draw = random.Random(SEED)
        names = [entry.stem for entry in entries]
        # With few modules a change may hold; a long proof takes the time of this test.
        rich = [entry for entry in entries if is_rich(entry.read_text().splitlines())]
        bad = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else folder
        for k in range(TAMPERED):
            kind, entry = KINDS[k % len(KINDS)], draw.choice(rich)
            lines = tampered(draw, kind, entry.read_text().splitlines(), names)
            file = bad / f"{value(lines, 'outline')}.{k}.txt"
            file.write_text("\n".join(lines) + "\n")
            expected = 2 if kind in UNREADABLE else 1
            got = status(file)
            assert got == expected, f"seed {SEED}, case {k}: {entry.stem} with another {kind} ended with {got}"
        print(f"{len(entries)} entries accepted, {TAMPERED} tampered ones rejected, seed {SEED}")


if __name__ == "__main__":
    main()
