"""A gear does not turn with an even torque: it asks for more and less of it, k times a turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import shape, torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

_ORDERS = tuple(map(float, range(2, 421)))


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    order = values.get("order", 0.0)
    scale = order if motion.arm.joints[joint].revolute else 2.0 * np.pi * order
    phase = scale * motion.q[:, joint]
    return values.get("sine", 0.0) * np.sin(phase) + values.get("cosine", 0.0) * np.cos(phase)


GEAR_RIPPLE = drive_effect(
    _torque,
    id="gear_ripple",
    title="ripple of a gear's torque",
    formula="a_i sin k q_i + b_i cos k q_i",
    cause="drives in motion",
    needs="slow motion, sampled three times a period or more",
    aliases=("friction_place", "spring"),
    source="T. D. Tuttle & W. P. Seering, A nonlinear model of a harmonic drive gear transmission, IEEE Trans. Robotics"
    " and Automation 12 (1996) 368-374, doi:10.1109/70.499819",
    parameters=(
        *(
            torque(name, "torque", -1e3, 1e3, (0.05, 2.0)).means(
                f"torque that goes with the {name} of the order times the joint's angle",
                "harmonic drives: 1 to 10 % of the dry friction to twice as much",
            )
            for name in ("sine", "cosine")
        ),
        shape("order", "dimensionless", 0.1, 5000.0, (2.0, 320.0), whole=True, grid=_ORDERS).means(
            "periods in one turn of the joint (on a slide: in one metre)",
            "teeth of the output stage and twice that; gear ratios; pole pairs times the gear ratio",
        ),
    ),
    enough=(("sine", "order"), ("cosine", "order")),
    rank=182,
)
