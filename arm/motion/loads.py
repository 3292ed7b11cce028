"""Load of each drive over a motion: peak torque and speed, power, and energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Joint

from .dynamics import drive_power, model_torque
from .motion import Motion


@dataclass(frozen=True)
class OfDrive:
    """What a motion asks of one drive, by the arm's whole model: the greatest `torque` (N*m; N for a slide) to either
    side and its root mean square `rms_torque` over time, the greatest `speed` (rad/s, m/s) and `power` (W), the
    `energy` (J) that the drive puts in and what it brakes off again (`braked`)."""

    torque: float
    rms_torque: float
    speed: float
    power: float
    energy: float
    braked: float

    def uses(self, joint: Joint) -> tuple[float | None, float | None]:
        """What share of its joint's peak torque the greatest torque takes, and of its rated one the root mean square;
        None where nobody knows those."""
        rated, peak = joint.rating
        return None if peak is None else self.torque / peak, None if rated is None else self.rms_torque / rated


def loads_of(motion: Motion) -> tuple[OfDrive, ...]:
    """What a motion asks of each of an arm's drives, by the rigid arm and its `effects`; integrals by trapezoids.

    Raises `PropertyNeeded` for a link of unknown mass, `InputError` for an arm with branches or links that run out.
    """
    torque = model_torque(motion)
    power = drive_power(motion, torque)
    span = float(motion.time[-1] - motion.time[0])
    loads: list[OfDrive] = []
    for item, speed, work in zip(torque.T, motion.velocity.T, power.T, strict=True):
        loads.append(
            OfDrive(
                torque=float(np.abs(item).max()),
                rms_torque=float(np.sqrt(np.trapezoid(item**2, motion.time) / span)),
                speed=float(np.abs(speed).max()),
                power=float(work.max()),
                energy=float(np.trapezoid(np.maximum(work, 0.0), motion.time)),
                braked=float(-np.trapezoid(np.minimum(work, 0.0), motion.time)),
            )
        )
    return tuple(loads)
