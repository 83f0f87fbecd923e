# SPDX-License-Identifier: GPL-3.0-or-later
"""Area of the copper of one layer: as the KiCad file says, by gerbv, and by tracespace (npm). gerbv rounds widths to whole
pixels, here 0.005 mm of 0.1 and 0.15 mm."""
import json
import math
import pathlib
import subprocess
import sys

import boards_test

TOLERANCE_TRACESPACE, TOLERANCE_GERBV = 0.005, 0.02
# Widths of tracks are whole numbers of pixels, so that a straight track has the same area wherever it lies.
PIXEL_MM = 0.01
GERBV_DPI = 5080
np = boards_test.import_of_debian("numpy")
Image = boards_test.import_of_debian("PIL.Image").Image


class Raster:
    """The union of shapes as pixels whose middle they cover. All rasters have the same grid, also of y turned over."""

    def __init__(self, low, high):
        self.low = low = [math.floor(v / PIXEL_MM) * PIXEL_MM for v in low]
        self.is_set = np.zeros([int((high[k] - low[k]) / PIXEL_MM) + 1 for k in (1, 0)], bool)

    def area_mm2(self):
        return self.is_set.sum() * PIXEL_MM ** 2

    def fill(self, low, high, inside):
        """`inside` gets the x and y of pixels in the box and says which of them are set."""
        box = [slice(max(0, int((low[k] - self.low[k]) / PIXEL_MM) - 1), int((high[k] - self.low[k]) / PIXEL_MM) + 2)
               for k in (0, 1)]
        part = self.is_set[box[1], box[0]]
        x = self.low[0] + (np.arange(part.shape[1]) + box[0].start + 0.5) * PIXEL_MM
        y = self.low[1] + (np.arange(part.shape[0]) + box[1].start + 0.5) * PIXEL_MM
        part |= inside(x[None, :], y[:, None])

    def line(self, a, b, radius):
        d = (b[0] - a[0], b[1] - a[1])
        square = d[0] ** 2 + d[1] ** 2

        def inside(x, y):
            t = np.clip(((x - a[0]) * d[0] + (y - a[1]) * d[1]) / square, 0, 1) if square > 0 else 0
            return (x - a[0] - t * d[0]) ** 2 + (y - a[1] - t * d[1]) ** 2 <= radius ** 2

        self.fill([min(a[k], b[k]) - radius for k in (0, 1)], [max(a[k], b[k]) + radius for k in (0, 1)], inside)

    def polygon(self, points):
        def inside(x, y):
            odd = np.zeros(np.broadcast(x, y).shape, bool)
            for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
                if ay != by:
                    odd ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
            return odd

        self.fill([min(p[k] for p in points) for k in (0, 1)], [max(p[k] for p in points) for k in (0, 1)], inside)


def rectangle(x, y, width, height, turn=0.0):
    c, s = math.cos(turn), math.sin(turn)
    return [(x + c * u - s * v, y + s * u + c * v)
            for u, v in ((width / 2, height / 2), (-width / 2, height / 2), (-width / 2, -height / 2),
                         (width / 2, -height / 2))]


def draw_board(root, layer, raster):
    """Draws pads, tracks and holes of the KiCad file."""
    def numbers(node, name):
        return [float(v) for v in boards_test.child(node, name)]

    for footprint in boards_test.children(root, "footprint"):
        x, y, *angle = numbers(footprint, "at")
        turn = math.radians(angle[0] if angle else 0.0)
        for pad in boards_test.children(footprint, "pad"):
            if not {layer, "*.Cu"} & set(boards_test.child(pad, "layers")):
                continue
            px, py, *own = numbers(pad, "at")
            # KiCad's y runs downwards, and the angle of a pad includes that of its footprint.
            place = (x + px * math.cos(turn) + py * math.sin(turn), y - px * math.sin(turn) + py * math.cos(turn))
            width, height = numbers(pad, "size")
            if pad[3] == "circle":
                raster.line(place, place, width / 2)
            else:
                raster.polygon(rectangle(*place, width, height, -math.radians(own[0] if own else 0.0)))
    for segment in boards_test.children(root, "segment"):
        if boards_test.child(segment, "layer") == [layer]:
            raster.line(numbers(segment, "start"), numbers(segment, "end"), numbers(segment, "width")[0] / 2)
    for via in boards_test.children(root, "via"):
        raster.line(numbers(via, "at"), numbers(via, "at"), numbers(via, "size")[0] / 2)
    for zone in boards_test.children(root, "zone"):
        if boards_test.child(zone, "layer") == [layer]:
            points = boards_test.children(boards_test.children(zone, "filled_polygon")[0], "pts")[0]
            raster.polygon([tuple(float(v) for v in p[1:]) for p in boards_test.children(points, "xy")])


def draw_shape(shape, raster):
    kind = shape["type"]
    if kind == "circle":
        raster.line((shape["cx"], shape["cy"]), (shape["cx"], shape["cy"]), shape["r"])
    elif kind == "rectangle":
        width, height = shape["xSize"], shape["ySize"]
        raster.polygon(rectangle(shape["x"] + width / 2, shape["y"] + height / 2, width, height))
    elif kind == "polygon":
        raster.polygon([tuple(p) for p in shape["points"]])
    elif kind == "layeredShape":
        for part in shape["shapes"]:
            if part.get("erase"):
                sys.exit(f"tracespace: a shape that erases: {part}")
            draw_shape(part, raster)
    else:
        sys.exit(f"tracespace: unknown shape {kind}")


def area_by_tracespace(modules, file):
    text = subprocess.run(["node", pathlib.Path(__file__).with_name("gerber_shapes.mjs"), modules, file], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    image = json.loads(text)
    assert image["units"] == "mm"
    x0, y0, x1, y1 = image["size"]
    raster = Raster((x0 - 1, y0 - 1), (x1 + 1, y1 + 1))
    for child in image["children"]:
        if child["type"] == "imageShape":
            draw_shape(child["shape"], raster)
        elif child["type"] == "imagePath":
            for s in child["segments"]:
                raster.line(s["start"][:2], s["end"][:2], child["width"] / 2)
        elif child["type"] == "imageRegion":
            raster.polygon([tuple(s["start"][:2]) for s in child["segments"]])
        else:
            sys.exit(f"tracespace: unknown part {child['type']}")
    return raster.area_mm2()


def area_by_gerbv(file):
    picture = file.with_suffix(".png")
    subprocess.run(["gerbv", "-x", "png", "-D", str(GERBV_DPI), "-B", "5", "-b", "#000000", "-f", "#FFFFFFFF", "-o",
                    str(picture), str(file)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    Image.MAX_IMAGE_PIXELS = None
    with Image.open(picture) as image:
        return float(np.asarray(image.convert("L"), dtype=np.float64).sum() / 255 * (25.4 / GERBV_DPI) ** 2)


def area_by_board(path, layer):
    root = boards_test.read_expression(path.read_text(encoding="utf-8"))
    ends = [[float(v) for v in boards_test.child(line, key)] for line in boards_test.children(root, "gr_line")
            for key in ("start", "end")]
    raster = Raster(*([f(e[k] for e in ends) for k in (0, 1)] for f in (min, max)))
    draw_board(root, layer, raster)
    return raster.area_mm2()
