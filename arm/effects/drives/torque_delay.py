"""Torque is logged later than the coordinates: another filter, another bus."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import RecordingTraits, WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import load_torque
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    delay = values.get("time", 0.0)
    if delay == 0.0 or motion.size < 2:
        return np.zeros(motion.size)
    return -delay * motion.rate(load_torque(motion)[:, joint])


TORQUE_DELAY = drive_effect(
    _torque,
    id="torque_delay",
    title="delay of the torque",
    formula="-d_i dtau_i/dt",
    cause="drives in motion",
    needs="fast changes of torque, and a clock",
    aliases=("armature", "link_inertial"),
    source="J. Swevers, W. Verdonck & J. De Schutter, Dynamic model identification for industrial robots, IEEE Control "
    "Systems Magazine 27 (2007) 58-71, doi:10.1109/MCS.2007.904659",
    parameters=(
        torque("time", "time", -0.2, 0.2, (2e-3, 30e-3)).means(
            "how much later the torque was taken than the coordinates logged with it",
            "filters and cycles of controllers: 2 to 30 ms",
        ),
    ),
    recording=RecordingTraits(of_instrument=True),
    together=True,
    watch=WatchTraits(lasts="a recording"),
    rank=215,
)
