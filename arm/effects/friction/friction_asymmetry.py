"""A joint rubs more one way than the other."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits

FRICTION_ASYMMETRY = drive_effect(
    lambda motion, values, joint: values.get("torque", 0.0) * 0.5 * (1.0 + direction(motion.velocity[:, joint])),
    id="friction_asymmetry",
    title="friction that differs with the direction",
    formula="f_i (1 + sign(q'_i))/2",
    cause="friction in motion",
    needs="motion both ways",
    aliases=("torque_offset", "friction_coulomb"),
    source="J. Swevers, W. Verdonck & J. De Schutter, Dynamic model identification for industrial robots, IEEE Control "
    "Systems Magazine 27 (2007) 58-71, doi:10.1109/MCS.2007.904659",
    parameters=(
        torque("torque", "torque", -1e4, 1e4, (0.1, 5.0)).means(
            "friction towards increasing coordinates beyond that the other way", "up to a third of the dry friction"
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=145,
)
