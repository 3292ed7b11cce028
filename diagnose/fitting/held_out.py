"""Rows that the fit has not seen: whole visits, payloads or stretches of time left out in turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from diagnose.patterns.basis import tip_of
from diagnose.residual.observed import Observed, poses, rms_length
from sections.numeric import Array

from .fit import normal_solution

Folds = NDArray[np.int64]
Split = TypeVar("Split")


def splits(observed: Observed, seed: int) -> dict[str, Folds]:
    """The ways to hold rows out that this recording allows, each a fold number for every reading.

    `pose blocks` (all readings of a pose stay together, neighbours in the workspace too), `random rows`, `time blocks`
    and `payloads` where there are any.
    """
    count, parts = observed.rows, observed.rules.fitting.folds
    found: dict[str, Folds] = {}
    if len(np.unique(poses(observed))) >= parts:
        found["pose blocks"] = _pose_blocks(observed)
    found["random rows"] = np.random.default_rng(seed).permutation(np.arange(count) % parts)
    if observed.recording.time is not None:
        order = np.argsort(np.argsort(observed.recording.time, kind="stable"))
        found["time blocks"] = (order * parts) // count
    payload = observed.recording.payload_mass
    if payload is not None:
        levels = np.unique(np.round(payload, 3))
        if 2 <= len(levels) <= 10:
            found["payloads"] = np.searchsorted(levels, np.round(payload, 3)).astype(np.int64)
    return found


def hardest(made: Mapping[str, Split]) -> Split:
    """The split that asks most: parts of the workspace, stretches of time where there are too few poses, else rows."""
    return next(made[name] for name in ("pose blocks", "time blocks", "random rows") if name in made)


def parts_of_workspace(observed: Observed) -> NDArray[np.int64]:
    """The part of the workspace in which each reading lies (N,), numbered: poses gathered by where the tip stands, four
    parts for each that is held out at a time where there are poses enough."""
    pose, parts = poses(observed), observed.rules.fitting.folds
    first = np.array([np.flatnonzero(pose == number)[0] for number in range(pose.max() + 1)])
    tip = tip_of(observed)[first]
    if observed.recording.touches is not None:
        # What is touched is one place or plane however the arm stands: parts of the joints' space are left out then.
        q = observed.recording.q
        tip = (q / np.maximum(np.ptp(q, axis=0), 1e-12))[first]
    cells = max(parts, min(4 * parts, len(first) // 2))
    centers = [int(np.argmin(np.sum((tip - tip.mean(axis=0)) ** 2, axis=1)))]
    distance = np.sum((tip - tip[centers[0]]) ** 2, axis=1)
    while len(centers) < cells and distance.max() > 0.0:
        centers.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.sum((tip - tip[centers[-1]]) ** 2, axis=1))
    nearest = np.argmin(((tip[:, None, :] - tip[None, centers, :]) ** 2).sum(axis=2), axis=1)
    return nearest[pose].astype(np.int64)


def _pose_blocks(observed: Observed) -> Folds:
    """Poses gathered into folds by where the tip stands, so that a fold is made of parts of the workspace."""
    return parts_of_workspace(observed) % observed.rules.fitting.folds


class HeldOut:
    """Fits to all folds but one, in turn, of any choice among some parts of a model.

    `columns` are the parts' displacements (N, C, d), `tethers` (d,) for each part what holds its sizes at nought: the
    reciprocal of their usual size over the scatter (None: nothing does). What the parts multiply to is worked out once
    a fold.
    """

    def __init__(
        self,
        observed: Observed,
        columns: Sequence[Array],
        folds: Folds,
        tethers: Sequence[Array | None] | None = None,
    ) -> None:
        self._observed, self._folds = observed, folds
        parts = list(columns) or [np.zeros((*observed.residual.shape, 0))]
        self._edges = np.cumsum([0, *(part.shape[2] for part in parts)])
        self._design = np.concatenate(parts, axis=2)
        given = list(tethers) if tethers is not None else [None] * len(parts)
        held = [np.zeros(p.shape[2]) if t is None else t for p, t in zip(parts, given, strict=True)]
        self._held = np.concatenate(held) ** 2
        scaled, target = observed.scaled(self._design), observed.scaled(observed.residual)
        size = np.sqrt(np.sum(scaled**2, axis=(0, 1)) + self._held)
        self._size = np.where(size > 0.0, size, 1.0)
        self._scaled = scaled / self._size
        self._products = [self._product(folds == fold, target) for fold in self._each]

    def _product(self, rows: NDArray[np.bool_], target: Array) -> tuple[Array, Array]:
        part = self._scaled[rows]
        flat = part.reshape(part.shape[0] * part.shape[1], part.shape[2])
        return flat.T @ flat, flat.T @ target[rows].reshape(-1)

    @property
    def _each(self) -> Sequence[int]:
        return np.unique(self._folds).tolist()

    def residual(self, which: Sequence[int] | None = None) -> Array:
        """The tip's residual (N, D), m, of each reading under a fit of some parts (all by default) that has not seen
        its fold."""
        width = self._observed.components
        left = self._observed.residual[:, :width].copy()
        spans = [np.arange(*self._edges[k : k + 2]) for k in (range(len(self._edges) - 1) if which is None else which)]
        taken = np.concatenate([np.zeros(0, dtype=np.int64), *spans])
        if len(taken) == 0 or len(self._products) == 1:
            return left
        at = np.ix_(taken, taken)
        whole = sum(gram[at] for gram, _ in self._products) + np.diag(self._held[taken] / self._size[taken] ** 2)
        against = sum(wanted[taken] for _, wanted in self._products)
        for fold, (gram, wanted) in zip(self._each, self._products, strict=True):
            values = normal_solution(whole - gram[at], against - wanted[taken])
            out = self._folds == fold
            left[out] -= self._design[out][:, :width][:, :, taken] @ (values / self._size[taken])
        return left

    def rms_of(self, drawn: Array) -> Array:
        """The RMS lengths (m, k) that fits of all parts leave held out of other residuals (N, C, k), m and rad."""
        width = self._observed.components
        left = drawn[:, :width].copy()
        if self._design.shape[2] == 0 or len(self._products) == 1:
            return np.sqrt(np.mean(np.sum(left**2, axis=1), axis=0))
        target = self._observed.scaled(drawn)
        against = [
            np.tensordot(self._scaled[self._folds == fold], target[self._folds == fold], ((0, 1), (0, 1)))
            for fold in self._each
        ]
        whole = sum(gram for gram, _ in self._products) + np.diag(self._held / self._size**2)
        for fold, (gram, _), wanted in zip(self._each, self._products, against, strict=True):
            out = self._folds == fold
            values = normal_solution(whole - gram, sum(against) - wanted) / self._size[:, None]
            left[out] -= np.tensordot(self._design[out][:, :width], values, 1)
        return np.sqrt(np.mean(np.sum(left**2, axis=1), axis=0))

    def better_by(self, which: Sequence[int], without: Sequence[int], together: NDArray[np.int64]) -> float:
        """How many standard errors lower the sum of squares that fits of some parts leave held out is than that of
        others (see `residual`): the difference over its scatter between groups of readings `together` (N,)."""
        mine, other = (np.sum(self.residual(parts) ** 2, axis=1) for parts in (which, without))
        gained = np.bincount(together, weights=other - mine)
        error = float(np.std(gained, ddof=1)) * np.sqrt(len(gained))
        return float(gained.sum()) / error if error > 0.0 else 0.0

    def rms(self, which: Sequence[int] | None = None) -> float:
        """The RMS length (m) of `residual`."""
        return rms_length(self.residual(which))


def residual_held_out(observed: Observed, columns: Sequence[Array], folds: Folds) -> Array:
    """The tip's residual (N, D), m, of each reading under a fit that has not seen its fold.

    `columns` are the displacements (N, C, d) of whatever the model fits, nuisances included.
    """
    return HeldOut(observed, columns, folds).residual()


def rms_held_out(observed: Observed, columns: Sequence[Array], folds: Folds) -> float:
    """The RMS length (m) of the residuals that `residual_held_out` gives."""
    return rms_length(residual_held_out(observed, columns, folds))
