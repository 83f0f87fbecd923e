# SPDX-License-Identifier: GPL-3.0-or-later
"""Which changes tools/mutate makes of a line, worked by hand."""
import importlib.machinery
import importlib.util
import pathlib
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/mutate"
LOADER = importlib.machinery.SourceFileLoader("mutate", str(TOOL))
mutate = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutate", LOADER))
LOADER.exec_module(mutate)


class Changes(unittest.TestCase):
    def test_comparison_and_negated_condition(self):
        self.assertEqual(mutate.changes_of("  if (a < b) return;\n"), ["  if (a <= b) return;", "  if (!(a < b)) return;"])

    def test_constants_one_up_and_one_down_but_never_below_0(self):
        self.assertEqual(mutate.changes_of("int x = 5'000;\n"), ["int x = 5001;", "int x = 4999;"])
        self.assertEqual(mutate.changes_of("int x = 0;\n"), ["int x = 1;"])

    def test_operator_and_removed_statement(self):
        self.assertEqual(mutate.changes_of("  sum = a + b;\n"), ["  sum = a - b;", "  ;"])
        self.assertEqual(mutate.changes_of("    leave_ = true;\n"), ["    leave_ = false;", "    ;"])
        self.assertEqual(mutate.changes_of("  c.link.tick(now);\n"), ["  ;"])

    def test_texts_comments_and_declarations_stay(self):
        for line in ("// a < b + 1\n", '  say("a < b + 1");\n', "#include <a>\n", "using std::span;\n", "}\n"):
            self.assertNotIn("<=", " ".join(mutate.changes_of(line)), line)
            self.assertNotIn("-", " ".join(mutate.changes_of(line)), line)
        self.assertEqual(mutate.changes_of("  return f(a, b);  // a + 1\n"), [])
        self.assertEqual(mutate.changes_of("  a = b;  // 1 of 2\n"), ["  ;// 1 of 2"])


if __name__ == "__main__":
    unittest.main()
