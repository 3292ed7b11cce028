"""The measuring frame and the tool where nobody knows them: found by least squares before anything is diagnosed.

The frame may stand anywhere (a tracker on a tripod), so it is found exactly first: the rotation by the singular value
decomposition of W. Kabsch, Acta Cryst. A32 (1976) 922, doi:10.1107/S0567739476001873, then frame and tool together by
Gauss-Newton. What is left of both is linear and stays among the nuisances of every fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arm.statics import PoseState

from .recording import Recording

Array = NDArray[np.float64]

_STEPS = 30


@dataclass(frozen=True)
class Alignment:
    """Measured positions as base-frame positions: `rotation` (D, D) and `translation` (D,), m; `tool` (D,), m, is added
    to the arm's own in the last link's frame; `residual` (N, D), m, is measured less modelled after all that."""

    rotation: Array
    translation: Array
    tool: Array
    residual: Array

    def in_base(self, measured: Array) -> Array:
        """Measured positions (N, D) in the base frame, m."""
        return measured @ self.rotation.T + self.translation


def aligned(recording: Recording, state: PoseState, modelled: Array) -> Alignment:
    """Set measured against modelled tips (N, D), m, with frame and tool free where the recording says so."""
    measured, width = recording.tip, recording.tip.shape[1]
    rotation, translation, tool = np.eye(width), np.zeros(width), np.zeros(width)
    directions = tool_directions(state, recording.size, width)
    free_frame, free_tool = recording.frame == "free", recording.tool == "free"
    if not (free_frame or free_tool):
        return Alignment(rotation, translation, tool, measured - modelled)
    if free_frame:
        rotation, translation = _rigid(measured, modelled)
    for _ in range(_STEPS):
        placed = measured @ rotation.T + translation
        residual = placed - modelled - directions @ tool
        columns: list[Array] = []
        if free_frame:
            columns += [_frame_columns(placed)]
        if free_tool:
            columns += [-directions]
        step = np.linalg.lstsq(np.concatenate(columns, axis=2).reshape(-1, sum(c.shape[2] for c in columns)),
                               -residual.reshape(-1), rcond=1e-10)[0]  # fmt: skip
        turns = 1 if width == 2 else 3
        if free_frame:
            turn = _rotation(step[width : width + turns])
            rotation, translation = turn @ rotation, turn @ translation + step[:width]
        if free_tool:
            tool = tool + step[-width:]
        if np.abs(step).max() < 1e-12:
            break
    residual = measured @ rotation.T + translation - modelled - directions @ tool
    return Alignment(rotation, translation, tool, residual)


def tool_directions(state: PoseState, rows: int, width: int) -> Array:
    """The last link's axes in the base frame, (N, D, D): how a tool offset displaces the tip."""
    matrix = state.frames.orientation
    full = [
        [np.broadcast_to(np.asarray(matrix[i][j], dtype=float), (rows,)) for j in range(width)] for i in range(width)
    ]
    return np.stack([np.stack(row, axis=1) for row in full], axis=1)


def _rigid(measured: Array, modelled: Array) -> tuple[Array, Array]:
    """Rotation and translation that bring `measured` closest to `modelled`."""
    center, goal = measured.mean(axis=0), modelled.mean(axis=0)
    u, _, vt = np.linalg.svd((measured - center).T @ (modelled - goal))
    keep = np.eye(len(center))
    keep[-1, -1] = np.sign(np.linalg.det(vt.T @ u.T)) or 1.0
    rotation = vt.T @ keep @ u.T
    return rotation, goal - rotation @ center


def _frame_columns(points: Array) -> Array:
    """How points (N, D) move with a shift and a small turn of the frame, (N, D, 3 or 6)."""
    count, width = points.shape
    shift = np.broadcast_to(np.eye(width), (count, width, width))
    if width == 2:
        turn = np.stack([-points[:, 1], points[:, 0]], axis=1)[:, :, None]
    else:
        axes = np.eye(3)
        turn = np.stack([np.cross(axis, points) for axis in axes], axis=2)
    return np.concatenate([shift, turn], axis=2)


def _rotation(turn: NDArray[np.floating[Any]]) -> Array:
    """The rotation matrix of a rotation vector (one number in the plane)."""
    if len(turn) == 1:
        c, s = np.cos(turn[0]), np.sin(turn[0])
        return np.array([[c, -s], [s, c]])
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(turn).as_matrix())
