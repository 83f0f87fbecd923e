# SPDX-License-Identifier: GPL-3.0-or-later
"""The sections of docs/evidence: each runs its programs, writes a page with tables and plots, and hands numbers to the
page on top."""
import collections
import csv
import datetime
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import tempfile
import textwrap

import evidence_top
from evidence_plot import Axis, dots, plot
from evidence_run import ROOT, Bench, Spread, exponent, fit, git, percent, processor, short, spread, table


class Page:
    """A page of docs/evidence in the making: text, plots and the numbers for the page on top."""

    def __init__(self, name, title, options):
        self.name, self.out, self.parts, self.numbers = name, options.out, [f"# {title}"], {}
        self.failed_only = options.failed

    def say(self, *paragraphs):
        self.parts += paragraphs

    def heading(self, text):
        self.parts.append(f"## {text}")

    def table(self, head, rows):
        self.parts.append(table(head, rows))

    def plot(self, name, title, x, y, series, note=""):
        file = self.out / f"{self.name}_{name}.svg"
        plot(file, title, x, y, [s for s in series if s[1]], note)
        self.parts.append(f"![{title}]({file.name})")

    def dots(self, name, title, label, rows, note=""):
        file = self.out / f"{self.name}_{name}.svg"
        dots(file, title, label, rows, note)
        self.parts.append(f"![{title}]({file.name})")

    def number(self, key, text, value=None, low=None, high=None):
        """A figure for the page on top: `text` is printed; value and range are drawn."""
        self.numbers[key] = {"text": text, "value": value, "low": low, "high": high}

    def ratio(self, key, value, template="{}"):
        self.number(key, template.format(spread(value)), float(value), getattr(value, "low", value), getattr(value, "high", value))


def of(rows, series, **wanted):
    return [r for r in rows if r.get("series") == series and all(r.get(k) == v for k, v in wanted.items())]


def error_bars(x, value, unit=1.0):
    return (x, value / unit, value.low / unit, value.high / unit) if isinstance(value, Spread) else (x, value / unit)


def placement(bench, page):
    rows = bench.rows("placement", by_time=("anytime",))
    base = {o: of(rows, "baseline", outline=o)[0] for o in ("smooth", "rough")}
    unit = base["smooth"]["processor_s"]
    page.say("The certified search places one outline on the grid and proves that no motion holds more modules "
             "([placement](../placement.md)). *Unit* is the processor time of the search on the smooth outline with 80 "
             "vertices and 757 cm², in the same run. Outlines are generated (seed: vertices · 100,003 + area); a rough one has "
             "radii that differ by ±25 % from vertex to vertex.")
    page.heading("Beside the paper's R4")
    page.say("R4 tries a pose for each pair of vertices and each of a hundred angles (252,800 here), with the paper's Algorithm 1 in "
             "CGAL; CGAL's time is extrapolated from 400 of its placements (inexact) and 100 (exact constructions), spread "
             "over all. *Sides first* is what a careful programmer would do. *Fast* is our own Algorithm 1.")
    versions = (("r4", "fast Algorithm 1"), ("r4_cgal", "CGAL, inexact"), ("r4_cgal_exact", "CGAL, exact"),
                ("r4_cgal_sides_first", "CGAL, inexact, sides first"), ("r4_cgal_exact_sides_first", "CGAL, exact, sides first"))
    lines, drawn = [], []
    for outline, r in base.items():
        for key, name in versions:
            ratio = r[f"{key}_s"].over(r["processor_s"])
            differ = r.get(f"{key}_differ", 0)
            lines.append((outline, name, r["modules"], r["r4_modules"], spread(ratio), differ))
            drawn.append((f"{outline}: {name}", float(ratio), ratio.low, ratio.high))
            if key == "r4_cgal":
                page.ratio(f"r4_{outline}", ratio)
    page.table(("outline", "R4 with", "search: modules", "R4: modules", "time of R4 over search", "values that differ"), lines)
    page.dots("r4", "Time of the paper's R4 over that of the certified search", "times the search", drawn, "median and range of the runs")
    page.number("r4_modules", ", ".join(f"{r['modules']} and {r['r4_modules']} ({o})" for o, r in base.items()))
    page.heading("Time against tolerance")
    page.say("A tile may stand over by ε. *Cells* are boxes of motions that were looked at.")
    tolerance = of(rows, "tolerance")
    page.table(("ε, mm", "modules", "bound − modules", "cells", "time, units"),
               [(f"{r['tolerance_mm']:g}", r["modules"], f"{r['gap']:g}", r["cells"], spread(r["processor_s"].over(unit))) for r in tolerance])
    page.number("tolerance", short(tolerance[-1]["cells"] / tolerance[0]["cells"]))
    page.say("What does cost is an outline that misses a pattern by a hair: 24 tiles of a hexagon in a 361-gon of radius "
             "60 mm − m hold 18 (worked by hand), and the smaller m is, the more cells are needed to prove it (ε = 1e-7 mm).")
    hair = of(rows, "hair")
    page.table(("m, mm", "modules", "bound", "cells", "time, units"),
               [(f"{r['missing_mm']:g}", r["modules"], r["upper_bound"], f"{r['cells']:,}", spread(r["processor_s"].over(unit))) for r in hair])
    page.plot("hair", "Proof against margin: cells until nothing is open", Axis("margin m by which the pattern does not fit, mm", [r["missing_mm"] for r in hair]),
              Axis("cells", [r["cells"] for r in hair]), [("361-gon", [(r["missing_mm"], r["cells"]) for r in hair])])
    page.heading("Bound against time")
    anytime = of(rows, "anytime")
    page.say("A rough outline of 1 m² with 200 vertices, ended by `--time-limit-s`: value and bound enclose the optimum at any time.")
    # The limit is one of time that passes, of which a busy machine gives a part; so each run is a point of its own.
    points = []
    for r in anytime:
        values = lambda key: r[key].values if isinstance(r[key], Spread) else [r[key]] * len(r["processor_s"].values)
        points += [(t / unit, 100 * g / m) for t, g, m in zip(r["processor_s"].values, values("gap"), values("modules"))]
    page.table(("time, units", "gap, % of the modules"), [(short(t), f"{g:.2f}") for t, g in sorted(points)])
    page.plot("anytime", "Gap between bound and value against time", Axis("time, units", [p[0] for p in points]),
              Axis("bound − modules, % of the modules", [p[1] for p in points if p[1] > 0]), [("1 m², 200 vertices", points)])
    page.heading("Growth with size")
    lines, curves, fits = [], {}, {}
    for series, key in (("vertices", "vertices"), ("area", "area_cm2")):
        for outline in ("smooth", "rough"):
            found = of(rows, series, outline=outline)
            curves[series, outline] = [error_bars(r[key], r["processor_s"].over(unit)) for r in found]
            fits[series, outline] = [(r[key], float(r["processor_s"])) for r in found if r["proved"]]
            lines.append((series, outline, f"{found[0][key]:g} … {found[-1][key]:g}", f"{found[0]['cells']:,} … {found[-1]['cells']:,}",
                          sum(r["proved"] for r in found), len(found), exponent(fits[series, outline])))
    page.table(("in", "outline", "range", "cells", "proved", "of", "exponent of time"), lines)
    for series, label in (("vertices", "vertices (757 cm²)"), ("area", "area, cm² (80 vertices)")):
        drawn = [(o, curves[series, o]) for o in ("smooth", "rough")]
        page.plot(series, f"Certified placement: time over {series}", Axis(label, [p[0] for _, c in drawn for p in c]),
                  Axis("time, units", [v for _, c in drawn for p in c for v in p[1:]]), drawn)
    page.number("vertices", f"{fit(fits['vertices', 'smooth'])[0]:.2f} (smooth), {fit(fits['vertices', 'rough'])[0]:.2f} (rough)")
    page.number("unit_ms", short(1e3 * unit))
    page.heading("What else it is asked for")
    page.table(("asked for", "outline", "value", "gap", "cells", "over the baseline"),
               [(r["series"], r["outline"], r["modules"], f"{r['gap']:.2g}", f"{r['cells']:,}", spread(r["processor_s"].over(base[r["outline"]]["processor_s"])))
                for s in ("clearance", "deficit", "connected", "weights", "hexagons", "gap 2 mm") for r in of(rows, s)])


