#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Writes the forty outlines of the benchmark into the folder outlines beside this file. They are dedicated to the public
domain (CC0 1.0), as this program is. Usage: generate.py [FOLDER]"""
import math
import pathlib
import random
import sys

SIDE_MM, HEIGHT_MM = 30.0, 15.0 * math.sqrt(3.0)


def area_mm2(ring):
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:] + ring[:1]))


def scaled(ring, area_cm2):
    factor = math.sqrt(100.0 * area_cm2 / abs(area_mm2(ring)))
    return [(factor * x, factor * y) for x, y in ring]


def polar(radii):
    """A ring with these radii at equal angles."""
    step = 2.0 * math.pi / len(radii)
    return [(r * math.cos(step * k), r * math.sin(step * k)) for k, r in enumerate(radii)]


def waves(seed, vertices, area_cm2):
    """A smooth outline: a circle with six waves, like the nets of the paper's parts."""
    draw = random.Random(seed)
    sizes = [0.3 * draw.random() / (k + 1) for k in range(6)]
    phases = [2.0 * math.pi * draw.random() for _ in range(6)]
    step = 2.0 * math.pi / vertices
    radii = [1.0 + sum(s * math.cos((k + 1) * step * v + p) for k, (s, p) in enumerate(zip(sizes, phases)))
             for v in range(vertices)]
    return scaled(polar(radii), area_cm2)


def rough(seed, vertices, area_cm2, spread=0.25):
    draw = random.Random(seed)
    return scaled(polar([1.0 - spread + 2.0 * spread * draw.random() for _ in range(vertices)]), area_cm2)


