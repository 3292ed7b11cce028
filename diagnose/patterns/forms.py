"""Simple forms of what no entry of the library explains: a step in time, a field over the workspace, a spring, a pull.

They compete with the library under the same criterion and the same calibration. Where one of them wins, the answer is
"unknown", of that form: a form is a description, not a cause.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.effects.geometry.tool_offset import TOOL_OFFSET
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.visits import blocks_of
from linkwright.core.sections.numeric import Array

from .basis import interactions, run_of, scaled_position, tip_axes
from .forces import forces, weight_at_tip
from .form import (
    BY_ANOTHER,
    COLUMN,
    FIELD,
    IN_PART,
    JOINT_PERIODIC,
    JOINT_STEP,
    LOAD_STEP,
    LOADED,
    OF_JOINT,
    PERIODIC,
    REGION,
    SIDES,
    SMOOTH,
    STEP,
    STIFFNESS_STEP,
    TOOL_STEP,
    TREND,
    VELOCITY,
    WARMTH,
    Form,
)
from .library import Candidate, columns_of

_ENDS = 0.05
"""The share of the recording at its beginning and end in which no step is looked for."""
_MANY_VISITS = 200
"""Beyond these no change is sought for each joint by itself: patterns of as many readings take most of the memory."""
_MOMENTS, _PERIODS, _REGIONS = 40, 130, 12
"""Moments at which a step is tried, spread evenly over the visits; periods, 0.4 cycles apart; centres of regions."""
_STRETCHES, _WIDEST = 10, 4
"""Into which a joint's travel is cut, and how many neighbours are one part of it at most."""


def forms(observed: Observed) -> Iterator[tuple[Candidate, Array]]:
    """Every form with its columns (N, C, d)."""
    axes = tip_axes(observed)
    joints = _joint_motions(observed)
    if observed.recording.time is not None:
        yield from _in_time(observed, axes, joints, observed.recording.time)
    yield from _over_position(observed, axes)
    yield from forces(observed)
    for number, motion in enumerate(joints):
        q = observed.recording.q[:, number]
        if np.ptp(q) > 0.0:
            span = 1.0 if observed.arm.joints[number].revolute else 2.0 * np.pi / np.ptp(q)
            waves = [wave(order * span * q) for order in (1, 2, 3) for wave in (np.sin, np.cos)]
            yield OF_JOINT.of((number,)), interactions(waves, motion)
            yield from _in_part_of_travel(number, q, motion)
            yield from _by_another(observed, number, motion)
    yield from _with_covariates(observed, axes)


def _in_part_of_travel(number: int, q: Array, motion: Array) -> Iterator[tuple[Candidate, Array]]:
    """Stretches of one joint's travel of up to four tenths of it, each with readings inside and out."""
    edges = np.linspace(q.min(), q.max(), _STRETCHES + 1)
    edges[-1] = np.inf
    for first, last in itertools.combinations(range(_STRETCHES + 1), 2):
        inside = (q >= edges[first]) & (q < edges[last])
        if last - first <= _WIDEST and inside.any():
            shapes = {"from": float(edges[first]), "to": float(min(edges[last], q.max()))}
            yield IN_PART.of((number,), shapes), interactions([inside.astype(float)], motion)


def _by_another(observed: Observed, number: int, motion: Array) -> Iterator[tuple[Candidate, Array]]:
    """A joint that turns with another's coordinate, in proportion, by its square and by both together: what drags it
    along, or what is twisted between them."""
    scaled = _scaled(observed.recording.q)
    for other in range(observed.arm.size):
        if other != number and scaled[:, other].any() and motion.any():
            there = scaled[:, other]
            yield (
                BY_ANOTHER.of((number, other)),
                interactions([there, there * there, there * scaled[:, number]], motion),
            )


def _scaled(q: Array) -> Array:
    """Joint coordinates (N, n), each from -1 to 1 over the recording; zero where it does not move."""
    low, high = q.min(axis=0), q.max(axis=0)
    spread = high - low
    return np.where(spread > 0.0, (2.0 * q - low - high) / np.where(spread > 0.0, spread, 1.0), 0.0)


def _joint_motions(observed: Observed) -> list[Array]:
    """How the tip moves with each joint, (N, C, 1)."""
    return [observed.drive_moved(index)[:, :, None] for index in range(observed.arm.size)]