SPHERE_RADIUS_MM, TORUS_MM = 50.0, (60.0, 20.0)


def farthest_mm(mesh, distance):
    """The largest distance of a mesh from an exact surface, over corners, middles of sides and of faces."""
    corners, faces = [], []
    for line in mesh.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            corners.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    worst = 0.0
    for face in faces:
        a, b, c = (corners[k] for k in face)
        for weights in ((1, 0, 0), (.5, .5, 0), (0, .5, .5), (.5, 0, .5), (1 / 3, 1 / 3, 1 / 3)):
            point = [weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k] for k in range(3)]
            worst = max(worst, abs(distance(point)))
    return worst


def off_sphere(p):
    return math.hypot(*p) - SPHERE_RADIUS_MM


def off_torus(p):
    return math.hypot(math.hypot(p[0], p[1]) - TORUS_MM[0], p[2]) - TORUS_MM[1]


def surface(bench, page):
    rows = bench.rows("mesh", runs=min(3, bench.runs), by_time=("repair by limit",))
    page.say("What happens to a part before modules are placed ([mesh](../mesh.md), [parts from CAD](../cad.md)). *Unit* is the processor "
             "time of decimating the generated torso of 30,000 faces to 0.05 mm in the same run. Every deviation is a proved bound, "
             "not a sample.")
    found = of(rows, "decimation")
    unit = next(r for r in found if r["asked_mm"] == 0.05)["processor_s"]
    page.heading("Decimation: faces and time against deviation")
    page.table(("allowed, mm", "proved, mm", "faces left", "of all", "time, units"),
               [(f"{r['asked_mm']:g}", f"{r['deviation_mm']:.4g}", f"{r['left']:,}", percent(r["left"] / r["faces"]), spread(r["processor_s"].over(unit))) for r in found])
    page.plot("decimation", f"Faces that remain of {found[0]['faces']:,} against the allowed deviation", Axis("allowed deviation, mm", [r["asked_mm"] for r in found]),
              Axis("faces left", [r["left"] for r in found]), [("torso", [(r["asked_mm"], r["left"]) for r in found])])
    grown = of(rows, "decimation by size")
    page.say("By size at 0.05 mm: " + ", ".join(f"{r['faces']:,} faces {spread(r['processor_s'].over(unit))} units" for r in grown)
             + f"; exponent {exponent([(r['faces'], r['processor_s']) for r in grown])}.")
    page.number("decimation", f"{percent(1 - next(r for r in found if r['asked_mm'] == 0.05)['left'] / found[0]['faces'], 0)}")
    page.heading("Repair of a dirty shell")
    page.say("`generate dirty-shell` has two walls, ribs, loose parts, crossings and flipped faces. Without a limit, by size; "
             "then 24,000 faces with a limit: a shorter one takes a coarser way, and says how far the result is from the part. A large deviation means that a piece was left out "
             "or an opening closed; `design` then says so and ends with status 1.")
    grown = of(rows, "repair by size")
    page.table(("faces", "crossings", "way", "proved, mm", "found, mm", "usable", "time, units"),
               [(f"{r['faces']:,}", r["crossings"], r["repair"], f"{r['deviation_mm']:.3g}", f"{r['found_mm']:.3g}", "yes" if r["usable"] else "**no**",
                 spread(r["processor_s"].over(unit))) for r in grown])
    page.say(f"Exponent of time over faces: {exponent([(r['faces'], r['processor_s']) for r in grown])}.")
    limited = of(rows, "repair by limit")
    page.table(("limit, s", "way", "crossings tested", "reduced by, mm", "proved, mm", "usable", "time, units"),
               [(f"{r['limit_s']:g}", r["repair"], percent(r["tested"], 0), short(r["reduced_mm"]), short(r["deviation_mm"]), "yes" if r["usable"] else "**no**",
                 spread(r["processor_s"].over(unit))) for r in limited])
    page.plot("repair", "Repair: proved deviation against the time it took", Axis("processor time, units", [r["processor_s"] / unit for r in limited]),
              Axis("proved deviation, mm", [r["deviation_mm"] for r in limited if r["deviation_mm"] > 0] or [0.01, 1]),
              [("dirty shell", [(r["processor_s"] / unit, r["deviation_mm"]) for r in limited])], "limits of 0.3 … 10 s")
    page.heading("The side of a wall")
    sides = of(rows, "side")
    page.say("A box without a floor, wall 3 mm: the outer sheet is known by formula. *Wrong* is the share by which the area taken "
             "differs from it.")
    page.table(("faces", "certain", "wrong", "time, units"),
               [(f"{r['faces']:,}", "yes" if r["certain"] else "no", percent(r["wrong_share"], 2), spread(r["processor_s"].over(unit))) for r in sides])
    page.say(f"Exponent of time over faces: {exponent([(r['faces'], r['processor_s']) for r in sides])}.")
    page.heading("STEP: triangles against deviation")
    page.say("Parts written by hand from a formula (`tests/plan/cad/data`), meshed by `triskin faces PART --deviation-mm D`. `extract` and `design` mesh at 0.05 mm: there, *found* is the "
             "largest distance of corners, middles of sides and of faces from the exact surface, computed here from the formula.")
    lines, curves = [], collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        for name, distance in (("sphere", off_sphere), ("torus", off_torus)):
            part, mesh = ROOT / f"tests/plan/cad/data/{name}.step", pathlib.Path(folder) / f"{name}.obj"
            bench.run("triskin", "extract", part, "-o", mesh)
            for asked in (1.0, 0.3, 0.1, 0.05, 0.03):
                made = bench.run("triskin", "faces", part, "--deviation-mm", asked)
                found = f"{farthest_mm(mesh, distance):.4f}" if asked == 0.05 else "–"
                curves[name].append((asked, made["triangles"]))
                lines.append((name, f"{asked:g}", f"{made['deviation_mm']:.4f}", found, f"{made['triangles']:,}"))
    page.table(("part", "allowed, mm", "stated, mm", "found, mm", "triangles"), lines)
    page.plot("step", "STEP: triangles against the allowed deviation", Axis("allowed deviation, mm", [p[0] for c in curves.values() for p in c]),
              Axis("triangles", [p[1] for c in curves.values() for p in c]), list(curves.items()),
              "exponents " + ", ".join(f"{n} {fit(c)[0]:.2f}".replace("-", "−") for n, c in curves.items()) + " (a smooth face needs −1)")


