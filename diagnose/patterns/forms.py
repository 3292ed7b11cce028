"""Simple forms of what no entry of the library explains: a step in time, a field over the workspace, a spring, a pull.

They compete with the library under the same criterion and the same calibration. Where one of them wins, the answer is
"unknown", of that form: a form is a description, not a cause.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from arm.effects import Settings

from .candidates import Candidate
from .forces import forces
from .form import clock_of, form, run_of, scaled_position
from .observed import Observed, blocks_of

Array = NDArray[np.float64]

SENTENCES = MappingProxyType(
    {
        "step_in_time": "a step in time: something slipped or was moved",
        "joint_step_in_time": "a step in time of one joint: its zero has moved",
        "periodic_in_time": "a term that is periodic in time",
        "joint_periodic_in_time": "a motion of one joint that is periodic in time",
        "trend_in_time": "a slow curved trend in time",
        "smooth_in_time": "something that wanders with time",
        "spring_to_a_point": "a spring to a fixed point (a cable or hose that pulls), acting through what bends",
        "constant_force": "a constant force at the tip, acting through what bends",
        "force_in_time": "a force at the tip that wanders with time (a cable or hose), acting through what bends",
        "pull_of_a_point": "a pull towards a point (a magnet) that weakens with distance, acting through what bends",
        "force_field": "a force at the tip that varies over the workspace, acting through what bends",
        "field_over_position": "a smooth field over the tip's position",
        "smooth_function_of_joint": "a smooth function of one joint's coordinate",
        "joint_in_part_of_travel": "one joint that is off within a part of its travel",
        "temperature": "something that follows the temperature",
        "payload_and_position": "something that grows with the payload and varies over the workspace",
        "side_of_approach": "something that depends on the side of approach",
        "region": "a displacement within one region of the workspace only",
        "other_column": "something that follows a further column of the recording",
        "velocity": "something that follows a joint's velocity",
    }
)

_STEPS_IN_TIME = 40
_PERIODS = 130
_REGIONS = 12
_EDGES = 10
"""Stretches that a joint's travel is cut into."""
_WIDEST = 4
"""Neighbouring stretches that are one part of the travel, at most."""
_MANY_VISITS = 200
"""Visits beyond which no period is sought for each joint."""
_LARGE = 4000
"""Readings beyond which fewer change points, periods and regions are tried."""


def forms(observed: Observed) -> Iterator[tuple[Candidate, Array]]:
    """Every form with its columns (N, C, d)."""
    axes = _axes(observed)
    joints = _joint_motions(observed)
    clock = clock_of(observed)
    few = 0.4 if observed.rows > _LARGE else 1.0
    yield from _in_time(observed, axes, joints, clock, few)
    yield from _over_position(observed, axes, few)
    yield from forces(observed)
    for number, motion in enumerate(joints):
        q = observed.recording.q[:, number]
        if np.ptp(q) > 0.0:
            span = 1.0 if observed.arm.joints[number].revolute else 2.0 * np.pi / np.ptp(q)
            waves = [wave(order * span * q) for order in (1, 2, 3) for wave in (np.sin, np.cos)]
            yield form("smooth_function_of_joint", (number,)), np.stack([w[:, None] * motion for w in waves], axis=2)
            yield from _in_part_of_travel(number, q, motion)
    yield from _with_covariates(observed, axes)


def _in_part_of_travel(number: int, q: Array, motion: Array) -> Iterator[tuple[Candidate, Array]]:
    """Stretches of one joint's travel of up to four tenths of it, each with readings inside and out."""
    edges = np.linspace(q.min(), q.max(), _EDGES + 1)
    edges[-1] = np.inf
    for first, last in itertools.combinations(range(_EDGES + 1), 2):
        inside = (q >= edges[first]) & (q < edges[last])
        if last - first <= _WIDEST and inside.any():
            shapes = {"from": float(edges[first]), "to": float(min(edges[last], q.max()))}
            yield form("joint_in_part_of_travel", (number,), shapes), (inside[:, None] * motion)[:, :, None]


def _axes(observed: Observed) -> Array:
    """A displacement of the tip along each axis, (D, C)."""
    axes = np.zeros((observed.components, observed.residual.shape[1]))
    axes[np.arange(observed.components), np.arange(observed.components)] = 1.0
    return axes


