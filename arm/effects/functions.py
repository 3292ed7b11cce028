"""Functions that the effects need of floats, NumPy arrays and CasADi symbols alike."""

from __future__ import annotations

import casadi as ca
import numpy as np

from ..vectors import Scalar


def sine(angle: Scalar) -> Scalar:
    """Sine of an angle in rad."""
    return ca.sin(angle) if isinstance(angle, ca.SX) else np.sin(angle)


def cosine(angle: Scalar) -> Scalar:
    """Cosine of an angle in rad."""
    return ca.cos(angle) if isinstance(angle, ca.SX) else np.cos(angle)


def hyperbolic_tangent(value: Scalar) -> Scalar:
    """Hyperbolic tangent."""
    return ca.tanh(value) if isinstance(value, ca.SX) else np.tanh(value)


def magnitude(value: Scalar) -> Scalar:
    """Absolute value."""
    return ca.fabs(value) if isinstance(value, ca.SX) else np.abs(value)


def saturated(value: Scalar, limit: float) -> Scalar:
    """The value held between -limit and limit."""
    return 0.5 * (magnitude(value + limit) - magnitude(value - limit))
