# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the wheel, installs it into a fresh environment, and uses it there without the tree: every example, the notebook,
mypy and pyright. Usage: check_wheel.py SOURCE BUILD PROGRAM DESIGN PART   PART: examples, types or notebook"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

source, build, program, design, part = (pathlib.Path(a).resolve() if k < 4 else a for k, a in enumerate(sys.argv[1:]))
folder = pathlib.Path(tempfile.mkdtemp(prefix="wheel."))
environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}", "XDG_STATE_HOME": str(folder / "state"),
               "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(folder)}
environment.pop("PYTHONPATH", None)


def run(*words, status=0):
    done = subprocess.run([str(w) for w in words], cwd=folder / "work", env=environment, capture_output=True, text=True)
    assert done.returncode == status, f"{words}: status {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


(folder / "work").mkdir()
subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", folder / "venv"], check=True)
python = folder / "venv/bin/python"
run(folder / "venv/bin/pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation",
    f"--config-settings=build={build}", source)
where = pathlib.Path(run(python, "-c", "import triskin; print(triskin.__file__)").strip())
assert where.is_relative_to(folder), where
for name in ("__init__.pyi", "_frames.pyi", "py.typed"):
    assert (where.parent / name).exists(), f"the wheel lacks {name}"
shutil.copytree(source / "docs/examples/python", folder / "work/examples")
shutil.copy(design, folder / "work/d.json")
scene = {"format": "triskin-scene", "version": 1, "design": "d.json",
         "contacts": [{"at_s": 1, "module": 5, "taxel": 3, "force_n": 1, "radius_mm": 3}]}
(folder / "work/s.json").write_text(json.dumps(scene))

# What each example says; module 5 is pressed by 1 N from the first second on.
EXAMPLES = {
    "design_part.py": ("hip.obj hip.json", r"\d+ modules, \d+ controllers"),
    "plot_touch.py": ("d.json sim s.json", r"touch.png: strongest \d{3} counts"),
    "force_threshold.py": ("d.json s.json", r"\d\.\d s: pressed \(\d+ counts\)\npressed at the end"),
    "live_contacts.py": ("d.json s.json", r"module 5: \d+ counts on \d+ mm2 at"),
    "async_tasks.py": ("d.json", r"\d{3,} samples while another task took 50 steps"),
    "verify.py": ("d.json", r"(?s).+"),
    "calibrate.py": ("d.json", r"counts for 1 kPa, a taxel stands for \d+ mm2\nnow at most"),
    "export_mujoco.py": ("d.json", r"skin\.xml: \d+ bodies, as .*module_7"),
    "sample_times.py": ("d.json", r"period \d\d\.\d ms.*\n.* 0 samples lost"),
    "record_ten_seconds.py": ("d.json sim 3", r"\d+ samples of 8 modules in [23]\.\d s"),
    "read_dataframe.py": ("pressed.mcap", r"most pressed: module 5 with \d+ counts"),
    "learning_frames.py": ("pressed.mcap frames 30", r"\d+ frames of 96 taxels at 30 Hz.*\ncolumn 63 is taxel 3 of module 5"),
}
if part in ("examples", "notebook"):
    run(program, "generate", "hip", "-o", "hip.obj", "--size-mm", 110, "--faces", 300)
    run(python, "-c", "import triskin; triskin.simulate('d.json').close()")
    run(program, "record", "d.json", "--link", "sim", "--scene", "s.json", "-o", "pressed.mcap", "--seconds", 3)
