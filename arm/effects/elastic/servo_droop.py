"""A position loop without integral action lets its joint sag under load: command and encoder part."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size
from linkwright.core.arm.effects.traits import DriveTraits, WatchTraits


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("compliance", 0.0), state.joints[index].drive_load)


SERVO_DROOP = Effect(
    id="servo_droop",
    title="droop of the servo loops",
    formula="sum J_i tau_i / Kp_i",
    place="joint",
    drive=DriveTraits(needed=True, before_encoder=True),
    cause="flexibility",
    needs="command and encoder both logged",
    aliases=("joint_compliance",),
    source="B. Siciliano, L. Sciavicco, L. Villani & G. Oriolo, Robotics: Modelling, Planning and Control "
    "(Springer, 2009), PD control without compensation of gravity, doi:10.1007/978-1-84628-642-1",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-1, (1e-6, 1e-3)).means(
            "reciprocal of the position loop's gain Kp", "up to 30 mrad under the torques of light arms"
        ),
    ),
    twists=OfDrives(_moved),
    watch=WatchTraits(lasts="a while"),
    rank=320,
    linear=True,
)
