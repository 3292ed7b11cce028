"""A function that several effects share, of floats, NumPy arrays and CasADi symbols alike."""

from __future__ import annotations

from arm.chain.vectors import Scalar
from sections.numeric import absolute


def saturated(value: Scalar, limit: float) -> Scalar:
    """The value held between -limit and limit."""
    return 0.5 * (absolute(value + limit) - absolute(value - limit))
