# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the skin for MuJoCo, as a body to include beside the robot's own file. Usage: export_mujoco.py DESIGN"""
import subprocess
import sys
import xml.etree.ElementTree as tree

subprocess.run(["triskin", "export", sys.argv[1], "--format", "mjcf", "-o", "skin.xml"], check=True)
bodies = [body.get("name") for body in tree.parse("skin.xml").getroot().iter("body")]
print(f"skin.xml: {len(bodies)} bodies, as {bodies[-1]}")
