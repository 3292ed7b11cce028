"""More friction under load where a joint creeps: grease parts loaded teeth only once they move."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import shape, torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import load_torque
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    speed = motion.velocity[:, joint]
    load = np.abs(load_torque(motion)[:, joint]) * np.exp(-np.abs(speed) / values.get("speed", 0.1))
    return values.get("share", 0.0) * load * direction(speed)


FRICTION_LOAD_STRIBECK = drive_effect(
    _torque,
    id="friction_load_stribeck",
    title="more friction under load at low speed",
    formula="mu_i |tau_i| sign(q'_i) exp(-|q'_i|/v_s)",
    cause="friction in motion",
    needs="slow motion beside fast, both ways, under several loads",
    aliases=("friction_load", "friction_stribeck", "friction_coulomb"),
    source="A. C. Bittencourt & S. Gunnarsson, Static friction in a robot joint: modeling and identification of load "
    "and temperature effects, ASME J. Dyn. Sys. Meas. Control 134 (2012) 051013, doi:10.1115/1.4006589",
    parameters=(
        torque("share", "dimensionless", -1.0, 2.0, (0.02, 0.3)).means(
            "share of the load that friction of a joint that hardly moves takes beyond that of one that does",
            "a robot's second joint: as much again as friction under load at speed",
        ),
        shape("speed", "angular_speed", 1e-4, 10.0, (0.03, 0.3), grid=(0.03, 0.1, 0.3), default=0.1).means(
            "speed at which it has fallen to 37 %", "greased gears: 0.03 to 0.3 rad/s at the joint"
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=115,
)
