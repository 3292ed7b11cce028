"""A drive that runs through the joint before it is dragged along when that joint moves, and drags at it in turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size, torque
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("coupling", 0.0), state.joints[index - 1].coordinate) if index else 0.0


def _torques(motion: Motion, settings: Settings) -> Mapping[int, Array]:
    """What gears that both joints turn ask of either drive, by the other's speed: one figure for both; nothing where
    either has no drive."""
    viscous, dry = settings.values.get("coefficient", 0.0), settings.values.get("torque", 0.0)
    torques: dict[int, Array] = {}
    drives = [joint.driven and not joint.passive for joint in motion.arm.joints]
    for index in range(1, motion.arm.size):
        if settings.acts_at(index) and drives[index - 1] and drives[index]:
            for own, other in ((index, index - 1), (index - 1, index)):
                speed = motion.velocity[:, other]
                torques[own] = torques.get(own, np.zeros(motion.size)) + viscous * speed + dry * direction(speed)
    return torques


JOINT_COUPLING = Effect(
    id="joint_coupling",
    title="coupling of a joint to the one before it",
    formula="sum J_i k_i q_(i-1), i from 2; of a motion d_i q'_(i-1) + f_i sign(q'_(i-1)) at i, and likewise at i-1",
    place="joint",
    needs_drive=True,
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
            "dry friction by the direction of the joint before, and of that one by this one's",
            "geared wrists: 0.1 to 2 N*m",
        ),
        torque("coefficient", "viscous_friction", -1e5, 1e5, (0.05, 5.0)).means(
            "the same over the speed", "geared wrists: 0.1 to 2 N*m*s/rad"
        ),
    ),
    twists=OfDrives(_moved),
    torques=_torques,
    only="joints after the first",
    rank=190,
    linear=True,
)
