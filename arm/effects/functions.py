"""Functions that several effects share, of floats, NumPy arrays and CasADi symbols alike."""

from __future__ import annotations

import itertools

from linkwright.core.arm.chain.chain import Zones
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.sections.numeric import absolute, sqrt


def saturated(value: Scalar, limit: float, rounding: Scalar | None = None) -> Scalar:
    """The value held between -limit and limit; with its corners rounded over some `rounding` of the limit on either
    side of them, where that is given."""
    if rounding is None:
        return 0.5 * (absolute(value + limit) - absolute(value - limit))
    room = (rounding * limit) ** 2
    return 0.5 * (sqrt((value + limit) ** 2 + room) - sqrt((value - limit) ** 2 + room))


def wound_up(load: Scalar, zones: Zones, rounding: Scalar | None = None) -> Scalar:
    """How far a drive gives (rad, m) under a load of either sign, zone by zone; `rounding` as in `saturated`."""
    total = load / zones[-1][1]
    for (end, stiffness), (_, beyond) in itertools.pairwise(zones):
        total = total + (1.0 / stiffness - 1.0 / beyond) * saturated(load, end, rounding)
    return total
