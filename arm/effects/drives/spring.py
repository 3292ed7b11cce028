"""A spring pulls at a joint: a cable package, a hose, a spring of balance."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import given, torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import WatchTraits

SPRING = drive_effect(
    lambda motion, values, joint: values.get("stiffness", 0.0) * (motion.q[:, joint] - values.get("rest", 0.0)),
    id="spring",
    title="spring at a joint",
    formula="k_i (q_i - rest)",
    cause="drives in motion",
    needs="a wide travel, at postures of which the load is known",
    aliases=("torque_offset", "counterbalance", "link_inertial"),
    source="Y. Wang, R. Gondokaryono, A. Munawar & G. S. Fischer, A convex optimization-based dynamic model "
    "identification package for the da Vinci Research Kit, IEEE Robotics and Automation Letters 4 (2019) "
    "3657-3664, doi:10.1109/LRA.2019.2927947",
    parameters=(
        torque("stiffness", "torsional_stiffness", -1e5, 1e6, (0.1, 30.0)).means(
            "torque by which it pulls back, over the joint's motion",
            "cable packages and hoses: 0.1 to 10 N*m/rad; springs more",
        ),
        given("rest", "angle", -100.0, 100.0, (0.0, 0.1)).means(
            "coordinate at which it is slack; where a fit puts it elsewhere, that is a torque_offset",
            "somewhere in the range",
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=172,
)
