#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the archives of `triskin fabricate --only order` as a board house and an assembly house would, by other code.
Usage: order_test.py TRISKIN WRITE_STRIP NODE_MODULES [DESIGN...]   without DESIGN: strips of our own
Positions and bill of materials: each part of each module once, at the place where the KiCad board has its pads, turned by
the assembly house's rule. Gerber and Excellon: the area of each copper layer and the number of holes by gerbv and by
tracespace (npm) against what the KiCad boards of the same design have; skipped and said without them.
Exit status: 0 all is as the design says, 1 something is not, 77 gerbv or tracespace is missing and the rest holds."""
import csv
import io
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

import boards_test
from boards_test import expect

HAS_READERS = shutil.which("gerbv") and (pathlib.Path(sys.argv[3]) / "@tracespace/plotter").exists()
if HAS_READERS:
    import gerber_areas

PARTS = {"U1": "AD7147ACPZ-1500RL7", "C1": "GRM155R71C104KA88D", "C2": "GRM155R61A105KE15D", "C3": "GRM155R71H103KA88D"}
LAYERS = {"F_Cu": "F.Cu", "In1_Cu": "In1.Cu", "In2_Cu": "In2.Cu", "B_Cu": "B.Cu"}
BOARD_FILES = {"F_Cu.gbr", "In1_Cu.gbr", "In2_Cu.gbr", "B_Cu.gbr", "F_Mask.gbr", "B_Mask.gbr", "B_Paste.gbr",
               "B_Silkscreen.gbr", "Edge_Cuts.gbr", "PTH.drl", "NPTH.drl", "notes.txt"}
FIDUCIALS_MM2 = 3 * math.pi * 0.5 ** 2


def unpack(path, folder):
    with zipfile.ZipFile(path) as archive:
        expect(archive.testzip() is None, f"{path.name}: sound")
        archive.extractall(folder)
        return set(archive.namelist())


def rows_of(path):
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"), newline="")))


def check_lists(folder, panel, modules):
    """Returns the positions: designator to row."""
    bill, positions = rows_of(folder / f"{panel}-bom.csv"), rows_of(folder / f"{panel}-cpl.csv")
    expect(list(positions[0]) == ["Designator", "Mid X", "Mid Y", "Layer", "Rotation"], f"columns {list(positions[0])}")
    placed = {row["Designator"]: row for row in positions}
    expect(len(placed) == len(positions), f"{panel}: a part is placed twice")
    wanted = {f"M{m}_{part}": number for m in modules for part, number in PARTS.items()}
    expect(set(placed) == set(wanted), f"{panel}: positions {sorted(set(placed) ^ set(wanted))[:5]}")
    billed = {}
    for row in bill:
        names = row["Designator"].split(",")
        expect(len(names) <= 200 and len(names) == int(row["Quantity"]), f"{panel}: a row of {len(names)} parts")
        for name in names:
            expect(name not in billed, f"{panel}: {name} is billed twice")
            billed[name] = row["Manufacturer Part Number"]
    expect(billed == wanted, f"{panel}: the bill has other parts")
    return placed


def pads_of_boards(boards):
    """Middle of pads 1 and of the part, in the frame of the island, y up: for each module and part."""
    found = {}
    for board in boards:
        for (reference, pad), places in board.places.items():
            if reference.startswith("M") and "." in pad and pad.split(".")[0] in PARTS:
                found.setdefault((reference, pad.split(".")[0]), {})[pad.split(".")[1]] = (places[0][0], -places[0][1])
    return found


def check_places(placed, found, where):
    """The lists have the board moved as a whole: distances from part to part stay, and directions turn by one angle for an
    island. A part of the back at angle 0 has pin 1 left (chip: upper left) as seen from the back, and turns
    counter-clockwise there (JLCPCB)."""
    for (reference, part), pads in found.items():
        name = f"{reference}_{part}"
        if name not in placed:
            continue
        row = placed[name]
        x, y, turn = (float(row[k]) for k in ("Mid X", "Mid Y", "Rotation"))
        expect(row["Layer"] == "Bottom", f"{name} on {row['Layer']}")
        to_board, shift = where[reference]
        if part == "U1":
            middle = pads["25"]
            first = pads["1"]
            # Seen from the back at angle 0: pin 1 at (−1.95, 1.25) from the middle.
            zero = (-1.95, 1.25)
        else:
            middle = [(pads["1"][k] + pads["2"][k]) / 2 for k in (0, 1)]
            first, zero = pads["1"], (-0.48, 0.0)
        c, s = math.cos(to_board), math.sin(to_board)
        wanted = [shift[0] + c * middle[0] - s * middle[1], shift[1] + s * middle[0] + c * middle[1]]
        expect(math.dist(wanted, (x, y)) < 0.002, f"{name}: at {x}, {y}, wanted {wanted}")
        # Turn the zero position counter-clockwise as seen from the back, then look through the board.
        angle = math.radians(turn)
        seen = (math.cos(angle) * zero[0] - math.sin(angle) * zero[1], math.sin(angle) * zero[0] + math.cos(angle) * zero[1])
        through = (-seen[0], seen[1])
        local = (first[0] - middle[0], first[1] - middle[1])
        expect(math.dist(through, (c * local[0] - s * local[1], s * local[0] + c * local[1])) < 0.002,
               f"{name}: pin 1 lies elsewhere at {turn}°")


def where_of(placed, found, modules_of_board):
    """How the panel has each island: fitted to the chips of two of its modules, or by one chip and its rotation."""
    where = {}
    for references in modules_of_board:
        first = references[0]
        pads = found[(first, "U1")]
        row = placed.get(f"{first}_U1")
        if row is None:
            continue
        if len(references) > 1:
            last = references[-1]
            a, b = pads["25"], found[(last, "U1")]["25"]
            p, q = ([float(placed[f"{r}_U1"][k]) for k in ("Mid X", "Mid Y")] for r in (first, last))
            turn = math.atan2(q[1] - p[1], q[0] - p[0]) - math.atan2(b[1] - a[1], b[0] - a[0])
        else:
            own = math.atan2(pads["1"][1] - pads["25"][1], pads["1"][0] - pads["25"][0])
            turn = math.pi - math.atan2(1.25, -1.95) - math.radians(float(row["Rotation"])) - own
        c, s = math.cos(turn), math.sin(turn)
        x, y = pads["25"]
        shift = (float(row["Mid X"]) - c * x + s * y, float(row["Mid Y"]) - s * x - c * y)
        where.update({r: (turn, shift) for r in references})
    return where


def check_gerber(folder, panel, boards, node_modules):
    for name, layer in LAYERS.items():
        file = folder / f"{panel}-{name}.gbr"
        text = file.read_text(encoding="ascii")
        expect("%MOMM*%" in text and text.endswith("M02*\n") and "%TF.FileFunction,Copper,L" in text, f"{file.name}: header")
        area = sum(gerber_areas.area_by_board(path, layer) for path in boards)
        if layer in ("F.Cu", "B.Cu"):
            area += FIDUCIALS_MM2
        by_gerbv, by_tracespace = gerber_areas.area_by_gerbv(file), gerber_areas.area_by_tracespace(node_modules, file)
        print(f"{file.name}: board {area:.2f}, gerbv {by_gerbv:.2f}, tracespace {by_tracespace:.2f} mm²")
        expect(abs(by_gerbv - area) < gerber_areas.TOLERANCE_GERBV * area, f"{file.name}: gerbv reads {by_gerbv:.2f} mm²")
        expect(abs(by_tracespace - area) < gerber_areas.TOLERANCE_TRACESPACE * area,
               f"{file.name}: tracespace reads {by_tracespace:.2f} mm²")


def holes_of(path):
    root = boards_test.read_expression(path.read_text(encoding="utf-8"))
    return len(boards_test.children(root, "via")) + sum(
        pad[2] == "thru_hole" for f in boards_test.children(root, "footprint") for pad in boards_test.children(f, "pad"))


def main():
    program, write_strip, node_modules, *designs = sys.argv[1:]
    with tempfile.TemporaryDirectory() as temporary:
        place = pathlib.Path(temporary)
        if not designs:
            designs = [str(place / "strip.json")]
            subprocess.run([write_strip, designs[0], "2"], check=True)
        for number, design in enumerate(designs):
            out = place / f"out{number}"
            subprocess.run([program, "fabricate", design, "-o", str(out), "--only", "kicad,order"], check=True,
                           capture_output=True)
            boards = sorted(p for p in (out / "kicad").glob("*.kicad_pcb") if p.stem != "Module")
            read = [boards_test.Board(p) for p in boards]
            found = pads_of_boards(read)
            modules_of_board = [sorted({r for r, _ in b.places if r.startswith("M")}) for b in read]
            all_modules, holes = set(), 0
            for path in sorted((out / "order").glob("*_board.zip")):
                panel = path.name.removesuffix("_board.zip")
                folder = place / f"{number}-{panel}"
                names = unpack(path, folder)
                expect(names == {f"{panel}-{n}" for n in BOARD_FILES}, f"{path.name}: files {names}")
                unpack(path.with_name(f"{panel}_assembly.zip"), folder)
                here = {m for m in re.findall(r"M(\d+)_U1", (folder / f"{panel}-cpl.csv").read_text(encoding="utf-8"))}
                placed = check_lists(folder, panel, here)
                expect(not all_modules & here, f"{panel}: modules of another panel")
                all_modules |= here
                check_places(placed, found, where_of(placed, found, modules_of_board))
                holes += len(re.findall(r"^X", (folder / f"{panel}-PTH.drl").read_text(encoding="ascii"), re.M))
                tooling = re.findall(r"^X", (folder / f"{panel}-NPTH.drl").read_text(encoding="ascii"), re.M)
                expect(len(tooling) == 4, f"{panel}: {len(tooling)} tooling holes")
                on_panel = [p for p, refs in zip(boards, modules_of_board) if refs[0][1:] in here]
                if HAS_READERS:
                    check_gerber(folder, panel, on_panel, node_modules)
            wanted = {str(m.get("number", m["id"])) for m in json.loads(pathlib.Path(design).read_text())["modules"]}
            expect(all_modules == wanted, f"modules {sorted(all_modules ^ wanted)} are on no panel")
            expect(holes == sum(holes_of(p) for p in boards), f"{holes} plated holes")
    if boards_test.failures:
        return 1
    if not HAS_READERS:
        print("left out: gerbv or @tracespace/plotter is not installed")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())
