"""What else of an arm and its loads may be otherwise, as symbols: where a row p goes on with factors of the drives, it
ends with these."""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.vectors import Vector, add, cross, norm, scale, times, unit
from linkwright.core.arm.effects.effect import Settings
from linkwright.core.arm.effects.geometry.link_length import LINK_LENGTH
from linkwright.core.arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION
from linkwright.core.sections.numeric import Array, cos, sin
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .tip import ActiveEffect

VARIED = ("link_length", "payload", "temperature", "force_direction")
"""What each link is too long by (m), the factor of all payloads, by how much all is warmer (K), and the two angles
(rad) by which forces at the tip are turned."""

AFTER_PAYLOAD = 4
"""Where, from a row's end, the factor of all payloads stands."""


def as_it_is(size: int) -> Array:
    """The end of a row p of an arm of so many joints that is as its file says: factors of stiffnesses and backlashes,
    then what `VARIED` lists."""
    return np.concatenate([np.ones(2 * size), np.zeros(size), [1.0], np.zeros(3)])


def varied_case(
    arm: Arm, load: LoadCase, names: frozenset[str], symbols: Any
) -> tuple[dict[str, Any], list[ActiveEffect]]:
    """What the statics of a load case take in place of what the file says, and the effects that come with it.

    Args:
        arm: The arm.
        load: The load case.
        names: Which of `VARIED` may be otherwise.
        symbols: A column of them, in that order.

    Returns:
        Arguments of `arm.chain.statics.solve`, and effects.
    """
    size = arm.size
    given: dict[str, Any] = {}
    effects: list[ActiveEffect] = []
    if "link_length" in names:
        effects += [ActiveEffect(LINK_LENGTH, Settings((k,), {"length": symbols[k]})) for k in range(size)]
    if "payload" in names:
        given["payload_mass"] = times(load.mass, symbols[size])
    if "temperature" in names:
        if any(entry.effect == THERMAL_EXPANSION.id for entry in arm.effects):
            given["warming"] = arm.temperature - REFERENCE_TEMPERATURE + symbols[size + 1]
        else:
            effects.append(ActiveEffect(THERMAL_EXPANSION, Settings((), {"warming": symbols[size + 1]})))
    if "force_direction" in names and any(load.force):
        given["tip_force"] = _turned(load.force, arm.flat, symbols[size + 2], symbols[size + 3])
    return given, effects


def _turned(force: tuple[float, float, float], flat: bool, one: Any, other: Any) -> Vector:
    """A force turned by an angle (rad) to either of two sides; within the plane where the arm moves in one."""
    along, least = unit(force), min(range(3), key=lambda k: abs(force[k]))
    hint = (float(least == 0), float(least == 1), float(least == 2))
    side = unit(cross((0.0, 0.0, 1.0) if flat else hint, along))
    across = cross(along, side)
    turned = add(scale(times(cos(one), 1.0 if flat else cos(other)), along), scale(sin(one), side))
    if not flat:
        turned = add(turned, scale(times(cos(one), sin(other)), across))
    return scale(norm(force), turned)
