"""Turns that are finite, as rotation vectors, quaternions and rotations; floats or arrays."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np

from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    Rotation,
    Scalar,
    Vector,
    add,
    compose,
    cross,
    dot,
    is_zero,
    minus,
    plus,
    scale,
    subtract,
    times,
)

Quaternion = tuple[Scalar, Vector]
"""A rotation: cosine of half its angle, and its axis times the sine."""


def arc(turn: Vector, straight: Vector, shift: Vector) -> Vector:
    """Where the end of a piece lies that turns by `turn` in all and is shifted by `shift` against its root: to first
    order straight + shift, with its strain constant along it as finite motions are."""
    end = add(straight, shift)
    if is_zero(turn):
        return end
    strain = subtract(end, scale(0.5, cross(turn, straight)))
    square = dot(turn, turn)
    angle = np.sqrt(square)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - square / 24.0, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0 - square / 120.0, (safe - np.sin(safe)) / (safe * safe * safe))
    across = cross(turn, strain)
    return add(strain, add(scale(first, across), scale(second, cross(turn, across))))


def after(orientation: Rotation, turn: Vector) -> Rotation:
    """An orientation turned further, about the base's axes, by a rotation vector (rad)."""
    return orientation if is_zero(turn) else compose(matrix(turn), orientation)


def matrix(turn: Vector) -> Rotation:
    """The rotation by a rotation vector (rad)."""
    return of_quaternion(quaternion(turn))


def quaternion(turn: Vector) -> Quaternion:
    """The rotation by a rotation vector (rad) as a quaternion, the real part first."""
    if is_zero(turn):
        return 1.0, ZERO
    angle = 0.5 * np.sqrt(dot(turn, turn))
    return np.cos(angle), scale(0.5 * np.sinc(angle / np.pi), turn)


def by_half(turn: Vector) -> Quaternion:
    """The rotation by half a rotation vector."""
    return quaternion(scale(0.5, turn))


def _after_quaternion(first: Quaternion, then: Quaternion) -> Quaternion:
    """One rotation after another."""
    (a, u), (b, v) = then, first
    real = minus(times(a, b), dot(u, v))
    return real, add(add(scale(a, v), scale(b, u)), cross(u, v))


def twice(turn: Quaternion) -> Quaternion:
    """A rotation and the same once more."""
    return _after_quaternion(turn, turn)


def half_of_all(turns: Iterable[Quaternion]) -> Quaternion:
    """The rotation half way, the short way round, to where rotations one after another lead."""
    real, vector = reduce(_after_quaternion, turns, (1.0, ZERO))
    if is_zero(vector):
        return 1.0, ZERO
    sign = np.where(np.asarray(real) < 0.0, -1.0, 1.0)
    real, vector = plus(1.0, times(sign, real)), scale(sign, vector)
    size = 1.0 / np.sqrt(real * real + dot(vector, vector))
    return times(size, real), scale(size, vector)


def of_quaternion(turn: Quaternion) -> Rotation:
    """A quaternion's rotation."""
    w, (x, y, z) = turn
    if is_zero((x, y, z)):
        return IDENTITY
    xx, yy, zz = (times(2.0, times(each, each)) for each in (x, y, z))
    xy, xz, yz = (times(2.0, times(*pair)) for pair in ((x, y), (x, z), (y, z)))
    wx, wy, wz = (times(2.0, times(w, each)) for each in (x, y, z))
    return (
        (minus(1.0, plus(yy, zz)), minus(xy, wz), plus(xz, wy)),
        (plus(xy, wz), minus(1.0, plus(xx, zz)), minus(yz, wx)),
        (minus(xz, wy), plus(yz, wx), minus(1.0, plus(xx, yy))),
    )