def covers(bench, page):
    rows = bench.rows("lattice", runs=min(2, bench.runs))
    page.say("Covers that bend: flat pieces by the edge error that is allowed ([unfolding](../unfolding.md)), and the lattice that grows "
             "on the surface ([lattice](../lattice.md)), ended by counted steps, one thread, five seeds. *Unit*: one step of the torso.")
    steps = of(rows, "steps")
    shapes = list(dict.fromkeys(r["shape"] for r in steps))
    longest = max(r["steps"] for r in steps)
    unit = statistics.median(r["processor_s"] / r["steps"] for r in steps if r["shape"] == "torso" and r["steps"] == longest)
    page.heading("Value against time and against the bound")
    page.say("The bound is area / 389.7 mm², which nothing is known to reach: modules lie in a lattice, so the border and the bends cost. "
             "There is no proof of optimality here; the spread is over seeds.")
    lines, curves = [], []
    for shape in shapes:
        points = []
        for count in sorted({r["steps"] for r in steps}):
            same = [r for r in steps if r["shape"] == shape and r["steps"] == count]
            share = Spread([r["modules"] / r["bound"] for r in same])
            time = Spread([r["processor_s"] / unit for r in same])
            modules = Spread([r["modules"] for r in same])
            points.append((count, 100 * share, 100 * share.low, 100 * share.high))
            lines.append((shape, count, spread(modules), int(same[0]["bound"]), percent(share), spread(time)))
        curves.append((shape, points))
        if shape == "torso":
            page.number("lattice", f"{points[-1][1]:.0f} %", points[-1][1])
    page.table(("cover", "steps", "modules", "bound by area", "share", "time, units"), lines)
    page.plot("steps", "Modules against the bound by area, by counted steps", Axis("steps of ruin and recreate", sorted({r["steps"] for r in steps})),
              Axis("modules, % of the bound", [p[2] for _, c in curves for p in c] + [100], log=False), curves, "median and range of five seeds")
    page.heading("Pieces against edge error")
    pieces = of(rows, "pieces")
    errors = sorted({r["edge_error_mm"] for r in pieces})
    page.table(("cover", *(f"{e:g} mm" for e in errors)), [(s, *(next(r["pieces"] for r in pieces if r["shape"] == s and r["edge_error_mm"] == e) for e in errors)) for s in shapes])
    page.plot("pieces", "Flat pieces against the allowed edge error", Axis("allowed edge error, mm on 30 mm", errors), Axis("pieces", [r["pieces"] for r in pieces]),
              [(s, [(r["edge_error_mm"], r["pieces"]) for r in pieces if r["shape"] == s]) for s in shapes])
    torso = of(rows, "pieces", shape="torso")
    page.say("Time on the torso over that at 1 mm: " + ", ".join(
        f"{r['edge_error_mm']:g} mm {spread(r['processor_s'].over(next(q for q in torso if q['edge_error_mm'] == 1.0)['processor_s']))}" for r in torso) + ".")
    page.number("overlaps", str(sum(r["overlaps"] for r in rows if "overlaps" in r)))
    page.heading("Growth with size")
    lines = []
    for series, key, name in (("pieces by size", "faces", "unfolding, faces (1,100 cm²)"), ("faces", "faces", "lattice, faces (30 steps)"), ("area", "area_cm2", "lattice, area (30 steps)")):
        found = of(rows, series)
        lines.append((name, f"{short(found[0][key])} … {short(found[-1][key])}", spread(found[-1]["processor_s"].over(found[0]["processor_s"])),
                      exponent([(r[key], r["processor_s"]) for r in found])))
    page.table(("what", "range", "last over first", "exponent of time"), lines)
    curves = [(n, [(r[k] / of(rows, s)[0][k], r["processor_s"] / of(rows, s)[0]["processor_s"]) for r in of(rows, s)])
              for s, k, n in (("pieces by size", "faces", "pieces, faces"), ("faces", "faces", "lattice, faces"), ("area", "area_cm2", "lattice, area"))]
    page.plot("growth", "Covers: time over size, each beside its smallest", Axis("times the smallest", [p[0] for _, c in curves for p in c]),
              Axis("times the smallest's time", [p[1] for _, c in curves for p in c]), curves)


