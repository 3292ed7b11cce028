"""Links lengthen and shorten under the force along them."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import add, dot, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        rigidity = link.beam.axial_rigidity
        if rigidity is None or not settings.acts_at(index):
            continue
        mean_force = dot(add(link.force, scale(0.5 * link.beam.taper.axial_weight, link.weight)), link.along)
        yield Twist("link", index, scale(times(mean_force, link.beam.length / rigidity), link.along))


AXIAL = Effect(
    id="axial",
    title="axial strain of the links",
    formula="u_i (N L + w_a L^2/2)/EA",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="more resolution than most instruments have",
    aliases=(),
    source="Gere & Goodno, Mechanics of Materials, axially loaded members",
    twists=_twists,
    link=LinkTraits(flexible=True, in_modes=True, along=True),
)
