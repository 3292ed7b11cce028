"""The measuring frame and the tool where nobody knows them: found by least squares before anything is diagnosed.

The frame may stand anywhere (a tracker on a tripod), so it is found exactly first (`rigid`), then frame and tool
together by Gauss-Newton. What is left of both is linear and stays among the nuisances of every fit.
Directions in which the readings hardly tell frame and tool apart (a target that never turns) are left alone, and said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.diagnose.instruments.placement import axes_in_words, determined, rigid
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

_STEPS = 30


@dataclass(frozen=True)
class Alignment:
    """Measured positions as base-frame positions: `rotation` (D, D) and `translation` (D,), m; `tool` (D,), m, is added
    to the arm's own in the last link's frame; `residual` (N, D), m, is measured less modelled after all that.
    `undetermined` are sentences on what of frame and tool the readings do not tell: it is left at zero."""

    rotation: Array
    translation: Array
    tool: Array
    residual: Array
    undetermined: tuple[str, ...] = ()


def aligned(
    recording: Recording, directions: Array, modelled: Array, *, rules: ResidualRules = RULES.residual
) -> Alignment:
    """Set measured against modelled tips (N, D), m, with frame and tool free where the recording says so; `directions`
    (N, D, D) are the last link's axes, along which a tool offset displaces the tip."""
    measured, width = recording.tip, recording.tip.shape[1]
    rotation, translation, tool = np.eye(width), np.zeros(width), np.zeros(width)
    free_frame, free_tool = recording.frame == "free", recording.tool == "free"
    if not (free_frame or free_tool):
        return Alignment(rotation, translation, tool, measured - modelled)
    if free_frame:
        rotation, translation = rigid(measured, modelled)
    turns = 1 if width == 2 else 3
    # A turn counts as what it moves at the arm's size, so that all are lengths.
    size = np.ones(width * (free_frame + free_tool) + turns * free_frame)
    if free_frame:
        size[width : width + turns] = max(float(np.sqrt(np.mean(np.sum(modelled**2, axis=1)))), 1e-12)
    undetermined: Array = np.zeros((0, len(size)))
    for _ in range(_STEPS):
        placed = measured @ rotation.T + translation
        residual = placed - modelled - directions @ tool
        center = placed.mean(axis=0)
        columns: list[Array] = []
        if free_frame:
            columns += [_frame_columns(placed - center)]
        if free_tool:
            columns += [-directions]
        design = (np.concatenate(columns, axis=2) / size).reshape(-1, len(size))
        step, undetermined = determined(design, -residual.reshape(-1))
        step /= size
        if free_frame:
            turn = _rotation(step[width : width + turns])
            rotation, translation = turn @ rotation, turn @ (translation - center) + center + step[:width]
        if free_tool:
            tool = tool + step[-width:]
        if np.abs(step).max() < 1e-12:
            break
    residual = measured @ rotation.T + translation - modelled - directions @ tool
    sentences = _sentences(undetermined, width if free_tool else 0, rules.named_part)
    return Alignment(rotation, translation, tool, residual, sentences)


def _sentences(undetermined: Array, of_tool: int, named: float) -> tuple[str, ...]:
    """What the readings do not tell of frame and tool (m, k), whose last columns are the tool's, in words."""
    if not len(undetermined):
        return ()
    shares = np.sum(undetermined**2, axis=0)
    axes = axes_in_words(shares[len(shares) - of_tool :], named)
    if axes:
        return (
            "Frame and tool are both free, and the target hardly turns. The target's place on the tool along "
            f"{axes} cannot be told apart from where the measuring frame stands. The arm file's value is "
            "kept.",
        )
    return (
        "The points that were reached lie on a line or closer. The measuring frame's turn about this line cannot be "
        "found, and is left at zero.",
    )


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
