"""The rows of the model: every column and the torque left, filtered alike, for each joint of each log."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.motion.dynamics import torque_of, torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import regressor
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .candidates import Candidates, of_arm
from .entries import with_entries
from .groups import Source
from .products import JointRows

About = Mapping[tuple[str, tuple[int, ...]], float]
"""Sizes by effect and place about which torques are worked out that are not in proportion to them."""
NOTHING: About = MappingProxyType({})


@dataclass(frozen=True)
class LogRows:
    """A log's kept samples: `columns` are, by joint, the model's columns that move it, `design` by joint (M, K) their
    filtered values, `target` (M, n) the filtered torque that the model as given leaves, `block` (M,) blocks of time.
    `nominal` (N, n) is the torque of the model as given, `rigid` (N, n) what its drives pass on to the arm, not
    filtered; `measured` (N, n) is filtered, `given` (M, n) the filtered torque of the model as given. `block` (M,)
    numbers blocks of `length` s."""

    prepared: PreparedLog
    columns: tuple[NDArray[np.int64], ...]
    design: tuple[Array, ...]
    target: Array
    nominal: Array
    rigid: Array
    measured: Array
    given: Array
    block: NDArray[np.int64]
    length: float

    def explained(self, sizes: Array) -> Array:
        """What sizes (W,) of the model's columns explain (M, n), N*m."""
        return np.column_stack([x @ sizes[at] for x, at in zip(self.design, self.columns, strict=True)])


def log_rows(prepared: PreparedLog, pool: Candidates, *, rules: Rules) -> LogRows:
    """The rows of a log, by the torque of the model as given."""
    n, kept = prepared.measured.shape[1], prepared.kept
    columns = _columns_of(pool.sources, n)
    place = [{int(c): k for k, c in enumerate(at)} for at in columns]
    design = [np.zeros((len(kept), len(at))) for at in columns]
    nominal, rigid = np.zeros_like(prepared.measured), np.zeros_like(prepared.measured)
    measured = np.concatenate([prepared.filtered(prepared.measured[s.start : s.stop]) for s in prepared.stretches])
    filtered = np.zeros((len(kept), n))
    for part, numbers, within in prepared.pieces():
        motion = prepared.piece(part)
        given = torque_stages(motion)
        nominal[part], rigid[part] = given.logged, given.load
        filtered[numbers] = prepared.filtered(given.logged)[within]
        _fill(design, place, prepared, pool.sources, replace(motion, torque=given.load), numbers, within)
    clock = prepared.motion.time
    length = min(rules.motion.block, float(clock[-1] - clock[0]) / rules.fitting.least_parts)
    block = np.floor((clock[kept] - clock[0]) / length).astype(np.int64)
    block = np.unique(block, return_inverse=True)[1]
    target = measured[kept] - filtered
    return LogRows(prepared, columns, tuple(design), target, nominal, rigid, measured, filtered, block, length)


def with_sources(rows: LogRows, sources: Sequence[Source]) -> LogRows:
    """The rows with the columns of further sources, which do not go by the drives' torque."""
    more = _columns_of(sources, rows.target.shape[1])
    design = [np.zeros((len(rows.target), len(at))) for at in more]
    place = [{int(c): k for k, c in enumerate(at)} for at in more]
    for part, numbers, within in rows.prepared.pieces():
        _fill(design, place, rows.prepared, sources, rows.prepared.piece(part), numbers, within)
    return replace(
        rows,
        columns=tuple(np.concatenate(pair) for pair in zip(rows.columns, more, strict=True)),
        design=tuple(np.hstack(pair) for pair in zip(rows.design, design, strict=True)),
    )


def with_loads(rows: LogRows, pool: Candidates, sizes: Array, about: About = NOTHING) -> LogRows:
    """The rows with what acts in proportion to the drives' torque worked out for the model with sizes (W,):
    friction by what the drives pass on to the arm, what is of the instrument by that and what the arm file has beside.
    What is named at joints does not count there: a torque constant would stand for all of it. Delays are taken at their
    whole length, not by the slope of the torque; what is not linear is taken `about` some sizes.
    """
    prepared = rows.prepared
    place = [{int(c): k for k, c in enumerate(at)} for at in rows.columns]
    design = [item.copy() for item in rows.design]
    more = rows.explained(np.where(of_arm(pool), sizes, 0.0))
    for instrument, base in ((False, rows.rigid), (True, rows.nominal)):
        chosen = [
            source
            for source in pool.sources
            if source.by_load
            and source.effect.recording.of_instrument == instrument
            and (not source.bent or about.get(source.place))
        ]
        torque = base + _on_clock(rows, more)
        for part, numbers, within in prepared.pieces():
            _fill(design, place, prepared, chosen, prepared.piece(part, torque), numbers, within, about)
    late = delays(pool, sizes, rows.target.shape[1])
    target = _on_time(rows, late) - rows.given
    for source in pool.sources:
        if source.delays:
            joint = source.joints[0]
            target[:, joint] += late[joint] * design[joint][:, place[joint][source.start]]
    return replace(rows, design=tuple(design), target=target)


def _on_clock(rows: LogRows, kept: Array) -> Array:
    """Values (N, n) at all samples by those (M, n) at the kept ones."""
    every = rows.prepared.motion.time
    return np.column_stack([np.interp(every, every[rows.prepared.kept], column) for column in kept.T])


