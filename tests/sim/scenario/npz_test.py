#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the taxel list of an export with NumPy. Usage: npz_test.py TRISKIN WRITE_STRIP. Exit status 77: NumPy is not installed."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("left out: NumPy is not installed (python3-numpy)")
    sys.exit(77)

triskin, write_strip = sys.argv[1:]
modules = 20
with tempfile.TemporaryDirectory() as folder:
    design = pathlib.Path(folder, "strip.json")
    subprocess.run([write_strip, design, str(modules)], check=True)
    files = {form: pathlib.Path(folder, name) for form, name in (("npz", "t.npz"), ("taxel-list", "t.json"), ("taxels", "t.csv"))}
    for form, file in files.items():
        subprocess.run([triskin, "export", design, "--format", form, "-o", file], check=True, stdout=subprocess.DEVNULL)
    arrays = dict(numpy.load(files["npz"]))
    listed = json.loads(files["taxel-list"].read_text())["taxels"]
    rows = list(csv.DictReader(files["taxels"].read_text().splitlines()))

assert arrays["position"].shape == (10 * modules, 3), arrays["position"].shape
assert arrays["normal"].shape == (10 * modules, 3)
assert numpy.allclose(numpy.linalg.norm(arrays["normal"], axis=1), 1.0, atol=1e-12)
assert numpy.all(arrays["radius"] == 0.002)
for k, taxel in enumerate(listed):
    assert arrays["module"][k] == taxel["module"] and arrays["taxel"][k] == taxel["taxel"]
    assert arrays["link"][k] == taxel["link"]
    assert numpy.array_equal(arrays["position"][k], taxel["position_m"])
# Other code wrote the table for spreadsheets: millimetres, on the board, 2 mm under the surface.
COLUMNS = ("x_mm", "y_mm", "z_mm", "nx", "ny", "nz")
places = {(int(r["module"]), int(r["taxel"])): numpy.array([float(r[c]) for c in COLUMNS]) for r in rows}
for module, taxel, position, normal in zip(arrays["module"], arrays["taxel"], arrays["position"], arrays["normal"]):
    place = places[(module, taxel)]
    assert numpy.allclose(1e3 * position, place[:3] + 2.0 * place[3:], atol=2e-4), (module, taxel)
    assert numpy.allclose(normal, place[3:], atol=1e-6)
print(len(listed), "taxels")
