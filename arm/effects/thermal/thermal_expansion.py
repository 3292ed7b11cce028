"""Links lengthen as they warm, each behind the temperature recorded by the lag of its mass."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import scale, times
from .effect import Effect, Parameter, Settings, Twist
from .warming import LAG, warming_of


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, link in enumerate(state.links):
        if not settings.acts_at(index):
            continue
        expansion = settings.values.get("expansion", link.beam.thermal_expansion)
        if expansion is None:
            raise ThermalExpansionMissing(index)
        warming = settings.values.get("warming")
        if warming is None:
            warming = warming_of(state, index, settings.values)
        yield Twist("link", index, scale(times(times(expansion, warming), link.beam.length), link.along))


class ThermalExpansionMissing(ValueError):
    """The model has thermal expansion, but a link's material does not say how much it expands."""

    def __init__(self, link: int) -> None:
        """`link` counts from 0."""
        super().__init__(
            f"link {link + 1} has no coefficient of thermal expansion: its material needs thermal_expansion, "
            "or the effect an expansion"
        )
        self.link = link


THERMAL_EXPANSION = Effect(
    id="thermal_expansion",
    title="thermal expansion of the links",
    formula="sum u_i alpha_i L_i dT_i, dT_i above 20 degC behind its first-order lag",
    place="link",
    cause="warming",
    automatic=False,
    needs="temperature or time, with poses in shuffled order",
    aliases=("instrument_scale", "link_length"),
    source="ISO 1:2022 (20 degC); the coefficient from the material's own source",
    parameters=(
        Parameter(
            "expansion",
            "thermal_expansion",
            "coefficient of linear thermal expansion (the material's own where none is given)",
            -5e-6,
            3e-4,
            (12e-6, 24e-6),
            "structural metals: EN 1993-1-1, EN 1999-1-1",
            role="size",
        ),
        LAG,
        Parameter(
            "warming",
            "temperature_difference",
            "temperature of the link above 20 degC, in place of the arm's or the recorded one",
            -200.0,
            500.0,
            (1.0, 30.0),
            "workshop conditions",
        ),
    ),
    twists=_twists,
    together=True,
    requires=("warming",),
    enough=((),),
)