def about(rows: LogRows, pool: Candidates, arm: Arm, sizes: Array) -> LogRows:
    """The rows linearised about an arm that holds sizes (W,) of the model's columns as entries of its file; what is of
    the log alone comes beside them.

    What is left of the target by those sizes is what `predict` says of the file; columns are what it changes by.
    """
    prepared = rows.prepared
    renewed = replace(prepared, motion=replace(prepared.motion, arm=with_entries(arm, prepared.entries)))
    left, load, drive = np.zeros_like(rows.target), np.zeros_like(rows.nominal), np.zeros_like(rows.nominal)
    for part, numbers, within in renewed.pieces():
        torque = torque_stages(renewed.piece(part))
        load[part], drive[part] = torque.load, torque.drive
        left[numbers] = prepared.filtered(prepared.measured[part] - torque.logged)[within]
    place = [{int(c): k for k, c in enumerate(at)} for at in rows.columns]
    design = [item.copy() for item in rows.design]
    for instrument, torque in ((False, load), (True, drive)):
        chosen = [
            source
            for source in pool.sources
            if source.by_load
            and source.effect.recording.of_instrument == instrument
            and (sizes[source.columns].any() or not source.bent)
        ]
        for part, numbers, within in renewed.pieces():
            _fill(design, place, renewed, chosen, renewed.piece(part, torque), numbers, within)
    gains = gains_of(renewed)
    for source in pool.sources:
        for joint in () if source.effect.recording.of_instrument else source.joints:
            design[joint][:, [place[joint][int(c)] for c in source.columns]] *= gains[joint]
    again = replace(rows, design=tuple(design))
    return replace(again, target=left + again.explained(sizes))


def gains_of(prepared: PreparedLog) -> Array:
    """How many times (n,) the instrument logs what each drive gives."""
    motion = _piece_of(prepared)
    entries = [entry for entry in motion.arm.effects if EFFECTS[entry.effect].recording.of_instrument]
    nothing = np.zeros_like(motion.q)
    one, none = (torque_of(replace(motion, torque=nothing + unit), entries) for unit in (1.0, 0.0))
    return 1.0 + (one - none).mean(axis=0)


def _piece_of(prepared: PreparedLog) -> Motion:
    """A few samples of a log."""
    stretch = prepared.stretches[0]
    return prepared.piece(slice(stretch.start, min(stretch.start + 8, stretch.stop)))


def delays(pool: Candidates, sizes: Array, joints: int) -> Array:
    """How late (n,) s each joint's torque is by sizes (W,) of the model's columns."""
    delays_ = np.zeros(joints)
    for source in pool.sources:
        if source.delays:
            delays_[source.joints[0]] += sizes[source.start]
    return delays_


def _on_time(rows: LogRows, late: Array) -> Array:
    """The filtered torque (M, n) so much later (n,) s."""
    prepared = rows.prepared
    target = np.empty_like(rows.target)
    for stretch in prepared.stretches:
        first, last = np.searchsorted(prepared.kept, (stretch.start, stretch.stop))
        clock = prepared.motion.time[stretch.start : stretch.stop]
        at = prepared.motion.time[prepared.kept[first:last]]
        for joint in range(target.shape[1]):
            curve = CubicSpline(clock, rows.measured[stretch.start : stretch.stop, joint])
            target[first:last, joint] = curve(np.clip(at + late[joint], clock[0], clock[-1]))
    return target


def _columns_of(sources: Sequence[Source], n: int) -> tuple[NDArray[np.int64], ...]:
    columns: list[list[int]] = [[] for _ in range(n)]
    for source in sources:
        for joint in source.joints:
            columns[joint] += source.columns.tolist()
    return tuple(np.array(column, dtype=np.int64) for column in columns)


def _fill(
    design: list[Array],
    place: list[dict[int, int]],
    prepared: PreparedLog,
    sources: Sequence[Source],
    motion: Motion,
    numbers: NDArray[np.int64],
    within: NDArray[np.int64],
    about: About = NOTHING,
) -> None:
    """Enter the filtered columns of some sources in a piece; what is not linear `about` some sizes."""
    inertial = any(isinstance(source.effect.torques, OfInertia) for source in sources)
    moves = motion.of_links
    slopes = regressor(motion.arm, moves.q, moves.velocity, moves.acceleration) if inertial else None
    raw: list[list[Array]] = [[] for _ in design]
    at: list[list[int]] = [[] for _ in design]
    for source in sources:
        for joint, values in source.torques(motion, slopes, about.get(source.place, 0.0)).items():
            raw[joint].append(values)
            at[joint] += [place[joint][int(c)] for c in source.columns]
    for joint, parts in enumerate(raw):
        if parts:
            values = prepared.filtered(np.column_stack(parts))
            design[joint][np.ix_(numbers, np.array(at[joint]))] = values[within]


def joint_rows(logs: Sequence[LogRows]) -> list[JointRows]:
    """Each joint's rows over several logs, one after the other."""
    offsets = np.cumsum([0, *(int(log.block.max()) + 1 for log in logs)])
    block = np.concatenate([log.block + offset for log, offset in zip(logs, offsets, strict=False)])
    number = np.concatenate([np.full(len(log.block), k) for k, log in enumerate(logs)])
    return [
        JointRows(
            columns,
            np.concatenate([log.design[joint] for log in logs]),
            np.concatenate([log.target[:, joint] for log in logs]),
            block,
            number,
            np.concatenate([log.prepared.moving[:, joint] for log in logs]),
            np.concatenate([log.prepared.near[:, joint] for log in logs]),
        )
        for joint, columns in enumerate(logs[0].columns)
    ]
