"""A bound on the worst error where no certificate to a small gap can be had: too many joints, or pins in space.

The error with its play is one vector: backlash adds intervals, a pin that may lie anywhere in its bore a disc.
`arm.worst.hull` bounds its length, as far as a fixed effort goes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.vectors import Vector
from linkwright.core.arm.errors.model import CaseModel
from linkwright.core.sections.numeric import Array

from .dependence import joints_that_matter, sample_full_travel
from .hull import Axis, Pins, PlayedVector, Within, bound, played_vector
from .polynomial import Coordinates, NotPolynomial, fit
from .workspace import RegionCells

QUICK, THOROUGH = 4_000_000, 100_000_000
"""Efforts, in control points looked at for a load case: some tenths of a second, and a few
seconds."""
CONFINED = 400_000_000
"""The same for all load cases together, where a box or a path confines the poses of five or six joints."""
_MOST_OF_A_CELL = 20_000
_FRAMES = 4
"""Frames of joints, from the base on, in which the error may be looked at."""
_OUTSIDE = 1e-9
"""So far (m) outside of a box a tip still counts as in it."""
_ALONGSIDE = 1e-9
"""Normals that differ by less are the same."""


def loose_bound(
    case: CaseModel,
    p: Array,
    coordinates: Coordinates,
    known: float,
    *,
    planar: bool,
    gap: float,
    effort: int,
    cells: RegionCells | None = None,
) -> float | None:
    """An error (m) that no pose within the joints' ranges exceeds wherever the play stands, within a relative `gap` of
    the error `known` to be reached where the `effort` allows; None where the error is no polynomial of few joints.
    With `cells` of a box or path, which are of all joints that move, no pose with its tip there.
    """
    matter = _matter(case, p, coordinates) if cells is None else tuple(coordinates.moving)
    try:
        played = _played(case, p, coordinates, matter, pins=not planar, cells=cells)
    except NotPolynomial:
        return None
    # In the plane pins add up, whatever the pose.
    radius = float(case.radii.sum()) if planar else 0.0
    narrow = None if cells is None else cells.narrowed
    return radius + bound(played, max(known - radius, 0.0), gap=gap, effort=effort, narrow=narrow)


def _matter(case: CaseModel, p: Array, coordinates: Coordinates) -> tuple[int, ...]:
    """The joints that the error and its play depend on, but for turning them as a whole."""

    def vectors(q: Array) -> Array:
        arrays = case.arrays(q, p)
        play = [arrays.intervals.reshape(len(q), -1), arrays.normals.reshape(len(q), -1)]
        return np.concatenate([arrays.vector, *play], axis=1)

    count = 3 * (1 + len(case.error.intervals) + len(case.error.discs))
    return joints_that_matter(vectors, count, case.state.arm, coordinates) or (0,)


def _merged(radii: Array, normals: Array) -> tuple[Array, list[int]]:
    """Discs whose normals (N, d, 3) are parallel at every pose add up to one: radii, and a disc that has its normal."""
    merged: list[int] = []
    sums: list[float] = []
    for index, radius in enumerate(radii.tolist()):
        for k, other in enumerate(merged):
            pair, normal = normals[:, index], normals[:, other]
            if min(np.abs(pair - normal).max(), np.abs(pair + normal).max()) <= _ALONGSIDE:
                sums[k] += radius
                break
        else:
            merged.append(index)
            sums.append(radius)
    return np.array(sums), merged


def _rows(vector: Vector, count: int) -> Array:
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in vector], axis=1)


def _played(
    case: CaseModel,
    p: Array,
    coordinates: Coordinates,
    matter: Sequence[int],
    *,
    pins: bool,
    cells: RegionCells | None = None,
) -> PlayedVector:
    """The error with its play, its `pins` too, in the frame where it curves least; raises `NotPolynomial`."""
    if 5 ** len(matter) > _MOST_OF_A_CELL:
        raise NotPolynomial("the error depends on too many joints")
    radii, kept = np.zeros(0), list[int]()
    if pins and len(case.radii):
        radii, kept = _merged(case.radii, case.arrays(sample_full_travel(coordinates, seed=5), p).normals)

    def columns(q: Array) -> Array:
        arrays = case.arrays(q, p)
        normals = arrays.normals[:, kept]
        if arrays.projection is not None:
            normals = normals @ arrays.projection
        return np.concatenate(
            [arrays.vector, arrays.intervals.reshape(len(q), -1), normals.reshape(len(q), -1)], axis=1
        )

    played: list[PlayedVector] = []
    for frame in range(min(case.state.arm.size, _FRAMES)):
        turned = _Turned(case.state.arm, frame)
        try:
            played.append(_in_frame(turned, columns, coordinates, matter, radii, cells))
        except NotPolynomial:
            if frame == 0:
                raise
    return min(played, key=lambda item: item.looseness)


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
    columns: Callable[[Array], Array],
    coordinates: Coordinates,
    matter: Sequence[int],
    radii: Array,
    cells: RegionCells | None,
) -> PlayedVector:
    joints = coordinates.of(matter)

    def seen(reduced: Array) -> Array:
        q = coordinates.placed(matter, reduced)
        return turned(columns(q), q)

    vectors = fit(seen, joints).in_reals
    vectors = vectors.reshape(-1, 3, *vectors.shape[1:])
    ends = joints.scaled(np.array(joints.ranges).T)
    axes = [Axis(turns, 2, float(low), float(high)) for turns, (low, high) in zip(joints.revolute, ends.T, strict=True)]
    pins = len(vectors) - len(radii)
    within = None
    if cells is not None:
        low, high = cells.box
        tips = fit(lambda q: cells.tips(joints.scaled(q)), joints).in_reals
        within = Within(tips, 0.5 * (low + high), 0.5 * (high - low) + _OUTSIDE)
    return played_vector(axes, vectors[0], vectors[1:pins], Pins(radii, vectors[pins:]), within)
