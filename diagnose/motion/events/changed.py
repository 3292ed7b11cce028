"""What changes within a log: the effect that acts otherwise from an instant on, or between two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.motion.findings import parameters_of
from linkwright.core.diagnose.motion.model.candidates import Candidates
from linkwright.core.diagnose.motion.model.evidence import LIKELY
from linkwright.core.diagnose.motion.model.identify import Identified
from linkwright.core.diagnose.motion.model.products import Products, products
from linkwright.core.diagnose.motion.model.rows import LogRows, joint_rows
from linkwright.core.diagnose.motion.model.steps import Parts, Step, SteppedFit, fitted, may_step, tried
from linkwright.core.diagnose.motion.result import Change, Instant
from linkwright.core.diagnose.result import HALF, FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_PARTS = 40
"""Parts of a log between which a change is looked for first; within them every sample is tried."""
_ROUNDS = 20
"""Instants and sizes in turn, until the instants stand."""
SURE = 1.96
"""Standard deviations to each end of a 95 % interval."""


@dataclass(frozen=True)
class Logs:
    """Candidates, the `rows` of all logs, and what weighs each joint's rows (n,)."""

    pool: Candidates
    rows: Sequence[LogRows]
    weights: Array

    def in_parts(self, number: int, part: NDArray[np.int64]) -> Products:
        """Products of all logs, of one (its number) by the `part` (M,) that each row belongs to."""
        rows = [
            replace(item, block=part if log == number else np.zeros_like(item.block))
            for log, item in enumerate(self.rows)
        ]
        return products(joint_rows(rows), self.pool.width, near=False)

    def between(self, number: int, start: int, stop: int) -> tuple[Products, Parts]:
        """Products of all logs, of one (its number) in parts, of which one is from a row to the one before another."""
        row = np.arange(len(self.rows[number].target))
        part = np.unique((row >= start).astype(np.int64) + (row >= stop), return_inverse=True)[1]
        motion = self.in_parts(number, part)
        here = motion.log == number
        return motion, here & (np.cumsum(here) == 1 + (start > 0))

    def fitted(self, motion: Products, steps: Sequence[Step] = ()) -> SteppedFit:
        """The whole library fitted to a motion in parts."""
        return fitted(self.pool, motion, self.weights, steps)


@dataclass(frozen=True)
class Settled:
    """A step with its `change`, and the share of the square that it explains `within` its time."""

    step: Step
    change: Change
    within: float


