"""Viscous friction: a torque against the motion in proportion to its speed."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import WatchTraits

FRICTION_VISCOUS = drive_effect(
    lambda motion, values, joint: values.get("coefficient", 0.0) * motion.velocity[:, joint],
    id="friction_viscous",
    title="viscous friction",
    formula="d_i q'_i",
    cause="friction in motion",
    needs="several speeds",
    aliases=("friction_quadratic", "friction_coulomb", "back_emf"),
    source="B. Armstrong-Helouvry, P. Dupont & C. Canudas de Wit, A survey of models, analysis tools and compensation "
    "methods for the control of machines with friction, Automatica 30 (1994) 1083-1138, "
    "doi:10.1016/0005-1098(94)90209-7",
    parameters=(
        torque("coefficient", "viscous_friction", 0.0, 1e5, (0.1, 50.0)).means(
            "friction over speed", "greased gears and seals of robots that carry 3 to 20 kg: 0.5 to 50 N*m*s/rad"
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=54,
)
