# SPDX-License-Identifier: GPL-3.0-or-later
import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import Recording

@dataclass(frozen=True)
class Frames:
    rate_hz: float
    time_s: npt.NDArray[np.float64]
    change_counts: npt.NDArray[np.float32]
    valid: npt.NDArray[np.bool_]
    window_counts: npt.NDArray[np.float32]
    force_n: npt.NDArray[np.float32]
    start_s: float
    numbers: npt.NDArray[np.int32]
    positions_mm: npt.NDArray[np.float64]
    normals: npt.NDArray[np.float64]

def frames(recording: Recording, rate_hz: float = 30.0, *, window: int = 4, max_age_s: float = 0.2) -> Frames: ...
def write_frames(
    recording: Recording,
    folder: str | os.PathLike[str],
    rate_hz: float = 30.0,
    *,
    window: int = 4,
    max_age_s: float = 0.2,
    link: str | None = None,
    link_poses: npt.ArrayLike | None = None,
) -> Frames: ...
