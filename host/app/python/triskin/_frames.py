# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames at a fixed rate for learning, from a recording."""
import dataclasses
import json
import pathlib

import numpy as np

from ._core import BadInput, Recording

TAXELS = 12


@dataclasses.dataclass(frozen=True)
class Frames:
    """A recording on a grid of times. Column 12 m + t of a table is taxel t of the m-th module (its number: numbers[m])."""

    rate_hz: float
    time_s: np.ndarray  #: (frames,): since the first sample; frame k is at k / rate_hz
    change_counts: np.ndarray  #: (frames, taxels), float32: the newest value that was sampled by then
    valid: np.ndarray  #: (frames, taxels), bool: it was measured, at most max_age_s before
    window_counts: np.ndarray  #: (frames, window, taxels), float32: the last samples by then, oldest first
    force_n: np.ndarray  #: (frames, modules), float32: sum over the taxels; NaN without a calibration
    start_s: float  #: of the first sample, since 1970
    numbers: np.ndarray  #: (modules,)
    positions_mm: np.ndarray  #: (taxels, 3), frame of the mesh
    normals: np.ndarray  #: (taxels, 3), outward


def frames(recording, rate_hz=30.0, *, window=4, max_age_s=0.2):
    """Puts a recording on a grid of `rate_hz` frames a second. A frame has for each taxel the newest value by its time, never
    a later one, and the last `window` samples of each module. A taxel that was not sampled yet is 0 and not valid. Raises
    BadInput for a recording without samples."""
    if not isinstance(recording, Recording):
        raise BadInput("frames: give a recording, as triskin.read returns it")
    if not 0.1 <= rate_hz <= 1000.0 or int(window) != window or not 1 <= window <= 1000 or not max_age_s > 0.0:
        raise BadInput("frames: rate_hz is 0.1 to 1000, window 1 to 1000 samples, max_age_s more than 0")
    samples, window = recording.samples, int(window)
    if len(samples) == 0:
        raise BadInput("frames: the recording has no samples")
    start_s = float(samples["time_s"].min())
    count = int(np.floor((samples["time_s"].max() - start_s) * rate_hz)) + 1
    time_s = np.arange(count) / rate_hz
    modules = recording.modules
    windows = np.zeros((count, window, modules, TAXELS), np.float32)
    valid = np.zeros((count, modules, TAXELS), bool)
    for module in range(modules):
        rows = np.flatnonzero(samples["module"] == module)
        rows = rows[np.argsort(samples["time_s"][rows], kind="stable")]
        if len(rows) == 0:
            continue
        at_s = samples["time_s"][rows] - start_s
        # Times are doubles of seconds since 1970, exact to a quarter of a microsecond.
        newest = np.searchsorted(at_s, time_s + 1e-6, side="right") - 1
        for back in range(window):
            known = newest - back
            there = known >= 0
            windows[there, window - 1 - back, module] = recording.change[rows[known[there]]]
        there = newest >= 0
        fresh = there & (time_s - at_s[np.maximum(newest, 0)] <= max_age_s)
        bits = samples["valid"][rows[np.maximum(newest, 0)]]
        valid[:, module] = fresh[:, None] & ((bits[:, None] >> np.arange(TAXELS)) & 1).astype(bool)
    change = windows[:, -1]
    known = recording.calibration()
    force = np.full((count, modules), np.nan, np.float32)
    if known is not None:
        counts_per_kpa, area_mm2 = known
        with np.errstate(divide="ignore", invalid="ignore"):
            pressure_kpa = np.where(counts_per_kpa > 0.0, change / counts_per_kpa, 0.0)
        force = (np.nansum(pressure_kpa, axis=2) * area_mm2 * 1e-3).astype(np.float32)  # kPa mm2 = 1e-3 N
    return Frames(rate_hz, time_s, change.reshape(count, -1), valid.reshape(count, -1), windows.reshape(count, window, -1),
                  force, start_s, recording.numbers.copy(), recording.positions_mm.reshape(-1, 3),
                  recording.normals.reshape(-1, 3))


def write_frames(recording, folder, rate_hz=30.0, *, window=4, max_age_s=0.2, link=None, link_poses=None):
    """Writes frames() into a folder: frames.npz with the tables and geometry.json beside it, which says where each column
    is: position (m), normal, number of module, taxel, units and order. `link` names the link that carries the skin;
    `link_poses`, (frames, 7), is its pose in the world at each frame: x, y, z (m), quaternion x, y, z, w. Returns the
    Frames."""
    grid = frames(recording, rate_hz, window=window, max_age_s=max_age_s)
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    tables = {"time_s": grid.time_s, "change_counts": grid.change_counts, "valid": grid.valid,
              "window_counts": grid.window_counts, "force_n": grid.force_n}
    if link_poses is not None:
        poses = np.asarray(link_poses, float)
        if poses.shape != (len(grid.time_s), 7):
            raise BadInput(f"write_frames: link_poses has the shape {poses.shape}, not {(len(grid.time_s), 7)}")
        tables["link_pose"] = poses
    np.savez_compressed(folder / "frames.npz", **tables)
    columns = len(grid.positions_mm)
    geometry = {
        "format": "triskin-frames", "version": 1, "name": recording.name, "simulated": recording.simulated,
        "rate_hz": rate_hz, "start_s": grid.start_s, "window": int(window),
        "frame": link if link is not None else "mesh", "order": "column = 12 * index of the module + taxel",
        "units": {"position": "m", "change_counts": "converter counts below rest", "force_n": "N, sum of a module",
                  "time_s": "s since start_s", "link_pose": "m, quaternion x y z w"},
        "module": [int(grid.numbers[c // TAXELS]) for c in range(columns)],
        "taxel": [c % TAXELS for c in range(columns)],
        "measures": ["temperature" if c % TAXELS in (6, 10) else "pressure" for c in range(columns)],
        "position": (grid.positions_mm / 1000.0).round(6).tolist(), "normal": grid.normals.round(6).tolist()}
    known = recording.calibration()
    if known is not None:
        geometry["area_mm2"] = [float(known[1][c // TAXELS]) for c in range(columns)]
    (folder / "geometry.json").write_text(json.dumps(geometry) + "\n", encoding="utf-8")
    return grid
