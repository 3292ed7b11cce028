"""A link warmer on one side than on the other bends, the more the warmer the whole has become.

The bend is taken in proportion to the warming above 20 degC, at which the link has its nominal shape.
"""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import scale, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size

from .warming import LAG, warming_of


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    curvature = settings.values.get("curvature", 0.0)
    for index, link in enumerate(state.links):
        if curvature == 0.0 or not settings.acts_at(index):
            continue
        slope = times(times(curvature, warming_of(state, index, settings.values)), link.beam.length)
        sag = times(times(0.5, slope), link.beam.length)
        yield Twist("link", index, scale(sag, link.height), scale(slope, link.width))


THERMAL_BENDING = Effect(
    id="thermal_bending",
    title="thermal bending of the links",
    formula="n_i k_i dT_i L_i^2/2, and its slope k_i dT_i L_i carried on; k_i = alpha G/(h dT), G from bottom to top",
    place="link",
    cause="warming",
    needs="temperature",
    aliases=("gearbox_thermal",),
    source="B. A. Boley & J. H. Weiner, Theory of Thermal Stresses (Wiley, 1960), beams",
    parameters=(
        size("curvature", "curvature_per_temperature", -1e-3, 1e-3, (5e-6, 1e-4)).means(
            "curvature towards the section's height for one kelvin of warming above 20 degC",
            "12 to 24 um/(m*K) over heights of 0.1 m, with 0.05 to 0.5 of the warming between bottom and top",
        ),
        LAG,
    ),
    twists=_twists,
    together=True,
    requires=("warming",),
    rank=220,
    linear=True,
)
