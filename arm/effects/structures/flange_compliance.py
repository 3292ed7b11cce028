"""A flange gives under the moment at a link's far end, which turns all that follows it.

It is in the model wherever a link has a `flange` with a stiffness.
"""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, add, dot, is_zero, scale, subtract
from linkwright.core.arm.effects.effect import Effect, Settings, Twist
from linkwright.core.arm.effects.traits import LinkTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        flange = state.arm.links[index].flange
        if flange is None or not settings.acts_at(index):
            continue
        about = scale(dot(link.moment, link.along), link.along)
        turn = ZERO
        if flange.tilting_stiffness is not None:
            turn = scale(1.0 / flange.tilting_stiffness, subtract(link.moment, about))
        # In the plane all moments lie across the links: what rounding leaves along them is not physics.
        if flange.torsional_stiffness is not None and not state.planar:
            turn = add(turn, scale(1.0 / flange.torsional_stiffness, about))
        if not is_zero(turn):
            yield Twist("link", index, rotation=turn)


FLANGE_COMPLIANCE = Effect(
    id="flange_compliance",
    title="compliance of the links' flanges",
    formula="((M - (M.u_i) u_i)/K_tilt + (M.u_i) u_i/K_torsion) x (p - o_{i+1}), M the moment at the far end of link i",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="two loads, and poses that differ in the angles beyond the link",
    aliases=("link_bending", "lateral_compliance"),
    source="A. Klimchik, A. Pashkevich & D. Chablat, Fundamentals of manipulator stiffness modeling using matrix "
    "structural analysis, Mech. Mach. Theory 133 (2019) 365, doi:10.1016/j.mechmachtheory.2018.11.023: elastic joints",
    twists=_twists,
    rank=236,
    link=LinkTraits(flexible=True),
)