def wiring(bench, page):
    rows = bench.rows("routing", by_time=())
    page.say("Controllers, jumpers and sheets ([routing](../routing.md)). *Unit*: dividing and wiring a compact patch of 38 modules.")
    parts = [r for r in rows if "mean_loss" in r]
    unit = next(r for r in parts if r["shape"] == "compact" and r["modules"] == 38)["processor_s"]
    page.heading("Controllers: gap and time by size")
    shapes = list(dict.fromkeys(r["shape"] for r in parts))
    page.table(("shape", "modules", "proved", "widest gap, controllers", "time, units"),
               [(r["shape"], f"{r['modules']:,}", f"{r['proved']} of {r['cases']}", r["widest_gap"], spread(r["processor_s"].over(unit))) for r in parts])
    curves = [(s, [error_bars(r["modules"], r["processor_s"].over(unit)) for r in parts if r["shape"] == s]) for s in shapes]
    page.plot("growth", "Controllers: time over modules", Axis("modules", [p[0] for _, c in curves for p in c]), Axis("time, units", [v for _, c in curves for p in c for v in p[1:]]),
              curves, "exponents " + ", ".join(f"{s} {fit([(r['modules'], r['processor_s']) for r in parts if r['shape'] == s])[0]:.2f}" for s in shapes))
    page.number("proved", f"{sum(r['proved'] for r in parts)} of {sum(r['cases'] for r in parts)}")
    page.heading("Beside an integer programme")
    page.say("CBC 2.10 (Debian) alone, as a spanning forest with flows (`tests/bench/milp.hpp`), in the same run, ended after 4 s an island.")
    milp = [r for r in rows if "milp_s" in r]
    page.table(("modules", "here: [bound, controllers]", "CBC: [bound, controllers]", "time of CBC over ours"),
               [(r["modules"], f"[{r['lower_bound']}, {r['patches']}]", f"[{r['milp_lower_bound']}, {r['milp_patches']}]", spread(r["ratio_to_milp"])) for r in milp])
    jumpers = of(rows, "jumpers")
    page.say("With jumpers, on generated covers: price of controllers (2) and jumpers (0.35) together.")
    page.table(("cover", "modules", "islands", "places", "controllers", "jumpers", "price", "CBC: [bound, price]", "time of CBC over ours"),
               [(r["shape"], r["modules"], r["islands"], r["places"], r["controllers"], r["jumpers"], f"{r['price']:.2f}{' proved' if r['price_proved'] else ''}",
                 f"[{r['milp_lower']:.2f}, {short(r['milp_upper'])}]", spread(r["ratio_to_milp"])) for r in jumpers])
    drawn = [(f"{r['modules']} modules", float(r["ratio_to_milp"]), r["ratio_to_milp"].low, r["ratio_to_milp"].high) for r in milp]
    drawn += [(f"jumpers of the {r['shape']}", float(r["ratio_to_milp"]), r["ratio_to_milp"].low, r["ratio_to_milp"].high) for r in jumpers]
    page.dots("cbc", "Time of CBC over that of routing", "times ours", drawn, "median and range of the runs")
    page.ratio("cbc", milp[-1]["ratio_to_milp"])
    page.number("cbc_modules", str(milp[-1]["modules"]))
    equal = sum(r["lower_bound"] <= r["patches"] == r["milp_patches"] for r in milp) + sum(r["milp_upper"] is not None and abs(r["price"] - r["milp_upper"]) < 1e-6 for r in jumpers)
    page.number("cbc_equal", f"{equal} of {len(milp) + len(jumpers)}")
    page.heading("Nesting: length against effort")
    nest = bench.rows("nesting", runs=1)
    page.say("Islands of designs on sheets of 300 × 400 mm, by the number of tries (`--tries`); counted work, so a run repeats exactly. libnest2d 5.0.0 (Debian) is no peer: it throws for four rectangles ([tried](../measurements/tried.md#others)).")
    page.table(("design", "islands", "tries", "length used, mm", "over one try", "share filled, first sheet", "time over one try"),
               [(r["shape"], r["islands"], r["tries"], short(r["used_mm"], 4), percent(r["used_mm"] / first["used_mm"]), percent(r["fill"]), short(r["processor_s"] / first["processor_s"]))
                for r in nest for first in [next(q for q in nest if q["shape"] == r["shape"])]])
    shapes = list(dict.fromkeys(r["shape"] for r in nest))
    page.plot("nesting", "Nesting: length used against tries", Axis("tries", [r["tries"] for r in nest]), Axis("length used, mm", [r["used_mm"] for r in nest], log=False, low=0.0),
              [(s, [(r["tries"], r["used_mm"]) for r in nest if r["shape"] == s]) for s in shapes])


