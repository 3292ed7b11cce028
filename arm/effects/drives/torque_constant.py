"""Torque is distinguished from current by a constant that is not quite the motor's: all of it is off by one share."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import RecordingTraits
from linkwright.core.arm.motion.rigid import load_torque

TORQUE_CONSTANT = drive_effect(
    lambda motion, values, joint: values.get("excess", 0.0) * load_torque(motion)[:, joint],
    id="torque_constant",
    title="error of a torque constant",
    formula="e_i tau_i",
    cause="drives in motion",
    needs="a mass that is known for certain",
    aliases=("link_inertial", "payload", "friction_load"),
    source="M. Gautier & S. Briot, Global identification of joint drive gains and dynamic parameters of robots, ASME J."
    " Dyn. Sys. Meas. Control 136 (2014) 051025, doi:10.1115/1.4027506",
    parameters=(
        torque("excess", "dimensionless", -0.9, 3.0, (0.02, 0.15)).means(
            "how much larger the torque was logged than it is, as a share of what it is",
            "makers' figures of motors and losses in gears: 5 to 15 %",
        ),
    ),
    recording=RecordingTraits(of_instrument=True),
    rank=155,
)
