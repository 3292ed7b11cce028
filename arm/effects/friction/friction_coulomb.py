"""Dry friction: a torque against the motion that does not ask how fast it is."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits

FRICTION_COULOMB = drive_effect(
    lambda motion, values, joint: values.get("torque", 0.0) * direction(motion.velocity[:, joint]),
    id="friction_coulomb",
    title="dry (Coulomb) friction",
    formula="f_i sign(q'_i)",
    cause="friction in motion",
    needs="motion both ways",
    aliases=("friction_load", "friction_asymmetry", "torque_offset"),
    source="B. Armstrong-Helouvry, P. Dupont & C. Canudas de Wit, A survey of models, analysis tools and compensation "
    "methods for the control of machines with friction, Automatica 30 (1994) 1083-1138, "
    "doi:10.1016/0005-1098(94)90209-7",
    parameters=(
        torque("torque", "torque", 0.0, 1e4, (0.1, 20.0)).means(
            "friction of the moving joint at any speed",
            "gears of robots that carry 3 to 20 kg: 0.2 N*m at wrists, 20 N*m at shoulders",
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=52,
)
