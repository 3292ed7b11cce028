"""The measuring frame and the tool where nobody knows them: found by least squares before anything is diagnosed.

The frame may stand anywhere (a tracker on a tripod), so it is found exactly first (`rigid`), then frame and tool
together by Gauss-Newton. What is left of both is linear and stays among the nuisances of every fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from arm.chain.arrays import matrices
from arm.chain.statics import PoseState
from diagnose.recording import Recording
from sections.numeric import Array

from .placement import rigid

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
    # How a tool offset displaces the tip.
    directions = matrices(state.frames.orientation, recording.size, width)
    free_frame, free_tool = recording.frame == "free", recording.tool == "free"
    if not (free_frame or free_tool):
        return Alignment(rotation, translation, tool, measured - modelled)
    if free_frame:
        rotation, translation = rigid(measured, modelled)
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
    return np.asarray(Rotation.from_rotvec(turn).as_matrix())
