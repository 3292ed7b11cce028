"""A rail is not straight: its carriage stands anywhere within a tolerance zone across the direction of travel."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import scale
from linkwright.core.arm.effects.effect import Disc, Effect, Interval, Settings, Twist, given
from linkwright.core.arm.effects.traits import PlayTraits


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    deviation = settings.values.get("deviation", 0.0)
    for index, joint in enumerate(state.joints):
        if deviation == 0.0 or joint.revolute or not settings.acts_at(index):
            continue
        # The shape of the rail is not moved by a load, so that nothing seats it: in every mode it counts as worst.
        if state.planar:
            across = (-joint.axis[1], joint.axis[0], 0.0)
            yield Interval((Twist("joint", index, scale(deviation, across)),), 0.0)
        else:
            yield Disc(index, deviation, joint.axis, (0.0, 0.0, 0.0))


RAIL_STRAIGHTNESS = Effect(
    id="rail_straightness",
    title="straightness of a rail",
    formula="sum s_i n_i, |s_i| <= deviation, n_i across slide i",
    place="joint",
    cause="geometry",
    needs="a target on the carriage, at many places along the rail",
    aliases=("clearance",),
    source="ISO 230-1:2012: straightness error motions of a linear axis, here as the zone's half width",
    parameters=(
        given("deviation", "length", 0.0, 5e-3, (5e-6, 100e-6)).means(
            "half the width of the zone within which the carriage's path lies",
            "profiled rail guides: running parallelism of some 10 um a metre; rails on welded frames: ten times that",
        ),
    ),
    play=PlayTraits(free=_play, repeats=True),
    enough=(("deviation",),),
    only="joints that slide",
)
