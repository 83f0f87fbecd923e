#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Makes the entries of Triskin for the covers: the best of some seeds of `triskin design`, by the number of modules, if
it has more than the entry that is there. Usage: make_cover_entries.py TRISKIN STEPS SEEDS [NAME ...]"""
import json
import pathlib
import subprocess
import sys
import tempfile

HOME = pathlib.Path(__file__).parent


def modules_in(entry):
    lines = entry.read_text().splitlines() if entry.exists() else []
    return next((int(line.split()[1]) for line in lines if line.startswith("modules ")), -1)


def main(triskin, steps, seeds, names):
    for name in names or sorted(file.stem for file in (HOME / "covers").glob("*.obj")):
        entry = HOME / "cover_entries" / f"{name}.txt"
        for seed in range(1, seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                design = pathlib.Path(folder) / "design.json"
                # Only the number of modules counts here, so wiring costs nothing.
                subprocess.run([triskin, "design", HOME / "covers" / f"{name}.obj", "-o", design, "--iterations", str(steps), "--seed", str(seed),
                                "--threads", "1", "--time-limit-s", "3600", "--controller-cost", "0", "--jumper-cost", "0", "--island-cost", "0"],
                               stdout=subprocess.DEVNULL, check=True)
                modules = json.loads(design.read_text())["modules"]
            if len(modules) <= modules_in(entry):
                continue
            lines = ["skin-cover-entry 1", f"# by Triskin, {steps} steps, seed {seed}", f"cover {name}", f"modules {len(modules)}"]
            lines += ["module " + " ".join(repr(round(c, 5)) for corner in m["corners"] for c in corner) for m in modules]
            entry.parent.mkdir(exist_ok=True)
            entry.write_text("\n".join(lines) + "\n")
        print(name, modules_in(entry), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])
