"""The voltage that BAM's models ask for: what a motor makes of it moves the pendulum against their friction."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from benchmarks.real.public.xl330 import voltage_by_bam
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.motion.motion import Motion

PLAIN = {"kt": 0.4, "R": 4.0, "armature": 0.002, "friction_base": 0.01, "friction_viscous": 0.004, "q_offset": 0.03}
SLOW = {"friction_stribeck": 0.02, "dtheta_stribeck": 1.5, "alpha": 1.2}
MASS, LENGTH = 0.49, 0.1


def motion() -> Motion:
    """A swing of a point mass, zero where it hangs."""
    arm = Arm("pendulum", (Joint(zero=-np.pi / 2),), (Link(LENGTH, mass=MASS, center_of_mass=LENGTH),))
    time = np.linspace(0.0, 3.0, 200)
    q, v, a = (1.1 * each[:, None] for each in (np.sin(4 * time), 4 * np.cos(4 * time), -16 * np.sin(4 * time)))
    return Motion(arm, time, q, v, a)


DRY = {"shared": 0.0, "along": 0.0, "against": 0.0, "slow": 0.0}
"""Friction by what motor and weight push against each other, by the motor, by the weight, and of slow motion by the
motor: shares of torques."""


@pytest.mark.parametrize(
    ("more", "shares", "creeping"),
    [
        ({}, {}, 0.0),
        (SLOW, {}, 0.02),
        ({"load_friction_base": 0.2}, {"shared": 0.2}, 0.0),
        (
            SLOW | {"load_friction_motor": 0.3, "load_friction_external": 0.1, "load_friction_motor_stribeck": 0.1},
            {"along": 0.3, "against": 0.1, "slow": 0.1},
            0.02,
        ),
    ],
)
def test_torques_are_in_balance(more: dict[str, float], shares: dict[str, float], creeping: float) -> None:
    swing, of = motion(), DRY | shares
    voltage = voltage_by_bam(cast(Any, SimpleNamespace(motion=swing)), PLAIN | more)
    q, v, a = swing.q[:, 0], swing.velocity[:, 0], swing.acceleration[:, 0]
    motor = 0.4 / 4.0 * (voltage - 0.4 * v)
    weight = -MASS * 9.80665 * LENGTH * np.sin(q + 0.03)
    slow = np.exp(-(np.abs(v / 1.5) ** 1.2))
    dry = 0.01 + creeping * slow + of["shared"] * np.abs(weight - motor) + of["slow"] * slow * np.abs(motor)
    dry = dry + np.abs(of["against"] * weight - of["along"] * motor)
    against = 0.004 * v + np.sign(v) * dry
    assert motor + weight - against == pytest.approx((MASS * LENGTH**2 + 0.002) * a, abs=1e-9)
