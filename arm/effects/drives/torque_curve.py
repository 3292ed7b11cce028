"""A torque of any shape over one joint's angle: a cable package, a stop of rubber, a spring that is not straight."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

_ANGLES = tuple(range(0, 360, 5))
"""deg, of the table."""


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    table = np.array([values.get(f"torque_{angle}", 0.0) for angle in _ANGLES])
    return np.interp(motion.q[:, joint], np.radians(_ANGLES), table, period=2.0 * np.pi)


TORQUE_CURVE = drive_effect(
    _torque,
    id="torque_curve",
    title="torque that goes with the joint's angle",
    formula="t_i(q_i), straight between the angles of a table",
    cause="drives in motion",
    only="joints that turn",
    needs="slow motion through the whole range, several times",
    aliases=("spring", "torque_offset", "counterbalance", "gear_ripple", "link_inertial"),
    source="C. de Boor, A Practical Guide to Splines (Springer, 1978), ch. 3; cables: Y. Wang, R. Gondokaryono, "
    "A. Munawar & G. S. Fischer, IEEE Robotics and Automation Letters 4 (2019) 3657-3664, "
    "doi:10.1109/LRA.2019.2927947",
    parameters=tuple(
        torque(f"torque_{angle}", "torque", -1e4, 1e4, (0.05, 5.0), label=f"torque at {angle} deg").means(
            f"torque that the drive gives at {angle} deg", "cable packages: 0.1 to 10 N*m"
        )
        for angle in _ANGLES
    ),
    recording=RecordingTraits(last_resort=True),
    watch=WatchTraits(lasts="a while"),
    rank=400,
)
