"""Friction changes as the grease warms: along a log, or with the temperature that it holds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import shape, torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    way = direction(motion.velocity[:, joint])
    warmed = 1.0 - np.exp(-motion.time / values.get("time", 300.0))
    result = values.get("torque", 0.0) * way * warmed
    if motion.temperature is None:
        return result
    return result + values.get("per_kelvin", 0.0) * way * (motion.temperature - REFERENCE_TEMPERATURE)


FRICTION_WARMUP = drive_effect(
    _torque,
    id="friction_warmup",
    title="friction that falls as it warms",
    formula="f_i sign(q'_i) (1 - exp(-t/T)), or h_i sign(q'_i) (temperature - 20 degC)",
    cause="friction in motion",
    needs="the same motion early and late, or a temperature",
    aliases=("friction_coulomb",),
    source="A. C. Bittencourt & S. Gunnarsson, Static friction in a robot joint - modeling and identification of load "
    "and temperature effects, ASME J. Dyn. Sys. Meas. Control 134 (2012) 051013, doi:10.1115/1.4006589",
    parameters=(
        torque("torque", "torque", -1e4, 1e4, (-5.0, -0.1)).means(
            "friction when warm beyond that at the log's beginning", "-20 to -45 % of the dry friction"
        ),
        torque("per_kelvin", "torque_per_temperature", -1e3, 1e3, (-0.5, -0.01), optional=True).means(
            "change of friction by the temperature that was logged, above 20 degC", "-1 to -2 % of the dry friction"
        ),
        shape("time", "time", 1.0, 1e5, (60.0, 1800.0), grid=(12.0, 60.0, 300.0, 1800.0), default=300.0).means(
            "time after which 63 % of the change is done", "12 s of a film of grease to 30 min of a gearbox"
        ),
    ),
    watch=WatchTraits(lasts="a recording"),
    rank=165,
)
