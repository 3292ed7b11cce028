"""Samples of a motion log looked at one by one and together: the clock, spikes, rest, several robots in one file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.first_look.readings import longest_run
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError

Mask = NDArray[np.bool_]


def checked_samples(
    log: MotionLog,
    arm: Arm,
    columns: Mapping[str, ReadColumn],
    ragged: Sequence[RejectedRow],
    headers: Headers,
    *,
    rules: Rules = RULES,
) -> MotionLog:
    """The log in the order of time, its clock from 0, less the samples that cannot be right. Raises `InputError`."""
    log = replace(log, rejected=tuple(ragged))
    log = _without_numbers(log, columns)
    _enough(log, rules)
    log = _in_order(log, headers, rules)
    _refuse_two_robots(log, arm, rules)
    log = _one_a_stamp(log, headers.get("time", "t_s"), rules)
    log = _without_spikes(log, arm, headers, rules)
    _enough(log, rules)
    log = _clock_said(log, headers.get("time", "t_s"), rules)
    _refuse_rest(log, arm, rules)
    return replace(log, rejected=tuple(sorted(log.rejected, key=lambda item: item.row)))


def _rejecting(log: MotionLog, reasons: Mapping[int, str]) -> MotionLog:
    """The log less samples (from 0), each set aside with its reason."""
    if not reasons:
        return log
    keep = np.ones(log.size, dtype=bool)
    keep[list(reasons)] = False
    more = [RejectedRow(int(log.row[index]), reason) for index, reason in reasons.items()]
    chosen = {name: value[keep] for name, value in vars(log).items() if isinstance(value, np.ndarray)}
    other = MappingProxyType({name: values[keep] for name, values in log.other.items()})
    return replace(log, **chosen, other=other, rejected=(*log.rejected, *more))


def _enough(log: MotionLog, rules: Rules) -> None:
    if log.size < rules.fitting.enough:
        why = f"; row {log.rejected[0].row}: {log.rejected[0].reason}" if log.rejected else ""
        raise InputError(
            log.file, "", f"has {log.size} samples that can be used, and {rules.fitting.enough} are needed{why}"
        )


def _without_numbers(log: MotionLog, columns: Mapping[str, ReadColumn]) -> MotionLog:
    reasons: dict[int, str] = {}
    for column in columns.values():
        if column.meaning.base not in ("dir", "a"):
            for index in np.flatnonzero(~np.isfinite(column.values)).tolist():
                reasons.setdefault(index, column.fault(index))
    return _rejecting(log, reasons)


def _in_order(log: MotionLog, headers: Headers, rules: Rules) -> MotionLog:
    """Stray stamps cost their samples; a clock that starts again, or runs backwards, is refused."""
    name = headers.get("time", "t_s")
    steps = np.diff(log.time)
    back = np.flatnonzero(steps < 0.0) + 1
    if len(back):
        stray = ~longest_run(log.time)
        if stray.sum() > max(1.0, rules.mistakes.few_stray * log.size):
            first = back[0]
            where = f"row {log.row[first]}: {log.time[first]:.9g} s after {log.time[first - 1]:.9g} s"
            if (steps < 0.0).mean() > 0.5:
                message = f"runs backwards ({where}); write the samples in the order of time"
            else:
                message = (
                    f"runs backwards ({where}): are these several logs, or two robots, in one file? give each a file "
                    "of its own, or choose one by `rows:` in recording.yaml"
                )
            raise InputError(log.file, name, message)
        log = _rejecting(
            log, dict.fromkeys(np.flatnonzero(stray).tolist(), f"{name} runs backwards against the samples around it")
        )
    interval = log.interval
    if not interval and np.ptp(log.time):
        interval = float(np.ptp(log.time)) / log.size
    if not rules.log.intervals[0] <= interval <= rules.log.intervals[1]:
        if not interval > 0.0:
            raise InputError(log.file, name, "stands still: the log has no clock")
        message = f"counts {interval:.4g} s from sample to sample; is it in another unit (ms, us, ns)?"
        others = ({"columns": {headers.clock: f"{name}/{by}"}} for by in ("1000", "1e6", "1e9"))
        raise headers.refusal(log.file, name, message, *others)
    return log


def _refuse_two_robots(log: MotionLog, arm: Arm, rules: Rules) -> None:
    """Refuse samples that come from two robots in turn: each lies by the one before the last, not by the last."""
    one, two = np.abs(np.diff(log.q, axis=0)), np.abs(log.q[2:] - log.q[:-2])
    joint = int(np.argmax(np.median(one, axis=0)))
    near, far = float(np.median(two[:, joint])), float(np.median(one[:, joint]))
    if far > rules.residual.coarsest_count(arm.joints[joint].revolute) and near < rules.log.alternates * far:
        raise InputError(
            log.file,
            f"q{joint + 1}",
            f"jumps to and fro from sample to sample (row {log.row[1]}): are these two robots in one file? choose one "
            "by `rows:` in recording.yaml",
        )


def _one_a_stamp(log: MotionLog, name: str, rules: Rules) -> MotionLog:
    """Of samples with one stamp, or stamps nearer to each other than those of any log, the first."""
    again = np.concatenate([[False], np.diff(log.time) < rules.log.intervals[0]])
    if not again.any():
        return log
    first = np.maximum.accumulate(np.where(again, 0, np.arange(log.size)))
    if again.mean() > 0.5:
        log = log.saying(
            f"{name} is coarser than the samples. {int(again.sum())} of {log.size} have the stamp of the one before "
            "and are set aside. Write the clock with more digits.",
        )
    else:
        rows = rows_text(log.row[again])
        log = log.saying(f"{name} has stamps that occur twice ({rows}). The first sample of each is kept.")
    reasons = {k: f"{name} is that of row {log.row[first[k]]} again" for k in np.flatnonzero(again).tolist()}
    return _rejecting(log, reasons)


def _without_spikes(log: MotionLog, arm: Arm, headers: Headers, rules: Rules) -> MotionLog:
    """Single samples that no motion makes: angles that jump there and back, spikes of torque."""
    reasons: dict[int, str] = {}
    for values, share, of in (
        (log.q, rules.log.spike_of_angle, "q"),
        (log.torque, rules.log.spike_of_torque, log.drive.base),
    ):
        for k in range(arm.size):
            name = headers.get(f"{of}{k + 1}", f"{of}{k + 1}")
            for index in np.flatnonzero(_spikes(values[:, k], share, rules)).tolist():
                reasons.setdefault(index, f"{name} jumps for this one sample")
    if len(reasons) > max(1.0, rules.mistakes.few_stray * log.size):
        return log.saying(f"{len(reasons)} samples jump against those around them. These samples are kept.")
    return _rejecting(log, reasons)


def _spikes(values: Array, share: float, rules: Rules) -> Mask:
    """Samples far from the median of the five around them, by the noise of the column and by its spread (of which they
    are a `share`), between two that agree."""
    if not np.isfinite(values).all() or len(values) < 5:
        return np.zeros(len(values), dtype=bool)
    from scipy.ndimage import median_filter

    off = np.abs(values - median_filter(values, 5, mode="nearest"))
    low, high = np.quantile(values, [0.01, 0.99])
    moving = off[off > 0.0]
    scatter = 1.4826 * float(np.median(moving)) if len(moving) else 0.0
    beside = np.abs(np.pad(values, 1, mode="edge")[2:] - np.pad(values, 1, mode="edge")[:-2])
    return (off > rules.log.spike * scatter) & (off > share * (high - low)) & (beside < rules.mistakes.better * off)


def _clock_said(log: MotionLog, name: str, rules: Rules) -> MotionLog:
    """What is odd about the intervals is said; time counts from the first sample."""
    steps = np.diff(log.time)
    interval = float(np.median(steps))
    log = replace(log, time=log.time - log.time[0])
    gaps = np.flatnonzero(steps > rules.log.gap * interval)
    if len(gaps):
        longest = int(gaps[np.argmax(steps[gaps])])
        log = log.saying(
            f"{name} has {len(gaps)} gap{'s' if len(gaps) > 1 else ''}, the longest of {steps[longest]:.3g} s after "
            f"row {log.row[longest]}. Nothing is made up for them.",
        )
    usual = steps[steps <= rules.log.gap * interval]
    scatter = float(np.quantile(usual, 0.84) - np.quantile(usual, 0.16)) / 2.0
    if scatter > rules.log.jitter * interval:
        log = log.saying(f"{name} jitters: samples come every {interval:.4g} s, give or take {scatter:.2g} s.")
    return log


def _refuse_rest(log: MotionLog, arm: Arm, rules: Rules) -> None:
    counts = np.array([rules.residual.coarsest_count(joint.revolute) for joint in arm.joints])
    low, high = np.quantile(log.q, [0.01, 0.99], axis=0)
    if (high - low < counts).all():
        raise InputError(log.file, "", "is a log at rest: no joint moves, so it tells nothing of friction or inertia")
