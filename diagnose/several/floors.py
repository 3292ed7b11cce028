"""The noise floors of several recordings, each from its repeats, and what they come to together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.noise import NoiseFloor, pooled_floor
from linkwright.core.diagnose.several.recordings import Several


def floor_of_all(floors: Sequence[NoiseFloor], several: Several) -> NoiseFloor:
    """The floor of all readings together: mean squares by the number of readings. Known only where each one's is; from
    repeats only where each one's is."""
    count = np.array([int(np.sum(several.which == index)) for index in range(len(floors))], dtype=float)
    share = count / count.sum()
    known = [floor.sigma for floor in floors if floor.sigma is not None]
    sigma = None
    if len(known) == len(floors):
        width = min(map(len, known))
        squares = share @ np.array([[part * part for part in item[:width]] for item in known])
        sigma = tuple(np.sqrt(squares).tolist())
    outliers = [
        RejectedRow(aside.row + start - 1, aside.reason)
        for start, floor in zip(several.first_row, floors, strict=True)
        for aside in floor.outliers
    ]
    return replace(pooled_floor(floors, several.names, sigma), outliers=tuple(outliers), doubtful=())
