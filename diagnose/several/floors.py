"""The noise floors of several recordings, each from its own repeats, and what they come to together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.noise import NoiseFloor
from linkwright.core.diagnose.several.recordings import Several


def floor_of_all(floors: Sequence[NoiseFloor], several: Several) -> NoiseFloor:
    """The floor of all readings together: mean squares by the number of readings. Known only where each one's is; from
    repeats only where each one's is."""
    count = np.array([int(np.sum(several.which == index)) for index in range(len(floors))], dtype=float)
    share = count / count.sum()
    known = [floor.sigma for floor in floors if floor.sigma is not None]
    rms, sigma = None, None
    if len(known) == len(floors):
        width = min(map(len, known))
        squares = share @ np.array([[part * part for part in item[:width]] for item in known])
        sigma = tuple(np.sqrt(squares).tolist())
        rms = float(np.sqrt(squares.sum()))
    sources = {floor.source for floor in floors}
    source = floors[0].source if len(sources) == 1 else "none" if "none" in sources else "declared"
    dof = sum(floor.degrees_of_freedom for floor in floors)
    again = [floor for floor in floors if floor.drift_m is not None]
    freedom = sum(item.drift_degrees_of_freedom for item in again)
    moved = sum((item.drift_m or 0.0) ** 2 * item.drift_degrees_of_freedom for item in again)
    labels = list(zip(several.names, floors, strict=True))
    outliers = [
        RejectedRow(aside.row + start - 1, aside.reason)
        for start, floor in zip(several.first_row, floors, strict=True)
        for aside in floor.outliers
    ]
    return replace(
        floors[0],
        sigma=sigma,
        source=source,
        degrees_of_freedom=dof if source == "repeats" else 0,
        rms_m=rms,
        sentence=" ".join(f"{name}: {item.sentence}" for name, item in labels),
        drift_m=float(np.sqrt(moved / freedom)) if freedom else None,
        drift_degrees_of_freedom=freedom,
        outliers=tuple(outliers),
        doubtful=(),
        resolution=None,
        warnings=tuple(f"{name}: {text}" for name, item in labels for text in item.warnings),
    )
