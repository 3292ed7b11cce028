"""A drive that gives: the arm behind it lags, and swings at its natural frequency."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import load_torque
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    size = values.get("time_squared", 0.0)
    if size == 0.0 or motion.size < 3:
        return np.zeros(motion.size)
    return -size * motion.rate(motion.rate(load_torque(motion)[:, joint]))


JOINT_RESONANCE = drive_effect(
    _torque,
    id="joint_resonance",
    title="resonance of an elastic joint",
    formula="-(1/omega_i)^2 d^2 tau_i/dt^2",
    cause="drives in motion",
    needs="fast changes of torque, sampled well above the resonance",
    aliases=("armature", "torque_delay"),
    source="M. W. Spong, Modeling and Control of Elastic Joint Robots, ASME J. Dyn. Sys. Meas. Control 109 (1987) "
    "310-319, doi:10.1115/1.3143860",
    parameters=(
        torque("time_squared", "time_squared", -0.1, 0.1, (1e-4, 1e-3)).means(
            "one over the square of the angular frequency at which the joint swings, (2 pi f)^-2: of 5 Hz 1.0e-3 s^2",
            "robots under load: 5 to 15 Hz",
        ),
    ),
    rank=216,
)
