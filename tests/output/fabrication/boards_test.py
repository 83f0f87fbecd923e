#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the files of `triskin fabricate` with the design by other code.
Usage: boards_test.py boards|ezdxf|kicad TRISKIN WRITE_STRIP [DESIGN...]   without DESIGN: strips of our own
boards: an s-expression reader of this file follows the copper of every KiCad board and finds patches, lines, addresses,
joints and cables. ezdxf: lengths on each layer of the drawings. kicad: its own rule check (pcbnew).
Exit status: 0 all is as the design says, 1 something is not, 77 the other reader is missing."""
import collections
import csv
import itertools
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

RELIEF, SIDE = 1.0, 30.0
BUS = ["GND", "VDD", "SDA0", "SCL0", "SDA1", "SCL1", "SDA2", "SCL2", "SDA3", "SCL3"]
CABLE = [0, 1, 2, 9, 7, 6, 8, 5, 4, 3]  # Each pin of a cable has this bus net.
COPPER_LAYERS = ("F.Cu", "In1.Cu", "In2.Cu", "B.Cu")
failures = 0


def expect(holds, what):
    global failures
    if not holds:
        failures += 1
        print("not so:", what)


def import_of_debian(name):
    """Packages of Debian belong to Debian's Python, which need not be the first in the path."""
    try:
        return __import__(name)
    except ImportError:
        if sys.executable != "/usr/bin/python3" and pathlib.Path("/usr/bin/python3").exists():
            sys.exit(subprocess.run(["/usr/bin/python3", *sys.argv], check=False).returncode)
        print(f"left out: {name} is not installed")
        sys.exit(77)


# --- s-expressions -----------------------------------------------------------------------------------------------------


def read_expression(text):
    stack = [[]]
    for token in re.finditer(r'\(|\)|"((?:[^"\\]|\\.)*)"|[^\s()"]+', text):
        word = token.group(0)
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token.group(1) if word.startswith('"') else word)
    assert len(stack) == 1, "brackets do not match"
    return stack[0][0]


def children(node, name):
    return [c for c in node if isinstance(c, list) and c and c[0] == name]


def child(node, name):
    found = children(node, name)
    return found[0][1:] if found else None


# --- copper ------------------------------------------------------------------------------------------------------------


class Copper:
    """A pad or a track: a line of some width on some layers. A rectangle is looked at as the circle inside it, so that
    what touches here surely touches."""

    def __init__(self, layers, start, end, radius, net, owner):
        self.layers, self.start, self.end, self.radius, self.net, self.owner = layers, start, end, radius, net, owner


def distance(a, b):
    def to_line(p, q, r):
        dx, dy = r[0] - q[0], r[1] - q[1]
        square = dx * dx + dy * dy
        t = 0.0 if square == 0 else max(0.0, min(1.0, ((p[0] - q[0]) * dx + (p[1] - q[1]) * dy) / square))
        return math.hypot(p[0] - q[0] - t * dx, p[1] - q[1] - t * dy)

    def turn(p, q, r):
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    if a.start != a.end and b.start != b.end:
        if turn(a.start, a.end, b.start) * turn(a.start, a.end, b.end) < 0 and \
                turn(b.start, b.end, a.start) * turn(b.start, b.end, a.end) < 0:
            return 0.0
    return min(to_line(a.start, b.start, b.end), to_line(a.end, b.start, b.end),
               to_line(b.start, a.start, a.end), to_line(b.end, a.start, a.end))


