"""A joint turns a little as its gearbox and housing warm. The warming is that of the link it carries."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size
from linkwright.core.arm.effects.traits import DriveTraits

from .warming import LAG, warming_of


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("per_kelvin", 0.0), warming_of(state, index, settings.values))


GEARBOX_THERMAL = Effect(
    id="gearbox_thermal",
    title="thermal motion of the joints",
    formula="sum J_i g_i dT_i, dT_i above 20 degC behind its first-order lag",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="warming",
    needs="temperature",
    aliases=("thermal_bending", "frame_drift"),
    source="ISO 230-3:2020 (determination of thermal effects)",
    parameters=(
        size("per_kelvin", "angle_per_temperature", -1e-3, 1e-3, (1e-6, 1e-5)).means(
            "motion of the joint for one kelvin of warming above 20 degC", "0.01 to 0.1 mrad for 10 K"
        ),
        LAG,
    ),
    twists=OfDrives(_moved),
    requires=("warming",),
    rank=210,
    linear=True,
)
