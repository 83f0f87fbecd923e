# SPDX-License-Identifier: GPL-3.0-or-later
"""From a surface to a plot of a touch, on simulated hardware: a design, a skin, contacts, a recording, a picture.
Usage: researcher_hour.py TRISKIN FOLDER     TRISKIN: the program; FOLDER gets all files
With a real skin only one line is another: triskin.open(design, link="can:can0") in place of triskin.simulate."""
import json
import pathlib
import subprocess
import sys

import numpy as np
import triskin

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])


def run(*words):
    subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


# A surface becomes a design. A scene says what touches the skin: 2 N on module 3 from the first second on.
mesh, design, scene, file = (folder / name for name in ("hip.obj", "hip.json", "touch.json", "touch.mcap"))
run("generate", "hip", "-o", mesh, "--size-mm", 110, "--faces", 300)
run("design", mesh, "-o", design, "--time-limit-s", 1)
scene.write_text(json.dumps({"format": "triskin-scene", "version": 1, "design": "hip.json",
                             "contacts": [{"at_s": 1, "module": 3, "taxel": 3, "force_n": 2, "radius_mm": 6}]}))

with triskin.simulate(str(design), scene=str(scene)) as skin:
    print(f"{skin.modules} modules, {12 * skin.modules} taxels")
    skin.read(3.0)  # three seconds pass
    for contact in skin.contacts():
        place = ", ".join(f"{v:.0f}" for v in contact["position_mm"])
        print(f"contact at module {skin.numbers[contact['module']]}: {contact['taxels']} taxels, {contact['change_counts']:.0f} counts, at {place} mm")
    good, report = skin.verify()  # in the middle of the stream; it goes on behind
    print("the hardware is the design" if good else report)
    print(f"{len(skin.read(1.0)) // skin.modules} samples of each module in the next second")

# What others recorded opens by its name.
run("record", design, "--link", "sim", "--scene", scene, "-o", file, "--seconds", 3)
recording = triskin.open(str(file))
strongest = recording.change_counts().max(axis=1).argmax()
mine = recording.samples["module"] == strongest
times = recording.samples["time_s"][mine] - recording.samples["time_s"][0]
pressed = recording.change[mine].max(axis=1)
begin = times[pressed > 200][0]
print(f"recording: {len(recording.samples)} samples{' of a simulation' if recording.simulated else ''}; module {recording.numbers[strongest]} is pressed")
assert recording.contacts(seconds=begin + 0.5) and not recording.contacts(seconds=max(0.0, begin - 0.2))



def write_svg(path):
    """The curves of the pressed module without any library: 10 s are 800 units, 1,000 counts 40."""
    curves = "".join('<polyline fill="none" stroke="#b35a00" points="%s"/>' % " ".join(
        f"{80 * t:.1f},{320 - 0.04 * c:.1f}" for t, c in zip(times, taxel)) for taxel in recording.change[mine].T)
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {80 * times[-1]:.0f} 330">{curves}</svg>')


try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    write_svg(folder / "touch.svg")
    print("plot: touch.svg")
    sys.exit()
figure = plt.figure(figsize=(9, 4))
places, change = recording.positions_mm.reshape(-1, 3), recording.change_counts().ravel()
figure.add_subplot(1, 2, 1, projection="3d").scatter(*places.T, c=change, cmap="inferno", s=6)
curve = figure.add_subplot(1, 2, 2)
curve.plot(times, recording.change[mine])
curve.set(xlabel="s", ylabel="counts below rest", title=f"module {recording.numbers[strongest]}")
figure.savefig(folder / "touch.png", dpi=110)
print("plot: touch.png")
