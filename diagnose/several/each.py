"""What comes of each of several recordings that were fitted together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

import numpy as np

from linkwright.core.diagnose.fitting.fit import solved
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.noise import NoiseFloor
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.result import OfRecording
from linkwright.core.sections.numeric import Array


def of_recordings(
    observed: Observed,
    floors: Sequence[NoiseFloor],
    residuals: tuple[Array, Array, Array, Array],
    model: tuple[Array, Array],
    rejected: Sequence[RejectedRow],
) -> tuple[OfRecording, ...]:
    """What comes of each recording. `residuals` (N, D) m are those before anything was fitted, after it, held out by
    parts of the workspace, and held out by recording with what each swallows left in; `model` are the columns (N, C, d)
    of what each recording swallows and of what was found; `rejected` all rows set aside, numbered through."""
    recording = observed.recording
    beside, named = model
    before, after, held_out, apart = residuals
    places = [recording.place_of(item.row) for item in rejected]
    results: list[OfRecording] = []
    for index, (name, each) in enumerate(zip(recording.names, recording.singles, strict=True)):
        rows = recording.which == index
        results.append(
            OfRecording(
                name=name,
                file=PurePath(each.file).name,
                unit=each.unit,
                date=each.date,
                rows=int(rows.sum()),
                frame=each.frame,
                tool=each.tool,
                noise_floor=floors[index].rms_m,
                rms_before=rms_length(before[rows]),
                rms_after=rms_length(after[rows]),
                rms_held_out=rms_length(held_out[rows]),
                rms_from_others=rms_length(_after_fit(observed, apart, beside, index)),
                rms_own=rms_length(_after_fit(observed, before, np.concatenate([beside, named], axis=2), index)),
                rejected=tuple(sorted(row for where, row in places if where == index)),
            )
        )
    return tuple(results)


def _after_fit(observed: Observed, residual: Array, columns: Array, index: int) -> Array:
    """A recording's residuals of the tip (n, D), m, less what columns (N, C, d) fitted to it alone take off."""
    rows = observed.which == index
    width = observed.components
    design = columns[rows][:, :width] / observed.scale[:width, None]
    target = residual[rows] / observed.scale[:width]
    flat = design.reshape(design.shape[0] * width, design.shape[2])
    if flat.shape[1] == 0:
        return residual[rows]
    return residual[rows] - columns[rows][:, :width] @ solved(flat, target.reshape(-1))


def from_others(each: Sequence[OfRecording]) -> float:
    """The RMS length (m) that the models of the other recordings leave in all readings."""
    count = np.array([one.rows for one in each], dtype=float)
    return float(np.sqrt(np.sum(count * np.array([one.rms_from_others for one in each]) ** 2) / count.sum()))


def determined_without(index: int, candidates: Sequence[Candidate], count: int) -> list[int]:
    """Which candidates the recordings (`count` of them) but one (from 0) tell: where all that are left have a separate
    size beside the common one, that common one alone."""
    numbers: list[int] = []
    for place, candidate in enumerate(candidates):
        same_place = [item for item in candidates if (item.effect, item.at) == (candidate.effect, candidate.at)]
        recordings = {item.only for item in same_place}
        common = None in recordings and {k for k in range(count) if k != index} <= recordings
        if candidate.only is None or not common:
            numbers.append(place)
    return numbers
