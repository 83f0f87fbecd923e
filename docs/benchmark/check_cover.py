#!/usr/bin/env python3
# SPDX-License-Identifier: CC0-1.0
"""Checks an entry of the covers: README.md beside this file has the rules. Usage: check_cover.py COVER.obj ENTRY.txt
Exit status: 0 all rules hold, 1 one does not, 2 a file cannot be read."""
import math
import pathlib
import sys

SIDE_MM, SIDE_TOLERANCE_MM = 30.0, 1e-4
MAX_DISTANCE_MM, MAX_OVERRUN_MM, MAX_OVERLAP_MM = 5.0, 0.55, 0.55
MIN_COSINE, BACK_COSINE, MIN_BACK_MM = 0.5, -0.2, 20.0
STEPS = 10  # the samples of a module divide its sides so often
CELL_MM = 12.0


class Unreadable(Exception):
    pass


def sub(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def norm(a):
    return math.sqrt(dot(a, a))


def unit(a):
    length = norm(a)
    return (a[0] / length, a[1] / length, a[2] / length) if length > 0 else (0.0, 0.0, 0.0)


def mixed(weights, corners):
    return tuple(sum(w * c[k] for w, c in zip(weights, corners)) for k in range(3))


def closest_weights(p, a, b, c):
    """Barycentric weights of the point of a triangle that is nearest to p: inside, else the best of its three sides."""
    n = cross(sub(b, a), sub(c, a))
    area = dot(n, n)
    if area > 0:
        v = dot(cross(sub(p, a), sub(c, a)), n) / area
        w = dot(cross(sub(b, a), sub(p, a)), n) / area
        if v >= 0 and w >= 0 and v + w <= 1:
            return 1 - v - w, v, w
    best, found = math.inf, None
    for k, (s, e) in enumerate(((a, b), (b, c), (c, a))):
        along = sub(e, s)
        t = min(1.0, max(0.0, dot(sub(p, s), along) / max(dot(along, along), 1e-300)))
        weights = [0.0, 0.0, 0.0]
        weights[k], weights[(k + 1) % 3] = 1 - t, t
        d = norm(sub(p, mixed(weights, (a, b, c))))
        if d < best:
            best, found = d, tuple(weights)
    return found


class Cover:
    def __init__(self, path):
        self.points, self.faces = [], []
        for line in path.read_text().splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                self.points.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                self.faces.append(tuple(int(w) - 1 for w in words[1:4]))
        edges = {}
        self.normals = [(0.0, 0.0, 0.0)] * len(self.points)
        for face in self.faces:
            corners = [self.points[k] for k in face]
            normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
            for k in range(3):
                edges[frozenset((face[k], face[(k + 1) % 3]))] = edges.get(frozenset((face[k], face[(k + 1) % 3])), 0) + 1
                one, other = unit(sub(corners[(k + 1) % 3], corners[k])), unit(sub(corners[(k + 2) % 3], corners[k]))
                angle = math.acos(max(-1.0, min(1.0, dot(one, other))))
                self.normals[face[k]] = tuple(s + angle * n for s, n in zip(self.normals[face[k]], normal))
        self.normals = [unit(n) for n in self.normals]
        self.border = {edge for edge, count in edges.items() if count == 1}
        # Each cell lists the faces that may be within MAX_DISTANCE_MM + 1 of a point in it.
        self.cells = {}
        reach = MAX_DISTANCE_MM + 1.0
        for index, face in enumerate(self.faces):
            low = [min(self.points[k][d] for k in face) - reach for d in range(3)]
            high = [max(self.points[k][d] for k in face) + reach for d in range(3)]
            for x in range(math.floor(low[0] / CELL_MM), math.floor(high[0] / CELL_MM) + 1):
                for y in range(math.floor(low[1] / CELL_MM), math.floor(high[1] / CELL_MM) + 1):
                    for z in range(math.floor(low[2] / CELL_MM), math.floor(high[2] / CELL_MM) + 1):
                        self.cells.setdefault((x, y, z), []).append(index)

    def nearest(self, p):
        """Distance, place, normal and whether the place is on the border; nothing if no face is near."""
        best = None
        for index in self.cells.get(tuple(math.floor(c / CELL_MM) for c in p), ()):
            corners = [self.points[k] for k in self.faces[index]]
            weights = closest_weights(p, *corners)
            place = mixed(weights, corners)
            d = norm(sub(p, place))
            if best is None or d < best[0]:
                best = d, place, index, weights
        if best is None:
            return None
        d, place, index, weights = best
        face = self.faces[index]
        sides = [frozenset((face[k], face[(k + 1) % 3])) for k in range(3) if weights[(k + 2) % 3] < 1e-9]
        on_border = any(side in self.border for side in sides)
        return d, place, unit(mixed(weights, [self.normals[k] for k in face])), on_border


def read_entry(path):
    name, count, modules = None, None, []
    lines = path.read_text().splitlines()
    if not lines or lines[0] != "skin-cover-entry 1":
        raise Unreadable("the first line is not \"skin-cover-entry 1\"")
    for number, line in enumerate(lines[1:], 2):
        words = line.split("#")[0].split()
        try:
            if not words:
                continue
            if words[0] == "cover" and name is None and len(words) == 2:
                name = words[1]
            elif words[0] == "modules" and count is None and len(words) == 2:
                count = int(words[1])
            elif words[0] == "module" and len(words) == 10:
                values = [float(w) for w in words[1:]]
                if not all(abs(v) < 1e5 for v in values):
                    raise ValueError
                modules.append([tuple(values[k:k + 3]) for k in (0, 3, 6)])
            else:
                raise ValueError
        except ValueError:
            raise Unreadable(f"line {number} cannot be read") from None
    if name is None or count is None:
        raise Unreadable("no line \"cover\" or \"modules\"")
    return name, count, modules


def module_fault(cover, corners):
    for k in range(3):
        if abs(norm(sub(corners[(k + 1) % 3], corners[k])) - SIDE_MM) > SIDE_TOLERANCE_MM:
            return f"a side is {norm(sub(corners[(k + 1) % 3], corners[k])):.4f} mm long"
    normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
    middle = cover.nearest(mixed((1 / 3, 1 / 3, 1 / 3), corners))
    if middle is None or dot(normal, middle[2]) < MIN_COSINE:
        return "its middle is far from the cover, or it faces another way"
    for i in range(STEPS + 1):
        for j in range(STEPS + 1 - i):
            p = mixed((i / STEPS, j / STEPS, (STEPS - i - j) / STEPS), corners)
            found = cover.nearest(p)
            if found is None or found[0] > MAX_DISTANCE_MM:
                return "a point is more than %g mm from the cover" % MAX_DISTANCE_MM
            if found[3]:
                off = sub(p, found[1])
                height = dot(off, found[2])
                overrun = math.sqrt(max(0.0, dot(off, off) - height * height))
                if overrun > MAX_OVERRUN_MM:
                    return f"it stands over the border by {overrun:.2f} mm"
    return None


def overlap_mm(a, b):
    """How deep the outlines of two modules overlap, seen along the mean of their normals; ≤ 0: they do not."""
    na, nb = (unit(cross(sub(t[1], t[0]), sub(t[2], t[0]))) for t in (a, b))
    if dot(na, nb) < BACK_COSINE:
        apart = norm(sub(mixed((1 / 3,) * 3, a), mixed((1 / 3,) * 3, b)))
        return MAX_OVERLAP_MM + 1.0 if apart < MIN_BACK_MM else 0.0
    along = unit(tuple(x + y for x, y in zip(na, nb)))
    least = math.inf
    for triangle in (a, b):
        for k in range(3):
            axis = unit(cross(along, sub(triangle[(k + 1) % 3], triangle[k])))
            pa, pb = [dot(axis, c) for c in a], [dot(axis, c) for c in b]
            least = min(least, max(pa) - min(pb), max(pb) - min(pa))
    return least


def faults(cover, stem, entry):
    """The faults of an entry (name, count, modules), as sentences; the cheap rules come first."""
    name, count, modules = entry
    if name != stem:
        yield f"the entry answers {name}"
    if count != len(modules):
        yield f"{count} modules are claimed, {len(modules)} are there"
    middles = [mixed((1 / 3,) * 3, m) for m in modules]
    for k in range(len(modules)):
        for other in range(k):
            if norm(sub(middles[k], middles[other])) < 2.0 * SIDE_MM / math.sqrt(3.0):
                overlap = overlap_mm(modules[k], modules[other])
                if overlap > MAX_OVERLAP_MM:
                    yield f"modules {other} and {k} overlap by {overlap:.2f} mm"
    for k, corners in enumerate(modules):
        fault = module_fault(cover, corners)
        if fault:
            yield f"module {k}: {fault}"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        entry = read_entry(pathlib.Path(sys.argv[2]))
        found = list(faults(Cover(pathlib.Path(sys.argv[1])), pathlib.Path(sys.argv[1]).stem, entry))
    except (OSError, UnicodeDecodeError, ValueError, Unreadable) as e:
        print(f"{sys.argv[2]}: {e}")
        return 2
    for fault in found:
        print(f"{sys.argv[2]}: {fault}")
    print(f"{entry[1]} modules: " + ("not shown" if found else "all rules hold"))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
