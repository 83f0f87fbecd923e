# SPDX-License-Identifier: GPL-3.0-or-later
"""Hands frames of recordings to LeRobot's own writer (lerobot 0.4 to 0.6, data set format v3.0). It was written from
the published interface; our tests run it against a stand-in, since LeRobot is not in Debian. No camera, no action:
add yours to `features` and to each frame. Usage: lerobot_dataset.py ROOT TASK FILE.mcap..."""
import json
import pathlib
import sys

import triskin
from lerobot.datasets.lerobot_dataset import LeRobotDataset

RATE_HZ, WINDOW = 30, 4

root, task, *files = sys.argv[1:]
recordings = [triskin.read(file) for file in files]
name, taxels = recordings[0].name, 12 * recordings[0].modules
column_names = [f"module_{number}_taxel_{t}" for number in recordings[0].numbers for t in range(12)]
features = {
    f"observation.tactile.{name}": {"dtype": "float32", "shape": (taxels,), "names": column_names},
    f"observation.tactile.{name}.valid": {"dtype": "float32", "shape": (taxels,), "names": column_names},
    # The last samples of each taxel, oldest first: a frame of 30 Hz has what a skin of 54 Hz measured in it.
    f"observation.tactile_window.{name}": {"dtype": "float32", "shape": (WINDOW * taxels,), "names": None},
}
dataset = LeRobotDataset.create(repo_id=f"local/{name}", root=root, fps=RATE_HZ, features=features, use_videos=False)
for recording in recordings:
    if 12 * recording.modules != taxels:
        sys.exit(f"{recording.name}: has {recording.modules} modules; a data set is of one skin")
    grid = triskin.frames(recording, RATE_HZ, window=WINDOW)
    for k in range(len(grid.time_s)):
        dataset.add_frame({f"observation.tactile.{name}": grid.change_counts[k],
                           f"observation.tactile.{name}.valid": grid.valid[k].astype("float32"),
                           f"observation.tactile_window.{name}": grid.window_counts[k].ravel(),
                           "task": task})
    dataset.save_episode()
dataset.finalize()  # writes the ends of the Parquet files
# LeRobot leaves files in meta alone: where each column is, beside the data.
triskin.write_frames(recordings[0], pathlib.Path(root) / "meta" / "triskin", RATE_HZ, window=WINDOW)
(pathlib.Path(root) / "meta" / "triskin" / "frames.npz").unlink()
print(json.dumps({"episodes": len(recordings), "taxels": taxels, "fps": RATE_HZ}))
