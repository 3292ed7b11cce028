"""Links bend as cantilevers: the displacement of each link's far end against its joint."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import LinkState, PoseState
from ..vectors import Scalar, Vector, add, dot, plus, scale, times
from .effect import Effect, Settings, Twist


def bent_end(link: LinkState, direction: Vector, turning: Vector, rigidity: Scalar) -> Scalar:
    """Deflection (m) along `direction` of a cantilever's far end: (F L^3/3 + M L^2/2 + w L^4/8)/EI.

    `turning` is the axis (unit) about which a positive moment bends towards `direction`; `rigidity` is EI in N*m^2.
    """
    length = link.beam.length
    transverse = dot(add(scale(1.0 / 3.0, link.force), scale(0.125, link.weight)), direction)
    moment = times(0.5, dot(link.moment, turning))
    return times(plus(times(length, transverse), moment), length * length / rigidity)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        in_height, in_width = link.beam.flexural_rigidity_height, link.beam.flexural_rigidity_width
        if in_height is None or in_width is None or not settings.acts_at(index):
            continue
        along_height = bent_end(link, link.height, link.width, in_height)
        along_width = bent_end(link, link.width, scale(-1.0, link.height), in_width)
        yield Twist("link", index, add(scale(along_height, link.height), scale(along_width, link.width)))


LINK_BENDING = Effect(
    id="link_bending",
    title="bending of the links",
    formula="n_i (F L^3/3 + M L^2/2 + w L^4/8)/EI",
    place="link",
    automatic=True,
    needs="two slopes of the link, or two payloads",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, deflections of cantilever beams; Roark's Formulas, beam tables",
    twists=_twists,
)
