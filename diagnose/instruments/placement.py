"""Where the nominal arm's tip would stand, and where the measuring frame stands, in spite of rows that are wrong.

This looks for gross mistakes only; the fits of a diagnosis align frame and tool by least squares (`alignment`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array

UNDETERMINED = 1e-3
"""Of the best told direction: less of frame and tool than this is not told by the readings and is left at zero. A
target that turns by a milliradian puts a tool a metre off for a millimetre of anything."""
_STEPS = 40
_TUKEY = 4.685
"""Tukey's biweight: 95 % efficient for Gaussian noise (P. J. Huber, Robust Statistics, Wiley 1981, ch. 7)."""


@dataclass(frozen=True)
class Placement:
    """Nominal tips `modelled` (N, D) and measured ones set against them, m.

    `rotation` (D, D), `translation` (D,) and `tool` (D,) are what was let free; `residual` (N, D) is measured less
    modelled, in the base frame's directions, `modelled` holds the tool.
    """

    modelled: Array
    residual: Array
    rotation: Array
    translation: Array
    tool: Array

    @property
    def distance(self) -> Array:
        """How far the measured tip is from the nominal one, (N,), m."""
        return np.linalg.norm(self.residual, axis=1)

    @property
    def misfit(self) -> float:
        """The middle distance, m: what a majority of the rows says."""
        return float(np.median(self.distance))


def placed(arm: Arm, q: Array, measured: Array, *, frame: bool, tool: bool) -> Placement:
    """Nominal and measured tips with frame and tool free where asked, by iteratively reweighted least squares. What of
    the tool hardly shows beside the frame is left at zero."""
    width = measured.shape[1]
    tips, axes = nominal(arm, q, width)
    rotation, translation, offset = np.eye(width), np.zeros(width), np.zeros(width)
    weight = np.ones(len(q))
    if frame or tool:
        if frame:
            rotation, translation = rigid(measured, tips, weight)
        previous = np.inf
        for _ in range(_STEPS):
            at = measured @ rotation.T + translation
            residual = at - tips - axes @ offset
            distance = np.linalg.norm(residual, axis=1)
            scale = max(1.4826 * float(np.median(distance)), 1e-9)
            weight = np.clip(1.0 - (distance / (_TUKEY * scale)) ** 2, 0.0, None) ** 2
            if tool:
                # Tool and shift together: both are linear once the frame's rotation stands.
                columns = [-axes] + ([np.broadcast_to(np.eye(width), axes.shape)] if frame else [])
                matrix = np.concatenate(columns, axis=2) * weight[:, None, None]
                step = np.linalg.lstsq(
                    matrix.reshape(-1, matrix.shape[2]), -(residual * weight[:, None]).reshape(-1), rcond=UNDETERMINED
                )[0]
                offset = offset + step[:width]
            if frame:
                rotation, translation = rigid(measured, tips + axes @ offset, weight)
            if abs(previous - scale) <= 1e-6 * scale:
                break
            previous = scale
    modelled = tips + axes @ offset
    return Placement(modelled, measured @ rotation.T + translation - modelled, rotation, translation, offset)


def rigid(measured: Array, goal: Array, weight: Array | None = None) -> tuple[Array, Array]:
    """The best rotation and translation of `measured` onto `goal`, weighted or not (W. Kabsch, Acta Cryst. A32 (1976)
    922, doi:10.1107/S0567739476001873)."""
    share = None if weight is None else weight / weight.sum()
    center, end = (points.mean(axis=0) if share is None else share @ points for points in (measured, goal))
    arms = measured - center if share is None else (measured - center) * share[:, None]
    u, _, vt = np.linalg.svd(arms.T @ (goal - end))
    keep = np.eye(len(center))
    keep[-1, -1] = np.sign(np.linalg.det(vt.T @ u.T)) or 1.0
    rotation = vt.T @ keep @ u.T
    return rotation, end - rotation @ center


def determined(design: Array, target: Array) -> tuple[Array, Array]:
    """Least squares of a target (n,) by columns (n, k) in the directions alone that the readings tell, and the other
    directions (m, k): those that move less than a share of the best."""
    u, s, vt = np.linalg.svd(design, full_matrices=False)
    told = s > UNDETERMINED * s[0]
    return vt[told].T @ ((u[:, told].T @ target) / s[told]), vt[~told]


def axes_in_words(shares: Array, named: float) -> str:
    """The axes whose shares (3,) are above what is named: `x and z`; empty where none is."""
    return " and ".join(axis for axis, part in zip("xyz", shares.tolist(), strict=False) if part > named)


def turn_of(rotation: Array) -> float:
    """The angle of a rotation matrix in the plane or in space, rad."""
    if len(rotation) == 2:
        return float(abs(np.arctan2(rotation[1, 0], rotation[0, 0])))
    return float(Rotation.from_matrix(rotation).magnitude())
