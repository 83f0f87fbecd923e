# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks an exported SDF file with the library of SDFormat. Usage: sdf_test.py TRISKIN WRITE_STRIP
Exit status: 0 passed, 1 failed, 77 left out because libsdformat is not installed."""
import ctypes
import pathlib
import subprocess
import sys
import tempfile

try:
    sdformat = ctypes.CDLL("libsdformat12.so.12")
except OSError:
    print("left out: libsdformat12 is not installed (tools/setup test installs it)")
    sys.exit(77)
triskin, write_strip = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    design, file = pathlib.Path(folder, "strip.json"), pathlib.Path(folder, "strip.sdf")
    subprocess.run([write_strip, design, "40"], check=True)
    subprocess.run([triskin, "export", design, "-o", file], check=True, stdout=subprocess.DEVNULL)
    # This is the function behind "ign sdf --check"; 0 means valid.
    whole = sdformat.cmdCheck(str(file).encode())
    heavy = pathlib.Path(folder, "heavy.sdf")
    subprocess.run([triskin, "export", design, "-o", heavy, "--mass-kg", "0.3"], check=True, stdout=subprocess.DEVNULL)
    whole = whole or sdformat.cmdCheck(str(heavy).encode())
    file.write_text(file.read_text().replace("attached_to=\"cover\"", "attached_to=\"nothing\"", 1))
    broken = sdformat.cmdCheck(str(file).encode())
sys.exit(0 if whole == 0 and broken != 0 else 1)
