"""A bent link's end slope turns everything that follows it."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.beam import BendingFactors
from linkwright.core.arm.chain.statics import LinkState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits

from .link_bending import end_bent


def end_slope(link: LinkState) -> tuple[Scalar, Scalar]:
    """Slope (rad) of a cantilever's far end towards the section's height and width: (F L^2/2 + M L + w L^3/6)/EI."""

    def forces(factors: BendingFactors) -> Vector:
        return add(
            scale(0.5 * factors.moment_deflection, link.force), scale(factors.weight_slope * (1.0 / 6.0), link.weight)
        )

    in_height, in_width = end_bent(link, forces, lambda factors: factors.moment_slope)
    return times(in_height, link.beam.length), times(in_width, link.beam.length)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        if link.beam.flexural_rigidity_height is None or not settings.acts_at(index):
            continue
        towards_height, towards_width = end_slope(link)
        turn = add(scale(towards_height, link.width), scale(towards_width, scale(-1.0, link.height)))
        yield Twist("link", index, rotation=turn)


SLOPE_PROPAGATION = Effect(
    id="slope_propagation",
    title="slopes of the bent links, carried to the tip",
    formula="z x (p - o_{i+1}) (F L^2/2 + M L + w L^3/6)/EI",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="poses that differ in the angles beyond the link",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, slopes of cantilever beams; Roark's Formulas, beam tables",
    twists=_twists,
    rank=60,
    link=LinkTraits(flexible=True, in_modes=True, along=True, turns_along=True),
)
