"""A joint rubs more at some angles than at others: a bearing stands askew, a shaft is bent."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    turn = motion.q[:, joint]
    pattern = values.get("sine", 0.0) * np.sin(turn) + values.get("cosine", 0.0) * np.cos(turn)
    return direction(motion.velocity[:, joint]) * pattern


FRICTION_PLACE = drive_effect(
    _torque,
    id="friction_place",
    title="friction that goes with the joint's angle",
    formula="sign(q'_i) (a_i sin q_i + b_i cos q_i)",
    cause="friction in motion",
    needs="a wide travel, both ways",
    aliases=("friction_load", "friction_coulomb"),
    source="B. Armstrong, Friction: experimental determination, modeling and compensation, IEEE ICRA (1988) 1422-1427, "
    "doi:10.1109/ROBOT.1988.12266",
    parameters=(
        *(
            torque(name, "torque", -1e4, 1e4, (0.05, 5.0)).means(
                f"friction that goes with the {name} of the joint's angle", "5 to 30 % of the dry friction"
            )
            for name in ("sine", "cosine")
        ),
    ),
    only="joints that turn",
    watch=WatchTraits(lasts="a while"),
    rank=186,
)
