"""More friction where a joint creeps: the film of grease bears only once it moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import shape, torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    speed = motion.velocity[:, joint]
    return values.get("torque", 0.0) * direction(speed) * np.exp(-np.abs(speed) / values.get("speed", 0.1))


FRICTION_STRIBECK = drive_effect(
    _torque,
    id="friction_stribeck",
    title="more friction at low speed (Stribeck)",
    formula="f_i sign(q'_i) exp(-|q'_i|/v_s)",
    cause="friction in motion",
    needs="slow motion beside fast, both ways",
    aliases=("friction_reversal", "friction_coulomb"),
    source="B. Armstrong-Helouvry, P. Dupont & C. Canudas de Wit, A survey of models, analysis tools and compensation "
    "methods for the control of machines with friction, Automatica 30 (1994) 1083-1138, "
    "doi:10.1016/0005-1098(94)90209-7",
    parameters=(
        torque("torque", "torque", -1e3, 1e4, (0.1, 5.0)).means(
            "friction of a joint that hardly moves beyond that of one that does", "10 to 40 % of the dry friction"
        ),
        shape("speed", "angular_speed", 1e-4, 10.0, (0.03, 0.3), grid=(0.03, 0.1, 0.3), default=0.1).means(
            "speed at which it has fallen to 37 %", "greased gears: 0.03 to 0.3 rad/s at the joint"
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=110,
)
