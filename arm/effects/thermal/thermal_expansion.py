"""Links lengthen as they warm, each behind the temperature recorded by the lag of its mass."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, given, size
from linkwright.core.arm.effects.traits import LinkTraits
from linkwright.core.materials.material import MissingProperty

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


class ThermalExpansionMissing(MissingProperty):
    """The model has thermal expansion, but a link's material does not say how much it expands."""

    def __init__(self, link: int) -> None:
        """`link` counts from 0."""
        super().__init__(
            "",
            "",
            f"link {link + 1} has no coefficient of thermal expansion: its material needs thermal_expansion, "
            "or the effect an expansion",
        )
        self.link = link

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the link when the error crosses between processes."""
        return ThermalExpansionMissing, (self.link,)


THERMAL_EXPANSION = Effect(
    id="thermal_expansion",
    title="thermal expansion of the links",
    formula="sum u_i alpha_i L_i dT_i, dT_i above 20 degC behind its first-order lag",
    place="link",
    cause="warming",
    needs="temperature or time, with poses in shuffled order",
    aliases=("instrument_scale", "link_length"),
    source="ISO 1:2022 (20 degC); the coefficient from the material's own source",
    parameters=(
        size("expansion", "thermal_expansion", -5e-6, 3e-4, (12e-6, 24e-6)).means(
            "coefficient of linear thermal expansion (the material's own where none is given)",
            "structural metals: EN 1993-1-1, EN 1999-1-1",
        ),
        LAG,
        given("warming", "temperature_difference", -200.0, 500.0, (1.0, 30.0)).means(
            "temperature of the link above 20 degC, in place of the arm's or the recorded one", "workshop conditions"
        ),
    ),
    twists=_twists,
    together=True,
    requires=("warming",),
    enough=((),),
    rank=80,
    linear=True,
    link=LinkTraits(built_in=False, expansion_unless="expansion"),
)
