"""What a form outside the library is made of: readings' clock, their place, and how the tip may be off there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.diagnose.instruments.registry import kinds_of, slots_of
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array


def run_of(clock: Array) -> Array:
    """The time of each reading from 0 at the first to 1 at the last."""
    return (clock - clock.min()) / np.ptp(clock)


def tip_of(observed: Observed) -> Array:
    """Where the arm file's tip stands at each reading, (N, 3), m; undeformed, for what is found must not move it. Where
    it touched a point or a plane, it stands there."""
    if observed.recording.touches is not None and observed.view is not None:
        return observed.view.settled
    return columns(observed.nominal.tip(), observed.rows)


def tip_axes(observed: Observed) -> Array:
    """A displacement of the tip along each axis, alike at all readings, (1 or N, C, D); of numbers that
    do not go with the tip's place (a level's tilts) each by itself."""
    if observed.view is not None and observed.recording.slots is not None:
        moved = np.zeros((*observed.residual.shape, observed.space))
        moved[:, : observed.components] = observed.view.shown
        for kind in kinds_of(observed.recording.slots):
            for number, slot in enumerate(() if kind.of_place else slots_of(kind.name)):
                moved[:, : observed.components, number] += observed.recording.slots == slot
        return moved
    return np.eye(observed.residual.shape[1])[None, :, : observed.components]


def interactions(functions: Sequence[Array] | Array, patterns: Array) -> Array:
    """The interactions of a regression: functions of the readings (F, N) times each of some patterns (N or 1, C, d),
    (N, C, F d)."""
    made = np.transpose(functions)[:, None, :, None] * patterns[:, :, None, :]
    return made.reshape(*made.shape[:2], -1)


def scaled_position(observed: Observed) -> Array:
    """Where the tip stands, (N, D), each axis from -1 to 1 or so over the recording."""
    tip = tip_of(observed)[:, : observed.space]
    spread = np.ptp(tip, axis=0)
    return (tip - tip.mean(axis=0)) / np.where(spread > 0.0, 0.5 * spread, 1.0)
