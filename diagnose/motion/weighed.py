"""Torque constants that nobody says, by what the arm weighs: currents and voltages as torques, one factor at each
joint."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.torques import direction
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .log import MotionLog
from .preparation import PreparedLog


def weighed(arm: Arm, prepared: Sequence[PreparedLog], *, rules: Rules) -> list[MotionLog]:
    """The logs with currents or voltages of unknown torque constants as torques, by the constants that the arm's
    weights make.

    Drives by whose signals the weights tell nothing count as not logged: their friction alone tells no constant.

    Args:
        arm: The arm, its masses known.
        prepared: All logs; those with torques stay as they are.
        rules: From what on a weight tells a constant.

    Raises:
        InputError: The weights tell the constant of no joint.
    """
    free = [item for item in prepared if item.log.torque_constants_free]
    if not free:
        return [item.log for item in prepared]
    constants, weights = np.array([_constant(free, joint, rules) for joint in range(arm.size)]).T
    constants[weights < rules.residual.torque_seen * weights.max()] = math.nan
    if not np.isfinite(constants).any():
        message = (
            "is missing, and the arm's weights tell none: write `torque_constants: [14.9, ...]` "
            f"(N m/{free[0].log.drive.unit}, one a joint)"
        )
        raise InputError(free[0].log.settings or free[0].log.file, "torque_constants", f"{message} in recording.yaml")
    return [
        replace(item.log, torque=item.log.torque * constants, weighed=tuple(constants.tolist()))
        if item.log.torque_constants_free
        else item.log
        for item in prepared
    ]


def _constant(free: Sequence[PreparedLog], joint: int, rules: Rules) -> tuple[float, float]:
    """N*m/A (N*m/V) of a joint, by what weights make beyond friction, a drive's inertia and a constant (nan: not told),
    and how much (N*m RMS) that is."""
    weights, current, motion_columns = (
        np.concatenate(item) for item in zip(*(_rows(item, joint) for item in free), strict=True)
    )
    if len(current) <= motion_columns.shape[1]:
        return math.nan, 0.0
    basis = np.linalg.qr(motion_columns)[0]
    m, y = (item - basis @ (basis.T @ item) for item in (weights, current))
    size = math.sqrt(float(m @ m) * float(y @ y))
    enough = size > 0.0 and float(y @ m) > rules.fitting.same_way * size
    return float(m @ m) / float(y @ m) if enough else math.nan, math.sqrt(float(m @ m) / len(m))


def _rows(log: PreparedLog, joint: int) -> tuple[Array, Array, Array]:
    """Torque by weights (M,), current or voltage (M,) and what a drive has of its own (M, 4), filtered, where the joint
    moves."""
    use = log.moving[:, joint]
    parts = [np.zeros((0, 6))]
    for part, numbers, within in log.pieces():
        motion = log.piece(part)
        v, a = motion.velocity[:, joint], motion.acceleration[:, joint]
        columns = [inverse_dynamics(motion)[:, joint], log.measured[part, joint], np.ones(len(v)), direction(v)]
        parts.append(log.filtered(np.stack([*columns, v, a], axis=1))[within][use[numbers]])
    rows = np.concatenate(parts)
    return rows[:, 0], rows[:, 1], rows[:, 2:]
