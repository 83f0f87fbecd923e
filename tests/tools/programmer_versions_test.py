#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/program_board.md says for each tool that it programs a board with which versions do: programmer_versions_test.py [PAGE]

Each tool with a line has its versions. What the page says of Debian's packages is what apt knows of them there, and a tool that is
installed here is of a version that the page allows. A tool that is not installed is only counted.
"""
import pathlib
import re
import shutil
import subprocess
import sys

# Tool on the page: its program, Debian's package.
TOOLS = {"OpenOCD": ("openocd", "openocd"), "probe-rs": ("probe-rs", None), "pyOCD": ("pyocd", "python3-pyocd"),
         "st-flash": ("st-flash", "stlink-tools"), "STM32CubeProgrammer": ("STM32_Programmer_CLI", None)}
# Found by running them: Debian's pyOCD 0.13.1 installs no program `pyocd`; st-flash failed with 1.7.0 on a sibling of the chip.
WITHOUT_PROGRAM = {"pyOCD": "0.13"}


def table(page, head):
    """Rows of the tables whose first line has these cells."""
    rows, inside = [], False
    for line in page.splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")] if line.startswith("|") else None
        if cells is None:
            inside = False
        elif cells == head:
            inside = True
        elif inside and not set(cells[0]) <= set("-: "):
            rows.append(cells)
    return rows


def parts(version):
    return [int(n) for n in version.split(".")]


def output_of(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    return done.stdout + done.stderr


def is_debian_12():
    release = pathlib.Path("/etc/os-release")
    return release.exists() and 'VERSION_ID="12"' in release.read_text() and shutil.which("apt-cache") is not None


def check(page):
    complaints, compared = [], 0
    versions = {row[0]: row[1] + " " + row[2] for row in table(page, ["tool", "versions", ""])}
    lines = [(row[0], row[1].strip("`")) for row in table(page, ["tool", "command"])]
    if len(lines) != 2 * len(TOOLS):
        complaints.append(f"{len(lines)} programming lines, {2 * len(TOOLS)} are expected: each tool on both boards")
    for tool, command in lines:
        if tool not in TOOLS or not command.startswith(TOOLS[tool][0] + " "):
            complaints.append(f"{tool}: the line does not begin with the program of the tool: {command[:40]}")
        if tool not in versions:
            complaints.append(f"{tool}: has a programming line and no versions")
    for tool, text in versions.items():
        if not text.startswith("any") and not re.match(r"\d+\.\d+", text):
            complaints.append(f"{tool}: names no version: {text}")
            continue
        program, package = TOOLS[tool]
        least = re.match(r"(\d+\.\d+)", text)
        if tool in WITHOUT_PROGRAM and parts(least.group(1)) <= parts(WITHOUT_PROGRAM[tool]):
            complaints.append(f"{tool}: {least.group(1)} has no program {program}")
        in_debian = re.search(r"Debian 12 has (\d+\.\d+)|`" + str(package) + r"` (\d+\.\d+)", text)
        stated = (in_debian.group(1) or in_debian.group(2)) if in_debian else least.group(1) if package and least else None
        if package and is_debian_12():
            candidate = re.search(r"Candidate: (\d+\.\d+)", output_of("apt-cache", "policy", package))
            if candidate:
                compared += 1
                if candidate.group(1) != stated:
                    complaints.append(f"{tool}: Debian 12 has {package} {candidate.group(1)}, the page says {stated}")
        if least and shutil.which(program):
            here = re.search(r"(\d+\.\d+)", output_of(program, "--version"))
            compared += 1
            if here is None or parts(here.group(1)) < parts(least.group(1)):
                complaints.append(f"{tool}: {program} here is {here and here.group(1)}, the page asks for {least.group(1)}")
    return complaints, compared


root = pathlib.Path(__file__).parent.parent.parent
text = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else root / "docs/program_board.md").read_text()
found, compared_here = check(text)
for complaint in found:
    print(complaint)
print(f"programmers: {compared_here} versions compared here, {len(found)} complaints")
sys.exit(1 if found else 0)
