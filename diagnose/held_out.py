"""Rows that the fit has not seen: whole visits, payloads or stretches of time left out in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .fit import solved
from .observed import Observed, poses, rms_length

Array = NDArray[np.float64]
Folds = NDArray[np.int64]

_FOLDS = 5


def splits(observed: Observed, seed: int) -> dict[str, Folds]:
    """The ways to hold rows out that this recording allows, each a fold number for every reading.

    `pose blocks` (all readings of a pose stay together, neighbours in the workspace too), `random rows`, `time blocks`
    and `payloads` where there are any.
    """
    count = observed.rows
    found: dict[str, Folds] = {"pose blocks": _pose_blocks(observed)}
    found["random rows"] = np.random.default_rng(seed).permutation(np.arange(count) % _FOLDS)
    if observed.recording.time is not None:
        order = np.argsort(np.argsort(observed.recording.time, kind="stable"))
        found["time blocks"] = (order * _FOLDS) // count
    payload = observed.recording.payload_mass
    if payload is not None:
        levels = np.unique(np.round(payload, 3))
        if 2 <= len(levels) <= 10:
            found["payloads"] = np.searchsorted(levels, np.round(payload, 3)).astype(np.int64)
    return found


def _pose_blocks(observed: Observed) -> Folds:
    """Poses gathered into folds by where the tip stands, so that a fold is a part of the workspace."""
    pose = poses(observed)
    first = np.array([np.flatnonzero(pose == number)[0] for number in range(pose.max() + 1)])
    tip = np.stack(
        [np.broadcast_to(np.asarray(x, dtype=float), (observed.rows,)) for x in observed.state.tip()], axis=1
    )[first]
    if len(first) < _FOLDS:
        return pose % max(len(first), 2)
    cells = max(_FOLDS, min(4 * _FOLDS, len(first) // 2))
    centers = [int(np.argmin(np.sum((tip - tip.mean(axis=0)) ** 2, axis=1)))]
    distance = np.sum((tip - tip[centers[0]]) ** 2, axis=1)
    while len(centers) < cells and distance.max() > 0.0:
        centers.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.sum((tip - tip[centers[-1]]) ** 2, axis=1))
    nearest = np.argmin(((tip[:, None, :] - tip[None, centers, :]) ** 2).sum(axis=2), axis=1)
    return (nearest % _FOLDS)[pose].astype(np.int64)


def residual_held_out(observed: Observed, columns: Sequence[Array], folds: Folds) -> Array:
    """The tip's residual (N, D), m, of each reading under a fit that has not seen its fold.

    `columns` are the displacements (N, C, d) of whatever the model fits, nuisances included.
    """
    width = observed.components
    residual = observed.residual
    left = residual[:, :width].copy()
    design = np.concatenate(list(columns), axis=2) if columns else np.zeros((*residual.shape, 0))
    if design.size == 0:
        return left
    scaled, target = design / observed.scale[:, None], residual / observed.scale
    for fold in np.unique(folds).tolist():
        out = folds == fold
        if out.all():
            continue
        values = solved(scaled[~out].reshape(-1, scaled.shape[-1]), target[~out].reshape(-1))
        left[out] -= design[out][:, :width] @ values
    return left


def rms_held_out(observed: Observed, columns: Sequence[Array], folds: Folds) -> float:
    """The RMS length (m) of the residuals that `residual_held_out` gives."""
    return rms_length(residual_held_out(observed, columns, folds))
