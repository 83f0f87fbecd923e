#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Writes the twelve covers of the benchmark into the folder covers beside this file, as OBJ in mm, normals outward. They
are dedicated to the public domain (CC0 1.0), as this program is. Usage: generate_covers.py [FOLDER]"""
import math
import pathlib
import sys


def grid(columns, rows, place, holes=()):
    """A surface over (0 … 1)², counter-clockwise seen from outside; `holes` are rectangles (u0, v0, u1, v1) left out."""
    points = [place(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    faces = []
    for j in range(rows):
        for i in range(columns):
            u, v = (i + 0.5) / columns, (j + 0.5) / rows
            if any(u0 < u < u1 and v0 < v < v1 for u0, v0, u1, v1 in holes):
                continue
            a = j * (columns + 1) + i
            b = a + columns + 1
            faces += [(a, a + 1, b + 1), (a, b + 1, b)]
    used = sorted({corner for face in faces for corner in face})
    number = {corner: k for k, corner in enumerate(used)}
    return [points[k] for k in used], [tuple(number[k] for k in face) for face in faces]


def cap(radius_mm, angle_rad, rings, around):
    """A spherical cap around +z with a corner at its pole."""
    points, faces = [(0.0, 0.0, radius_mm)], []
    for ring in range(1, rings + 1):
        a = angle_rad * ring / rings
        points += [(radius_mm * math.sin(a) * math.cos(2 * math.pi * k / around), radius_mm * math.sin(a) * math.sin(2 * math.pi * k / around),
                    radius_mm * math.cos(a)) for k in range(around)]
    at = lambda ring, k: 1 + (ring - 1) * around + k % around
    for k in range(around):
        faces.append((0, at(1, k), at(1, k + 1)))
        for ring in range(1, rings):
            faces += [(at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)), (at(ring, k), at(ring + 1, k + 1), at(ring, k + 1))]
    return points, faces


def tube(radius_at, sweep_rad, length_mm):
    """Part of a tube along y, open below; radius_at(v, angle) in mm."""
    def place(u, v):
        angle = sweep_rad * (0.5 - u)
        r = radius_at(v, angle)
        return -r * math.sin(angle), length_mm * v, r * math.cos(angle)
    return place


def s_curve(radius_mm, arc_rad, width_mm):
    """Two arcs of opposite sense, one after the other."""
    def place(u, v):
        a = 2.0 * arc_rad * u
        if a <= arc_rad:
            return radius_mm * math.sin(a), width_mm * v, radius_mm * (math.cos(a) - 1.0)
        x, z = radius_mm * math.sin(arc_rad), radius_mm * (math.cos(arc_rad) - 1.0)
        b = 2.0 * arc_rad - a
        return 2.0 * x - radius_mm * math.sin(b), width_mm * v, 2.0 * z - radius_mm * (math.cos(b) - 1.0)
    return place


def ridge(half_mm, fold_rad, length_mm):
    """Two plates that meet at an edge with this angle between their normals."""
    def place(u, v):
        s = (u - 0.5) * 2.0 * half_mm
        return s * math.cos(fold_rad / 2), length_mm * v, -abs(s) * math.sin(fold_rad / 2)
    return place


def torus(ring_mm, tube_mm, ring_rad, tube_rad):
    def place(u, v):
        a, b = ring_rad * (u - 0.5), tube_rad * (v - 0.5)
        r = ring_mm + tube_mm * math.cos(b)
        return r * math.cos(a), r * math.sin(a), tube_mm * math.sin(b)
    return place


def covers():
    yield "plate", grid(6, 5, lambda u, v: (240.0 * u, 180.0 * v, 0.0))
    yield "plate-holes", grid(32, 24, lambda u, v: (256.0 * u, 192.0 * v, 0.0), [(5 / 32, 5 / 24, 9 / 32, 9 / 24), (20 / 32, 14 / 24, 26 / 32, 19 / 24)])
    yield "half-tube", grid(30, 6, tube(lambda v, a: 60.0, math.pi, 200.0))
    yield "wide-tube", grid(20, 6, tube(lambda v, a: 120.0, 0.6 * math.pi, 220.0))
    yield "cone", grid(28, 8, tube(lambda v, a: 110.0 - 60.0 * v, 0.9 * math.pi, 190.0))
    yield "dome", cap(150.0, math.radians(45.0), 10, 40)
    yield "cap", cap(60.0, math.radians(80.0), 9, 32)
    yield "saddle", grid(20, 20, lambda u, v: (220.0 * (u - 0.5), 220.0 * (v - 0.5), 220.0**2 * ((u - 0.5)**2 - (v - 0.5)**2) / 240.0))
    yield "torus", grid(24, 24, torus(110.0, 60.0, math.radians(110.0), math.radians(150.0)))
    yield "s-curve", grid(32, 6, s_curve(50.0, 0.75 * math.pi, 180.0))
    yield "ridge", grid(8, 8, ridge(95.0, math.radians(50.0), 200.0))
    yield "sleeve", grid(40, 20, tube(lambda v, a: (62.0 - 14.0 * v) * (1.0 + 0.12 * math.cos(2.0 * a)), 1.6 * math.pi, 240.0), [(0.42, 0.35, 0.58, 0.6)])


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, (points, faces) in covers():
        lines = [f"# {name}, mm, CC0 1.0"]
        lines += ["v " + " ".join(repr(round(c, 3) + 0.0) for c in p) for p in points]
        lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
        (folder / f"{name}.obj").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "covers")