def _joint_motions(observed: Observed) -> list[Array]:
    """How the tip moves with each joint, (N, C)."""
    unit = MappingProxyType({"offset": 1.0})
    return [observed.signature("encoder_offset", Settings((index,), unit)) for index in range(observed.arm.size)]


def _times_axes(functions: list[Array], axes: Array) -> Array:
    """Functions of the readings (N,) times each axis, (N, C, d)."""
    return np.stack([f[:, None] * axis[None, :] for f in functions for axis in axes], axis=2)


def _in_time(
    observed: Observed, axes: Array, joints: list[Array], clock: Array, few: float
) -> Iterator[tuple[Candidate, Array]]:
    span = float(np.ptp(clock))
    if span <= 0.0:
        return
    starts = np.sort(np.unique([clock[rows].min() for rows in blocks_of(observed.block)]))
    inner = starts[(starts > clock.min() + 0.05 * span) & (starts < clock.max() - 0.05 * span)]
    count = int(_STEPS_IN_TIME * few)
    if len(inner) > count:
        inner = inner[np.linspace(0, len(inner) - 1, count).astype(int)]
    for since in inner.tolist():
        after = (clock >= since).astype(float)
        yield form("step_in_time", shapes={"since": since}), _times_axes([after], axes)
        for number, motion in enumerate(joints):
            yield form("joint_step_in_time", (number,), {"since": since}), (after[:, None] * motion)[:, :, None]
    run = run_of(clock)
    yield form("trend_in_time"), _times_axes([run, run * run], axes)
    smooth = [np.cos(np.pi * order * run) for order in range(1, 7)]
    if observed.rows > 4 * len(smooth):
        yield form("smooth_in_time"), _times_axes(smooth, axes)
    if len(starts) >= 12:
        fastest = min(0.5 * len(starts), 0.4 * _PERIODS * few)
        for cycles in np.arange(1.4, fastest, 0.4).tolist():
            angle = 2.0 * np.pi * cycles * run
            waves = [np.sin(angle), np.cos(angle)]
            yield form("periodic_in_time", shapes={"period": span / cycles}), _times_axes(waves, axes)
            for number, motion in enumerate(joints if len(starts) <= _MANY_VISITS else ()):
                turning = np.stack([wave[:, None] * motion for wave in waves], axis=2)
                yield form("joint_periodic_in_time", (number,), {"period": span / cycles}), turning


def _over_position(observed: Observed, axes: Array, few: float) -> Iterator[tuple[Candidate, Array]]:
    place = scaled_position(observed)
    width = place.shape[1]
    linear = [place[:, i] for i in range(width)]
    squares = [place[:, i] * place[:, j] for i in range(width) for j in range(i, width)]
    yield form("field_over_position", shapes={"order": 2.0}), _times_axes([*linear, *squares], axes)
    if width == 2 and observed.rows > 60:
        cubes = [place[:, 0] ** a * place[:, 1] ** (3 - a) for a in range(4)]
        yield form("field_over_position", shapes={"order": 3.0}), _times_axes([*linear, *squares, *cubes], axes)
    for center in _spread_out(place, int(_REGIONS * few)):
        for size in (0.35, 0.7):
            bump = np.exp(-0.5 * np.sum((place - place[center]) ** 2, axis=1) / size**2)
            shape = {f"center_{axis}": float(value) for axis, value in zip("xyz", place[center], strict=False)}
            yield form("region", shapes={"size": size, **shape}), _times_axes([bump], axes)


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
        yield form("temperature"), _times_axes([warm, warm * warm], axes)
    if recording.payload_mass is not None and np.ptp(recording.payload_mass) > 0.0:
        load = (recording.payload_mass - recording.payload_mass.mean()) / np.ptp(recording.payload_mass)
        yield form("payload_and_position"), _times_axes([load, *(load * p for p in place)], axes)
    for name, columns in (("side_of_approach", recording.sides), ("velocity", recording.velocity)):
        for number in range(observed.arm.size if columns is not None else 0):
            values = columns[:, number] if columns is not None else np.zeros(observed.rows)
            if np.ptp(values) > 0.0:
                scaled = values / np.abs(values).max()
                yield form(name, (number,)), _times_axes([scaled, *(scaled * p for p in place)], axes)
    for name, values in recording.other.items():
        if np.isfinite(values).all() and np.ptp(values) > 0.0:
            scaled = (values - values.mean()) / np.ptp(values)
            yield form("other_column", shapes={name: 0.0}), _times_axes([scaled], axes)
