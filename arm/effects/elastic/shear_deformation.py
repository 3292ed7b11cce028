"""Links give in shear: short deep links more than they bend."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import add, dot, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        in_height, in_width = link.beam.shear_rigidity_height, link.beam.shear_rigidity_width
        if in_height is None or in_width is None or not settings.acts_at(index):
            continue
        taper = link.beam.taper
        by_height = add(link.force, scale(0.5 * taper.shear_height_weight, link.weight))
        by_width = by_height
        if taper.shear_width_weight != taper.shear_height_weight:
            by_width = add(link.force, scale(0.5 * taper.shear_width_weight, link.weight))
        along_height = times(dot(by_height, link.height), link.beam.length / in_height)
        along_width = times(dot(by_width, link.width), link.beam.length / in_width)
        yield Twist("link", index, add(scale(along_height, link.height), scale(along_width, link.width)))


SHEAR_DEFORMATION = Effect(
    id="shear_deformation",
    title="shear deformation of the links",
    formula="n_i (F L + w L^2/2)/(kappa G A)",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="short deep links",
    aliases=("link_bending",),
    source="W. D. Pilkey, Analysis and Design of Elastic Beams (Wiley, 2002), shear coefficients from strain energy",
    twists=_twists,
    link=LinkTraits(flexible=True, shear_modulus="always", along=True),
)
