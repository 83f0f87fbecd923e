#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks what tools/evidence computes and draws, by hand, and that the pages of docs/evidence belong together.
Usage: evidence_test.py SOURCE"""
import json
import pathlib
import re
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(ROOT / "tools"))
import evidence_plot  # noqa: E402
import evidence_run  # noqa: E402
import evidence_sections  # noqa: E402
import evidence_top  # noqa: E402

PAGES = ROOT / "docs/evidence"


class Numbers(unittest.TestCase):
    def test_exponents_of_a_square_and_of_noise(self):
        slope, error = evidence_run.fit([(1, 3), (2, 12), (4, 48)])
        self.assertAlmostEqual(slope, 2.0)
        self.assertAlmostEqual(error, 0.0)
        # Logarithms to base 2: (0, 0), (1, 1), (2, 0): mean slope 0, rest 2/3, error sqrt(2/3 / 1 / 2) = 0.577.
        slope, error = evidence_run.fit([(1, 1), (2, 2), (4, 1)])
        self.assertAlmostEqual(slope, 0.0)
        self.assertAlmostEqual(error, 0.57735, places=4)

    def test_a_ratio_is_formed_in_each_run(self):
        ratio = evidence_run.Spread([10, 20, 30]).over(evidence_run.Spread([1, 4, 3]))
        self.assertEqual((float(ratio), ratio.low, ratio.high), (10.0, 5.0, 10.0))
        self.assertEqual(evidence_run.spread(ratio), "10 (5 … 10)")

    def test_numbers_as_they_are_printed(self):
        for value, text in ((31611.7, "31,600"), (0.0, "0"), (7.0, "7"), (0.02345, "0.0234"), (1234567, "1,234,567"), (1234567.8, "1,230,000"), (1.5e-7, "1.50e-7"), (None, "–")):
            self.assertEqual(evidence_run.short(value), text)
        for value, text in ((0.001, "0.001"), (1e-5, "10⁻⁵"), (2e5, "2·10⁵"), (5000, "5,000"), (0.5, "0.5")):
            self.assertEqual(evidence_plot.number(value), text)


class Plots(unittest.TestCase):
    def test_axes_place_their_ends_and_tick_at_round_numbers(self):
        axis = evidence_plot.Axis("x", [1, 100])
        self.assertAlmostEqual(axis.place(10), 0.5)
        self.assertEqual(axis.ticks(), [1, 2, 5, 10, 20, 50, 100])
        self.assertEqual(evidence_plot.Axis("x", [0, 1], log=False).ticks(), [0, 0.5, 1.0])

    def test_a_plot_is_xml_with_every_point_and_both_colour_schemes(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "p.svg"
            evidence_plot.plot(file, "A & B", evidence_plot.Axis("x", [1, 10]), evidence_plot.Axis("y", [1, 10]), [("one", [(1, 1), (10, 10, 9, 10)]), ("<two>", [(1, 0)])])
            text = file.read_text()
            ElementTree.fromstring(text)
            self.assertIn("prefers-color-scheme:dark", text)
            self.assertEqual(len(re.findall(r'<circle class="f0"', text)), 3)  # two points and the name
            self.assertIn("&lt;two>", text)
            evidence_plot.dots(file, "D", "times", [("a", 2.0, 1.0, 3.0)])
            ElementTree.fromstring(file.read_text())


class Pages(unittest.TestCase):
    def test_the_page_on_top_is_that_of_its_numbers(self):
        numbers = json.loads((PAGES / "numbers.json").read_text())
        with tempfile.TemporaryDirectory() as folder:
            for file, _, _ in evidence_top.PLOTS:
                if (PAGES / file).exists():
                    (pathlib.Path(folder) / file).touch()
            evidence_top.write(pathlib.Path(folder), numbers, evidence_sections.TITLES)
            self.assertEqual((pathlib.Path(folder) / "README.md").read_text(), (PAGES / "README.md").read_text())

    def test_ten_numbers_and_three_plots_are_there(self):
        page = (PAGES / "README.md").read_text()
        self.assertEqual(len(evidence_top.TEN), 10)
        self.assertNotIn("(not measured)", page)
        self.assertEqual(page.count(".svg)"), 3)

    def test_every_plot_belongs_to_a_page_and_is_there(self):
        named = {name for page in PAGES.glob("*.md") for name in re.findall(r"\]\((\w+\.svg)\)", page.read_text())}
        self.assertEqual(named, {file.name for file in PAGES.glob("*.svg")})


if __name__ == "__main__":
    unittest.main()
