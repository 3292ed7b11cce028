"""A sensor of torque or current does not read zero where there is none."""

from __future__ import annotations

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits

TORQUE_OFFSET = drive_effect(
    lambda motion, values, _: np.full(motion.size, values.get("torque", 0.0)),
    id="torque_offset",
    title="offset of the torque's zero",
    formula="t_i",
    cause="drives in motion",
    needs="motion both ways, at postures of which the load is known",
    aliases=("friction_asymmetry", "spring", "base_tilt"),
    source="J. Swevers, W. Verdonck & J. De Schutter, Dynamic model identification for industrial robots, IEEE Control "
    "Systems Magazine 27 (2007) 58-71, doi:10.1109/MCS.2007.904659",
    parameters=(
        torque("torque", "torque", -1e4, 1e4, (0.05, 3.0)).means(
            "what is logged where there is no torque", "current sensors and torque sensors: 1 % of their range"
        ),
    ),
    recording=RecordingTraits(of_instrument=True),
    watch=WatchTraits(lasts="a while"),
    rank=72,
)
