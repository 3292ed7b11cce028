"""A diagnosis by rollout: windows of the logs simulated by the arm as given, as written, and as fits that have not seen
the window would write it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.judged import Filed
from linkwright.core.diagnose.motion.model.candidates import Candidates
from linkwright.core.diagnose.motion.model.rows import LogRows, joint_rows
from linkwright.core.diagnose.motion.result import Deviation, Rollout, RolloutOfJoint, RolloutTraces
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .simulator import Rolled, rolled_out
from .windows import Windows, courses, windows

_MOST = 240
"""Windows that are simulated, over all logs: two minutes of motion."""


@dataclass(frozen=True)
class _Log:
    """A log's windows, and the fold of each (W,); -1 where it lies in several."""

    windows: Windows
    fold: NDArray[np.int64]


@dataclass(frozen=True)
class _Part:
    """What was simulated of a log, by an arm or by those of several folds: `which` (W,) windows."""

    rolled: Rolled
    which: NDArray[np.bool_]
    beside: tuple[str, ...]


def rollout(
    arm: Arm, written: Filed, pool: Candidates, rows: Sequence[LogRows], folds: NDArray[np.int64], *, rules: Rules
) -> Rollout:
    """Windows of logs simulated under the torques that were logged.

    Args:
        arm: The arm as given.
        written: The one that is written.
        pool: The candidates that it was made of.
        rows: The logs.
        folds: (B,) the fold of each block of time.
        rules: How long a window is.
    """
    seconds = rules.motion.rollout
    reason = _why_not(rows)
    logs = [] if reason else _windows(rows, folds, seconds)
    if not reason and not any(len(log.fold) for log in logs):
        reason = f"no stretch of {seconds:g} s has all torques"
    if reason:
        return Rollout(seconds, 0, (0, 0, 0), (), (), (), reason)
    unseen = written.of_folds(arm, pool)
    try:
        before = [_simulated(log, arm) for log in logs]
        after = [_simulated(log, written.arm) for log in logs]
        held = [_held_out(log, unseen) for log in logs] if written.members else before
    except InputError as error:
        return Rollout(seconds, 0, (0, 0, 0), (), (), (), error.message)
    states = (before, after, held)
    left = tuple(sum(int(part.rolled.left[part.which].sum()) for part in state) for state in states)
    deviations = [_deviations(logs, state) for state in states]
    return Rollout(
        seconds,
        sum(len(log.fold) for log in logs),
        (left[0], left[1], left[2]),
        tuple(RolloutOfJoint(joint + 1, *(each[joint] for each in deviations)) for joint in range(arm.size)),
        tuple(_traces(log, one, two) for log, one, two in zip(logs, before, after, strict=True)),
        tuple(dict.fromkeys(name for part in after for name in part.beside)),
    )


def _why_not(rows: Sequence[LogRows]) -> str:
    """What a rollout lacks; empty where it lacks nothing."""
    if not np.isfinite([row.prepared.cutoff for row in rows]).all():
        return "the log is sampled too slowly to be simulated under its torques"
    known = np.all([np.isfinite(row.prepared.log.torque).any(axis=0) for row in rows], axis=0)
    silent = [str(joint + 1) for joint in np.flatnonzero(~known).tolist()]
    return f"the torque of joint {', '.join(silent)} was not logged" if silent else ""


def _windows(rows: Sequence[LogRows], folds: NDArray[np.int64], seconds: float) -> list[_Log]:
    blocks = joint_rows(rows)[0].block
    ends = np.cumsum([len(row.block) for row in rows])
    every: list[_Log] = []
    for row, block in zip(rows, np.split(blocks, ends[:-1]), strict=True):
        bare = windows(replace(row.prepared, entries=()), seconds)
        kept = row.prepared.kept
        fold = folds[block[np.clip(np.searchsorted(kept, bare.rows[:, [0, -1]]), 0, len(kept) - 1)]]
        every.append(_Log(bare, np.where(fold[:, 0] == fold[:, 1], fold[:, 0], -1)))
    apart = max(1, int(np.ceil(sum(len(log.fold) for log in every) / _MOST)))
    return [_Log(log.windows.only(np.arange(0, len(log.fold), apart)), log.fold[::apart]) for log in every]


def _simulated(log: _Log, arm: Arm, which: NDArray[np.bool_] | None = None) -> _Part:
    """The windows of a log, or some of them, simulated by an arm; the others are not a number."""
    use = np.ones(len(log.fold), dtype=bool) if which is None else which
    numbers = np.flatnonzero(use)
    shape = (*log.windows.rows.shape, arm.size)
    q, velocity = np.full(shape, np.nan), np.full(shape, np.nan)
    going = np.zeros((len(use), arm.size), dtype=np.int64)
    beside: tuple[str, ...] = ()
    for some, simulator, given in courses(arm, log.windows.only(numbers)) if len(numbers) else ():
        part = rolled_out(simulator, given, _limits(arm, log.windows))
        at = numbers[some]
        q[at], velocity[at], going[at] = part.q, part.velocity, part.going
        beside = simulator.beside
    return _Part(Rolled(q, velocity, going), use, beside)


def _held_out(log: _Log, arms: Sequence[Arm]) -> _Part:
    """Each window simulated by the arm of the fit that has not seen it."""
    whole = _simulated(log, arms[0], log.fold == 0)
    for fold, arm in enumerate(arms[1:], start=1):
        part = _simulated(log, arm, log.fold == fold)
        for name in ("q", "velocity", "going"):
            getattr(whole.rolled, name)[part.which] = getattr(part.rolled, name)[part.which]
    return replace(whole, which=log.fold >= 0)


def _limits(arm: Arm, given: Windows) -> Array:
    """Between which coordinates (2, n) joints may go: their ranges, and where they went."""
    q = given.prepared.motion.q
    low, high = np.array([joint.range for joint in arm.joints]).T
    return np.array([np.minimum(low, q.min(axis=0)), np.maximum(high, q.max(axis=0))])


def _deviations(logs: Sequence[_Log], parts: Sequence[_Part]) -> list[Deviation]:
    """By joint, over all windows that were simulated."""
    off: list[list[Array]] = [[], []]
    for log, part in zip(logs, parts, strict=True):
        motion, rows = log.windows.prepared.motion, log.windows.rows[part.which]
        off[0].append(part.rolled.q[part.which] - motion.q[rows])
        off[1].append(part.rolled.velocity[part.which] - motion.velocity[rows])
    q, velocity = (np.concatenate(item)[:, 1:] for item in off)
    figures = [
        np.sqrt(np.mean(np.square(item), axis=axes))
        for item, axes in ((q, (0, 1)), (q[:, -1], 0), (velocity, (0, 1)), (velocity[:, -1], 0))
    ]
    return [Deviation(*row) for row in np.array(figures).T.tolist()]


def _traces(log: _Log, before: _Part, after: _Part) -> RolloutTraces:
    """What is drawn of a log: its windows, one after the other, with a gap between two, each as far as it went."""
    prepared = log.windows.prepared

    def apart(values: Array) -> Array:
        gap = np.full((len(values), 1, *values.shape[2:]), np.nan)
        return np.concatenate((values, gap), axis=1).reshape(-1, *values.shape[2:])

    def as_far(rolled: Rolled) -> Array:
        samples = np.arange(rolled.q.shape[1])[:, None]
        return np.where(samples < rolled.going[:, None], rolled.q, np.nan)

    measured = prepared.motion.q[log.windows.rows]
    return RolloutTraces(
        Path(prepared.log.file).name,
        *(apart(values) for values in (log.windows.time, measured, as_far(before.rolled), as_far(after.rolled))),
    )