def contacts(bench, page):
    rows = bench.rows("contact", runs=min(3, bench.runs), by_time=())
    page.say("Contact on the soft layer ([mechanics](../mechanics.md)): four levels of the forward model, and contacts found from taxels.")
    page.heading("Levels of the forward model")
    levels = of(rows, "level")
    exact = next(r for r in levels if r["level"] == "fft")["microseconds"]
    count = of(rows, "levels")[0]
    page.say(f"{count['contacts']} contacts of spheres, flat punches and lines, Poisson's ratio 0.1 … 0.45; worst error against the exact layer (level fft), and how "
             "many times cheaper a contact is (median).")
    page.table(("level", "cheaper than exact", "indentation", "contact radius", "peak pressure", "ΔC/C of a taxel, worst", "median of the groups", "refused"),
               [(r["level"], spread(exact.over(r["microseconds"])), *((percent(r[k]) if r["level"] != "fft" else "–") for k in ("indentation", "contact_radius", "peak_pressure", "taxel", "median_taxel")), r["refused"])
                for r in levels])
    drawn = [(r["level"], [error_bars(100 * r["taxel"], exact.over(r["microseconds"]))]) for r in levels if r["level"] != "fft"]
    page.plot("levels", "Levels: how much cheaper, against their worst error", Axis("worst error of a taxel, % of its peak", [p[0][0] for _, p in drawn]),
              Axis("times cheaper than the exact layer", [v for _, c in drawn for p in c for v in p[1:]]), drawn)
    best = next(r for r in levels if r["level"] == "table")
    page.ratio("table_cheaper", exact.over(best["microseconds"]))
    page.number("table_error", percent(best["taxel"]))
    page.heading("Grid for bodies without symmetry")
    grid = of(rows, "grid")
    base = grid[0]["milliseconds"]
    page.table(("ν", "points a contact radius", "grid", "indentation", "peak pressure", "taxel", "time over the first"),
               [(r["poisson"], f"{r['points_per_radius']:.1f}", f"{r['points']}²", percent(r["indentation"], 2), percent(r["peak_pressure"], 2), percent(r["taxel"], 2), spread(r["milliseconds"].over(base))) for r in grid])
    ratios = sorted({r["poisson"] for r in grid})
    page.plot("grid", "Grid against the exact layer: error over spacing", Axis("points a contact radius", [r["points_per_radius"] for r in grid]), Axis("error of a taxel, % of its peak", [100 * r["taxel"] for r in grid]),
              [(f"ν = {v}", [(r["points_per_radius"], 100 * r["taxel"]) for r in grid if r["poisson"] == v]) for v in ratios])
    page.heading("Contacts found from noisy taxels")
    study = of(rows, "study")
    seed = of(rows, "draws")[0]["seed"]
    page.say(f"Draws with a known truth (seed {seed}, noise 0.01 in ΔC/C). The Cramér-Rao bound is the least error that any unbiased method can have; a "
             "prior may go below it.")
    page.table(("contacts", "draws", "wrong number", "within 1.96 stated deviations", "error over stated, mean square", "place over Cramér-Rao", "force over Cramér-Rao", "without noise: place, mm", "force"),
               [(r["contacts"], r["draws"], r["wrong_counts"], percent(r["covered"]), f"{r['mean_square']:.2f}", f"{r['position_over_bound']:.2f}", f"{r['force_over_bound']:.2f}", f"{r['exact_position_mm']:.1e}", f"{r['exact_force_share']:.1e}")
                for r in study])
    page.number("cramer_rao", f"{study[0]['position_over_bound']:.2f} in place, {study[0]['force_over_bound']:.2f} in force")
    page.number("covered", percent(study[0]["covered"]))
    grown = of(rows, "growth")
    page.say("Cost by the number of taxels, one contact of 0.5 N in their middle (noise 0.01, seven draws):")
    page.table(("modules", "taxels", "found", "error of place, mm", "of force", "time over the first"),
               [(r["modules"], r["taxels"], f"{r['found']} of {r['draws']}", f"{r['place_mm']:.3f}", percent(r["force_share"]), spread(r["processor_s"].over(grown[0]["processor_s"]))) for r in grown])
    page.plot("growth", "Finding one contact: time over taxels", Axis("taxels", [r["taxels"] for r in grown]), Axis("times the first", [v for r in grown for v in error_bars(0, r["processor_s"].over(grown[0]["processor_s"]))[1:]]),
              [("one contact", [error_bars(r["taxels"], r["processor_s"].over(grown[0]["processor_s"])) for r in grown])],
              f"exponent {exponent([(r['taxels'], r['processor_s']) for r in grown])}")
    page.heading("Scenes by level and effect")
    scene = bench.rows("scene")
    page.say(f"A scene of {scene[0]['modules']} modules under a sliding finger, processor time over that of the bare scene beside it. An effect that a scene does not name costs nothing.")
    page.dots("scene", "What each effect of a scene costs", "times the bare scene", [(r["effect"], float(r["ratio_to_none"]), r["ratio_to_none"].low, r["ratio_to_none"].high) for r in scene if r["effect"] != "none"],
              "median and range of the runs")
    page.table(("effect", "over the bare scene", "virtual time over processor time"), [(r["effect"], spread(r["ratio_to_none"]), spread(r["real_time_factor"])) for r in scene])
    table_level = next(r for r in scene if r["effect"] == "level table")
    page.ratio("scene_table", table_level["ratio_to_none"])
    mujoco(bench, page)


