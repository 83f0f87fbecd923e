#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests how tools/check_readme compares a line of a page with a line of the output."""
import importlib.machinery
import importlib.util
import pathlib
import unittest

TOOL = pathlib.Path(__file__).resolve().parent.parent.parent / "tools/check_readme"
loader = importlib.machinery.SourceFileLoader("check_readme", str(TOOL))
check_readme = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_readme", loader))
loader.exec_module(check_readme)

COUNTS = "… controllers (lower bound …), … jumpers (lower bound …), … islands"


class Matches(unittest.TestCase):
    def test_many(self):
        self.assertTrue(check_readme.matches(COUNTS, "8 controllers (lower bound 8), 0 jumpers (lower bound 0), 5 islands"))

    def test_one(self):
        self.assertTrue(check_readme.matches(COUNTS, "8 controllers (lower bound 8), 1 jumper (lower bound 1), 1 island"))

    def test_one_is_the_whole_count(self):
        self.assertFalse(check_readme.matches(COUNTS, "8 controllers (lower bound 8), 11 jumper (lower bound 1), 5 islands"))

    def test_a_number_of_the_page_is_the_number_of_the_output(self):
        self.assertTrue(check_readme.matches("… rules checked, 0 violations", "61 rules checked, 0 violations"))
        self.assertFalse(check_readme.matches("… rules checked, 0 violations", "61 rules checked, 1 violation"))

    def test_signs_of_expressions_stand_for_themselves(self):
        self.assertTrue(check_readme.matches("… taxel at (… mm …", "module 3 taxel at (4 mm up)"))
        self.assertFalse(check_readme.matches("coverage … %.", "coverage 5 %!"))


if __name__ == "__main__":
    unittest.main()
