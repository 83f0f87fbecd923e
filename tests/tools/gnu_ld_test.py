#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links targets again with GNU ld, which takes libraries in their order, where mold finds everything anywhere: a machine without
mold has to build too. Usage: gnu_ld_test.py NINJA BUILD_FOLDER TARGET_FILE..."""
import pathlib
import re
import subprocess
import sys
import tempfile


def link_command(ninja, build, target):
    commands = subprocess.run([ninja, "-C", build, "-t", "commands", "-s", target], capture_output=True, text=True, check=True)
    return commands.stdout.strip().splitlines()[-1]


def links(ninja, build, target, folder):
    linked = pathlib.Path(folder) / pathlib.Path(target).name
    command, replaced = re.subn(r"(?<= -o )\S+", str(linked), link_command(ninja, build, target), count=1)
    if replaced != 1:
        sys.exit(f"{target}: no output in its link command")
    command = command.replace("-fuse-ld=mold", "").replace(" -o ", " -fuse-ld=bfd -o ", 1)
    command = command.split(" && ")[1]  # Commands after the link are left out.
    result = subprocess.run(command, shell=True, cwd=build, capture_output=True, text=True)
    if result.returncode != 0 or not linked.exists():
        print(f"{target}: GNU ld does not link it\n{result.stderr[-2000:]}")
        return False
    return True


def main(ninja, build, *targets):
    with tempfile.TemporaryDirectory() as folder:
        return 0 if all([links(ninja, build, target, folder) for target in targets]) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
