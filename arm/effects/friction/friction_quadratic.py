"""Friction that grows faster than the speed, or slower."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    return values.get("coefficient", 0.0) * motion.velocity[:, joint] * np.abs(motion.velocity[:, joint])


FRICTION_QUADRATIC = drive_effect(
    _torque,
    id="friction_quadratic",
    title="friction with the square of the speed",
    formula="e_i q'_i |q'_i|",
    cause="friction in motion",
    needs="slow and fast motion",
    aliases=("friction_viscous",),
    source="L. Simoni, M. Beschi, G. Legnani & A. Visioli, Friction modeling with temperature effects for industrial "
    "robot manipulators, IEEE/RSJ IROS (2015): friction as a polynomial of the speed",
    parameters=(
        torque("coefficient", "quadratic_friction", -1e5, 1e5, (-10.0, 5.0)).means(
            "friction over the square of the speed; negative where it grows ever slower",
            "up to half of the viscous friction at full speed, mostly negative (greases that thin under shear)",
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=120,
)