class Board:
    def __init__(self, path):
        root = read_expression(path.read_text(encoding="utf-8"))
        assert root[0] == "kicad_pcb" and child(root, "version") == ["20211014"]
        self.net_names = {number: name for number, name in (n[1:] for n in children(root, "net"))}
        self.items, self.places = [], {}
        for footprint in children(root, "footprint"):
            self.read_footprint(footprint)
        for segment in children(root, "segment"):
            start, end = (tuple(float(v) for v in child(segment, k)) for k in ("start", "end"))
            self.items.append(Copper({child(segment, "layer")[0]}, start, end, float(child(segment, "width")[0]) / 2,
                                     self.net_names[child(segment, "net")[0]], None))
        for via in children(root, "via"):
            place = tuple(float(v) for v in child(via, "at"))
            self.items.append(Copper(set(COPPER_LAYERS), place, place, float(child(via, "size")[0]) / 2,
                                     self.net_names[child(via, "net")[0]], None))
        self.planes = []  # net name, ring
        for zone in children(root, "zone"):
            points = children(children(zone, "filled_polygon")[0], "pts")[0]
            expect(child(zone, "layer") == ["In1.Cu"], "a plane lies on In1")
            self.planes.append((child(zone, "net_name")[0], [tuple(float(v) for v in p[1:]) for p in children(points, "xy")]))
        self.lines, self.bends = collections.defaultdict(list), []
        for line in children(root, "gr_line"):
            start, end = (tuple(float(v) for v in child(line, k)) for k in ("start", "end"))
            self.lines[child(line, "layer")[0]].append(math.dist(start, end))
            if child(line, "layer") == ["User.1"]:
                middle = [(start[a] + end[a]) / 2 for a in (0, 1)]
                angle, = [t[1] for t in children(root, "gr_text") if child(t, "layer") == ["User.1"] and
                          math.dist([float(v) for v in child(t, "at")[:2]], middle) < 1e-3]
                self.bends.append(((start, end), float(angle.split("°")[0])))

    def read_footprint(self, footprint):
        x, y, *angle = (float(v) for v in child(footprint, "at"))
        turn = math.radians(angle[0] if angle else 0.0)
        reference = [t for t in children(footprint, "fp_text") if t[1] == "reference"][0][2]
        for pad in children(footprint, "pad"):
            px, py = (float(v) for v in child(pad, "at")[:2])
            # KiCad's y runs downwards: a turn that looks counter-clockwise is a negative one of its axes.
            place = (x + px * math.cos(turn) + py * math.sin(turn), y - px * math.sin(turn) + py * math.cos(turn))
            layers = {l for l in child(pad, "layers") if l.endswith(".Cu")}
            if layers == {"*.Cu"}:
                layers = set(COPPER_LAYERS)
            net = child(pad, "net")
            radius = min(float(v) for v in child(pad, "size")) / 2
            self.items.append(Copper(layers, place, place, radius, net[1] if net else None, (reference, pad[1])))
            self.places.setdefault((reference, pad[1]), []).append(place)

    def connect(self):
        """Parts of copper that hang together, by touch alone; nets are only compared."""
        cells = collections.defaultdict(list)
        for k, item in enumerate(self.items):
            margin = item.radius + 0.2
            low = [min(item.start[a], item.end[a]) - margin for a in (0, 1)]
            high = [max(item.start[a], item.end[a]) + margin for a in (0, 1)]
            for cell in itertools.product(*(range(int(low[a] // 2), int(high[a] // 2) + 1) for a in (0, 1))):
                cells[cell].append(k)
        part = list(range(len(self.items)))

        def root(k):
            while part[k] != k:
                part[k] = part[part[k]]
                k = part[k]
            return k

        seen = set()
        for members in cells.values():
            for a, b in itertools.combinations(members, 2):
                if (a, b) in seen:
                    continue
                seen.add((a, b))
                one, two = self.items[a], self.items[b]
                if not one.layers & two.layers:
                    continue
                gap = distance(one, two) - one.radius - two.radius
                if gap < 1e-6:
                    expect(one.net == two.net, f"{one.net} {one.owner} touches {two.net} {two.owner}")
                    part[root(a)] = root(b)
                elif one.net != two.net:
                    expect(gap > 0.0999, f"{one.net} {one.owner} is {gap:.3f} mm from {two.net} {two.owner}")
        self.part_of = {}
        for k, item in enumerate(self.items):
            if item.owner:
                self.part_of.setdefault(item.owner, set()).add(root(k))


def is_within(point, ring):
    odd = False
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
        if (ay > point[1]) != (by > point[1]) and point[0] < ax + (point[1] - ay) * (bx - ax) / (by - ay):
            odd = not odd
    return odd


def around(item):
    """Places on the border of a pad or track, and along its middle."""
    length = math.dist(item.start, item.end)
    for k in range(int(length / 0.5) + 2):
        t = k / (int(length / 0.5) + 1)
        x, y = (item.start[a] + t * (item.end[a] - item.start[a]) for a in (0, 1))
        yield x, y
        for turn in range(8):
            angle = turn * math.pi / 4
            yield x + item.radius * math.cos(angle), y + item.radius * math.sin(angle)


SENSOR_GAP = 0.24  # mm between sensor tracks and digital ones on the two lower layers, which no plane parts


def check_shield(board, modules):
    """A plane that ACSHIELD drives lies under every taxel and sensor track of the touch side; on the lower layers nothing
    digital passes near a sensor track. Plated holes of the bus on the touch side are pads, not tracks."""
    for module in modules:
        name = f"M{module['id']}_"
        rings = [ring for net, ring in board.planes if net == name + "ACSHIELD"]
        expect(rings, f"{name}: no plane of ACSHIELD")
        sensors = [i for i in board.items if i.net and i.net.startswith(name + "CIN")]
        # Around the hole through which a sensor's track goes to the chip, the plane is open.
        holes = [i for i in sensors if i.layers == set(COPPER_LAYERS)]
        bare = sum(not any(is_within(p, r) for r in rings) and
                   not any(math.dist(p, h.start) < h.radius + 0.12 for h in holes)
                   for i in sensors if i.layers == {"F.Cu"} for p in around(i))
        expect(bare == 0, f"{name}: {bare} places of sensors without the plane under them")
        digital = [i for i in board.items if i.net and i.owner is None and i.layers != set(COPPER_LAYERS) and
                   "_CIN" not in i.net and not i.net.endswith("ACSHIELD")]
        expect(not any(i.layers & {"F.Cu", "In1.Cu"} for i in digital), f"{name}: a digital track above the plane")
        for sensor in sensors:
            if sensor.layers == {"F.Cu"} or sensor.owner:
                continue
            near = [i.net for i in digital if distance(sensor, i) - sensor.radius - i.radius < SENSOR_GAP]
            expect(not near, f"{name}: {sensor.net} beside {sorted(set(near))}")


def check_planes(board):
    """Copper of another net on In1 keeps off the planes; the hole of ACSHIELD hangs on its plane."""
    for net, ring in board.planes:
        box = [f(p[a] for p in ring) for a in (0, 1) for f in (min, max)]
        edges = list(zip(ring, ring[1:] + ring[:1]))
        for item in board.items:
            x, y = item.start
            if "In1.Cu" not in item.layers or not (box[0] < x < box[1] and box[2] < y < box[3]):
                continue
            if item.net == net:
                expect(is_within(item.start, ring), f"{net}: its hole is in the plane")
                continue
            near = [(a, b) for a, b in edges if min(a[0], b[0]) - 1 < x < max(a[0], b[0]) + 1 and
                    min(a[1], b[1]) - 1 < y < max(a[1], b[1]) + 1]
            gap = min((distance(item, Copper(item.layers, a, b, 0.0, net, None)) for a, b in near), default=1) - item.radius
            expect(not is_within(item.start, ring) and gap > 0.0999, f"{net}: {item.net} is {gap:.3f} mm from the plane")


THICKNESS = 0.272  # mm; the inner radius of a bend is ten times this (docs/fabrication.md)
HOLE_FREE = 0.5  # mm from the wall of a hole to the bend


def check_bends(board):
    """No plated hole, pad or taxel lies in the area of a bend, nor a hole near it; tracks cross it at right angles. The
    angle of a fold stands beside it in whole degrees."""
    for (start, end), angle in board.bends:
        reach = (10 * THICKNESS + THICKNESS / 2) * math.radians(angle) / 2
        along = [(end[a] - start[a]) / math.dist(start, end) for a in (0, 1)]
        for item in board.items:
            def place(p):
                d = (p[0] - start[0], p[1] - start[1])
                return d[0] * along[0] + d[1] * along[1], abs(d[0] * along[1] - d[1] * along[0])
            (s, near), (t, far) = place(item.start), place(item.end)
            if not (0 < s < math.dist(start, end)) or min(near, far) - item.radius > reach + HOLE_FREE:
                continue
            if item.layers == set(COPPER_LAYERS):
                expect(near - 0.1 > reach + HOLE_FREE - 0.015, f"{item.owner}: its hole is {near:.2f} mm from a bend")
            elif item.owner:
                expect(near - item.radius > reach - 0.015, f"{item.owner} is {near - item.radius:.2f} mm from a bend")
            elif min(near, far) - item.radius < reach - 0.015:
                expect(abs(s - t) < 1e-3, f"{item.net}: its track crosses a bend askew")


# --- what the design says ----------------------------------------------------------------------------------------------


def corners_of(module):
    i, j = module["i"], module["j"]
    grid = [(i, j), (i + 1, j), (i, j + 1)] if module["up"] else [(i + 1, j), (i + 1, j + 1), (i, j + 1)]
    return grid


def side_pairs(modules):
    """Returns pairs of modules of an island that share a lattice side, as (id, id) by that side's ends."""
    ends = collections.defaultdict(list)
    for m in modules:
        grid = corners_of(m)
        for s in range(3):
            ends[frozenset((grid[s], grid[(s + 1) % 3]))].append(m["id"])
    return ends


def expected_joints(modules):
    """Returns joints that carry lines: from each module to its parent in the same island, but not over a jumper."""
    ids = {m["id"] for m in modules}
    return {frozenset((m["id"], m["parent"])) for m in modules
            if m["parent"] in ids and m["parent"] in m["neighbours"]}


def check_module(board, module):
    name, patch = f"M{module['id']}", module["patch"]
    for port in "ABC":
        for net, wire in enumerate(BUS):
            owner = (name, f"{port}{net + 1}")
            expect(len(board.part_of[owner]) == 1 and board.part_of[owner] == board.part_of[(name, f"A{net + 1}")],
                   f"{name}: {wire} of port {port} hangs together with that of port A")
            nets = {i.net for i in board.items if i.owner == owner}
            expect(nets == {f"P{patch}_{wire}"}, f"{name}: port {port} carries {nets}")
    closed = {s for s in BUS[2:] + ["ADD0L", "ADD0H", "ADD1L", "ADD1H"]
              if board.part_of[(name, s + ".1")] == board.part_of[(name, s + ".2")]}
    line, address = module["line"], module["address"]
    expect(closed == {f"SDA{line}", f"SCL{line}", "ADD0" + "LH"[address & 1], "ADD1" + "LH"[address >> 1 & 1]},
           f"{name}: line {line}, address {address}, closed straps {sorted(closed)}")


def check_whole_nets(board):
    """All pads of a net on a module hang together; from module to module check_module follows the ports."""
    parts = collections.defaultdict(set)
    for item in board.items:
        if item.owner and item.net:
            parts[(item.owner[0], item.net)] |= board.part_of[item.owner]
    for (module, net), found in parts.items():
        expect(len(found) == 1, f"{module}: {net} is in {len(found)} parts")


def check_taxels(board, module):
    """Compares the places of the pads with the design: equal distances between all pairs, and not mirrored."""
    flat = [board.places[(f"M{module['id']}", f"T{t}")][0] for t in range(12)]
    solid = [t["position"] for t in module["taxels"]]
    for a, b in itertools.combinations(range(12), 2):
        expect(abs(math.dist(flat[a], flat[b]) - math.dist(solid[a], solid[b])) < 1e-3, f"taxels {a} and {b}")
    (ax, ay), (bx, by), (cx, cy) = flat[0], flat[1], flat[11]
    x = [solid[1][k] - solid[0][k] for k in range(3)]
    y = [solid[11][k] - solid[0][k] for k in range(3)]
    n = module["taxels"][0]["normal"]
    seen_from_outside = sum(n[k] * (x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3]) for k in range(3))
    on_board = -((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))  # y runs downwards
    expect(seen_from_outside * on_board > 0, "the board is seen from the touch side")
    corner = module["corners"][module["rotation"]]
    expect(math.dist(corner, solid[5]) < 8, "taxel 5 lies at the corner where the side of port A begins")


def joints_on(board, modules):
    """Returns pairs of modules with a common part of copper on the GND of their ports, followed over tracks between modules."""
    pairs = set()
    by_place = {}
    for m in modules:
        for port, pin in itertools.product("ABC", range(1, 11)):
            for place in board.places[(f"M{m['id']}", f"{port}{pin}")]:
                by_place[place] = m["id"]

    def nearest(point):
        place = min(by_place, key=lambda p: math.dist(p, point))
        return by_place[place] if math.dist(place, point) < 1e-3 else None

    count = 0
    for track in (i for i in board.items if i.owner is None and i.layers == {"B.Cu"}):
        ends = frozenset((nearest(track.start), nearest(track.end)))
        if None in ends or len(ends) < 2:  # A track inside a module.
            continue
        count += 1
        if track.net.endswith("GND"):
            pairs.add(ends)
    return pairs, count


def check_cables(board, design, modules):
    wanted = {f"C{m['patch']}": (m, m["rotation"]) for m in modules if m["parent"] < 0}
    by_id = {m["id"]: m for m in modules}
    for jumper in design.get("jumpers", []):
        for end, side in zip(jumper["modules"], jumper["sides"]):
            if end in by_id:
                wanted["J{}-{}_M{}".format(*jumper["modules"], end)] = (by_id[end], side)
    found = {ref for ref, _ in board.places if not ref.startswith("M")}
    expect(found == set(wanted), f"cables {sorted(found)} of {sorted(wanted)}")
    for ref, (module, side) in wanted.items():
        port = "ABC"[(side - module["rotation"]) % 3]
        for pin in range(10):
            contact = (f"M{module['id']}", f"{port}{CABLE[pin] + 1}")
            expect(board.part_of[(ref, str(pin + 1))] == board.part_of[contact], f"{ref}: pin {pin + 1} to {contact}")


def check_netlist(path, board):
    root = read_expression(path.read_text(encoding="utf-8"))
    listed = {}
    for net in children(children(root, "nets")[0], "net"):
        for node in children(net, "node"):
            listed[(child(node, "ref")[0], child(node, "pin")[0])] = child(net, "name")[0]
    on_board = {i.owner: i.net for i in board.items if i.owner and i.net}
    expect(listed == on_board, f"{path.name}: net list and board name the same nets")


def island_length(modules):
    """Measures edge, folds and slits of an island by counting sides."""
    slit = fold = outline = 0
    by_id = {m["id"]: m for m in modules}
    for ids in side_pairs(modules).values():
        if len(ids) == 1:
            outline += 1
        elif ids[1] in by_id[ids[0]]["neighbours"]:
            fold += 1
        else:
            slit += 1
    return outline, fold, slit


def islands_of(design):
    islands = collections.defaultdict(list)
    for m in design["modules"]:
        islands[m["island"]].append(m)
    return islands


def header_pins():
    """Nets of the controller and their pins, from the firmware's header of the board."""
    header = pathlib.Path(__file__).resolve().parents[3] / (
        "firmware/board/stm32g474/boards/nucleo_g474re/triskin/board/board_config.hpp")
    names = {"CanReceive": "CAN_RX", "CanSend": "CAN_TX", "LogSend": "LOG_TX", "Light": "LIGHT",
             "ChainClock": "CHAIN_CLOCK", "ChainIn": "CHAIN_IN", "ChainOut": "CHAIN_OUT",
             "ChainEnable": "CHAIN_ENABLE", "ChainEnable2": "CHAIN_ENABLE2", "ChainLatch": "CHAIN_LATCH"}
    pins = {}
    for name, port, number in re.findall(r"\bk(\w+)\{'([A-Z])', (\d+)\}", header.read_text(encoding="utf-8")):
        line = re.fullmatch(r"(Scl|Sda)([1-4])", name)
        if name != "Boot":  # The pin of CAN_RX.
            pins[f"{line[1].upper()}{int(line[2]) - 1}" if line else names[name]] = f"P{port}{number}"
    return pins


def check_controller(folder):
    """The circuit has the pins of the header, and its cable fits the skin's."""
    with (folder / "kicad/controller.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    nets = collections.defaultdict(set)
    for row in rows:
        nets[row["net"]].add((row["component"], row["pin"]))
    wanted = header_pins()
    expect(len(wanted) == 18, f"{len(wanted)} pins in the header")
    for net, pin in wanted.items():
        expect({p for c, p in nets[net] if c == "U1"} == {pin}, f"controller: {net} at {nets[net]}, header: {pin}")
    used = [row["pin"] for row in rows if row["component"] == "U1"]
    expect(len(used) == len(set(used)), "controller: a pin has two nets")
    for pin, net in enumerate(CABLE, 1):
        expect(("J1", str(pin)) in nets[BUS[net]], f"controller: pin {pin} of the cable is not {BUS[net]}")
    for net in BUS[2:]:
        pulls = [c for c, _ in nets[net] if c.startswith("R")]
        expect(len(pulls) == 1 and any(c == pulls[0] for c, _ in nets["VDD"]), f"controller: pull-up of {net}")
    for net, pins in nets.items():
        expect(len(pins) > 1 or net == "USB_VBUS", f"controller: {net} joins nothing")


def check_boards(folder, design):
    check_controller(folder)
    for island, modules in islands_of(design).items():
        path, = folder.glob(f"kicad/*-I{island}-*.kicad_pcb")
        board = Board(path)
        board.connect()
        for module in modules:
            check_module(board, module)
            check_taxels(board, module)
        pairs, tracks = joints_on(board, modules)
        joints = expected_joints(modules)
        expect(pairs == joints, f"island {island}: joints {pairs ^ joints} differ")
        expect(tracks == 20 * len(joints), f"island {island}: {tracks} tracks over {len(joints)} joints")
        check_shield(board, modules)
        check_planes(board)
        check_bends(board)
        check_cables(board, design, modules)
        check_whole_nets(board)
        check_netlist(path.with_suffix(".net"), board)
        outline, fold, slit = island_length(modules)
        cut = max(RELIEF, design.get("corner_cut_mm", 0))
        for layer, length in (("Edge.Cuts", outline * (SIDE - 2 * cut) + 3 * len(modules) * cut),
                              ("User.1", fold * (SIDE - 2 * cut)), ("User.2", slit * (SIDE - 2 * cut))):
            expect(abs(sum(board.lines[layer]) - length) < 1e-3, f"{layer}: {sum(board.lines[layer])} of {length} mm")
    if not failures:
        print(f"{len(islands_of(design))} boards with {len(design['modules'])} modules are wired as the design is")


def check_drawings(folder, design, ezdxf):
    for island, modules in islands_of(design).items():
        path, = folder.glob(f"dxf/*-I{island}-*.dxf")
        drawing = ezdxf.readfile(str(path))
        expect(not drawing.audit().has_errors, f"{path.name}: sound")
        length = collections.Counter()
        for entity in drawing.modelspace():
            if entity.dxftype() == "POLYLINE":
                points = [tuple(v.dxf.location)[:2] for v in entity.vertices]
                length[entity.dxf.layer] += sum(math.dist(a, b) for a, b in zip(points, points[1:] + points[:1]))
            elif entity.dxftype() == "LINE":
                length[entity.dxf.layer] += math.dist(entity.dxf.start, entity.dxf.end)
        outline, fold, slit = island_length(modules)
        cut = max(RELIEF, design.get("corner_cut_mm", 0))
        edge = outline * (SIDE - 2 * cut) + 3 * len(modules) * cut
        expect(abs(length["OUTLINE"] + length["HOLES"] - edge) < 1e-3, f"island {island}: edge {length} of {edge} mm")
        expect(abs(length["FOLDS"] - fold * (SIDE - 2 * cut)) < 1e-3, f"island {island}: folds {length}")
        expect(abs(length["SLITS"] - slit * (SIDE - 2 * cut)) < 1e-3, f"island {island}: slits {length}")
    print(f"ezdxf {ezdxf.__version__}: lengths of {len(islands_of(design))} drawings agree")


def rings_on(drawing, layer):
    return [[tuple(v.dxf.location)[:2] for v in entity.vertices]
            for entity in drawing.modelspace() if entity.dxftype() == "POLYLINE" and entity.dxf.layer == layer]


def check_sheets(folder, design, ezdxf):
    """Every island's outline lies on its sheet where places.csv says, and nothing else does."""
    lines = (folder / "sheets/places.csv").read_text(encoding="utf-8").split()
    expect(lines[0] == "part_number,sheet,x_mm,y_mm,angle_deg", f"head of places.csv: {lines[0]}")
    expect(len(lines) == 1 + len(islands_of(design)), f"{len(lines) - 1} islands in places.csv")
    wanted = collections.Counter()
    for line in lines[1:]:
        name, sheet, *numbers = line.split(",")
        x, y, angle = map(float, numbers)
        wanted[sheet] += 1
        drawing = ezdxf.readfile(str(folder / f"sheets/sheet_{sheet}.dxf"))
        expect(not drawing.audit().has_errors, f"sheet {sheet}: sound")
        (ring,) = rings_on(ezdxf.readfile(str(folder / f"dxf/{name}.dxf")), "OUTLINE")
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        moved = [(x + c * p - s * q, y + s * p + c * q) for p, q in ring]
        distance = min(max(math.dist(a, b) for a, b in zip(moved, other)) for other in rings_on(drawing, "OUTLINE")
                       if len(other) == len(moved))
        expect(distance < 0.002, f"{name} lies {distance} mm from its place on sheet {sheet}")
        expect(name in {e.dxf.text for e in drawing.modelspace() if e.dxftype() == "TEXT"}, f"{name} is marked")
    for sheet, count in wanted.items():
        outlines = rings_on(ezdxf.readfile(str(folder / f"sheets/sheet_{sheet}.dxf")), "OUTLINE")
        expect(len(outlines) == count, f"sheet {sheet} has {len(outlines)} outlines, {count} are listed")


def check_rules(folder, design, pcbnew):
    boards = sorted(folder.glob("kicad/*.kicad_pcb"))
    expect(len(boards) == 1 + len(islands_of(design)), f"{len(boards)} boards")  # The module alone is one.
    for path in boards:
        report = path.with_suffix(".rpt")
        board = pcbnew.LoadBoard(str(path))
        filled = [zone.GetFilledArea() for zone in board.Zones()]
        pcbnew.ZONE_FILLER(board).Fill(board.Zones())
        for zone, area in zip(board.Zones(), filled):
            expect(abs(zone.GetFilledArea() / area - 1) < 0.01, f"{zone.GetNetname()}: KiCad fills {zone.GetFilledArea()} of {area}")
        pcbnew.WriteDRCReport(board, str(report), pcbnew.EDA_UNITS_MILLIMETRES, True)
        text = report.read_text(encoding="utf-8")
        violations = int(re.search(r"Found (\d+) DRC violations", text).group(1))
        open_pads = int(re.search(r"Found (\d+) unconnected pads", text).group(1))
        expect(violations == 0, f"{path.name}: {violations} violations\n{text}")
        expect(open_pads == 0, f"{path.name}: {open_pads} open connections\n{text}")
    print(f"KiCad {pcbnew.GetBuildVersion()}: 0 violations on {len(boards)} boards")


def main():
    witness, program, write_strip = sys.argv[1:4]
    foreign = {"ezdxf": "ezdxf", "kicad": "pcbnew"}.get(witness)
    other = import_of_debian(foreign) if foreign else None
    with tempfile.TemporaryDirectory() as temporary:
        place = pathlib.Path(temporary)
        designs = sys.argv[4:]
        if not designs:
            designs = [str(place / "whole.json"), str(place / "short.json")]
            subprocess.run([write_strip, designs[0], "20"], check=True)
            subprocess.run([write_strip, designs[1], "7", "3"], check=True)
        for number, name in enumerate(designs):
            folder = place / f"out{number}"
            subprocess.run([program, "fabricate", name, "-o", str(folder), "--only", "dxf,kicad,sheets"], check=True,
                           capture_output=True)
            design = json.loads(pathlib.Path(name).read_text(encoding="utf-8"))
            if witness == "boards":
                check_boards(folder, design)
            elif witness == "ezdxf":
                check_drawings(folder, design, other)
                check_sheets(folder, design, other)
            else:
                check_rules(folder, design, other)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
