# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs programs for docs/evidence, joins repeated runs, and formats numbers, tables and fits."""
import json
import math
import os
import pathlib
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIMED = ("_s", "seconds", "ratio", "real_time_factor")


class Spread(float):
    """A median with the range of its runs; it computes like the median."""

    def __new__(cls, values):
        made = super().__new__(cls, statistics.median(values))
        made.values = list(values)
        return made

    def over(self, other):
        """The ratio, formed in each run."""
        return Spread([a / b for a, b in zip(self.values, other.values)])

    @property
    def low(self):
        return min(self.values)

    @property
    def high(self):
        return max(self.values)


def is_timed(key):
    return key.endswith(TIMED) or key.startswith(("ratio", "cgal", "r4_")) and not key.endswith(("evaluated", "differ", "extrapolated", "modules", "placements"))


def short(value, digits=3):
    """A number with so many significant digits, thousands separated."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    if abs(value) >= 10**digits or float(value).is_integer() and abs(value) < 1e6:
        return f"{float(f'{value:.{digits}g}'):,.0f}" if abs(value) >= 10**digits and not float(value).is_integer() else f"{value:,.0f}"
    text = f"{value:.{digits}g}"
    return text if "e" not in text else f"{float(text):.{digits - 1}e}".replace("e-0", "e-")


def spread(value, digits=3):
    """Median and range: 32,100 (30,900 … 33,000)."""
    if not isinstance(value, Spread) or len(value.values) < 2:
        return short(value, digits)
    return f"{short(float(f'{value:.{digits}g}'), digits)} ({short(float(f'{value.low:.{digits}g}'), digits)} … {short(float(f'{value.high:.{digits}g}'), digits)})"


def percent(share, digits=1):
    return f"{100 * share:.{digits}f} %"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def fit(points):
    """The exponent of y = c · x^e and its standard error, by least squares of the logarithms."""
    xs, ys = [math.log(p[0]) for p in points], [math.log(max(p[1], 1e-300)) for p in points]
    mx, my = statistics.fmean(xs), statistics.fmean(ys)
    sxx = sum((x - mx)**2 for x in xs)
    slope = sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sxx
    rest = sum((y - my - slope * (x - mx))**2 for x, y in zip(xs, ys))
    error = math.sqrt(rest / max(1, len(xs) - 2) / sxx)
    return slope, error


def exponent(points):
    slope, error = fit(points)
    return f"{slope:.2f} ± {error:.2f}"


class Bench:
    """Runs triskin-bench several times and joins the rows."""

    def __init__(self, options):
        self.bin, self.runs = options.bin.resolve(), options.runs
        self.unequal = []

    def run(self, program, *arguments, folder=None, environment=None, check=True):
        """The JSON answer of a program."""
        done = subprocess.run([str(self.bin / program), *map(str, arguments), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              cwd=folder, env={**os.environ, **(environment or {})})
        if check and done.returncode not in (0, 1):
            raise SystemExit(f"{program} {' '.join(map(str, arguments))}: {done.stderr.strip()[-500:]}")
        return json.loads(done.stdout)

    def rows(self, subject, runs=None, by_time=()):
        """Rows of a subject with Spread for what is timed. Series in `by_time` end by a time limit: what they count may
        differ between runs and becomes a Spread too; elsewhere a difference is noted and shown on the page."""
        repeated = []
        for k in range(runs or self.runs):
            print(f"  triskin-bench {subject} --quick ({k + 1} of {runs or self.runs})", flush=True)
            repeated.append(self.run("triskin-bench", subject, "--quick")["rows"])
        joined = []
        for same in zip(*repeated):
            row = {}
            for key, value in same[0].items():
                if key == "markdown":  # the same figures as text, for other pages
                    continue
                values = [r[key] for r in same]
                numeric = all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values)
                if numeric and is_timed(key) and key != "limit_s" and key != "answer_s":
                    row[key] = Spread(values)
                elif numeric and same[0].get("series") in by_time:
                    row[key] = Spread(values) if len(set(values)) > 1 else value
                else:
                    row[key] = value
                    if any(v != value for v in values) and same[0].get("series") not in by_time:
                        self.unequal.append(f"{subject}: {same[0].get('series', '')} {key}: {values}")
            joined.append(row)
        return joined


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False).stdout.strip()


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return "unknown processor"
