"""Inverse dynamics by MuJoCo, row by row, and logs as CSV."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from linkwright.core.sections.numeric import Array


def inverse(model: mujoco.MjModel, q: Array, velocity: Array, acceleration: Array) -> Array:
    """The torques (N, n) that give a model these motions (N, n each)."""
    data, torque = mujoco.MjData(model), np.zeros(q.shape)
    for row in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[row], velocity[row], acceleration[row]
        mujoco.mj_inverse(model, data)
        torque[row] = data.qfrc_inverse
    return torque


def as_csv(names: Sequence[str], *columns: Array) -> str:
    """Columns as text with seven digits."""
    rows = np.column_stack(columns).tolist()
    return "\n".join([",".join(names), *(",".join(f"{item:.7g}" for item in row) for row in rows)])
