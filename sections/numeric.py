"""The few functions that floats, NumPy arrays and CasADi symbols have to share.

Everything else in the formulas is ``+ - * / **``, which the three kinds already have in common.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

Number: TypeAlias = Any
"""A float, a NumPy array of floats or a CasADi ``SX``/``MX``. CasADi ships no types, hence ``Any``."""


def is_symbol(value: Number) -> bool:
    """Whether the value is a CasADi expression (``SX``, ``MX``), whose size cannot be compared."""
    return isinstance(value, (ca.SX, ca.MX))


def sqrt(value: Number) -> Number:
    """Square root."""
    return ca.sqrt(value) if is_symbol(value) else np.sqrt(value)


def maximum(first: Number, second: Number) -> Number:
    """The larger of two, element by element."""
    if is_symbol(first) or is_symbol(second):
        return ca.fmax(first, second)
    return np.maximum(first, second)


def minimum(first: Number, second: Number) -> Number:
    """The smaller of two, element by element."""
    if is_symbol(first) or is_symbol(second):
        return ca.fmin(first, second)
    return np.minimum(first, second)


def exp(value: Number) -> Number:
    """Exponential."""
    return ca.exp(value) if is_symbol(value) else np.exp(value)


def log(value: Number) -> Number:
    """Natural logarithm."""
    return ca.log(value) if is_symbol(value) else np.log(value)


def atan(value: Number) -> Number:
    """Arc tangent."""
    return ca.atan(value) if is_symbol(value) else np.arctan(value)


def polynomial(coefficients: Sequence[Any], variables: Sequence[Number]) -> Number:
    """A polynomial in several variables by nested Horner steps.

    ``coefficients[i]`` multiplies the i-th power of the first variable: a number where there is one
    variable, else
    the coefficients of a polynomial in the others.
    """
    first, rest = variables[0], variables[1:]
    total: Number = 0.0
    for entry in reversed(coefficients):
        total = total * first + (polynomial(entry, rest) if rest else entry)
    return total


def sin(value: Number) -> Number:
    """Sine of an angle in radians."""
    return ca.sin(value) if is_symbol(value) else np.sin(value)


def absolute(value: Number) -> Number:
    """Absolute value."""
    return ca.fabs(value) if is_symbol(value) else np.abs(value)


def atan2(opposite: Number, adjacent: Number) -> Number:
    """Angle of a point, in radians from -pi to pi."""
    symbolic = is_symbol(opposite) or is_symbol(adjacent)
    return ca.atan2(opposite, adjacent) if symbolic else np.arctan2(opposite, adjacent)
