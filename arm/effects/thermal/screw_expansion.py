"""A slide's screw or scale grows as it warms: the slide travels farther than its coordinate says."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size

from .warming import LAG, warming_of


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    growth = times(settings.values.get("expansion", 0.0), warming_of(state, index, settings.values))
    return times(growth, state.joints[index].coordinate)


SCREW_EXPANSION = Effect(
    id="screw_expansion",
    title="expansion of a slide's screw or scale",
    formula="sum J_i a_i dT_i q_i, dT_i above 20 degC behind its first-order lag",
    place="joint",
    cause="warming",
    needs="temperature, at several positions of the slide",
    aliases=("encoder_scale", "thermal_expansion"),
    source="ISO 230-3:2020 (determination of thermal effects): distortion of linear axes in motion",
    parameters=(
        size("expansion", "thermal_expansion", -1e-4, 1e-4, (5e-6, 2e-5)).means(
            "growth for one kelvin of warming above 20 degC, from the coordinate's zero on",
            "steel screws 11e-6/K, glass scales 8e-6/K; more where the recorded temperature is not the screw's",
        ),
        LAG,
    ),
    twists=OfDrives(_moved, "joints that slide"),
    requires=("warming",),
    only="joints that slide",
    linear=True,
)
