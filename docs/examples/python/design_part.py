# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a design of a mesh with the program and reads from its file what it covers. Usage: design_part.py MESH OUT.json"""
import json
import pathlib
import subprocess
import sys

mesh, out = sys.argv[1:3]
subprocess.run(["triskin", "design", mesh, "-o", out, "--time-limit-s", "1"], check=True)
design = json.loads(pathlib.Path(out).read_text(encoding="utf-8"))
print(f"{len(design['modules'])} modules, {len(design['patches'])} controllers")