def mujoco(bench, page):
    page.heading("MuJoCo's ball on our taxels")
    node, modules, strip = shutil.which("node"), ROOT / "build/npm/node_modules", bench.bin / "write_strip"
    if not node or not (modules / "mujoco-js").exists() or not strip.exists():
        page.say("Left out: needs Node, mujoco-js (`tools/setup test`) and `write_strip`.")
        return
    done = subprocess.run([node, str(ROOT / "tests/sim/scenario/mujoco_test.mjs"), str(bench.bin / "triskin"), str(strip), str(modules)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    said = re.search(r"impulse of the ball: ([\d. ]+); mean ([\d.]+)", done.stdout)
    if done.returncode != 0 or not said:
        page.say(f"Failed: `{(done.stderr or done.stdout).strip().splitlines()[-1]}`")
        return
    ratios = [float(v) for v in said[1].split()]
    page.say(f"A ball of 2 kg drops on a strip at {len(ratios)} places; MuJoCo (mujoco-js 0.0.7) moves the ball, the simulated controllers report taxels. Impulse by taxels over "
             f"impulse by momentum: {min(ratios):.3f} … {max(ratios):.3f}, mean {said[2]} (`tests/sim/scenario/mujoco_test.mjs`).")
    page.number("mujoco", f"{100 * (min(ratios) - 1):+.1f} … {100 * (max(ratios) - 1):+.1f} %".replace("-", "−"))


def device(bench, page):
    rows = bench.rows("device")
    page.say("What the controllers and the host compute from time stamps and counts ([samples](../stream.md), [calibration](../calibration.md)).")
    page.heading("Clocks: stated bound against answers")
    page.say("The controller's clock is 80 ppm fast, a frame takes 100 µs and a uniform jitter more; sixteen modules at 54 Hz for two minutes, the first 20 s not counted. A delay that "
             "all frames share (here 100 µs) cannot be seen; the bound covers it. *Outside*: times outside their stated bound.")
    clocks = of(rows, "clock")
    page.table(("jitter, ms", "an answer every, s", "median error, µs", "worst, µs", "stated bound (median), µs", "outside", "of"),
               [(f"{r['jitter_us'] / 1e3:g}", f"{r['answer_s']:g}", f"{r['median_us']:.0f}", f"{r['worst_us']:.0f}", f"{r['bound_us']:.0f}", f"{r['outside_bound']:.0f}", f"{r['judged']:,}") for r in clocks])
    curves = [(f"{name}, {j / 1e3:g} ms", [(r["answer_s"], r[key]) for r in clocks if r["jitter_us"] == j]) for j in (100.0, 1000.0, 10000.0) for key, name in (("bound_us", "bound"), ("worst_us", "worst"))]
    page.plot("clock", "Time stamps: worst error and stated bound against the time between answers", Axis("an answer every, s", [r["answer_s"] for r in clocks]),
              Axis("µs", [p[1] for _, c in curves for p in c]), curves, "by jitter of the way")
    page.number("clock", f"{sum(r['outside_bound'] for r in clocks):.0f} of {sum(r['judged'] for r in clocks):,}")
    one = next(r for r in clocks if r["jitter_us"] == 1000 and r["answer_s"] == 1)
    page.number("clock_error", f"{one['worst_us']:.0f} µs, stated {one['bound_us']:.0f}")
    page.heading("Fixed point against real numbers")
    fixed = of(rows, "fixed point")
    page.say("The firmware removes temperature and drift in integers. Against the same formula in double precision, twelve taxels, random gains, drift of ±2,000 counts, touches, noise: half a "
             "count is the rounding of the output.")
    page.table(("readings", "worst, counts", "mean, counts"), [(f"{r['readings']:,}", f"{r['worst_counts']:.4f}", f"{r['mean_counts']:.4f}") for r in fixed])
    page.plot("fixed", "Fixed point: largest difference over a run", Axis("readings", [r["readings"] for r in fixed]), Axis("counts", [1.0], log=False, low=0.0),
              [("worst", [(r["readings"], r["worst_counts"]) for r in fixed]), ("mean", [(r["readings"], r["mean_counts"]) for r in fixed])], f"beyond the half count of rounding: {max(r['worst_counts'] for r in fixed) - 0.5:.3f} counts at most")
    page.number("fixed", f"{max(r['worst_counts'] for r in fixed):.2f} counts in {fixed[-1]['readings']:,} readings")
    page.heading("Calibration: error against effort")
    lines = of(rows, "calibration")
    page.say("Sensitivity of a taxel (10 counts a kPa) from pressures of 0 … 20 kPa: noise of 3 counts a sample, and 2 counts that differ from step to step, which more samples do not lower. "
             "2,000 draws; *inside*: the truth is within the stated bound, which is one of 95 %.")
    page.table(("steps", "samples a step", "error (rms)", "inside the bound"), [(r["steps"], r["samples"], f"{r['rms_percent']:.2f} %", percent(r["inside_bound"])) for r in lines])
    page.plot("calibration", "Calibration: error of a sensitivity against steps", Axis("steps of pressure", [r["steps"] for r in lines]), Axis("error (rms), %", [r["rms_percent"] for r in lines]),
              [(f"{n} sample{'s' if n > 1 else ''} a step", [(r["steps"], r["rms_percent"]) for r in lines if r["samples"] == n]) for n in sorted({r["samples"] for r in lines})])
    page.number("calibration", f"{percent(min(r['inside_bound'] for r in lines))} … {percent(max(r['inside_bound'] for r in lines))}")


def fitted_design(bench, folder):
    """A forearm, designed by counted steps and flashed into simulated controllers behind one CAN bus."""
    environment = {"XDG_STATE_HOME": str(folder / "state")}
    def triskin(*arguments, folder=folder):
        return bench.run("triskin", *arguments, folder=folder, environment=environment)
    triskin("generate", "forearm", "-o", "f.obj")
    triskin("design", "f.obj", "-o", "f.json", "--iterations", "30", "--time-limit-s", "600", "--threads", "1")
    triskin("robot", "new", "bot.json", "--name", "b", "--bus", "left=can:can0@1000000/2000000")
    triskin("robot", "add", "bot.json", "f.json", "--name", "f", "--bus", "left")
    (folder / "scene.json").write_text(json.dumps({"format": "triskin-scene", "version": 1, "robot": "bot.json", "seed": 1}))
    triskin("flash", "bot.json", "--scene", "scene.json")
    return triskin


def streams(bench, page):
    page.say("Samples from the converters to the host ([samples, losses, times](../stream.md)): virtual hardware at register level, one CAN bus of 1 and 2 Mbit/s with real frame lengths. All figures are counted in virtual time.")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        triskin = fitted_design(bench, folder)
        modules = triskin("export", "f.json", "--format", "taxel-list", "-o", "t.json") and len(json.loads((folder / "f.json").read_text())["modules"])
        page.heading("Noise against rate")
        page.say("`record --decimation D`, nothing touches the skin: standard deviation of a taxel (median over the taxels that are at rest).")
        lines, points = [], []
        for decimation in (256, 128, 64):
            shutil.rmtree(folder / "o", ignore_errors=True)
            triskin("record", "bot.json", "--scene", "scene.json", "-o", "o", "--format", "csv", "--seconds", "6", "--decimation", decimation, "--every", 4, "--overload")
            values = collections.defaultdict(list)
            times = collections.defaultdict(list)
            with open(next((folder / "o").glob("*.csv")), encoding="utf-8") as file:
                for r in csv.DictReader(file):
                    times[r["module"]].append(int(r["link_time_us"]))
                    if r["valid"] == "4095":
                        for taxel in range(12):
                            values[r["module"], taxel].append(int(r[f"taxel_{taxel}"]))
            noise = [statistics.pstdev(v[len(v) // 2:]) for v in values.values() if len(v) > 20]
            rate = {256: 27.1, 128: 54.3, 64: 108.5}[decimation]
            lines.append((decimation, rate, f"{statistics.median(noise):.2f}", f"{statistics.median(noise) * math.sqrt(27.1 / rate):.2f}"))
            points.append((rate, statistics.median(noise)))
        page.table(("readings a sample", "samples a second", "noise, counts", "averaged to 27 a second, counts"), lines)
        page.plot("noise", "Noise of a taxel against its rate", Axis("samples a second", [p[0] for p in points]), Axis("standard deviation, counts", [p[1] for p in points]), [("taxel at rest", points)],
                  f"exponent {exponent(points)}; 0.5 would be white noise")
        page.heading("Load of the bus against losses")
        page.say(f"{modules} modules, `record --every N --overload`: the load that the host computes before it starts (longest frames, converters 4 % fast), and the share of the samples that arrived. "
                 "Without `--overload` a stream that does not fit is refused.")
        lines, points = [], []
        for decimation, every in ((256, 8), (256, 4), (256, 2), (256, 1), (64, 3), (64, 2), (64, 1)):
            shutil.rmtree(folder / "o", ignore_errors=True)
            r = triskin("record", "bot.json", "--scene", "scene.json", "-o", "o", "--seconds", "5", "--decimation", decimation, "--every", every, "--overload")
            r = r["covers"][0] if "covers" in r else r
            delivered = r["samples"] / r["expected"]
            lines.append((decimation, every, percent(r["bus_load"]), f"{r['expected']:,}", f"{r['lost']:,}", percent(delivered, 2)))
            points.append((100 * r["bus_load"], 100 * delivered))
            if r["bus_load"] < 1:
                page.number("lost", f"{r['lost']:,} of {r['expected']:,} samples at a computed load of {percent(r['bus_load'], 0)} of the bus")
        page.table(("readings a sample", "every", "computed load", "samples", "lost and counted", "arrived"), lines)
        ideal = [(p[0], min(100.0, 1e4 / p[0])) for p in sorted(points)]
        page.plot("load", "Samples that arrive against the load of the bus", Axis("computed load, %", [p[0] for p in points]), Axis("samples that arrive, %", [p[1] for p in points], log=False, low=0.0),
                  [("measured", points), ("what a full bus can carry", ideal)])
    page.heading("Firmware for sixteen controllers at once")
    program = bench.bin / "test_deploy"
    if program.exists():
        done = subprocess.run([str(program), "--gtest_filter=Broadcast.sixteen*:Broadcast.two_slots*"], stdout=subprocess.PIPE, text=True, check=False)
        said = re.findall(r"^(classic|FD), (\d+ kB[^:]*): ([\d.]+) s of bus time(?:, (\d+) rounds, (\d+) of (\d+) data frames sent again)?", done.stdout, re.M)
        floor = re.search(r"the flash alone takes ([\d.]+) s", done.stdout)
        page.say("Each controller loses 1 % of the frames, one is dead, one is cut in the middle (`test_deploy --gtest_filter='Broadcast.*'`, virtual time). The flash of one board alone takes "
                 f"{floor[1] if floor else '–'} s, which no way can beat.")
        page.table(("bus", "image", "over the flash's own time", "rounds", "frames sent again"),
                   [(b, i, f"{float(s) / float(floor[1]):.2f}", rounds, percent(int(again) / int(all_))) for b, i, s, rounds, again, all_ in said if floor and all_])
    else:
        page.say("Left out: test_deploy is not built.")
    page.say("Events that start at a threshold are not here: the firmware streams every sample and has no such mode.")


def run_cases(program, pattern):
    """How many tests passed and ran, and the names of those that failed."""
    done = subprocess.run([str(program), f"--gtest_filter={pattern}", "--gtest_brief=1"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, cwd=tempfile.gettempdir())
    ran = re.search(r"\[==========\] (\d+) tests? from", done.stdout)
    passed = re.search(r"\[  PASSED  \] (\d+) test", done.stdout)
    failed = re.findall(r"\[  FAILED  \] ([\w./]+)(?:, where| \()", done.stdout)
    return int(passed[1]) if passed else 0, int(ran[1]) if ran else 0, sorted(set(failed))


def hard(bench, page):
    """Cases at the edge of the numbers, listed in tests/hard/cases.txt, run here and shown by part."""
    lines = [line.split("|", 3) for line in (ROOT / "tests/hard/cases.txt").read_text().splitlines() if line.strip() and not line.startswith("#")]
    lines = [[word.strip() for word in line] for line in lines]
    page.say("Inputs at the edge of the numbers, with answers worked by hand or by exact arithmetic: `ctest --test-dir build/host -L hard`. The list is `tests/hard/cases.txt`, from which "
             "CMake takes the label and this page is made (`tools/evidence --only hard`); *passed* is what this run counted. A pattern that matches no test fails the test `hard_cases_are_there`.")
    kept = page.out / "numbers.json"
    before = json.loads(kept.read_text()).get("hard", {}).get("lines", {}) if page.failed_only and kept.exists() else {}
    done_before = 0
    results = {}
    per_part, open_cases = collections.OrderedDict(), [line for line in lines if line[1] == "open"]
    total = passed_total = 0
    for part, pattern, kind, guarantee in (line for line in lines if line[1] != "open"):
        key = f"{part} {pattern}"
        if before.get(key, [0, 1])[0] == before.get(key, [0, 1])[1]:
            passed, ran = before[key]
            done_before += 1
        else:
            program = bench.bin / f"test_{part}"
            if not program.exists():
                per_part.setdefault(part, []).append((pattern, kind, guarantee, "not built"))
                continue
            passed, ran, failed = run_cases(program, pattern)
            open_cases += [(part, "", f"`{name}`", "failed in this run") for name in failed]
        results[key] = [passed, ran]
        total, passed_total = total + ran, passed_total + passed
        per_part.setdefault(part, []).append((pattern, kind, guarantee, f"{passed} of {ran}"))
        print(f"  {part} {pattern}: {passed} of {ran}", flush=True)
    page.say(f"**{passed_total} of {total} cases pass.**")
    for part, cases in per_part.items():
        page.heading(part)
        page.table(("at the edge", "guarantee", "tests", "passed"), [(kind, guarantee, f"`{pattern}`", result) for pattern, kind, guarantee, result in cases])
    page.heading("Open")
    if open_cases:
        page.table(("part", "case", "why"), [(part, kind, why) for part, _, kind, why in open_cases])
    else:
        page.say("None.")
    page.number("hard", f"{passed_total} of {total}")
    page.number("hard_parts", str(len(per_part)))
    page.numbers["lines"] = results
    if done_before:
        page.say(f"{done_before} of {len(results)} lines passed in an earlier run and were not repeated (`--failed`).")


SECTIONS = {"placement": placement, "surface": surface, "covers": covers, "wiring": wiring, "contacts": contacts, "device": device, "streams": streams, "hard": hard}
TITLES = {"placement": "Placement: speed against error", "surface": "Parts and meshes: speed against error", "covers": "Covers: value against time", "wiring": "Controllers, jumpers, sheets: speed against error",
          "contacts": "Contacts and scenes: speed against error", "device": "Clocks, fixed point, calibration: error against effort", "streams": "Samples and updates: noise, load, losses", "hard": "Hard cases"}


def run_note(bench, started, load):
    minutes = (datetime.datetime.now() - started).total_seconds() / 60
    dirty = " with changes" if git("status", "--porcelain", "--untracked-files=no", "--", "host", "shared", "firmware", "tests/bench") else ""
    note = [f"Made by `tools/evidence --only {{}}` on {started:%Y-%m-%d}, commit {git('rev-parse', '--short', 'HEAD')}{dirty}, {bench.runs} run{'s' if bench.runs > 1 else ''}, {processor()}, {os.cpu_count()} cores, load {load:.1f} at the start, "
            f"{minutes:.0f} min."]
    if bench.unequal:
        note.append("**Counted work that differed between runs:** " + "; ".join(bench.unequal) + ".")
    else:
        note.append("All counted work was equal in all runs.")
    return note


def wrapped(text):
    """Breaks prose at 120 columns and leaves tables, headings and pictures alone."""
    if text.startswith(("|", "#", "![", "<", "```", "- ")):
        return text
    return "\n".join(textwrap.wrap(text, 118, break_long_words=False, break_on_hyphens=False))


def make(names, options):
    kept = options.out / "numbers.json"
    for name in names:
        print(f"{name}:", flush=True)
        started, load = datetime.datetime.now(), os.getloadavg()[0]
        bench, page = Bench(options), Page(name, TITLES[name], options)
        SECTIONS[name](bench, page)
        note = [line.format(name) for line in run_note(bench, started, load)]
        page.parts[1:1] = [" ".join(note)]
        (options.out / f"{name}.md").write_text("\n\n".join(wrapped(part) for part in page.parts) + "\n")
        # Read only now: another section may have been made meanwhile.
        numbers = json.loads(kept.read_text()) if kept.exists() else {}
        numbers[name] = {"note": note[0], **page.numbers}
        kept.write_text(json.dumps(numbers, indent=1, ensure_ascii=False) + "\n")
        evidence_top.write(options.out, numbers, TITLES)
        print(f"docs/evidence/{name}.md", flush=True)
