"""Vectors, rotations and nominal tips as arrays of numbers, one row a pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.sections.numeric import Array

from .chain import Arm
from .kinematics import place
from .vectors import Rotation, Scalar


def columns(vector: Sequence[Scalar], rows: int) -> Array:
    """The components of a vector, each a number or `rows` of them, as columns (rows, len(vector))."""
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (rows,)) for part in vector], axis=1)


def matrices(rotation: Rotation, rows: int, width: int = 3) -> Array:
    """The entries of a rotation, each a number or `rows` of them, as matrices (rows, width, width): 2 for those in the
    plane."""
    return np.stack([columns(row[:width], rows) for row in rotation[:width]], axis=1)


def nominal(arm: Arm, q: Array, width: int = 3) -> tuple[Array, Array]:
    """The nominal tips (N, width), m, at poses q (N, n) and the last link's axes (N, width, width)."""
    frames = place(arm, [q[:, index] for index in range(arm.size)])
    return columns(frames.tip()[:width], len(q)), matrices(frames.orientation, len(q), width)
