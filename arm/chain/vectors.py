"""Three-vectors and rotations whose components are floats, NumPy arrays or CasADi symbols.

Components that are plain floats 0 and 1 are folded here, before they meet a symbol: CasADi folds
products with zero but does not re-associate, so constants gathered as floats keep the expression of
a planar arm as small as code written for the plane.
"""

from __future__ import annotations

import math
from typing import Any

Scalar = Any
"""A float, a NumPy array or a CasADi SX: the formulas do not ask which."""
Vector = tuple[Scalar, Scalar, Scalar]
Rotation = tuple[Vector, Vector, Vector]
"""Rows of a 3x3 rotation matrix."""

ZERO: Vector = (0.0, 0.0, 0.0)
IDENTITY: Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

_SNAP = 1e-12


def _is(value: Scalar, constant: float) -> bool:
    return isinstance(value, (float, int)) and value == constant


# Arms of many pieces ask for these sums and products millions of times: what an operand is, is asked but once and in
# place, and what says that it is nothing (`ZERO`, `IDENTITY`) is not looked into.


def times(a: Scalar, b: Scalar) -> Scalar:
    """a * b, with the floats 0, 1 and -1 folded."""
    a_number, b_number = isinstance(a, (float, int)), isinstance(b, (float, int))
    if (a_number and a == 0.0) or (b_number and b == 0.0):
        return 0.0
    if a_number:
        if a == 1.0:
            return b
        if a == -1.0:
            return -b
    if b_number:
        if b == 1.0:
            return a
        if b == -1.0:
            return -a
    return a * b


def plus(a: Scalar, b: Scalar) -> Scalar:
    """a + b, with the float 0 folded."""
    if isinstance(a, (float, int)) and a == 0.0:
        return b
    if isinstance(b, (float, int)) and b == 0.0:
        return a
    return a + b


def minus(a: Scalar, b: Scalar) -> Scalar:
    """a - b, with the float 0 folded."""
    if isinstance(b, (float, int)) and b == 0.0:
        return a
    if isinstance(a, (float, int)) and a == 0.0:
        return -b
    return a - b


def add(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    if a is ZERO or b is ZERO:
        return b if a is ZERO else a
    return (plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2]))


def subtract(a: Vector, b: Vector) -> Vector:
    """The difference a - b."""
    return (minus(a[0], b[0]), minus(a[1], b[1]), minus(a[2], b[2]))


def scale(factor: Scalar, a: Vector) -> Vector:
    """The vector a, factor times as long."""
    if a is ZERO:
        return ZERO
    return (times(factor, a[0]), times(factor, a[1]), times(factor, a[2]))


def dot(a: Vector, b: Vector) -> Scalar:
    """The scalar product."""
    return plus(plus(times(a[0], b[0]), times(a[1], b[1])), times(a[2], b[2]))


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product a x b."""
    if a is ZERO or b is ZERO:
        return ZERO
    return (
        minus(times(a[1], b[2]), times(a[2], b[1])),
        minus(times(a[2], b[0]), times(a[0], b[2])),
        minus(times(a[0], b[1]), times(a[1], b[0])),
    )


def is_zero(a: Vector) -> bool:
    """Whether every component is a constant zero (a symbol that happens to vanish is not)."""
    return all(_is(component, 0.0) for component in a)


def snap(value: float) -> float:
    """The float itself, or 0, 1 or -1 where it lies within 1e-12: a cos(pi/2) of 6e-17 would double an expression."""
    for constant in (0.0, 1.0, -1.0):
        if abs(value - constant) < _SNAP:
            return constant
    return value


def snap_vector(a: tuple[float, float, float]) -> tuple[float, float, float]:
    """Each component snapped to 0 and +-1."""
    return (snap(a[0]), snap(a[1]), snap(a[2]))


def norm(a: tuple[float, float, float]) -> float:
    """The length of a vector of floats."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def unit(a: tuple[float, float, float]) -> tuple[float, float, float]:
    """The unit vector along a vector of floats, snapped; ValueError where it has no length."""
    length, largest = norm(a), max(abs(item) for item in a)
    if 0.0 < largest < math.inf and not 0.0 < length < math.inf:  # its square is no number, its direction is one
        return unit((a[0] / largest, a[1] / largest, a[2] / largest))
    if not length > 0.0 or not math.isfinite(length):
        raise ValueError("a direction needs a length other than zero")
    return snap_vector((a[0] / length, a[1] / length, a[2] / length))