def change_of(identified: Identified, *, rules: Rules) -> Change | None:
    """The change within a log that explains most of the square that is left; None where none explains half of it.

    The whole library is fitted with one group of the candidates that has other sizes from an instant on; of all groups
    and instants the likeliest is taken, if it pays for having been chosen.
    """
    logs, best = Logs(identified.pool, identified.rows, identified.noise.weights), None
    for number, rows in enumerate(identified.rows):
        count = len(rows.target)
        motion = logs.in_parts(number, np.arange(count) * _PARTS // count)
        part = np.cumsum(motion.log == number)
        where = [(motion.log == number) & (part > first) for first in range(1, part[-1])]
        steps = list(tried(logs.fitted(motion), where, may_step(identified.pool)))
        step = max(steps, key=lambda item: item.gain, default=None)
        if step is None or step.gain <= np.log(len(steps)) + rules.search.margin:
            continue
        change = settled(logs, number, logs.fitted(motion, (step,)), rules=rules).change
        if change.share > HALF and (best is None or change.share > best.share):
            best = change
    return best


def settled(logs: Logs, number: int, fit: SteppedFit, *, quiet: bool = False, rules: Rules) -> Settled:
    """The change in a log (its number) with its instants, sizes and noise in turn until the instants stand: what the
    library left without it was no noise, but where the weights are already those of `quiet` motion."""
    rows, given = logs.rows[number], logs.weights
    constant = np.sum(_left(rows, logs.fitted(fit.motion).common) ** 2, axis=0)
    start, stop = -1, -1
    for _ in range(_ROUNDS):
        earlier = start, stop
        start, stop, gained, left = _span(rows, fit)
        if (start, stop) == earlier:
            break
        weights = given if quiet else given * constant / np.maximum(left, 1e-12 * constant)
        motion, there = logs.between(number, start, stop)
        fit = replace(logs, weights=weights).fitted(motion, (replace(fit.steps[0], parts=there),))
    start, stop, gained, left = _span(rows, fit)
    clock, (step,) = rows.prepared.motion.time[rows.prepared.kept], fit.steps
    begins = np.flatnonzero(gained[: stop + 1] - gained[start] <= LIKELY)
    ends = start + np.flatnonzero(gained[stop] - gained[start:] <= LIKELY)
    change = Change(
        step.group.effect.id,
        step.group.at,
        sized(step, rows, rules=rules),
        rows.prepared.log.file,
        Instant(float(clock[start]), (float(clock[max(begins[0] - 1, 0)]), float(clock[begins[-1]]))),
        None
        if stop == len(clock)
        else Instant(float(clock[stop]), (float(clock[ends[0] - 1]), float(clock[min(ends[-1], len(clock) - 1)]))),
        1.0 - float(given @ left) / float(given @ constant),
        tuple(_pushed(rows, step, slice(start, stop)).tolist()),
    )
    before, after = (np.sum(item[start:stop], axis=0) @ fit.weights for item in _squares(rows, fit))
    return Settled(step, change, 1.0 - float(after) / max(float(before), 1e-300))


def sized(step: Step, rows: LogRows, *, rules: Rules) -> tuple[FittedParameter, ...]:
    """The parameters of a step that the logs show, with their intervals."""
    scatter = np.sqrt(np.diagonal(step.covariance))
    half, shown = SURE * np.stack((scatter, scatter)), scatter < rules.motion.shown * step.group.usual
    return parameters_of(step.group, rows.prepared.motion.arm, step.numbers, half, shown)


def _pushed(rows: LogRows, step: Step, there: slice) -> Array:
    """RMS (n,) N*m of what a step adds to the torques on some rows."""
    sizes = np.zeros(1 + max(int(columns.max(initial=0)) for columns in rows.columns))
    sizes[step.group.columns] = step.group.values(step.numbers)
    return np.sqrt(np.mean(np.square(rows.explained(sizes)[there]), axis=0))


def _left(rows: LogRows, sizes: Array) -> Array:
    """What sizes (W,) leave of each joint's torque where it counts (M, n), N*m."""
    return (rows.target - rows.explained(sizes)) * rows.prepared.moving


def _squares(rows: LogRows, fit: SteppedFit) -> tuple[Array, Array]:
    """Squares (M, n) of what is left of each joint's torque without the step, and with it."""
    (step,) = fit.steps
    there = fit.common.copy()
    there[step.group.columns] += step.group.values(step.numbers)
    return _left(rows, fit.common) ** 2, _left(rows, there) ** 2


def _span(rows: LogRows, fit: SteppedFit) -> tuple[int, int, Array, Array]:
    """The row from which on the step fits best and the first that it no longer fits (M where it lasts to the end), how
    many nats it has gained before each row (M + 1,), and the sum of squares (n,) left of each joint's torque.

    (The greatest sum of consecutive terms: J. Bentley, Programming Pearls, Comm. ACM 27 (1984) 865.)
    """
    before, after = _squares(rows, fit)
    gained = np.concatenate(([0.0], 0.5 * np.cumsum((before - after) @ fit.weights)))
    stop = int(np.argmax(gained - np.minimum.accumulate(gained)))
    if gained[-1] >= gained[stop] - LIKELY:
        stop = len(before)
    start = int(np.argmin(gained[:stop]))
    left = before.sum(axis=0) + np.sum((after - before)[start:stop], axis=0)
    return start, stop, gained, left