if part == "examples":
    there = {p.name for p in (folder / "work/examples").glob("*.py")}
    assert there == set(EXAMPLES), there ^ set(EXAMPLES)
    for name, (arguments, said) in EXAMPLES.items():
        out = run(python, f"examples/{name}", *arguments.split())
        assert re.search(said, out), f"{name}: {out}"
        assert len((folder / "work/examples" / name).read_text().splitlines()) <= 50, f"{name} is longer than a page"
    # LeRobot is not in Debian; a stand-in with the calls that its page names takes what the script hands over.
    stand_in = folder / "work/lerobot/datasets"
    stand_in.mkdir(parents=True)
    (stand_in / "lerobot_dataset.py").write_text("""
class LeRobotDataset:
    @classmethod
    def create(cls, repo_id, root, fps, features, use_videos):
        me = cls()
        me.features, me.frames, me.episodes, me.is_final = features, 0, 0, False
        assert fps == 30 and repo_id.startswith('local/') and not use_videos
        return me
    def add_frame(self, frame):
        assert set(frame) == set(self.features) | {'task'}
        for name, feature in self.features.items():
            assert frame[name].shape == tuple(feature['shape']) and frame[name].dtype == feature['dtype'], name
            assert feature['names'] is None or len(feature['names']) == feature['shape'][0]
        self.frames += 1
    def save_episode(self):
        assert self.frames > 60
        self.episodes += 1
    def finalize(self):
        assert self.episodes == 1
""")
    out = subprocess.run([python, source / "docs/examples/lerobot_dataset.py", "data", "press", "pressed.mcap"],
                         cwd=folder / "work", env={**environment, "PYTHONPATH": str(folder / "work")}, check=True,
                         capture_output=True, text=True).stdout
    assert json.loads(out) == {"episodes": 1, "taxels": 96, "fps": 30}, out
    assert (folder / "work/data/meta/triskin/geometry.json").exists()
    # By hand: the frames of a grid against the samples of the recording.
    run(python, "-c", """
import numpy as np, triskin
r = triskin.read('pressed.mcap')
g = triskin.frames(r, 20.0, window=3)
t = r.samples['time_s'] - r.samples['time_s'].min()
assert np.allclose(np.diff(g.time_s), 0.05) and g.window_counts.shape == (len(g.time_s), 3, 96)
for k in (0, 7, len(g.time_s) - 1):
    for m in range(8):
        mine = [(t[j], j) for j in range(len(t)) if r.samples['module'][j] == m and t[j] <= g.time_s[k] + 1e-6]
        last = [j for _, j in sorted(mine)[-3:]]
        for back, j in enumerate(reversed(last)):
            assert (g.window_counts[k, 2 - back, 12 * m:12 * m + 12] == r.change[j].astype('float32')).all(), (k, m, back)
        assert g.valid[k, 12 * m] == bool(last and r.samples['valid'][last[-1]] & 1 and g.time_s[k] - t[last[-1]] <= 0.2)
try:
    triskin.frames(r, 0.0)
    raise SystemExit('0 Hz was taken')
except triskin.BadInput as e:
    assert 'rate_hz' in str(e) and triskin.BadInput.__module__ == 'triskin'
try:
    triskin.read('d.json')
    raise SystemExit('a design was taken')
except triskin.BadInput:
    pass
d = r.to_dataframe('value')
assert len(d) == len(r.samples) and (d['value_3'] == r.samples['value'][:, 3]).all()
""")
    print(f"{len(EXAMPLES)} examples")
if part == "types":
    right = folder / "work/right.py"
    right.write_text("import triskin\n\n\ndef strongest(file: str) -> float:\n    with triskin.open(file, link=\"sim\") as skin:\n"
                     "        for block in skin.blocks(0.5):\n            print(len(block))\n            break\n"
                     "        return float(skin.change_counts().max())\n\n\n"
                     "def first(file: str) -> int:\n    return int(triskin.read(file).numbers[0])\n\n\n"
                     "def many(file: str) -> int:\n    return len(triskin.frames(triskin.read(file), rate_hz=20.0).time_s)\n")
    wrong = folder / "work/wrong.py"
    wrong.write_text("import triskin\n\nwith triskin.simulate(\"d.json\", every=\"two\") as skin:\n    print(skin.pressure())\n")
    asked = []
    if shutil.which("mypy"):
        mypy = ("mypy", "--python-executable", python, "--cache-dir", folder / "mypy", "--strict")
        run(*mypy, right)
        said = run(*mypy, wrong, status=1)
        assert "every" in said and '"pressure"' in said, said
        asked.append("mypy")
    pyright = source / "build/npm/node_modules/pyright/index.js"
    if pyright.exists() and shutil.which("node"):
        run("node", pyright, "--pythonpath", python, right)
        said = run("node", pyright, "--pythonpath", python, wrong, status=1)
        assert "every" in said and '"pressure"' in said, said
        asked.append("pyright")
    print(f"asked {' and '.join(asked) or 'nobody'}")
if part == "notebook":
    shutil.copy(source / "docs/examples/touch.ipynb", folder / "work")
    out = run(python, "-c", """
import nbformat, nbclient, os, pathlib, triskin
# The kernel is Debian's interpreter; it finds the module in the environment.
os.environ['PYTHONPATH'] = str(pathlib.Path(triskin.__file__).parent.parent)
book = nbformat.read('touch.ipynb', 4)
nbclient.NotebookClient(book, timeout=120).execute()
print(*[o['text'] for c in book.cells for o in c.get('outputs', []) if o.output_type == 'stream'])
""")
    assert re.search(r"module 5", out), out
    print("the notebook runs")
shutil.rmtree(folder)