def rotate(rotation: Rotation, a: Vector) -> Vector:
    """The rotation applied to a vector."""
    if a is ZERO or rotation is IDENTITY:
        return a
    return (dot(rotation[0], a), dot(rotation[1], a), dot(rotation[2], a))


def transpose(rotation: Rotation) -> Rotation:
    """The transpose, which is the inverse of a rotation."""
    return (
        (rotation[0][0], rotation[1][0], rotation[2][0]),
        (rotation[0][1], rotation[1][1], rotation[2][1]),
        (rotation[0][2], rotation[1][2], rotation[2][2]),
    )


def compose(a: Rotation, b: Rotation) -> Rotation:
    """The matrix product a b: b first, then a."""
    if a is IDENTITY or b is IDENTITY:
        return b if a is IDENTITY else a
    columns = transpose(b)
    return (
        (dot(a[0], columns[0]), dot(a[0], columns[1]), dot(a[0], columns[2])),
        (dot(a[1], columns[0]), dot(a[1], columns[1]), dot(a[1], columns[2])),
        (dot(a[2], columns[0]), dot(a[2], columns[1]), dot(a[2], columns[2])),
    )


def about(axis: tuple[float, float, float], cosine: Scalar, sine: Scalar) -> Rotation:
    """Rotation about a unit axis, as a a^T + c (I - a a^T) + s K, which folds for axes along x, y or z."""
    x, y, z = axis

    def entry(i: int, j: int, skew: float) -> Scalar:
        outer = snap(axis[i] * axis[j])
        kronecker = 1.0 if i == j else 0.0
        return plus(plus(outer, times(snap(kronecker - outer), cosine)), times(skew, sine))

    return (
        (entry(0, 0, 0.0), entry(0, 1, -z), entry(0, 2, y)),
        (entry(1, 0, z), entry(1, 1, 0.0), entry(1, 2, -x)),
        (entry(2, 0, -y), entry(2, 1, x), entry(2, 2, 0.0)),
    )


def from_roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> Rotation:
    """Rotation by fixed-axis roll (x), pitch (y), yaw (z), as in URDF, snapped."""
    matrix = compose(
        about((0.0, 0.0, 1.0), math.cos(yaw), math.sin(yaw)),
        compose(
            about((0.0, 1.0, 0.0), math.cos(pitch), math.sin(pitch)),
            about((1.0, 0.0, 0.0), math.cos(roll), math.sin(roll)),
        ),
    )
    return (snap_vector(matrix[0]), snap_vector(matrix[1]), snap_vector(matrix[2]))


def to_roll_pitch_yaw(rotation: Rotation) -> tuple[float, float, float]:
    """The fixed-axis roll, pitch and yaw (rad) of a rotation of floats; yaw 0 where the pitch is +-90 degrees.

    Near there, where roll and yaw turn about nearly the same axis, the roll makes up for what the yaw cannot tell.
    """
    r = [[float(entry) for entry in row] for row in rotation]
    level = math.hypot(r[0][0], r[1][0])
    pitch = math.atan2(-r[2][0], level)
    yaw = math.atan2(r[1][0], r[0][0]) if level > _SNAP else 0.0
    s, c = math.sin(yaw), math.cos(yaw)
    return math.atan2(s * r[0][2] - c * r[1][2], c * r[1][1] - s * r[0][1]), pitch, yaw
