"""Turns that are finite, as rotation vectors, quaternions and rotations; floats or arrays."""

from __future__ import annotations

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
    rotate,
    scale,
    subtract,
    times,
    transpose,
)

Quaternion = tuple[Scalar, Vector]
"""A rotation: cosine of half its angle, and its axis times the sine."""
_NONE = 1e-150
"""What stands for an angle of zero where it divides."""
_LEAST = 1e-15
"""Of half a turn about an axis nothing tells which way round is the short one."""


def arc(turn: Vector, straight: Vector, strain: Vector) -> tuple[Rotation, Vector]:
    """By what a piece that turns by `turn` in all has turned half way along, and where its end lies against its root:
    to first order straight + strain, the strain as it is half way, constant along it as finite motions are."""
    if is_zero(turn):
        return IDENTITY, add(straight, strain)
    square = dot(turn, turn)
    angle = np.maximum(np.sqrt(square), _NONE)
    cosine, share = np.cos(0.25 * angle), np.sin(0.25 * angle) / angle
    half = _of_quaternion((cosine, scale(share, turn)))
    # Sine of half the angle and one less its cosine, by the angle and by its square; (angle - sin)/angle^3.
    sine, versine = 2.0 * share * cosine, 2.0 * share * share
    left = (1.0 - 2.0 * sine * (1.0 - versine * square)) / np.maximum(square, _NONE)
    second = np.where(square < 1e-8, 1.0 / 6.0 - square / 120.0, left)
    shift = rotate(transpose(half), strain)
    steady = add(straight, subtract(shift, scale(0.5, cross(turn, straight))))
    across = cross(turn, steady)
    return half, add(steady, add(scale(2.0 * sine * sine, across), scale(second, cross(turn, across))))


def after(orientation: Rotation, turn: Vector) -> Rotation:
    """An orientation turned further, about the base's axes, by a rotation vector (rad)."""
    return orientation if is_zero(turn) else compose(matrix(turn), orientation)


def matrix(turn: Vector) -> Rotation:
    """The rotation by a rotation vector (rad)."""
    return _of_quaternion(_quaternion(turn))


def half_of(rotation: Rotation) -> Rotation:
    """The rotation that is `rotation` when it is done twice, the short way round."""
    if rotation is IDENTITY:
        return IDENTITY
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    # Four times the square of the cosine of half the angle.
    square = np.maximum(plus(1.0, plus(xx, plus(yy, zz))), _LEAST)
    real = 0.5 * np.sqrt(square)
    vector = scale(0.25 / real, (minus(zy, yz), minus(xz, zx), minus(yx, xy)))
    size = 1.0 / np.sqrt(2.0 + 2.0 * real)
    return _of_quaternion((times(size, 1.0 + real), scale(size, vector)))


def _quaternion(turn: Vector) -> Quaternion:
    """The rotation by a rotation vector (rad) as a quaternion, the real part first."""
    if is_zero(turn):
        return 1.0, ZERO
    angle = 0.5 * np.sqrt(dot(turn, turn))
    return np.cos(angle), scale(0.5 * np.sinc(angle / np.pi), turn)


def _of_quaternion(turn: Quaternion) -> Rotation:
    w, (x, y, z) = turn
    if is_zero((x, y, z)):
        return IDENTITY
    xx, yy, zz = (times(2.0, times(item, item)) for item in (x, y, z))
    xy, xz, yz = (times(2.0, times(*pair)) for pair in ((x, y), (x, z), (y, z)))
    wx, wy, wz = (times(2.0, times(w, item)) for item in (x, y, z))
    return (
        (minus(1.0, plus(yy, zz)), minus(xy, wz), plus(xz, wy)),
        (plus(xy, wz), minus(1.0, plus(xx, zz)), minus(yz, wx)),
        (minus(xz, wy), plus(yz, wx), minus(1.0, plus(xx, yy))),
    )
