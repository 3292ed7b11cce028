"""Since when a log follows other torques: the effect and the instant from which on it acts otherwise than before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.result import HALF, FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .findings import parameters_of
from .model.evidence import LIKELY
from .model.identify import Identified
from .model.products import Products, products
from .model.rows import LogRows, joint_rows
from .model.steps import Step, SteppedFit, fitted, may_step, tried
from .result import Change

_PARTS = 40
"""Parts of a log between which a change is looked for first; within them every sample is tried."""
_ROUNDS = 20
"""Instants and sizes in turn, until the instant stands."""
SURE = 1.96
"""Standard deviations to each end of a 95 % interval."""


def change_of(identified: Identified, *, rules: Rules) -> Change | None:
    """The change within a log that explains most of the square that is left; None where none explains half of it.

    The whole library is fitted with one group of the candidates that has other sizes from an instant on; of all groups
    and instants the likeliest is taken, if it pays for having been chosen.
    """
    weights, best = identified.noise.weights, None
    for number, rows in enumerate(identified.rows):
        count = len(rows.target)
        motion = _in_parts(identified, number, np.arange(count) * _PARTS // count)
        fit, part = fitted(identified.pool, motion, weights), np.cumsum(motion.log == number)
        where = [(motion.log == number) & (part > first) for first in range(1, part[-1])]
        steps = list(tried(fit, where, may_step(identified.pool)))
        step = max(steps, key=lambda item: item.gain, default=None)
        if step is None or step.gain <= np.log(len(steps)) + rules.search.margin:
            continue
        change = _settled(identified, number, fitted(identified.pool, motion, weights, (step,)), rules=rules)
        if change.share > HALF and (best is None or change.share > best.share):
            best = change
    return best


def _settled(identified: Identified, number: int, fit: SteppedFit, *, rules: Rules) -> Change:
    """The change in a log (its number) with its instant, sizes and noise in turn until the instant stands: what the
    library left without it was no noise."""
    rows, given = identified.rows[number], identified.noise.weights
    constant = np.sum(_left(rows, fitted(identified.pool, fit.motion, given).common) ** 2, axis=0)
    start = -1
    for _ in range(_ROUNDS):
        earlier = start
        start, worse, left = _instant(rows, fit)
        if start == earlier:
            break
        weights = given * constant / np.maximum(left, 1e-12 * constant)
        motion = _in_parts(identified, number, (np.arange(len(rows.target)) >= start).astype(np.int64))
        later = (motion.log == number) & (np.cumsum(motion.log == number) == 2)
        fit = fitted(identified.pool, motion, weights, (replace(fit.steps[0], parts=later),))
    start, worse, left = _instant(rows, fit)
    clock = rows.prepared.motion.time[rows.prepared.kept]
    likely: NDArray[np.int64] = np.flatnonzero(worse <= LIKELY) + 1
    (step,) = fit.steps
    return Change(
        step.group.effect.id,
        step.group.at,
        sized(step, rows, rules=rules),
        rows.prepared.log.file,
        float(clock[start]),
        (float(clock[likely[0] - 1]), float(clock[likely[-1]])),
        1.0 - float(given @ left) / float(given @ constant),
    )


def sized(step: Step, rows: LogRows, *, rules: Rules) -> tuple[FittedParameter, ...]:
    """The parameters of a step that the logs show, with their intervals."""
    scatter = np.sqrt(np.diagonal(step.covariance))
    half, shown = SURE * np.stack((scatter, scatter)), scatter < rules.motion.shown * step.group.usual
    return parameters_of(step.group, rows.prepared.motion.arm, step.numbers, half, shown)


def _in_parts(identified: Identified, number: int, part: NDArray[np.int64]) -> Products:
    """Products of all logs, of one (its number) by the `part` (M,) that each row belongs to."""
    rows = [
        replace(item, block=part if log == number else np.zeros_like(item.block))
        for log, item in enumerate(identified.rows)
    ]
    return products(joint_rows(rows), identified.pool.width, near=False)


def _left(rows: LogRows, sizes: Array) -> Array:
    """What sizes (W,) leave of each joint's torque where it counts (M, n), N*m."""
    return (rows.target - rows.explained(sizes)) * rows.prepared.moving


def _instant(rows: LogRows, fit: SteppedFit) -> tuple[int, Array, Array]:
    """The row from which on the step fits best, for each row how much less likely it is than that (nats), and the sum
    of squares (n,) that is left of each joint's torque."""
    (step,) = fit.steps
    later = fit.common.copy()
    later[step.group.columns] += step.group.values(step.numbers)
    before, after = (_left(rows, sizes) ** 2 for sizes in (fit.common, later))
    cost = np.cumsum(before @ fit.weights)[:-1] + np.cumsum((after @ fit.weights)[::-1])[::-1][1:]
    start = int(np.argmin(cost)) + 1
    return start, 0.5 * (cost - cost.min()), before[:start].sum(axis=0) + after[start:].sum(axis=0)