def cracked(seed, vertices, area_cm2, cracks):
    """A smooth outline with cracks of 0.2 mm that reach to a third of its radius, as nets of curved covers have."""
    ring = waves(seed, vertices, area_cm2)
    out = []
    for k, (x, y) in enumerate(ring):
        if k % (vertices // cracks) != vertices // cracks // 2:
            out.append((x, y))
            continue
        length = math.hypot(x, y)
        across = (-0.1 * y / length, 0.1 * x / length)
        out += [(x - across[0], y - across[1]), (x / 3.0, y / 3.0), (x + across[0], y + across[1])]
    return out


def rectangle(width_mm, height_mm, x_mm=0.0, y_mm=0.0):
    return [(x_mm, y_mm), (x_mm + width_mm, y_mm), (x_mm + width_mm, y_mm + height_mm), (x_mm, y_mm + height_mm)]


def comb(teeth, tooth_mm, gap_mm, length_mm, spine_mm):
    """Teeth that stand on a spine, the first and the last at its ends."""
    top_mm = spine_mm + length_mm
    ring = [(0.0, 0.0), (teeth * tooth_mm + (teeth - 1) * gap_mm, 0.0)]
    for k in reversed(range(teeth)):
        left_mm = k * (tooth_mm + gap_mm)
        if k < teeth - 1:
            ring.append((left_mm + tooth_mm, spine_mm))
        ring += [(left_mm + tooth_mm, top_mm), (left_mm, top_mm)]
        if k > 0:
            ring.append((left_mm, spine_mm))
    return ring


def circle(radius_mm, vertices, x_mm=0.0, y_mm=0.0):
    return [(x_mm + x, y_mm + y) for x, y in polar([radius_mm] * vertices)]


def trapezoid(bottom, rows, drawn_in_mm):
    """A trapezoid of whole tiles, its sides drawn in (or moved out by a negative distance)."""
    def left_mm(y_mm):
        return (y_mm + 2.0 * drawn_in_mm) / math.sqrt(3.0)

    width, low, high = bottom * SIDE_MM, drawn_in_mm, rows * HEIGHT_MM - drawn_in_mm
    return [(left_mm(low), low), (width - left_mm(low), low), (width - left_mm(high), high), (left_mm(high), high)]


def spiral(turns, width_mm, pitch_mm):
    steps = int(24 * turns)
    inner = [(pitch_mm * (1.0 + k / 24.0)) for k in range(steps + 1)]
    outside = [((r + width_mm) * math.cos(k * math.pi / 12), (r + width_mm) * math.sin(k * math.pi / 12)) for k, r in enumerate(inner)]
    inside = [(r * math.cos(k * math.pi / 12), r * math.sin(k * math.pi / 12)) for k, r in enumerate(inner)]
    return outside + inside[::-1]


def turned(ring, angle_rad):
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return [(c * x - s * y, s * x + c * y) for x, y in ring]


def outlines():
    """Name and rings: the outer one, then holes."""
    yield "paper-lh", [waves(1, 20, 57.0)]
    yield "paper-lua", [waves(2, 74, 139.0)]
    yield "paper-ruf", [cracked(3, 126, 279.0, 6)]
    yield "paper-ut", [waves(4, 113, 757.0)]
    yield "paper-lt", [waves(5, 18, 1050.0)]
    for k, (w, h) in enumerate([(100.0, 51.9), (299.0, 77.9), (170.0, 170.0), (420.0, 297.0), (1000.0, 25.9)]):
        yield f"rectangle-{k + 1}", [turned(rectangle(w, h), 0.1 + 0.3 * k)]
    yield "l-narrow", [[(0, 0), (200, 0), (200, 60), (70, 60), (70, 150), (0, 150)]]
    yield "l-wide", [[(0, 0), (310, 0), (310, 130), (95, 130), (95, 400), (0, 400)]]
    yield "u", [[(0, 0), (260, 0), (260, 240), (195, 240), (195, 70), (65, 70), (65, 240), (0, 240)]]
    yield "cross", [[(80, 0), (150, 0), (150, 80), (230, 80), (230, 150), (150, 150), (150, 230), (80, 230), (80, 150),
                     (0, 150), (0, 80), (80, 80)]]
    yield "comb-3", [comb(3, 40.0, 20.0, 120.0, 35.0)]
    yield "comb-5", [turned(comb(5, 31.0, 12.0, 160.0, 30.0), 0.7)]
    yield "comb-8", [comb(8, 55.0, 25.0, 300.0, 60.0)]
    yield "ring-thin", [circle(130.0, 60), circle(98.0, 48)[::-1]]
    yield "ring-wide", [circle(200.0, 80), circle(70.0, 36)[::-1]]
    yield "ring-off-centre", [circle(180.0, 72), circle(60.0, 36, 70.0, 25.0)[::-1]]
    for k, (bottom, rows, drawn) in enumerate([(3, 2, 0.0), (5, 3, -0.01), (6, 4, 0.001), (9, 5, 0.0)]):
        yield f"tiles-{k + 1}", [turned(trapezoid(bottom, rows, drawn), 0.2 + 0.25 * k)]
    for k, (vertices, area) in enumerate([(30, 100.0), (60, 300.0), (100, 1000.0), (200, 2000.0)]):
        yield f"rough-{k + 1}", [rough(10 + k, vertices, area)]
    for k, (vertices, area) in enumerate([(40, 200.0), (120, 1500.0), (300, 5000.0)]):
        yield f"smooth-{k + 1}", [waves(20 + k, vertices, area)]
    yield "needle", [[(0, 0), (900, 14), (1800, 0), (900, 45)]]
    yield "wedge", [[(0, 0), (500, -60), (500, 60)]]
    yield "half-disc", [polar([150.0] * 72)[:37]]
    yield "spiral", [spiral(2.0, 45.0, 60.0)]
    yield "plate-4-holes", [rectangle(250.0, 180.0), *(circle(9.0, 24, x, y)[::-1] for x in (30.0, 220.0) for y in (30.0, 150.0))]
    yield "plate-24-holes", [rectangle(400.0, 300.0),
                             *(circle(4.0, 12, 40.0 + 64.0 * i, 45.0 + 70.0 * j)[::-1] for i in range(6) for j in range(4))]
    yield "slots", [rectangle(300.0, 220.0), *(rectangle(200.0, 6.0, 50.0, y)[::-1] for y in (50.0, 107.0, 164.0))]
    yield "hexagon", [polar([121.0] * 6)]
    yield "pentagon", [polar([160.0] * 5)]


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, rings in outlines():
        lines = ["skin-placement-outline 1", f"name {name}"]
        for ring in rings:
            lines.append("ring " + " ".join(f"{round(x, 3) + 0.0!r} {round(y, 3) + 0.0!r}" for x, y in ring))
        (folder / f"{name}.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "outlines")
