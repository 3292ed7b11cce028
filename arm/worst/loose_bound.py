"""A bound on the worst error where no certificate to a small gap can be had: too many joints, or pins in space.

The error with its play is one vector: backlash adds intervals, and a pin that may lie anywhere in its bore adds a point
on a circle, whose angle is one more coordinate. `arm.worst.hull` bounds its length, as far as a fixed effort goes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.chain.chain import Arm, FloatVector
from arm.chain.kinematics import place
from arm.chain.vectors import Vector, cross, rotate, unit
from arm.errors.model import CaseModel
from sections.numeric import Array

from .dependence import all_round, joints_that_matter
from .hull import Axis, PlayedVector, bound, in_real_basis, played_vector
from .polynomial import Coordinates, NotPolynomial, fit

QUICK, THOROUGH = 2_000_000, 10_000_000
"""Efforts, in control points looked at for a load case: some tenths of a second, and some five times as much."""
_MOST_OF_A_CELL = 20_000
_ENOUGH = 1e-3
"""Relative gap that bounds without the pins' angles are worked out to: what these would take off is more."""
_FRAMES = 4
"""Frames of joints, from the base on, in which the error may be looked at."""
_ALONGSIDE = 1e-9
"""Normals that differ by less are the same."""


def loose_bound(
    case: CaseModel, p: Array, coordinates: Coordinates, known: float, *, planar: bool, gap: float, effort: int
) -> float | None:
    """An error (m) that no pose within the joints' ranges exceeds wherever the play stands, within a relative `gap` of
    the error `known` to be reached where the `effort` allows; None where the error is no polynomial of few joints.
    """
    total = float(case.radii.sum())

    def least(pins: Sequence[_Pin], gap: float) -> float:
        radius = total - sum(pin.radius for pin in pins)
        played = _played(case, p, coordinates, matter, pins)
        return radius + bound(played, max(known - radius, 0.0), gap=gap, most_points=effort)

    matter = _matter(case, p, coordinates)
    try:
        pins = [] if planar else _pins(case, p, coordinates, matter)
        found = least(pins, gap)
        if pins and found > known * (1.0 + _ENOUGH):
            # Without their angles pins add up whatever their axes: looser, and far less effort.
            found = min(found, least((), _ENOUGH))
    except NotPolynomial:
        return None
    return found


@dataclass(frozen=True)
class _Pin:
    """Pins whose axes stay parallel: they add up to one, of `radius` (m). `across` are unit vectors across its axis, in
    the frame of joint `joint`."""

    joint: int
    radius: float
    across: tuple[FloatVector, FloatVector]


def _matter(case: CaseModel, p: Array, coordinates: Coordinates) -> tuple[int, ...]:
    """The joints that the error and its play depend on, but for turning them as a whole."""

    def vectors(q: Array) -> Array:
        arrays = case.arrays(q, p)
        play = [arrays.intervals.reshape(len(q), -1), arrays.normals.reshape(len(q), -1)]
        return np.concatenate([arrays.vector, *play], axis=1)

    count = 3 * (1 + len(case.error.intervals) + len(case.error.discs))
    return joints_that_matter(vectors, count, case.state.arm, coordinates) or (0,)


def _pins(case: CaseModel, p: Array, coordinates: Coordinates, matter: Sequence[int]) -> list[_Pin]:
    """The case's pins, parallel ones together, the largest first, as many as an effort allows; only those that sit in a
    joint, across its axis."""
    arm, q = case.state.arm, all_round(coordinates, seed=5)
    normals = case.arrays(q, p).normals
    frames = place(arm, [q[:, j] for j in range(arm.size)]).joints
    found: list[tuple[Array, _Pin]] = []
    for index, disc in enumerate(case.error.discs):
        own, axis = normals[:, index], arm.joints[disc.joint].axis
        if np.abs(own - _rows(rotate(frames[disc.joint].frame, axis), len(q))).max() > _ALONGSIDE:
            continue
        for k, (normal, pin) in enumerate(found):
            if min(np.abs(own - normal).max(), np.abs(own + normal).max()) <= _ALONGSIDE:
                found[k] = (normal, replace(pin, radius=pin.radius + disc.radius))
                break
        else:
            hint = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.6 else (0.0, 1.0, 0.0)
            first = unit(cross(axis, hint))
            found.append((own, _Pin(disc.joint, disc.radius, (first, cross(axis, first)))))
    largest = sorted((pin for _, pin in found), key=lambda pin: -pin.radius)
    most = math.log(_MOST_OF_A_CELL / 5.0 ** len(matter)) / math.log(3.0)
    return largest[: max(0, math.floor(most))]


