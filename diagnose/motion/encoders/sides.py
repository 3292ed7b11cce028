"""On which side of the drives each of two encoders stands, and by how much their zeros differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.effects.torques import direction
from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .serial import residual, rms, serial


@dataclass(frozen=True)
class Sides:
    """Two encoders at each drive, as a log has them.

    Args:
        offset: (n,) rad (m), by how much the second one reads more where the drive bears nothing.
        beyond_drive: Whether the first is on the link's side, and the second on the motor's.
        shown: Whether the log shows which is which: the link gives way to the load.
        late: s, by which the second is read later.
        unlike: The joints (from 1) at which the two tell of different motions, so that the second counts nowhere.
    """

    offset: Array
    beyond_drive: bool
    shown: bool
    late: float
    unlike: tuple[int, ...]


def sides(
    first: Array,
    second: Array,
    torque: Array,
    rates: tuple[Array, Array],
    *,
    said: bool,
    late: float,
    rules: Rules,
) -> Sides:
    """The sides of two encoders: a link stays behind its motor in the direction in which that pushes.

    Args:
        first: (N, n) coordinates, rad (m).
        second: (N, n) those of the second encoders.
        torque: (N, n) what the drives give; zero where that is not known.
        rates: Velocity and acceleration (N, n), rad/s and rad/s^2 (m/s, m/s^2).
        said: Whether the first encoder is beyond the drive where the log does not show it.
        late: s, by which the second was read later; that is put right already.
        rules: What is chance.
    """
    apart = second - first
    most = rules.motion.encoders_agree * float(first.std(axis=0).max())
    unlike = tuple((np.flatnonzero(apart.std(axis=0) > most) + 1).tolist())
    offset, share, slope = np.zeros(first.shape[1]), 0.0, 0.0
    for joint in range(first.shape[1]):
        # A motor's friction and its rotor take their part of its torque; one encoder may read later than the other.
        speed, speeding_up = (each[:, joint] for each in rates)
        columns = np.column_stack((np.ones(len(speed)), direction(speed), speed, speeding_up, torque[:, joint]))
        sizes = np.linalg.lstsq(columns, apart[:, joint], rcond=None)[0]
        offset[joint] = sizes[0]
        push = residual(columns[:, :-1], columns[:, -1])
        left = apart[:, joint] - columns @ sizes
        explains = 1.0 - rms(left) / max(rms(left + sizes[-1] * push), 1e-300)
        chance = serial(columns, left, np.ones(len(left), dtype=bool)).chance(-1, float(sizes[-1]))
        if explains > max(rules.motion.cut, share) and chance < rules.residual.level:
            share, slope = explains, float(sizes[-1])
    return Sides(offset, slope > 0.0 if share else said, share > 0.0, late, unlike)


def lateness(first: Array, second: Array, load: Array, velocity: Array, *, rules: Rules) -> float:
    """By how much later (s) second encoders (N, n) are read than the first: what differs in proportion to the speed
    (N, n), in the middle of the joints, beside what a load (N, n) N*m makes of the drives. Nothing where the joints do
    not agree."""
    each: list[float] = []
    for apart, speed, push in zip((second - first).T, velocity.T, load.T, strict=True):
        if np.abs(speed).max() > rules.motion.slow:
            columns = np.column_stack((speed, np.ones(len(speed)), direction(speed), push))
            each.append(-float(np.linalg.lstsq(columns, apart, rcond=None)[0][0]))
    if not each:
        return 0.0
    middle = float(np.median(each))
    return middle if np.median(np.abs(np.array(each) - middle)) < HALF * abs(middle) else 0.0
