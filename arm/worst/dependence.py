"""Which joints the length of an error depends on: the fewer, the fewer cells a certificate needs.

A joint whose range has no width counts for nothing, nor does one that moves no part of the error. Nor does a joint with
a fixed axis whose coordinate turns the whole error rigidly about that axis, as the first joint of an arm does whose
axis is vertical: gravity and the forces at the tip are the same whichever way it points. Whether it
does is tested on the error itself rather than concluded from the arm's data, so that every exception is noticed: an
axis that leans, a force across it, a periodic encoder error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.sections.numeric import Array

from .polynomial import Coordinates

ErrorColumns = Callable[[Array], Array]
"""Poses (N, n) to vectors, x, y and z of one after the other, and then figures that are no vectors: (N, columns)."""

_POSES = 128
_NOTHING = 1e-12
"""Of the greatest entry: what rounding leaves of nothing."""
_SAME = 1e-11
"""Of the greatest product of two vectors: what rounding leaves of no difference."""
_LOOKED_AT = 32


def joints_that_matter(columns: ErrorColumns, vectors: int, arm: Arm, coordinates: Coordinates) -> tuple[int, ...]:
    """The joints (from 0) on which the figures or the lengths of the sums of the vectors depend that `columns` gives:
    the first `vectors` columns are vectors.

    Whatever the joints' ranges, poses from whole circles tell: what differs nowhere in a sample of them is taken to
    differ nowhere, which is certain, but for rounding, of polynomials.
    """
    free = coordinates.moving
    q = sample_full_travel(coordinates, seed=3)
    here = columns(q)
    size = np.abs(here).max(axis=0, initial=0.0)
    for kind in (slice(0, vectors), slice(vectors, None)):
        size[kind] = size[kind].max(initial=0.0)
    other = sample_full_travel(coordinates, seed=4)
    moved = {j: columns(_replaced(q, j, other)) for j in free}
    matter = [j for j in free if not _alike(moved[j], here, size)]
    for j in matter:
        axis = _fixed_axis(arm, q, j)
        if axis is None:
            continue
        turned = np.hstack([_turned(here[:, :vectors], axis, other[:, j] - q[:, j]), here[:, vectors:]])
        if _alike(moved[j], turned, size):
            return tuple(k for k in matter if k != j)
    return tuple(matter)


def still_all_that_matter(columns: ErrorColumns, vectors: int, coordinates: Coordinates, joints: Sequence[int]) -> bool:
    """Whether the `joints` that mattered for another design are all that matter for this one: wherever the others
    stand, the vectors have the same lengths and products with each other, and the other figures are the same."""
    if len(joints) == len(coordinates.moving):
        return True
    q = sample_full_travel(coordinates, seed=6)[:_LOOKED_AT]
    values = columns(np.vstack([q, coordinates.placed(joints, q[:, list(joints)])]))
    vectors_here = values[:, :vectors].reshape(len(values), -1, 3)
    here, there = np.split(vectors_here @ vectors_here.transpose(0, 2, 1), 2)
    if np.abs(here - there).max(initial=0.0) > _SAME * np.abs(here).max(initial=0.0):
        return False
    here, there = np.split(values[:, vectors:], 2)
    return _alike(there, here, np.abs(here).max(initial=0.0))


@lru_cache(maxsize=64)
def sample_full_travel(coordinates: Coordinates, seed: int) -> Array:
    """Poses (N, n) from whole circles and whole slides; joints without width stand where they do."""
    free = coordinates.moving
    some = coordinates.of(free)
    reach = np.where(some.revolute, np.pi, 1.0)
    x = np.random.default_rng(seed).uniform(-reach, reach, (_POSES, len(free)))
    poses = coordinates.placed(free, some.unscaled(x))
    poses.setflags(write=False)
    return poses


def _replaced(q: Array, joint: int, other: Array) -> Array:
    out = q.copy()
    out[:, joint] = other[:, joint]
    return out


def _alike(one: Array, two: Array, size: Array | float) -> bool:
    return bool(np.all(np.abs(one - two) <= _NOTHING * size))


def _fixed_axis(arm: Arm, q: Array, joint: int) -> Array | None:
    """The axis of a turning joint in the base frame, where that is the same at all poses."""
    if not arm.joints[joint].revolute:
        return None
    axis = place(arm, [q[:, j] for j in range(arm.size)]).joints[joint].axis
    rows = np.stack([np.broadcast_to(part, len(q)) for part in axis], axis=1)
    return rows[0] if np.abs(rows - rows[0]).max() <= _NOTHING else None


def _turned(columns: Array, axis: Array, angle: Array) -> Array:
    """Vectors (N, 3 k) turned about an axis by an angle (N,)."""
    vectors = columns.reshape(len(columns), -1, 3)
    cosine, sine = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    along = (vectors @ axis)[:, :, None] * axis
    out = along + cosine * (vectors - along) + sine * np.cross(axis, vectors)
    return np.asarray(out.reshape(columns.shape), dtype=float)