def _in_time(observed: Observed, axes: Array, joints: list[Array], clock: Array) -> Iterator[tuple[Candidate, Array]]:
    span = float(np.ptp(clock))
    if span <= 0.0:
        return
    starts = np.sort(np.unique([clock[rows].min() for rows in blocks_of(observed.block)]))
    ends = _ENDS * span
    inner = starts[(starts > clock.min() + ends) & (starts < clock.max() - ends)]
    if len(inner) > _MOMENTS:
        inner = inner[np.linspace(0, len(inner) - 1, _MOMENTS).astype(int)]
    changes = list(_changes(observed, joints)) if len(starts) <= _MANY_VISITS else []
    for since in inner.tolist():
        after = (clock >= since).astype(float)
        yield STEP.of(shapes={"since": since}), interactions([after], axes)
        for number, motion in enumerate(joints):
            yield JOINT_STEP.of((number,), {"since": since}), interactions([after], motion)
        for changed, at, moved in changes:
            yield changed.of(at, {"since": since}), interactions([after], moved)
    run = run_of(clock)
    yield TREND.of(), interactions([run, run * run], axes)
    smooth = [np.cos(np.pi * order * run) for order in range(1, 7)]
    if observed.rows > 4 * len(smooth):
        yield SMOOTH.of(), interactions(smooth, axes)
    if len(starts) >= observed.rules.search.enough_visits:
        fastest = min(0.5 * len(starts), 0.4 * _PERIODS)
        for cycles in np.arange(1.4, fastest, 0.4).tolist():
            angle = 2.0 * np.pi * cycles * run
            waves = [np.sin(angle), np.cos(angle)]
            yield PERIODIC.of(shapes={"period": span / cycles}), interactions(waves, axes)
            for number, motion in enumerate(joints if len(starts) <= _MANY_VISITS else ()):
                yield JOINT_PERIODIC.of((number,), {"period": span / cycles}), interactions(waves, motion)


def _changes(observed: Observed, joints: list[Array]) -> Iterator[tuple[Form, tuple[int, ...], Array]]:
    """What may change from one reading to the next beside a place or a zero, with what it moves (N, C, d): where the
    tool sits on the hand, what hangs there, how much a joint gives. The form, the joint (none of its own) and the
    columns of each."""
    sizes = tuple(size.name for size in TOOL_OFFSET.sizes)
    moved = columns_of(observed, Candidate(TOOL_OFFSET.id, (), sizes, MappingProxyType({})))
    if moved is not None:
        yield TOOL_STEP, (), moved[:, :, moved.any(axis=(0, 1))]
    weight = weight_at_tip(observed)
    if weight.any():
        yield LOAD_STEP, (), weight
    for number, motion in enumerate(joints):
        load = np.broadcast_to(np.asarray(observed.state.joints[number].drive_load, float), (observed.rows,))
        if np.ptp(load) > 0.0 and motion.any():
            yield STIFFNESS_STEP, (number,), load[:, None, None] * motion


def _over_position(observed: Observed, axes: Array) -> Iterator[tuple[Candidate, Array]]:
    place, rules = scaled_position(observed), observed.rules.patterns
    width = place.shape[1]
    linear = [place[:, i] for i in range(width)]
    squares = [place[:, i] * place[:, j] for i in range(width) for j in range(i, width)]
    yield FIELD.of(shapes={"order": 2.0}), interactions([*linear, *squares], axes)
    if width == 2 and observed.rows > rules.rows_for_curves:
        cubes = [place[:, 0] ** a * place[:, 1] ** (3 - a) for a in range(4)]
        yield FIELD.of(shapes={"order": 3.0}), interactions([*linear, *squares, *cubes], axes)
    for center in _spread_out(place, _REGIONS):
        for size in REGION.shapes["size"]:
            bump = np.exp(-0.5 * np.sum((place - place[center]) ** 2, axis=1) / size**2)
            shape = {f"center_{axis}": float(value) for axis, value in zip("xyz", place[center], strict=False)}
            yield REGION.of(shapes={"size": size, **shape}), interactions([bump], axes)


def _spread_out(points: Array, count: int) -> list[int]:
    """Indices of points far from each other, greedily."""
    chosen = [int(np.argmin(np.sum(points**2, axis=1)))]
    distance = np.sum((points - points[chosen[0]]) ** 2, axis=1)
    while len(chosen) < min(count, len(points)) and distance.max() > 0.01:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.sum((points - points[chosen[-1]]) ** 2, axis=1))
    return chosen


def _with_covariates(observed: Observed, axes: Array) -> Iterator[tuple[Candidate, Array]]:
    recording = observed.recording
    place = list(scaled_position(observed).T)
    if recording.temperature is not None and np.ptp(recording.temperature) > 0.0:
        warm = (recording.temperature - recording.temperature.mean()) / np.ptp(recording.temperature)
        yield WARMTH.of(), interactions([warm, warm * warm], axes)
    if recording.payload_mass is not None and np.ptp(recording.payload_mass) > 0.0:
        load = (recording.payload_mass - recording.payload_mass.mean()) / np.ptp(recording.payload_mass)
        yield LOADED.of(), interactions([load, *(load * p for p in place)], axes)
    for form, columns in ((SIDES, recording.sides), (VELOCITY, recording.velocity)):
        for number in range(observed.arm.size if columns is not None else 0):
            values = columns[:, number] if columns is not None else np.zeros(observed.rows)
            if np.ptp(values) > 0.0:
                scaled = values / np.abs(values).max()
                yield form.of((number,)), interactions([scaled, *(scaled * p for p in place)], axes)
    for name, values in recording.other.items():
        if np.isfinite(values).all() and np.ptp(values) > 0.0:
            scaled = (values - values.mean()) / np.ptp(values)
            yield COLUMN.of(shapes={name: 0.0}), interactions([scaled], axes)
