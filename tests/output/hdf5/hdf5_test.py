#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the HDF5 file of the taxels with h5py and compares it with the CSV of the same design. Usage: hdf5_test.py TRISKIN WRITE_STRIP
Exit status: 0 they agree, 1 they do not, 77 h5py is missing or the program has no HDF5."""
import csv
import pathlib
import subprocess
import sys
import tempfile

from debian_h5py import h5py


def main():
    with tempfile.TemporaryDirectory() as folder:
        design, table, rows = (str(pathlib.Path(folder) / name) for name in ("strip.json", "strip.h5", "strip.csv"))
        subprocess.run([sys.argv[2], design, "20"], check=True)
        run = subprocess.run([sys.argv[1], "export", design, "-o", table], capture_output=True, text=True, check=False)
        if "without HDF5" in run.stderr:
            print(run.stderr.strip())
            return 77
        assert run.returncode == 0, run.stderr
        subprocess.run([sys.argv[1], "export", design, "--format", "taxels", "-o", rows], check=True, capture_output=True)
        with open(rows, encoding="utf-8") as file, h5py.File(table) as taxels:
            expected = list(csv.DictReader(file))
            assert len(expected) == 240 == len(taxels["module"])
            assert taxels.attrs["format"] in ("triskin-taxels", b"triskin-taxels"), taxels.attrs["format"]
            assert len(taxels.attrs["design_id"]) == 16 and taxels["position"].attrs["unit"] in ("mm", b"mm")
            for k, row in enumerate(expected):
                for name in ("module", "taxel", "patch", "line", "address"):
                    assert taxels[name][k] == int(row[name]), (name, k)
                assert taxels["cover"].asstr()[k] == row["cover"] == "strip"
                assert taxels["measures_pressure"][k] == (int(row["taxel"]) not in (6, 10))
                for x, name in enumerate(("x_mm", "y_mm", "z_mm")):
                    assert abs(taxels["position"][k, x] - float(row[name])) < 5.1e-5, (name, k)
                for x, name in enumerate(("nx", "ny", "nz")):
                    assert abs(taxels["normal"][k, x] - float(row[name])) < 5.1e-7, (name, k)
    print("240 rows agree")
    return 0


if __name__ == "__main__":
    sys.exit(main())
