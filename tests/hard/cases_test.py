#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fails when a line of tests/hard/cases.txt names tests that are not there. Usage: cases_test.py CASES BIN

A pattern is one of --gtest_filter. Parts whose program is not built are left out and named.
"""
import fnmatch
import pathlib
import re
import subprocess
import sys


def names_in(program):
    """All tests of a program, as Suite.name."""
    listed = subprocess.run([str(program), "--gtest_list_tests"], stdout=subprocess.PIPE, text=True, check=True).stdout
    names, suite = [], ""
    for line in listed.splitlines():
        word = line.split("#")[0].strip()
        if re.fullmatch(r"\S+\.", word) and not line.startswith(" "):
            suite = word
        elif line.startswith("  ") and suite:
            names.append(suite + word)
    return names


def main():
    cases, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    known, wrong, found = {}, 0, set()
    for number, line in enumerate(cases.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        fields = [field.strip() for field in line.split("|")]
        if len(fields) != 4 or not all(fields) or ";" in line:
            print(f"{cases}:{number}: four fields between |, without semicolons")
            wrong += 1
            continue
        part, patterns = fields[:2]
        program = folder / f"test_{part}"
        if patterns == "open":
            continue
        if part not in known:
            known[part] = names_in(program) if program.exists() else None
            if known[part] is None:
                print(f"left out: {program.name} is not built")
        for pattern in patterns.split(":"):
            matching = [n for n in known[part] or [] if fnmatch.fnmatchcase(n, pattern)]
            found.update((part, n) for n in matching)
            if known[part] is not None and not matching:
                print(f"{cases}:{number}: {part} has no test {pattern}")
                wrong += 1
    print(f"{len(found)} hard cases in {len(known)} parts, {wrong} findings")
    return 1 if wrong or not found else 0


if __name__ == "__main__":
    sys.exit(main())
