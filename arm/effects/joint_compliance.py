"""Drives give under the torque (or force) that they hold."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import times
from .effect import Effect, Parameter, Settings, Twist, drive_motion


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, joint in enumerate(state.joints):
        if not settings.acts_at(index):
            continue
        if "compliance" in settings.values:
            yield from drive_motion(state, index, times(settings.values["compliance"], joint.drive_load))
            continue
        stiffness = settings.values.get("stiffness", joint.stiffness)
        if stiffness is not None:
            yield from drive_motion(state, index, joint.drive_load / stiffness)


JOINT_COMPLIANCE = Effect(
    id="joint_compliance",
    title="compliance of the drives",
    formula="sum J_i tau_i / K_i",
    place="joint",
    cause="flexibility",
    automatic=True,
    needs="two payloads, or joint-side encoders",
    aliases=("link_bending", "servo_droop", "base_compliance"),
    source="M. W. Spong, Modeling and Control of Elastic Joint Robots, ASME J. Dyn. Sys. 109 (1987), "
    "doi:10.1115/1.3143860",
    parameters=(
        Parameter(
            "stiffness",
            "torsional_stiffness",
            "torsional stiffness of the drive",
            1e2,
            1e9,
            (1e4, 4e6),
            "range from small harmonic drives to large machine-tool drives",
        ),
        Parameter(
            "compliance",
            "compliance",
            "compliance of the drive beyond what the arm file gives it",
            -1e-2,
            1e-2,
            (2.5e-7, 1e-4),
            "the reciprocal of the same stiffnesses",
            role="size",
        ),
    ),
    twists=_twists,
)
