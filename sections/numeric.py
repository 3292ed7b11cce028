"""The few functions that floats, NumPy arrays and CasADi symbols have to share.

Everything else in the formulas is ``+ - * / **``, which the three kinds already have in common. CasADi is never
imported here: where a value is one of its symbols, somebody has imported it.

>>> import linkwright as lw
>>> float(lw.numeric.sqrt(2.25))
1.5
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = Any
"""A float, a NumPy array of floats or a CasADi ``SX``/``MX``. CasADi ships no types, hence ``Any``."""

Array: TypeAlias = NDArray[np.float64]
"""Floats of any shape."""


def is_symbol(value: Number) -> bool:
    """Whether the value is a CasADi expression (``SX``, ``MX``), whose size cannot be compared."""
    casadi = sys.modules.get("casadi")
    return casadi is not None and isinstance(value, (casadi.SX, casadi.MX))


def _library(first: Number, second: Number = 0.0) -> Any:
    """Whose functions take these values: CasADi's where one is a symbol, NumPy's else; both spell them alike."""
    return sys.modules["casadi"] if is_symbol(first) or is_symbol(second) else np


def sqrt(value: Number) -> Number:
    """Square root."""
    return _library(value).sqrt(value)


def maximum(first: Number, second: Number) -> Number:
    """The larger of two, element by element."""
    library = _library(first, second)
    return np.maximum(first, second) if library is np else library.fmax(first, second)


def minimum(first: Number, second: Number) -> Number:
    """The smaller of two, element by element."""
    library = _library(first, second)
    return np.minimum(first, second) if library is np else library.fmin(first, second)


def exp(value: Number) -> Number:
    """Exponential."""
    return _library(value).exp(value)


def log(value: Number) -> Number:
    """Natural logarithm."""
    return _library(value).log(value)


def atan(value: Number) -> Number:
    """Arc tangent."""
    return _library(value).arctan(value)


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
    return _library(value).sin(value)


def cos(value: Number) -> Number:
    """Cosine of an angle in radians."""
    return _library(value).cos(value)


def tanh(value: Number) -> Number:
    """Hyperbolic tangent."""
    return _library(value).tanh(value)


def absolute(value: Number) -> Number:
    """Absolute value."""
    return sys.modules["casadi"].fabs(value) if is_symbol(value) else np.abs(value)


def atan2(opposite: Number, adjacent: Number) -> Number:
    """Angle of a point, in radians from -pi to pi."""
    return _library(opposite, adjacent).arctan2(opposite, adjacent)


def column_of_symbols(name: str, size: int = 1) -> Any:
    """A column of CasADi symbols (size, 1), which NumPy's functions give expressions of as well: a separate formula
    may use `np.sin` where the project has `sections.numeric.sin`.

    CasADi (from 3.8 on) warns of that at length unless it is told that it is meant; whoever told it otherwise is left
    alone.
    """
    import casadi as ca

    options: Any = ca.GlobalOptions
    if hasattr(options, "setNumpyMode") and options.getNumpyMode() == 0:
        options.setNumpyMode(-1)
    return ca.SX.sym(name, size)  # pyright: ignore[reportCallIssue]
