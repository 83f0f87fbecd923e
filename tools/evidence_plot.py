# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the plots of docs/evidence as SVG: one style, with a background of its own in light and in dark."""
import math

LIGHT = {"bg": "#ffffff", "fg": "#1f2328", "soft": "#59636e", "grid": "#dde3ea",
         "c": ("#0b6e99", "#c4460d", "#2c7a3f", "#7b4fb5", "#8a6d00", "#b3266d", "#505a64")}
DARK = {"bg": "#0f1419", "fg": "#e6edf3", "soft": "#9aa7b4", "grid": "#2b3440",
        "c": ("#58b4e0", "#ff9457", "#6fcf83", "#c3a3f7", "#e0c341", "#ff7fb8", "#aab6c2")}
WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 760, 420, 78, 52, 62
RIGHT_MIN, CHARACTER = 40, 6.9  # of 12 px, so that names at the right end have room
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def style():
    def rules(c):
        colours = "".join(f".s{k}{{stroke:{v}}}.f{k}{{fill:{v}}}" for k, v in enumerate(c["c"]))
        return (f".bg{{fill:{c['bg']}}}.fg{{fill:{c['fg']}}}.soft{{fill:{c['soft']}}}.grid{{stroke:{c['grid']}}}"
                f".axis{{stroke:{c['soft']}}}" + colours)
    return f"<style>text{{font:12px sans-serif}}.t{{font-size:15px;font-weight:600}}{rules(LIGHT)}" \
           f"@media (prefers-color-scheme:dark){{{rules(DARK)}}}</style>"


def escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")


def number(value):
    """As few digits as tell the value; powers of ten outside 0.001 … 100,000."""
    if value == 0:
        return "0"
    power = math.floor(math.log10(abs(value)) + 1e-9)
    if -3 <= power < 5:
        return f"{value:,.{max(0, 1 - power)}f}".rstrip("0").rstrip(".") if power < 1 else f"{value:,.0f}"
    mantissa = value / 10.0**power
    head = "" if abs(mantissa - 1) < 1e-9 else f"{mantissa:.2g}·"
    return f"{head}10{str(power).translate(SUPERSCRIPT)}"


class Axis:
    """Maps values to 0 … 1; logarithmic axes end at values of 1, 2 or 5, linear ones at round numbers."""

    def __init__(self, label, values, log=True, low=None, high=None):
        self.label, self.log = label, log
        values = [v for v in values if not log or v > 0]
        low = min(values) if low is None else low
        high = max(values) if high is None else high
        if log:
            if high / low < 1.5:
                low, high = low / 2, high * 2
            self.low, self.high = math.log10(low), math.log10(high)
            pad = 0.04 * (self.high - self.low)
            self.low, self.high = self.low - pad, self.high + pad
        else:
            if high == low:
                high = low + 1
            self.low, self.high = low, high + 0.05 * (high - low)

    def place(self, value):
        return ((math.log10(value) if self.log else value) - self.low) / (self.high - self.low)

    def ticks(self):
        if self.log:
            decades = self.high - self.low
            steps = (1, 2, 5) if decades < 2.5 else (1,)
            every = 1 if decades <= 8 else 2
            powers = range(math.floor(self.low), math.ceil(self.high) + 1)
            found = [s * 10.0**p for p in powers if p % every == 0 for s in steps]
            return [t for t in found if self.low <= math.log10(t) <= self.high]
        raw = (self.high - self.low) / 5
        power = 10.0**math.floor(math.log10(raw))
        step = power * next(s for s in (1, 2, 5, 10) if raw <= s * power * 1.0001)
        return [k * step for k in range(math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9) + 1)]


def marker(k, x, y):
    shape = k % 6
    if shape == 0:
        return f'<circle class="f{k}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>'
    if shape == 1:
        return f'<rect class="f{k}" x="{x - 3.5:.1f}" y="{y - 3.5:.1f}" width="7" height="7"/>'
    if shape == 2:
        return f'<path class="f{k}" d="M{x:.1f} {y - 5:.1f}l5 8.5h-10z"/>'
    if shape == 3:
        return f'<path class="f{k}" d="M{x:.1f} {y - 5:.1f}l5 5l-5 5l-5 -5z"/>'
    if shape == 4:
        return f'<path class="f{k}" d="M{x:.1f} {y + 5:.1f}l5 -8.5h-10z"/>'
    return f'<circle class="s{k} bg" cx="{x:.1f}" cy="{y:.1f}" r="3.6" stroke-width="2"/>'


def head(title, note, height):
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img">', style(),
           f"<title>{escaped(title)}</title>", f'<rect class="bg" width="{WIDTH}" height="{height}" rx="6"/>',
           f'<text class="fg t" x="16" y="24">{escaped(title)}</text>']
    if note:
        out.append(f'<text class="soft" x="16" y="41">{escaped(note)}</text>')
    return out


