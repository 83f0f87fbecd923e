#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Records one simulated skin to HDF5 and to CSV, and compares the two with h5py. Usage: recording_test.py TRISKIN WRITE_STRIP
recording_test.py --compare FILE.h5 FILE.csv holds two recordings of one stream against each other.
Exit status: 0 they agree, 1 they do not, 77 h5py is missing or the program has no HDF5."""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from debian_h5py import h5py


def triskin(folder, *arguments, status=0):
    environment = dict(os.environ, XDG_STATE_HOME=folder)
    run = subprocess.run([sys.argv[1], *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if "without HDF5" in run.stderr:
        print(run.stderr.strip())
        sys.exit(77)
    assert run.returncode == status, (arguments, run.returncode, run.stderr)
    return run.stderr


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def compare(table, rows):
    assert len(rows) == len(table["module"]) > 500, (len(rows), len(table["module"]))
    for k, row in enumerate(rows):
        for name, column in (("module", "module"), ("sample", "sample"), ("valid", "valid"), ("link_time", "link_time_us"), ("device_time", "device_time_us"), ("reader_patch", "reader_patch"), ("reader_node", "reader_node")):
            assert table[name][k] == int(row[column]), (name, k)
        assert list(table["value"][k]) == [int(row[f"taxel_{t}"]) for t in range(12)], k
        assert (table["error"][k] == 4294967295) == (row["error_us"] == ""), k


def read(hdf5, text_file):
    with open(text_file, encoding="utf-8") as file, h5py.File(hdf5) as recorded:
        return {name: recorded[name][:] for name in recorded if name != "design"}, list(csv.DictReader(file))


def full_disk(folder):
    """A file that may not grow above 100 kB stands for a full disk: status 2, and the samples before it are there."""
    environment = dict(os.environ, XDG_STATE_HOME=folder)
    run = subprocess.run(["prlimit", "--fsize=100000", sys.argv[1], "record", "strip.json", "--link", "sim", "--seconds", "30", "-o", "full.h5"],
                         cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 2 and "full.h5" in run.stderr, (run.returncode, run.stderr)


def main():
    if sys.argv[1] == "--compare":
        compare(*read(sys.argv[2], sys.argv[3]))
        print("the recordings agree")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[2], str(pathlib.Path(folder) / "strip.json"), "20"], check=True)
        triskin(folder, "flash", "strip.json", "--link", "sim")
        for name in ("a.h5", "a.csv"):
            triskin(folder, "record", "strip.json", "--link", "sim", "--seconds", "2", "-o", name)
        table, rows = read(pathlib.Path(folder) / "a.h5", pathlib.Path(folder) / "a.csv")
        compare(table, rows)
        # Nothing is adopted here: modules 0 … 15 are those of patch 0 at node 1, the others those of patch 1 at node 2.
        assert all(table["reader_patch"] == table["module"] // 16) and all(table["reader_node"] == table["reader_patch"] + 1)
        with h5py.File(pathlib.Path(folder) / "a.h5") as recorded:
            assert text(recorded.attrs["format"]) == "triskin-recording" and text(recorded.attrs["result_status"]) == "complete"
            assert text(recorded.attrs["simulated"]) == "true" and all(row["simulated"] == "1" for row in rows)
            assert text(recorded.attrs["link"]) == "sim" and text(recorded["value"].attrs["unit"]) == "counts"
            # Text is text and numbers are numbers to a reader that knows nothing of us.
            for name in ("format", "design_id", "link", "program", "result_status"):
                assert isinstance(recorded.attrs[name], str), (name, type(recorded.attrs[name]))
            assert recorded.attrs["version"] == 1 and recorded.attrs["result_samples"] == len(rows)
            assert recorded.attrs["result_lost"] == 0 and 1.9 < float(recorded.attrs["result_seconds"]) < 2.3
            assert recorded.attrs["unix_start_ns"].dtype.kind == "u" and recorded.attrs["unix_start_ns"] > 1.6e18
            design = json.loads(text(recorded["design"][()]))
            assert design["design_id"] == text(recorded.attrs["design_id"])
        full_disk(folder)
        assert "mcap or csv" in triskin(folder, "record", "strip.json", "--link", "sim", "--format", "hdf5", "-o", "-", status=2)
        assert "choose one" in triskin(folder, "record", "strip.json", "--link", "sim", "--format", "csv", "-o", "b.h5", status=2)
    print("the recordings agree")
    return 0


if __name__ == "__main__":
    sys.exit(main())
