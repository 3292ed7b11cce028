"""A drive that runs through the joint before it is dragged along when that joint moves, and drags at it in turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size, torque
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.effects.traits import DriveTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("coupling", 0.0), state.joints[index - 1].coordinate) if index else 0.0


def _torques(motion: Motion, settings: Settings) -> Mapping[int, Array]:
    """What gears and a motor that both joints turn, by the sum or the difference of their speeds, ask of either drive:
    friction takes power as a whole. Nothing where either has no drive."""
    viscous, dry, apart = (settings.values.get(name, 0.0) for name in ("coefficient", "torque", "torque_apart"))
    torques: dict[int, Array] = {}
    drives = [joint.driven and not joint.passive for joint in motion.arm.joints]
    for index in range(1, motion.arm.size):
        if settings.acts_at(index) and drives[index - 1] and drives[index]:
            for item, other in ((index, index - 1), (index - 1, index)):
                one, two = motion.velocity[:, item], motion.velocity[:, other]
                more = viscous * two + dry * direction(one + two) + apart * direction(one - two)
                torques[item] = torques.get(item, np.zeros(motion.size)) + more
    return torques


JOINT_COUPLING = Effect(
    id="joint_coupling",
    title="coupling of a joint to the one before it",
    formula="sum J_i k_i q_(i-1), i from 2; of a motion d_i q'_(i-1) + f_i sign(q'_i + q'_(i-1)) "
    "+ g_i sign(q'_i - q'_(i-1)) at i, and likewise at i-1",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="angle errors",
    needs="both joints' travel, each with the other at several places",
    aliases=("encoder_scale",),
    source="J. J. Craig, Introduction to Robotics: Mechanics and Control (3rd ed., Pearson, 2005), "
    "actuator space and joint space",
    parameters=(
        size("coupling", "dimensionless", -0.5, 0.5, (1e-4, 1e-2)).means(
            "motion of the joint for one unit of the joint before (rad, m)",
            "what is left of a wrist's or belt's coupling once the controller has taken out its nominal value",
        ),
        torque("torque", "torque", -1e4, 1e4, (0.05, 3.0)).means(
            "dry friction of a motor that turns by the sum of this joint's and the joint before's speeds, at both",
            "geared wrists: 0.1 to 2 N*m",
        ),
        torque("torque_apart", "torque", -1e4, 1e4, (0.05, 3.0), optional=True).means(
            "the same by the difference", "geared wrists: 0.1 to 2 N*m"
        ),
        torque("coefficient", "viscous_friction", -1e5, 1e5, (0.05, 5.0)).means(
            "viscous friction by the other's speed, at both", "geared wrists: 0.1 to 2 N*m*s/rad"
        ),
    ),
    twists=OfDrives(_moved),
    torques=_torques,
    only="joints after the first",
    rank=190,
    linear=True,
)
