#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every input of ../shared/data/trials before the program: what its README says is right.

usage: trials_test.py TRISKIN DATA     Exit status 77: the folder DATA/trials is not there.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass

AREA_CM2, FACES = 70.12, 96
# The pipe of base.obj looks along +z; glTF nodes without a turn keep that.
OUTSIDE = r"on average \(-?0\.00, -?0\.00, 0\.9"


@dataclass
class Trial:
    """One file, the command that reads it, and what must be said."""
    file: str
    command: tuple = ("extract", "{file}", "-o", "{out}.obj", "--json")
    status: int = 0
    says: str = OUTSIDE
    scale: float = 1.0  # Of the area.


PLACE = ("place", "{file}", "--time-limit-s", "2", "--json")
TRIALS = [
    *[Trial(f) for f in ("base.obj", "3mf_plain.3mf", "3mf_other_root.3mf", "3mf_prefix.3mf", "3mf_comment.3mf",
                         "gltf_plain.gltf", "gltf_mirror_node.gltf", "gltf_quantized.gltf", "gltf_percent_uri.gltf",
                         "stl_solid_header.stl", "obj_cr_only.obj", "ply_ascii_cr.ply", "off_4off.off",
                         "off_free_layout.off", "obj_utf16.obj", "dae_zup.dae", "dae_yup.dae")],
    Trial("gltf_node_transform.gltf", says=r"on average \(-?0\.00, -0\.9", scale=4.0),
    Trial("obj_open_reversed.obj", says=r"on average \(-?0\.00, -?0\.00, -0\.9.*--flip"),
    Trial("obj_open_reversed.obj", ("extract", "{file}", "-o", "{out}.obj", "--json", "--flip")),
    Trial("obj_inch.obj", status=2, says="--unit in"),
    Trial("obj_inch.obj", ("extract", "{file}", "-o", "{out}.obj", "--json", "--unit", "in")),
    Trial("obj_comma_decimals.obj", status=2, says="decimal commas"),
    Trial("stl_truncated.stl", status=2, says="65 of 96"),
    Trial("obj_far_very.obj"),
    Trial("wkt_hole_twice.wkt", PLACE, 2, "hole 0 and .*hole 1"),
    Trial("wkt_hole_equals_outer.wkt", PLACE, 2, "outer ring and .*hole 0"),
    Trial("wkt_bowtie_asym.wkt", PLACE, 2, r"touches itself at \(100, 60\).*vertex 0"),
    Trial("wkt_z.wkt", PLACE, says="modules"),
    Trial("wkt_empty.wkt", PLACE, 2, "EMPTY"),
    Trial("geo_dup_key.geojson", PLACE, 2, '"coordinates" appears twice'),
    Trial("h.json", ("check", "{file}"), 2, r"corners.*must lie in"),
    Trial("m_flip.mcap", ("recover", "{file}"), 2, "-o"),
    Trial("m_flip.mcap", ("recover", "{file}", "-o", "{out}.mcap"), says="a chunk is damaged at byte 68180"),
]
MODULES = {"base.obj": 1, "gltf_mirror_node.gltf": 1, "obj_open_reversed.obj": -1}


def vertices_of(path):
    return [tuple(map(float, line.split()[1:])) for line in path.read_text().splitlines() if line.startswith("v ")]


def run(triskin, trial, folder):
    file, out = folder / trial.file, folder / "out"
    command = [triskin] + [word.replace("{file}", str(file)).replace("{out}", str(out)) for word in trial.command]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)


def faults_of(triskin, trial, folder):
    """What is wrong with the answer, as sentences."""
    done = run(triskin, trial, folder)
    text = (done.stdout + done.stderr).replace("\n", " ")
    faults = []
    if done.returncode != trial.status:
        faults.append(f"status {done.returncode}, not {trial.status}")
    if not re.search(trial.says, text):
        faults.append(f"does not say {trial.says}")
    if trial.command[0] == "extract" and done.returncode == 0:
        result = json.loads(done.stdout)
        if result["faces"] != FACES:
            faults.append(f"{result['faces']} faces, not {FACES}")
        if abs(result["area_cm2"] / trial.scale - AREA_CM2) > 0.02:
            faults.append(f"{result['area_cm2']} cm², not {trial.scale * AREA_CM2}")
    if trial.file.startswith("dae_") and done.returncode == 0:
        ys, zs = zip(*[v[1:] for v in vertices_of(folder / "out.obj")])
        if abs(max(ys) - 90) > 0.01 or abs(min(ys)) > 0.01 or abs(max(zs) - 60) > 0.3 or abs(min(zs) - 47.8) > 0.3:
            faults.append(f"its numbers were turned: y {min(ys)} … {max(ys)}, z {min(zs)} … {max(zs)}")
    return [f"{trial.file}: {fault}\n    {text[-300:]}" for fault in faults]


def side_faults(triskin, name, side, folder):
    """The modules of a design lie on the side that the faces say."""
    done = subprocess.run([triskin, "design", folder / name, "-o", folder / "d.json", "--iterations", "5", "--json"],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return [f"{name}: design ends with {done.returncode}: {done.stderr}"]
    modules = json.loads((folder / "d.json").read_text())["modules"]
    mean = sum(m["taxels"][0]["normal"][2] for m in modules) / len(modules)
    return [] if side * mean > 0.85 else [f"{name}: mean normal of {len(modules)} modules is {mean} along z"]


def main():
    triskin, data = sys.argv[1:]
    trials = pathlib.Path(data) / "trials"
    if not trials.exists():
        print(f"left out: {trials} is not there")
        return 77
    faults = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "trials"
        shutil.copytree(trials, folder, copy_function=shutil.copyfile)
        folder.chmod(0o755)
        before = (folder / "m_flip.mcap").read_bytes()
        for trial in TRIALS:
            faults += faults_of(triskin, trial, folder)
        if (folder / "m_flip.mcap").read_bytes() != before:
            faults.append("m_flip.mcap: was changed in place")
        for name, side in MODULES.items():
            faults += side_faults(triskin, name, side, folder)
        named = {t.file for t in TRIALS} | {"README.md", "cover data2.bin"}
        faults += [f"{p.name}: is not tried here" for p in sorted(folder.iterdir())
                   if p.name not in named and p.suffix not in (".bin",) and not p.name.startswith(("out", "d.json"))]
    print("\n".join(faults) or f"{len(TRIALS)} trials, all right")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
