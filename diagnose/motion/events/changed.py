"""What changes within a log: the effect that acts otherwise from an instant on, or between two."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.motion.findings import parameters_of
from linkwright.core.diagnose.motion.model.candidates import Candidates
from linkwright.core.diagnose.motion.model.evidence import LIKELY
from linkwright.core.diagnose.motion.model.groups import Group
from linkwright.core.diagnose.motion.model.identify import Identified
from linkwright.core.diagnose.motion.model.noise import Noise, noise
from linkwright.core.diagnose.motion.model.products import Products, products
from linkwright.core.diagnose.motion.model.rows import LogRows, joint_rows
from linkwright.core.diagnose.motion.model.steps import Parts, Step, SteppedFit, fitted, may_step, tried
from linkwright.core.diagnose.motion.result import Change
from linkwright.core.diagnose.result import HALF, FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .placed import Placed, placed

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

    def in_parts(self, number: int, *edges: int) -> tuple[Products, NDArray[np.int64]]:
        """Products of all logs, of one (its number) in parts with edges at some rows; and the row with which each part
        begins (-1: another log's)."""
        row = np.arange(len(self.rows[number].target))
        begins = np.unique([0, *(edge for edge in edges if edge < len(row))])
        part = np.searchsorted(begins, row, side="right") - 1
        rows = [
            replace(item, block=part if log == number else np.zeros_like(item.block))
            for log, item in enumerate(self.rows)
        ]
        motion = products(joint_rows(rows), self.pool.width, near=False)
        row_of = np.full(motion.blocks, -1)
        row_of[motion.log == number] = begins
        return motion, row_of

    def between(self, number: int, start: int, stop: int) -> tuple[Products, Parts]:
        """Products of all logs, of one (its number) in parts, of which one is from a row to the one before another."""
        motion, begins = self.in_parts(number, start, stop)
        return motion, (begins >= start) & (begins < stop)

    def fitted(self, motion: Products, steps: Sequence[Step] = ()) -> SteppedFit:
        """The whole library fitted to a motion in parts."""
        return fitted(self.pool, motion, self.weights, steps)


@dataclass(frozen=True)
class Settled:
    """A step with its `change`, the rows it spans, what it has `added` to the torques (M, n), and the share of the
    square that it explains `within` its rows; of one that was chosen, how many nats it gains, its choice `paid` for."""

    step: Step
    change: Change
    span: tuple[int, int]
    added: Array
    within: float
    paid: float = 0.0


def change_of(identified: Identified, *, rules: Rules) -> Change | None:
    """The change within a log that explains most of the square that is left; None where none explains half of it."""
    made = stepped(identified.pool, identified.rows, identified.noise, may_step(identified.pool), rules=rules)
    return max((item.change for item in made), key=lambda change: change.share, default=None)


def stepped(
    pool: Candidates, rows: Sequence[LogRows], heard: Noise, groups: Sequence[Group], *, rules: Rules
) -> Iterator[Settled]:
    """The likeliest step within each log, if it pays for having been chosen and explains half of the square left.

    The whole library is fitted with one of the groups that has other sizes from an instant on. What the library leaves
    without the step is no noise: step and noise are sought in turn, from the noise that is `heard` without any.
    """
    for number, row in enumerate(rows):
        logs, before = Logs(pool, rows, heard.weights), None
        for _ in range(_ROUNDS):
            made = _likeliest(logs, number, groups, before.span if before else (0, 0), rules=rules)
            stands = made and before and made.span == before.span and made.step.group is before.step.group
            before = made
            if made is None or stands:
                break
            less = replace(row, target=row.target - made.added)
            quiet = [less if log == number else item for log, item in enumerate(rows)]
            logs = replace(logs, weights=noise(pool, products(joint_rows(quiet), pool.width, near=False)).weights)
        if before and before.paid > rules.search.margin and before.change.share > HALF:
            yield before


def _likeliest(
    logs: Logs, number: int, groups: Sequence[Group], known: tuple[int, int], *, rules: Rules
) -> Settled | None:
    """The likeliest step within a log (its number) by the noise as it stands, from an instant between parts on, or in
    the rows that are `known` from the first to the one before the second; None where the log is too short."""
    count = len(logs.rows[number].target)
    motion, begins = logs.in_parts(number, *(part * count // _PARTS for part in range(_PARTS)), *known)
    where = [begins >= first for first in begins.tolist() if first > 0]
    if known[0] < known[1]:
        where.append((begins >= known[0]) & (begins < known[1]))
    steps = list(tried(logs.fitted(motion), where, groups))
    if not steps:
        return None
    best = max(steps, key=lambda item: item.gain)
    made = settled(logs, number, logs.fitted(motion, (best,)), rules=rules)
    return replace(made, paid=best.gain - float(np.log(len(steps))))


def settled(logs: Logs, number: int, fit: SteppedFit, *, rules: Rules) -> Settled:
    """The change in a log (its number) by its instants."""
    alone, start, end = roughly(logs, number, fit)
    rows = logs.rows[number]
    return settled_at(rows, alone, placed(rows, alone, fit.steps[0], start, end), rules=rules)


def roughly(logs: Logs, number: int, fit: SteppedFit) -> tuple[SteppedFit, float, float | None]:
    """Between which rows of a log (its number) a step is likeliest, rows and sizes in turn until the rows stand: the
    library alone, and the times of its start and its end (None: the log's)."""
    rows, clock = logs.rows[number], _clock(logs.rows[number])
    start, stop = -1, -1
    for _ in range(_ROUNDS):
        earlier = start, stop
        start, stop = _span(rows, fit)
        if (start, stop) == earlier:
            break
        motion, there = logs.between(number, start, stop)
        fit = logs.fitted(motion, (replace(fit.steps[0], parts=there),))
    return logs.fitted(fit.motion), float(clock[start]), float(clock[stop]) if stop < len(clock) else None


def settled_at(rows: LogRows, alone: SteppedFit, made: Placed, *, rules: Rules) -> Settled:
    """The change that a step makes at its instants, beside the library `alone`."""
    clock, step = _clock(rows), made.step
    start = min(int(np.searchsorted(clock, made.start.time)), len(clock) - 1)
    stop = len(clock) if made.end is None else max(int(np.searchsorted(clock, made.end.time)), start + 1)
    left = rows.target - rows.explained(made.common)
    constant, before, after = (
        np.square(each * rows.prepared.moving) @ alone.weights
        for each in (rows.target - rows.explained(alone.common), left, left - made.added)
    )
    change = Change(
        step.group.effect.id,
        step.group.at,
        sized(step, rows, rules=rules),
        rows.prepared.log.file,
        made.start,
        made.end,
        1.0 - float(np.sum(after)) / max(float(np.sum(constant)), 1e-300),
        tuple(np.sqrt(np.mean(np.square(made.added[start:stop]), axis=0)).tolist()),
    )
    within = float(np.sum(after[start:stop])) / max(float(np.sum(before[start:stop])), 1e-300)
    return Settled(step, change, (start, stop), made.added, 1.0 - within)


def _clock(rows: LogRows) -> Array:
    """When (M,) s each row is."""
    return rows.prepared.motion.time[rows.prepared.kept]


def sized(step: Step, rows: LogRows, *, rules: Rules) -> tuple[FittedParameter, ...]:
    """The parameters of a step that the logs show, with their intervals."""
    variance = np.diagonal(step.covariance)
    scatter = np.sqrt(np.where(variance > 0.0, variance, np.inf))  # rounding, where rows tell nothing of a number
    half, shown = SURE * np.stack((scatter, scatter)), scatter < rules.motion.shown * step.group.usual
    return parameters_of(step.group, rows.prepared.motion.arm, step.numbers, half, shown)


def _squares(rows: LogRows, sizes: Array, weights: Array) -> Array:
    """Squares (M,) of what sizes (W,) leave of the torques where these count, joints weighed by `weights` (n,)."""
    return np.asarray(np.square((rows.target - rows.explained(sizes)) * rows.prepared.moving) @ weights)


def _span(rows: LogRows, fit: SteppedFit) -> tuple[int, int]:
    """The row from which on the step fits best and the first that it no longer fits (M where it lasts to the end).

    (The greatest sum of consecutive terms: J. Bentley, Programming Pearls, Comm. ACM 27 (1984) 865.)
    """
    (step,), there = fit.steps, fit.common.copy()
    there[step.group.columns] += step.group.values(step.numbers)
    before, after = (_squares(rows, sizes, fit.weights) for sizes in (fit.common, there))
    gained = np.concatenate(([0.0], 0.5 * np.cumsum(before - after)))
    stop = int(np.argmax(gained - np.minimum.accumulate(gained)))
    if stop == 0 or gained[-1] >= gained[stop] - LIKELY:
        stop = len(before)  # so does one that gains nowhere, which explains nothing
    return int(np.argmin(gained[:stop])), stop
