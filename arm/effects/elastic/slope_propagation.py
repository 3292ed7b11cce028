"""A bent link's end slope turns everything that follows it."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.beam import BendingFactors
from linkwright.core.arm.chain.statics import LinkState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, dot, plus, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits

from .link_bending import in_both_planes


def end_slope(link: LinkState) -> tuple[Scalar, Scalar]:
    """Slope (rad) of a cantilever's far end towards the section's height and width: (F L^2/2 + M L + w L^3/6)/EI."""
    length, taper = link.beam.length, link.beam.taper

    def forces(factors: BendingFactors) -> Vector:
        return add(
            scale(0.5 * factors.moment_deflection, link.force), scale(factors.weight_slope * (1.0 / 6.0), link.weight)
        )

    def load(force: Vector, direction: Vector, turning: Vector, factors: BendingFactors) -> Scalar:
        """`turning` is the axis about which a positive moment bends towards `direction`."""
        return plus(times(length, dot(force, direction)), times(factors.moment_slope, dot(link.moment, turning)))

    by_height = forces(taper.height)
    by_width = by_height if taper.width is taper.height else forces(taper.width)
    towards_height = load(by_height, link.height, link.width, taper.height)
    towards_width = load(by_width, link.width, scale(-1.0, link.height), taper.width)
    in_height, in_width = in_both_planes(link, towards_height, towards_width)
    return times(in_height, length), times(in_width, length)


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