def _rows(vector: Vector, count: int) -> Array:
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in vector], axis=1)


def _played(
    case: CaseModel, p: Array, coordinates: Coordinates, matter: Sequence[int], pins: Sequence[_Pin]
) -> PlayedVector:
    """The error with its play, in the frame where it curves least; raises `NotPolynomial`."""
    arm = case.state.arm

    def error(q: Array) -> Array:
        arrays = case.arrays(q, p)
        return np.concatenate([arrays.vector, arrays.intervals.reshape(len(q), -1)], axis=1)

    def sides(q: Array) -> Array:
        joints = place(arm, [q[:, j] for j in range(arm.size)]).joints
        rows = [_rows(rotate(joints[pin.joint].frame, side), len(q)) for pin in pins for side in pin.across]
        return np.concatenate([np.zeros((len(q), 0)), *rows], axis=1)

    if 5 ** len(matter) > _MOST_OF_A_CELL:
        raise NotPolynomial("the error depends on too many joints")
    found: list[PlayedVector] = []
    for frame in range(min(arm.size, _FRAMES)):
        turned = _Turned(arm, frame)
        try:
            found.append(_in_frame(turned, error, sides, coordinates, matter, pins))
        except NotPolynomial:
            if frame == 0:
                raise
    return min(found, key=lambda each: each.looseness)


@dataclass(frozen=True)
class _Turned:
    """Vectors as the frame of a joint sees them, which are as long: where the error turns with the arm, it stands
    almost still there, and control points lie closer to it."""

    arm: Arm
    joint: int

    def __call__(self, vectors: Array, q: Array) -> Array:
        """Columns (N, 3 k) in the base frame at poses q (N, n) in the joint's."""
        if self.joint == 0:
            return vectors
        frame = place(self.arm, [q[:, j] for j in range(self.arm.size)]).joints[self.joint].frame
        rows = np.stack([_rows(row, len(q)) for row in frame], axis=1)
        return np.asarray((vectors.reshape(len(q), -1, 3) @ rows).reshape(vectors.shape), dtype=float)


def _in_frame(
    turned: _Turned,
    error: Callable[[Array], Array],
    sides: Callable[[Array], Array],
    coordinates: Coordinates,
    matter: Sequence[int],
    pins: Sequence[_Pin],
) -> PlayedVector:
    own = coordinates.of(matter)

    def columns(reduced: Array) -> Array:
        q = coordinates.placed(matter, reduced)
        return turned(np.concatenate([error(q), sides(q)], axis=1), q)

    vectors = in_real_basis(fit(columns, own))
    plays = len(vectors) // 3 - 1 - 2 * len(pins)
    ends = own.scaled(np.array(own.ranges).T)
    axes = [Axis(turns, 2, float(low), float(high)) for turns, (low, high) in zip(own.revolute, ends.T, strict=True)]
    whole = np.zeros((*vectors[:3].shape, *[3] * len(pins)))
    middle = (slice(None),) * vectors.ndim
    whole[(*middle, *[0] * len(pins))] = vectors[:3]
    for k, pin in enumerate(pins):
        for side in range(2):
            at = [1 + side if other == k else 0 for other in range(len(pins))]
            first = 3 + 3 * plays + 6 * k + 3 * side
            whole[(*middle, *at)] = pin.radius * vectors[first : first + 3]
    axes += [Axis(True, 1, -math.pi, math.pi)] * len(pins)
    intervals = vectors[3 : 3 + 3 * plays].reshape(plays, 3, *vectors.shape[1:])
    return played_vector(axes, whole, intervals)
