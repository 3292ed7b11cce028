"""A drive that runs through the joint before it is dragged along when that joint moves."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("coupling", 0.0), state.joints[index - 1].coordinate) if index else 0.0


JOINT_COUPLING = Effect(
    id="joint_coupling",
    title="coupling of a joint to the one before it",
    formula="sum J_i k_i q_(i-1), i from 2",
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
    ),
    twists=OfDrives(_moved),
    only="joints after the first",
    rank=190,
    linear=True,
)
