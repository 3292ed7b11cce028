"""Functions that several effects share, of floats, NumPy arrays and CasADi symbols alike."""

from __future__ import annotations

import itertools

from arm.chain.chain import Zones
from arm.chain.vectors import Scalar
from sections.numeric import absolute


def saturated(value: Scalar, limit: float) -> Scalar:
    """The value held between -limit and limit."""
    return 0.5 * (absolute(value + limit) - absolute(value - limit))


def wound_up(load: Scalar, zones: Zones) -> Scalar:
    """How far a drive gives (rad, m) under a load of either sign, zone by zone."""
    total = load / zones[-1][1]
    for (end, stiffness), (_, beyond) in itertools.pairwise(zones):
        total = total + (1.0 / stiffness - 1.0 / beyond) * saturated(load, end)
    return total
