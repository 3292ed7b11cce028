"""A carriage tilts as it travels along its rail, and turns all that it carries.

In the plane that is pitch, about the plane's normal. In space it is roll about the rail, and pitch and yaw across it,
which go with the slide wherever joints before it have turned it. Each is as large as the others, on its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from linkwright.core.arm.chain.chain import FloatVector
from linkwright.core.arm.chain.statics import PoseState, in_base_frame
from linkwright.core.arm.chain.vectors import IDENTITY, Vector, cross, dot, scale, unit
from linkwright.core.arm.effects.effect import Disc, Effect, Interval, Settings, Twist, given
from linkwright.core.arm.effects.traits import LinkTraits, PlayTraits


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    angle = settings.values.get("angle", 0.0)
    for index, joint in enumerate(state.joints):
        if angle == 0.0 or joint.revolute or not settings.acts_at(index):
            continue
        # The shape of the rail is not moved by a load, so that nothing seats it: in every mode it counts as worst.
        for axis in IDENTITY[2:] if state.planar else _of_the_rail(state, index):
            yield Interval((Twist("joint", index, rotation=scale(angle, axis)),), 0.0)


def _of_the_rail(state: PoseState, index: int) -> Iterator[Vector]:
    """The axes of roll, pitch and yaw, in the base frame."""
    along = state.arm.joints[index].axis
    aside = unit(cast(FloatVector, cross(along, min(IDENTITY, key=lambda axis: abs(dot(along, axis))))))
    for axis in (along, aside, cast(FloatVector, cross(along, aside))):
        yield in_base_frame(state, index, axis)


RAIL_PITCH = Effect(
    id="rail_pitch",
    title="tilt of a rail's carriage",
    formula="sum psi_i x (p - p_i), roll, pitch and yaw in psi_i each <= angle, p_i the carriage of slide i",
    # The carriage is the link that the slide carries; an angle at a joint that slides would be read as a length.
    place="link",
    cause="geometry",
    needs="a level or an autocollimator on the carriage, at many places along the rail",
    aliases=("encoder_offset", "backlash"),
    source="ISO 230-1:2012: angular error motions of a linear axis, here as half of their range",
    parameters=(
        given("angle", "angle", 0.0, 5e-3, (10e-6, 200e-6)).means(
            "how far the carriage rolls, pitches and yaws, each to either side",
            "straightness of rail guides over the length of a carriage: 10 um over 0.1 to 1 m",
        ),
    ),
    play=PlayTraits(free=_play, repeats=True),
    enough=(("angle",),),
    only="joints that slide",
    link=LinkTraits(built_in=False),
)
