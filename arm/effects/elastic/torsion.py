"""Links twist about their own axis, which turns everything that follows them."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import dot, scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        rigidity = link.beam.torsional_rigidity
        if rigidity is None or not settings.acts_at(index):
            continue
        torque = dot(link.moment, link.along)
        yield Twist("link", index, rotation=scale(times(torque, link.beam.length / rigidity), link.along))


TORSION = Effect(
    id="torsion",
    title="torsion of the links",
    formula="u_i x (p - o_{i+1}) T L/GJ",
    place="link",
    cause="flexibility",
    automatic=True,
    needs="a chain in space whose links carry torques about themselves",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, torsion; Saint-Venant torsion, free warping",
    twists=_twists,
    flexible=True,
    in_modes=True,
    shear_modulus="in space",
    along_the_link=True,
)
