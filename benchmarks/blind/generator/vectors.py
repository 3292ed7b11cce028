"""Vectors as arrays of shape (3, ...), rotations as (3, 3, ...): one array operation serves all rows of a recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cross(a: Array, b: Array) -> Array:
    """a x b along the first axis; the rest broadcasts."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def dot(a: Array, b: Array) -> Array:
    """Scalar product along the first axis."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def turned(rotation: Array, vector: Array) -> Array:
    """rotation @ vector; a vector with one axis more (nodes) shares its row's rotation."""
    if vector.ndim > rotation.ndim - 1:
        rotation = rotation[..., None]
    return rotation[:, 0] * vector[0] + rotation[:, 1] * vector[1] + rotation[:, 2] * vector[2]


def turned_back(rotation: Array, vector: Array) -> Array:
    """Transposed rotation @ vector."""
    return turned(np.swapaxes(rotation, 0, 1), vector)


def product(a: Array, b: Array) -> Array:
    """Matrix product a @ b of rotations."""
    return np.stack([turned(a, b[:, column]) for column in range(3)], axis=1)


def rotated(psi: Array, vector: Array) -> Array:
    """exp(psi x) vector by Rodrigues' formula, safe at psi = 0."""
    square = dot(psi, psi)
    small = square < 1e-8
    angle = np.sqrt(np.where(small, 1.0, square))
    first = np.where(small, 1.0 - square / 6.0, np.sin(angle) / angle)
    second = np.where(small, 0.5 - square / 24.0, (1.0 - np.cos(angle)) / np.where(small, 1.0, square))
    once = cross(psi, vector)
    return vector + first * once + second * cross(psi, once)


def rotation_of(psi: Array) -> Array:
    """The matrix exp(psi x), shape (3, 3, ...)."""
    ones = np.ones(psi.shape[1:])
    units = [np.stack([ones * (row == column) for row in range(3)]) for column in range(3)]
    return np.stack([rotated(psi, unit) for unit in units], axis=1)


def rotation_rate(psi: Array, curvature: Array) -> Array:
    """d psi / ds of R = exp(psi x) with R' = R (curvature x): the inverse right Jacobian of SO(3)."""
    square = dot(psi, psi)
    small = square < 1e-8
    angle = np.sqrt(np.where(small, 1.0, square))
    factor = np.where(small, 1.0 / 12.0, (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / np.where(small, 1.0, square))
    once = cross(psi, curvature)
    return curvature + 0.5 * once + factor * cross(psi, once)
