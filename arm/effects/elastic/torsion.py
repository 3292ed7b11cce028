"""Links twist about their shear centres, which shifts their centroids and turns everything that follows them."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import LinkState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, add, dot, minus, plus, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits


def about_shear_centre(link: LinkState, force: Vector) -> Scalar:
    """The torque (N*m) about a link's shear centre of a force (N) at its centroid."""
    height, width = link.beam.shear_centre_height, link.beam.shear_centre_width
    return minus(times(width, dot(force, link.height)), times(height, dot(force, link.width)))


def twist_and_shift(link: LinkState) -> tuple[Scalar, Vector]:
    """The twist (rad) of a link's far end about the link, and the shift (m) of its centroid by it."""
    beam, flexibility = link.beam, link.beam.length / link.beam.torsional_rigidity
    by_force = about_shear_centre(link, link.force)
    by_weight = about_shear_centre(link, link.weight)
    eccentric = plus(by_force, times(0.5, times(beam.torsion_by_weight, by_weight)))
    twist = times(plus(dot(link.moment, link.along), eccentric), flexibility)
    # Where the shear centre runs askew along a tapered link, its eccentricity counts with its square's mean.
    spread = times(minus(beam.taper.offset_square, 1.0), times(eccentric, flexibility))
    shift = plus(twist, spread)
    up, aside = times(shift, beam.shear_centre_width), times(shift, beam.shear_centre_height)
    return twist, add(scale(up, link.height), scale(times(-1.0, aside), link.width))


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        if link.beam.torsional_rigidity is None or not settings.acts_at(index):
            continue
        twist, shift = twist_and_shift(link)
        yield Twist("link", index, shift, rotation=scale(twist, link.along))


TORSION = Effect(
    id="torsion",
    title="torsion of the links",
    formula="u_i x (p - o_{i+1} - e) T L/GJ, T = (M - e x (F + w L/2)).u_i, e from centroid to shear centre",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="a chain in space whose links carry torques about themselves, or open sections loaded off their shear centre",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, torsion, shear centre; V. Z. Vlasov, Thin-walled Elastic Beams "
    "(Jerusalem 1961): warping is held at joints and free at the tip",
    twists=_twists,
    link=LinkTraits(flexible=True, in_modes=True, shear_modulus="in space", along=True),
)
