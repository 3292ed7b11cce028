"""A drive spins its rotor up, geared: the square of the ratio times the rotor's inertia, at the joint."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect

ARMATURE = drive_effect(
    lambda motion, values, joint: values.get("inertia", 0.0) * motion.acceleration[:, joint],
    id="armature",
    title="inertia of the drive's rotor",
    formula="J_i q''_i",
    cause="drives in motion",
    needs="accelerations",
    aliases=("link_inertial", "torque_delay"),
    source="W. Khalil & E. Dombre, Modeling, Identification and Control of Robots (Hermes Penton, 2002), ch. 9 and 12",
    parameters=(
        torque("inertia", "inertia", 0.0, 1e4, (0.05, 5.0)).means(
            "inertia of rotor and gear as the joint feels it: times the square of the gear ratio",
            "robots that carry 3 to 20 kg: 0.1 kg*m^2 at wrists, 0.5 to 4 kg*m^2 at shoulders",
        ),
    ),
    rank=62,
)