def plot(path, title, x, y, series, note=""):
    """series: (name, points) with points (x, y) or (x, y, low, high); drawn in the order given, names at their ends.

    x and y are Axis. A point whose value is not on a logarithmic axis (0) is drawn at its lower end, with an arrow.
    """
    right = max(RIGHT_MIN, 26 + CHARACTER * max(len(name) for name, _ in series))
    width, height = WIDTH - LEFT - right, HEIGHT - TOP - BOTTOM

    def at(px, py):
        vertical = 0.0 if y.log and py <= 0 else min(1.0, max(0.0, y.place(py)))
        return LEFT + width * x.place(px), TOP + height * (1 - vertical)

    out = head(title, note, HEIGHT)
    for tick in y.ticks():
        v = TOP + height * (1 - y.place(tick))
        out.append(f'<path class="grid" d="M{LEFT} {v:.1f}h{width:.1f}"/><text class="soft" x="{LEFT - 7}" y="{v + 4:.1f}" '
                   f'text-anchor="end">{number(tick)}</text>')
    for tick in x.ticks():
        h = LEFT + width * x.place(tick)
        out.append(f'<path class="grid" d="M{h:.1f} {TOP}v{height}"/><text class="soft" x="{h:.1f}" y="{TOP + height + 17}" '
                   f'text-anchor="middle">{number(tick)}</text>')
    out.append(f'<path class="axis" fill="none" d="M{LEFT} {TOP}v{height}h{width:.1f}"/>')
    out.append(f'<text class="fg" x="{LEFT + width / 2:.1f}" y="{HEIGHT - 14}" text-anchor="middle">{escaped(x.label)}</text>')
    out.append(f'<text class="fg" transform="translate(17 {TOP + height / 2}) rotate(-90)" text-anchor="middle">{escaped(y.label)}</text>')
    ends = []
    for k, (name, points) in enumerate(series):
        points = sorted(points)
        places = [at(p[0], p[1]) for p in points]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
        out.append(f'<polyline class="s{k}" points="{line}" fill="none" stroke-width="2"/>')
        for p, (a, b) in zip(points, places):
            if len(p) == 4:
                low, high = at(p[0], p[2])[1], at(p[0], p[3])[1]
                if abs(low - high) > 1:
                    out.append(f'<path class="s{k}" stroke-width="1.4" d="M{a:.1f} {low:.1f}V{high:.1f}M{a - 3:.1f} {low:.1f}h6M{a - 3:.1f} {high:.1f}h6"/>')
            out.append(marker(k, a, b))
            if y.log and p[1] <= 0:
                out.append(f'<text class="f{k}" x="{a:.1f}" y="{b - 9:.1f}" text-anchor="middle">0</text>')
        ends.append((places[-1][1], k, name))
    # Names that would overlap are moved apart, lowest last.
    ends.sort()
    last, placed = -1e9, []
    for v, k, name in ends:
        last = max(v, last + 16)
        placed.append([last, k, name])
    overflow = placed[-1][0] - (TOP + height)
    for entry in placed:
        entry[0] -= max(0.0, overflow)
    for v, k, name in placed:
        out.append(marker(k, LEFT + width + 12, v))
        out.append(f'<text class="f{k}" x="{LEFT + width + 21:.1f}" y="{v + 4:.1f}">{escaped(name)}</text>')
    path.write_text("\n".join(out) + "\n</svg>\n")


def dots(path, title, label, rows, note=""):
    """Ratios on one logarithmic axis: rows (name, middle, low, high), with a line at 1."""
    row, top, left = 26, 58, 16 + CHARACTER * max(len(r[0]) for r in rows)
    height, width = top + row * len(rows) + 48, WIDTH - left - 96
    x = Axis(label, [v for r in rows for v in r[1:4]] + [1.0])
    place = lambda v: left + 12 + (width - 24) * x.place(v)
    out = head(title, note, height)
    bottom = top + row * len(rows)
    for tick in x.ticks():
        out.append(f'<path class="grid" d="M{place(tick):.1f} {top - 6}V{bottom}"/><text class="soft" x="{place(tick):.1f}" y="{bottom + 16}" '
                   f'text-anchor="middle">{number(tick)}</text>')
    out.append(f'<path class="axis" stroke-dasharray="4 3" d="M{place(1):.1f} {top - 6}V{bottom}"/>')
    out.append(f'<text class="fg" x="{left + width / 2:.1f}" y="{bottom + 37}" text-anchor="middle">{escaped(label)}</text>')
    for k, (name, middle, low, high) in enumerate(rows):
        v = top + row * (k + 0.5)
        out.append(f'<text class="fg" x="{left + 2}" y="{v + 4:.1f}" text-anchor="end">{escaped(name)}</text>')
        out.append(f'<path class="s0" stroke-width="2" d="M{place(low):.1f} {v:.1f}H{place(high):.1f}"/>')
        out.append(marker(0, place(middle), v))
        out.append(f'<text class="f0" x="{place(high) + 9:.1f}" y="{v + 4:.1f}">{number(float(f"{middle:.3g}"))}</text>')
    path.write_text("\n".join(out) + "\n</svg>\n")
