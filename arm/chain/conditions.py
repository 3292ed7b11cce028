"""What held at a reading beyond the pose and the load: time, temperatures, sides of approach, velocities, commands.

Effects ask it by name; None means that nobody knows, and an effect that needs it then has nothing to say.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from .vectors import Scalar

Scalars = tuple[Scalar, ...]


@dataclass(frozen=True)
class Past:
    """Where the arm had been before the first of some readings: times (M,) on their clock, s, none of them later than
    that reading, and the `warming` (K above 20 degC) of each link at them (M,), None where nobody knows it."""

    time: NDArray[np.float64]
    warming: tuple[NDArray[np.float64], ...] | None = None


@dataclass(frozen=True)
class Conditions:
    """Conditions of one pose (floats) or of N readings in the order of their visits (arrays of N).

    `time` in s since the recording began. `warming` (K above 20 degC), one entry for each link. `sides` +1 where a
    joint last moved towards increasing coordinates, -1 otherwise, one for each joint. `velocities` (rad/s, m/s) and
    `accelerations` (rad/s^2, m/s^2), `commanded` coordinates (rad, m), one for each joint. `loaded_for` is the time (s)
    since the present payload was taken up. `last_moves` (rad, m), one for each joint, is how far it had gone since the
    reading before, zero at the first. `past` is what the arm had been through before the first reading, where it is
    known: lags go on from there.
    """

    time: Scalar | None = None
    warming: Scalars | None = None
    sides: Scalars | None = None
    velocities: Scalars | None = None
    accelerations: Scalars | None = None
    commanded: Scalars | None = None
    loaded_for: Scalar | None = None
    last_moves: Scalars | None = None
    past: Past | None = None

    def lagged_warming(self, link: int, lag: float) -> Scalar:
        """The warming of `link` (from 0) behind a first-order lag of `lag` s: lag * dT'/dt = warming - dT.

        The link starts at the first temperature that is known, and temperature runs linearly between readings, for
        which the answer is exact. Without a lag, times or warming of several readings: the warming itself (0.0 where
        nobody knows it).
        """
        if self.warming is None:
            return 0.0
        warming = self.warming[link]
        if lag <= 0.0 or not isinstance(warming, np.ndarray) or not isinstance(self.time, np.ndarray):
            return warming
        if self.past is None or self.past.warming is None:
            return first_order_response(self.time, warming, lag)
        time, before = np.concatenate([self.past.time, self.time]), self.past.warming[link]
        return first_order_response(time, np.concatenate([before, warming]), lag)[len(before) :]


@dataclass(frozen=True)
class ConditionsOfSome(Conditions):
    """Conditions of the readings `rows` of a `whole`: lags run through all of it, and are computed once (`lags`)."""

    whole: Conditions = field(default_factory=Conditions)
    rows: slice = field(default_factory=lambda: slice(None))
    lags: dict[tuple[int, float], Scalar] = field(default_factory=dict[tuple[int, float], Scalar], compare=False)

    def lagged_warming(self, link: int, lag: float) -> Scalar:
        """The warming of `link` (from 0) behind a lag of `lag` s, at these readings."""
        if (link, lag) not in self.lags:
            self.lags[link, lag] = self.whole.lagged_warming(link, lag)
        return _some(self.lags[link, lag], self.rows)


def in_pieces(held: Conditions, pieces: Sequence[slice]) -> Iterator[ConditionsOfSome]:
    """The conditions of all readings as those of one piece of them after another."""
    lags: dict[tuple[int, float], Scalar] = {}
    names = [item.name for item in fields(Conditions) if item.name != "past"]
    for rows in pieces:
        parts = {name: _some(getattr(held, name), rows) for name in names}
        yield ConditionsOfSome(**parts, whole=held, rows=rows, lags=lags)


def _some(held: Any, rows: slice) -> Any:
    if isinstance(held, tuple):
        return tuple(_some(item, rows) for item in cast(Scalars, held))
    return held[rows] if isinstance(held, np.ndarray) else held


def first_order_response(time: NDArray[np.float64], drive: NDArray[np.float64], lag: float) -> NDArray[np.float64]:
    """Answer of lag * y' = drive - y to a drive that is piecewise linear in time (N), from rest at its first value."""
    from scipy.linalg import solve_banded  # here, for a list of effects needs none of it

    order = np.argsort(time, kind="stable")
    t, u = np.asarray(time, dtype=float)[order], np.asarray(drive, dtype=float)[order]
    # How far the answer is from the drive shrinks from one time to the next, and takes up what a ramp adds meanwhile;
    # where no time goes by, all of a step.
    step = np.diff(t) / lag
    added = np.diff(u) * np.divide(np.expm1(-step), step, out=-np.ones_like(step), where=step > 0.0)
    behind = np.stack([np.ones_like(u), np.append(-np.exp(-step), 0.0)])
    answer = np.empty_like(u)
    answer[order] = u + solve_banded((1, 0), behind, np.concatenate([[0.0], added]))
    return answer
