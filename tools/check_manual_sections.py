#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds the sections of the reference manual that facts.txt and sources cite against a list of the revision.

  check_manual_sections.py FACTS SECTIONS [SOURCE...]

A citation's chapter must be in the list and be that of the block that the fact names; a section that the list has a
register for must be cited for that register; a third number must be in the list. Sources (§39.9.2) are held to the
chapters and, where the list has it, nothing else. Exit 1 with a list of what does not fit."""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from list_silicon_constants import facts  # noqa: E402


def sections(path):
    """{number: (words of the second column, title)}"""
    out = {}
    for number, line in enumerate(pathlib.Path(path).read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        columns = [c.strip() for c in line.split("|")]
        if len(columns) != 3 or not re.fullmatch(r"\d+(\.\d+)*", columns[0]):
            sys.exit(f"{path}:{number}: number | blocks or register | title")
        out[columns[0]] = (columns[1].split(), columns[2])
    return out


def chapter_of(number):
    return number.split(".")[0]


def block_and_registers(register):
    """("I2C", {"ISR"}) of `I2C1->ISR`; the block is empty where the fact names none."""
    m = re.match(r"(\w+?)(?:_TypeDef|_Channel\w*|_CONFIG)?(?:->|\.)([A-Z0-9_x]+)", register)
    return (m[1], m[2]) if m else ("", "")


def wrong_citation(register, number, known):
    """What is wrong with one citation; empty: nothing."""
    chapter = known.get(chapter_of(number))
    if chapter is None:
        return f"chapter {chapter_of(number)} is not in the list"
    block, name = block_and_registers(register)
    family = re.sub(r"\d+$", "", block)
    blocks = {w for words, _ in known.values() for w in words}
    if block in blocks and block not in chapter[0] and family not in chapter[0]:
        return f"{block} is not in chapter {chapter_of(number)}, {chapter[1]}"
    if number.count(".") < 2:
        return ""
    if number not in known:
        return f"section {number} is not in the list"
    listed = known[number][0]
    if listed != ["-"] and name and name not in listed:
        return f"section {number} is about {listed[0]}, not {name}"
    return ""


def citations(source):
    """Sections of the manual in the fourth column of a fact."""
    m = re.search(r"RM ([0-9][0-9., ]*)", source)
    return re.findall(r"\d+(?:\.\d+)*", m[1]) if m else []


def wrong_facts(path, known):
    for constant, register, _, _, source in facts(path):
        numbers = citations(source)
        # One fact may cite several sections for several registers: one of them must fit.
        wrong = [w for w in (wrong_citation(register, n, known) for n in numbers) if w]
        if wrong and len(wrong) == len(numbers):
            yield f"{path}: {constant}: {wrong[0]}"


def wrong_source(path, known):
    for number, line in enumerate(pathlib.Path(path).read_text().splitlines(), 1):
        if "UM10204" in line:
            continue
        for cited in re.findall(r"§(\d+(?:\.\d+)*)", line):
            if chapter_of(cited) not in known:
                yield f"{path}:{number}: chapter {chapter_of(cited)} is not in the list"
    text = pathlib.Path(path).read_text()
    # The first citation of a register header or of a block of the machine names the chapter of its block.
    m = re.search(r"RM0440 §(\d+)", text)
    for cited in re.findall(r"§(\d+)\.\d+\.\d+", text) if m else []:
        words = known.get(m[1], ([], ""))[0]
        if "I2C" in words and cited != m[1]:
            yield f"{path}: cites chapter {cited} for a block of chapter {m[1]}"


def main():
    if len(sys.argv) < 3:
        print(__doc__)
        return 2
    known = sections(sys.argv[2])
    bad = list(wrong_facts(sys.argv[1], known))
    for source in sys.argv[3:]:
        bad += wrong_source(source, known)
    print("\n".join(bad) if bad else f"{len(known)} sections; every citation fits")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
