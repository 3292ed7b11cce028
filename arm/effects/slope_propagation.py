"""A bent link's end slope turns everything that follows it."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import LinkState, PoseState
from ..vectors import Scalar, Vector, add, dot, plus, scale, times
from .effect import Effect, Settings, Twist


def end_slope(link: LinkState, direction: Vector, turning: Vector, rigidity: Scalar) -> Scalar:
    """Slope (rad) of a cantilever's far end towards `direction`: (F L^2/2 + M L + w L^3/6)/EI, EI in N*m^2."""
    length = link.beam.length
    transverse = dot(add(scale(0.5, link.force), scale(1.0 / 6.0, link.weight)), direction)
    return times(plus(times(length, transverse), dot(link.moment, turning)), length / rigidity)


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        in_height, in_width = link.beam.flexural_rigidity_height, link.beam.flexural_rigidity_width
        if in_height is None or in_width is None or not settings.acts_at(index):
            continue
        towards_height = end_slope(link, link.height, link.width, in_height)
        towards_width = end_slope(link, link.width, scale(-1.0, link.height), in_width)
        turn = add(scale(towards_height, link.width), scale(towards_width, scale(-1.0, link.height)))
        yield Twist("link", index, rotation=turn)


SLOPE_PROPAGATION = Effect(
    id="slope_propagation",
    title="slopes of the bent links, carried to the tip",
    formula="z x (p - o_{i+1}) (F L^2/2 + M L + w L^3/6)/EI",
    place="link",
    automatic=True,
    needs="poses that differ in the angles beyond the link",
    aliases=("joint_compliance",),
    source="Gere & Goodno, Mechanics of Materials, slopes of cantilever beams; Roark's Formulas, beam tables",
    twists=_twists,
)
