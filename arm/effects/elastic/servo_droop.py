"""A position loop without integral action lets its joint sag under load: command and encoder part."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import times
from .effect import Effect, Parameter, Settings, Twist, drive_motion


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    compliance = settings.values.get("compliance", 0.0)
    for index, joint in enumerate(state.joints):
        if compliance != 0.0 and settings.acts_at(index):
            yield from drive_motion(state, index, times(compliance, joint.drive_load))


SERVO_DROOP = Effect(
    id="servo_droop",
    title="droop of the servo loops",
    formula="sum J_i tau_i / Kp_i",
    place="joint",
    cause="flexibility",
    automatic=False,
    needs="command and encoder both logged",
    aliases=("joint_compliance",),
    source="B. Siciliano, L. Sciavicco, L. Villani & G. Oriolo, Robotics: Modelling, Planning and Control "
    "(Springer, 2009), PD control without compensation of gravity, doi:10.1007/978-1-84628-642-1",
    parameters=(
        Parameter(
            "compliance",
            "compliance",
            "reciprocal of the position loop's gain Kp",
            0.0,
            1e-1,
            (1e-6, 1e-3),
            "up to 30 mrad under the torques of light arms",
            role="size",
        ),
    ),
    twists=_twists,
    before_encoder=True,
)
