#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the assembly sheet back from the drawing operators of its PDF, with mutool, and its QR codes, with zbarimg.
Usage: sheet_test.py TRISKIN WRITE_STRIP [DESIGN...]   without DESIGN: two strips of our own, whole and with cut corners
Exit status: 0 all is as the design says, 1 something is not, 77 a reader is missing or the program has no sheet."""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

MM = 25.4 / 72
SIDE = 30.0
TOLERANCE = 0.01
MARGIN = 8.0
SLIT = str(pathlib.Path(__file__).resolve().parents[3] / "docs/examples/scenes/forearm.json")  # cables that enter at a slit
failures = 0


def expect(holds, what):
    global failures
    if not holds:
        failures += 1
        print("not so:", what)


def inside(point, polygon):
    x, y = point
    turns = [(b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) for a, b in zip(polygon, polygon[1:] + polygon[:1])]
    return all(t > 0 for t in turns) or all(t < 0 for t in turns)


def points_of(path):
    """Returns the corners of a path in mm; the closing point is not repeated."""
    scale = [float(v) for v in path.get("transform").split()]
    points = []
    for step in path:
        if step.tag in ("moveto", "lineto"):
            x, y = float(step.get("x")), float(step.get("y"))
            points.append((MM * (scale[0] * x + scale[2] * y + scale[4]), MM * (scale[1] * x + scale[3] * y + scale[5])))
    closed = any(step.tag == "closepath" for step in path)
    if closed and len(points) > 1 and points[-1] == points[0]:
        points.pop()
    return points


class Page:
    def __init__(self, root):
        self.outlines, self.lines, self.fills, self.texts, self.glyphs = [], [], [], [], []
        for path in root.iter("stroke_path"):
            points, width = points_of(path), MM * float(path.get("linewidth"))
            closed = path.find("closepath") is not None
            (self.outlines if closed else self.lines).append((points, width))
        for path in root.iter("fill_path"):
            color = [float(v) for v in path.get("color").split()]
            self.fills.append((points_of(path), color))
        for span in root.iter("span"):
            glyphs = span.findall("g")
            if not glyphs:
                continue
            matrix = [float(v) for v in span.get("trm").split()]
            size = math.hypot(matrix[0], matrix[1])
            self.add_runs(glyphs, size, matrix)

    def add_runs(self, glyphs, size, matrix):
        """mutool puts texts of one font into one span: a run ends where the next glyph does not follow."""
        run, start, due = "", None, None
        for g in glyphs:
            at = (float(g.get("x")), float(g.get("y")))
            if due is not None and math.dist(at, due) > 0.3 * size:
                self.texts.append((run, (MM * start[0], MM * start[1]), MM * size))
                run, start = "", None
            start = start or at
            if g.get("unicode").strip():
                self.glyphs.append((g.get("unicode"), (MM * at[0], MM * at[1]), MM * size))
            run += g.get("unicode")
            step = float(g.get("adv"))
            due = (at[0] + step * matrix[0], at[1] - step * matrix[1] if matrix[1] else at[1])
            if matrix[1]:
                due = (at[0] + step * matrix[0], at[1] + step * matrix[1])
        if run:
            self.texts.append((run, (MM * start[0], MM * start[1]), MM * size))


def read_pages(pdf):
    trace = subprocess.run(["mutool", "draw", "-q", "-F", "trace", pdf], capture_output=True, text=True, check=True).stdout
    return [Page(page) for page in tree.fromstring(trace).iter("page")]


def sides_of(polygon):
    return [math.dist(a, b) for a, b in zip(polygon, polygon[1:] + polygon[:1])]


def module_outlines(page, cut):
    """Returns hairlines of 0.05 mm with the corners of a module and its lengths."""
    expected = [SIDE] if cut == 0 else [SIDE - 2 * cut, cut]
    found = []
    for points, width in page.outlines:
        if abs(width - 0.05) > 0.005 or len(points) != (3 if cut == 0 else 6):
            continue
        lengths = sides_of(points)
        if max(lengths) > 33:
            continue  # the example of the key, larger than life
        for k, length in enumerate(lengths):
            expect(abs(length - expected[k % len(expected)]) <= TOLERANCE, f"a side is {length:.4f} mm long")
        found.append(points)
    return found


def number_in(page, polygon):
    inner = [t for t, at, size in page.texts if abs(size - 4.4) < 0.1 and inside((at[0] + 0.5, at[1] - 1.5), polygon)]
    expect(len(inner) == 1, f"a module has the numbers {inner}")
    return int(inner[0]) if inner else -1


def straps_in(page, polygon):
    """Tells which pad is black in the upper row, and of which address those in the lower: ADD0L, ADD0H, ADD1L, ADD1H."""
    def pads(shapes):
        squares = [p for p in shapes if len(p) == 4 and all(abs(s - 2.0) < 0.02 for s in sides_of(p))]
        centers = [(sum(x for x, _ in p) / 4, sum(y for _, y in p) / 4) for p in squares]
        return [c for c in centers if inside(c, polygon)]
    closed = pads([p for p, color in page.fills if color == [0, 0, 0]])
    opened = pads([p for p, _ in page.outlines])
    rows = {}
    for center, black in [(c, True) for c in closed] + [(c, False) for c in opened]:
        rows.setdefault(round(center[1], 1), []).append((center[0], black))
    expect(len(rows) == 2 and all(len(r) == 4 for r in rows.values()), f"pads stand as {rows}")
    line, bridges = [[k for k, (_, is_black) in enumerate(sorted(rows[y])) if is_black] for y in sorted(rows)]
    expect(len(line) == 1, f"black pads {line}")
    addresses = [a for a in range(4) if bridges == [a & 1, 2 + (a >> 1)]]
    expect(len(addresses) == 1, f"black pads {bridges}")
    return (line + [-1])[0], (addresses + [-1])[0]


def input_side(page, module, polygon, cut):
    """Returns the tile side at which the arrow enters: the outline is drawn in the order of the tile."""
    heads = [p for p, color in page.fills if color == [0, 0, 0] and len(p) == 3 and inside(p[0], polygon)]
    expect(len(heads) == 1, f"module {module} has {len(heads)} arrows")
    if not heads:
        return -1
    step = 1 if cut == 0 else 2
    middles = [((polygon[step * s][0] + polygon[(step * s + 1) % len(polygon)][0]) / 2,
                (polygon[step * s][1] + polygon[(step * s + 1) % len(polygon)][1]) / 2) for s in range(3)]
    return min(range(3), key=lambda s: math.dist(heads[0][0], middles[s]))


def check_modules(design, pages):
    wiring = {m["id"]: m for m in design["modules"]}
    cut, seen = design.get("corner_cut_mm", 0), {}
    for page in pages:
        for polygon in module_outlines(page, cut):
            module = number_in(page, polygon)
            expect(module not in seen, f"module {module} is drawn twice")
            seen[module] = polygon
            m = wiring.get(module)
            if m is None:
                continue
            line, address = straps_in(page, polygon)
            expect((line, address) == (m["line"], m["address"]), f"module {module} is strapped {line}, {address}")
            side = input_side(page, module, polygon, cut)
            expect(side == m["rotation"], f"module {module} has its port A at side {side}")
            area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, polygon[1:] + polygon[:1]))
            expect(area < 0, f"module {module} is mirrored")  # y points down: counter-clockwise seen from outside
    expect(sorted(seen) == sorted(wiring), f"{len(seen)} of {len(wiring)} modules are drawn")
    return len(seen)


def rows_of(page):
    """Returns the text in table rows: cells at one height, from the left."""
    rows = {}
    for text, at, _ in page.texts:
        rows.setdefault(round(at[1], 1), []).append((at[0], text))
    return [[t for _, t in sorted(row)] for row in rows.values()]


def strap_of(address):
    """Returns the solder bridges at ADD0 and ADD1, and the address of the converter: "ADD0L ADD1H (2E)"."""
    return f"ADD0{'LH'[address & 1]} ADD1{'LH'[address >> 1]} ({0x2C + address:02X})"


def check_tables(design, pages):
    rows = {}
    for page in pages:
        for row in rows_of(page):
            if len(row) == 7 and row[0].isdigit() and row[2].startswith("L"):
                expect(int(row[0]) not in rows, f"module {row[0]} is in two tables")
                rows[int(row[0])] = row
    for m in design["modules"]:
        row = rows.get(m["id"], [""] * 7)
        expect(row[2] == f"L{m['line']}" and row[3] == strap_of(m["address"]), f"table of module {m['id']}: {row}")
        parent = "cable" if m["parent"] < 0 else str(m["parent"])
        jumper = "" if parent == "cable" else "jumper J{}-{}".format(*sorted((m["id"], int(parent))))
        expect(row[4] in (parent, jumper), f"module {m['id']} hangs on {row[4]}, not {parent}")


def check_points(pages):
    """The name of a point P or Q must not overlap text beside it, such as the name of a jumper."""
    for number, page in enumerate(pages, 1):
        names = [(text, at, size) for text, at, size in page.glyphs if text in "PQ" and abs(size - 4.0) < 0.1]
        for text, at, size in names:
            near = [other for other, there, of in page.glyphs if (there, of) != (at, size) and math.dist(at, there) < 0.6 * size]
            expect(not near, f"page {number}: {text} is written over {near}")


def check_cable_names(pages, cut):
    """The name of a cable stands inside the drawing, which ends at the margins, and beside modules, not over them."""
    for number, page in enumerate(pages, 1):
        names = [(text, at) for text, at, size in page.texts if "cable C" in text and abs(size - 2.6) < 0.1]
        modules = module_outlines(page, cut) if names else []
        for text, (x, y) in names:
            expect(x >= MARGIN and y >= MARGIN, f"page {number}: {text} begins at {x:.1f}, {y:.1f} mm")
            expect(not any(inside((x, y), module) for module in modules), f"page {number}: {text} stands over a module")


def check_rulers(pages):
    for k, page in enumerate(pages):
        lengths = [math.dist(p[0], p[1]) for p, _ in page.lines if len(p) == 2]
        expect(any(abs(length - 100) <= TOLERANCE for length in lengths), f"page {k + 1} has no ruler of 100 mm")


def check_codes(design, folder, pdf, count):
    subprocess.run(["mutool", "draw", "-q", "-r", "150", "-o", str(folder / "page%03d.png"), pdf], check=True, capture_output=True)
    patches, found = len(design["patches"]), set()
    for k in range(1, count + 1):
        texts = subprocess.run(["zbarimg", "-q", "--raw", str(folder / f"page{k:03d}.png")], capture_output=True, text=True).stdout.split()
        expect(texts, f"page {k} has no code")
        for text in texts:
            head, _, page = text.rpartition("/")
            name, _, patch = head.rpartition("/")
            expect(name == "triskin:" + design["design_id"] and page == str(k), f"page {k} says {text!r}")
            expect(patch == "-" or int(patch) < patches, f"page {k} says {text!r}")
            if patch != "-":
                found.add(int(patch))
    expect(found == set(range(patches)), f"codes name the controllers {sorted(found)} of {patches}")


def check(program, file, paper, folder):
    pdf = str(folder / "sheet.pdf")
    run = subprocess.run([program, "export", file, "--format", "pdf", "--paper", paper, "-o", pdf], capture_output=True, text=True)
    if run.returncode == 2 and "without its assembly sheet" in run.stderr:
        print(run.stderr.strip())
        sys.exit(77)
    expect(run.returncode == 0, run.stderr)
    first = pathlib.Path(pdf).read_bytes()
    subprocess.run([program, "export", file, "--format", "pdf", "--paper", paper, "-o", pdf], check=True, capture_output=True)
    expect(first == pathlib.Path(pdf).read_bytes(), "the same design gives other bytes")
    expect(b"CreationDate" not in first, "the sheet has a date")
    design, pages = json.loads(pathlib.Path(file).read_text()), read_pages(pdf)
    modules = check_modules(design, pages)
    check_tables(design, pages)
    check_points(pages)
    check_cable_names(pages, design.get("corner_cut_mm", 0))
    check_rulers(pages)
    if paper == "A4":  # they are the same on each paper
        check_codes(design, folder, pdf, len(pages))
    print(f"{file}, {paper}: {modules} modules on {len(pages)} pages")


def renumber(design, new):
    """Changes the numbers of the modules wherever the design names one; -1 is none."""
    def new_or_none(number):
        return number if number < 0 else new(number)
    for m in design["modules"]:
        m["id"], m["parent"] = new(m["id"]), new_or_none(m["parent"])
        m["neighbours"] = [new_or_none(n) for n in m["neighbours"]]
    for p in design["patches"]:
        p["entry"], p["second_entry"] = new(p["entry"]), new_or_none(p["second_entry"])
        p["modules"] = [new(m) for m in p["modules"]]
        p["cut_joints"] = [[new(m) for m in joint] for joint in p["cut_joints"]]


def make_strips(write_strip, folder):
    """Draws a strip over several pages, a shorter one with cut corners and one whose numbers have a gap; straps changed so that no pattern hides a fault."""
    files = []
    for name, count, cut in (("whole", 40, 0), ("cut", 9, 5), ("gaps", 40, 0)):
        file = folder / f"{name}.json"
        subprocess.run([write_strip, str(file), str(count)], check=True)
        design = json.loads(file.read_text())
        if cut:
            design["corner_cut_mm"] = cut
        for m in design["modules"]:
            m["line"], m["address"] = (m["line"] + 2 * m["id"]) % 4, (m["address"] + 3 * (m["id"] // 4)) % 4
        if name == "gaps":
            renumber(design, lambda number: number if number < 5 else number + 7)
        file.write_text(json.dumps(design))
        files.append(str(file))
    return files


def main():
    for reader in ("mutool", "zbarimg"):
        if shutil.which(reader) is None:
            print(f"{reader} is not installed: the sheet is not read back")
            return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in sys.argv[3:] or [*make_strips(sys.argv[2], folder), SLIT]:
            for paper in ("A4", "roll"):
                check(sys.argv[1], file, paper, folder)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
