"""Rows that the fit has not seen: whole visits, payloads or stretches of time left out in turn."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.patterns.basis import tip_of
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.visits import poses
from linkwright.core.sections.numeric import Array

from .fit import normal_solution
from .shared_masses import Shared, Steps

Folds = NDArray[np.int64]
Split = TypeVar("Split")

_FOLDS = 5
_MOST_PARTS = 4 * _FOLDS
_TOLD = 1e-12
"""Of the largest, what directions of normal equations below are told by nothing, as in `normal_solution`."""


def splits(observed: Observed, seed: int) -> dict[str, Folds]:
    """The ways to hold rows out that this recording allows, each a fold number for every reading.

    `pose blocks` (all readings of a pose stay together, neighbours in the workspace too; each pose by itself where they
    are few), `random rows`, `time blocks` and `payloads` where there are any.
    """
    count, parts = observed.rows, _FOLDS
    folds: dict[str, Folds] = {}
    if len(np.unique(poses(observed))) >= parts:
        folds["pose blocks"] = _pose_blocks(observed)
    folds["random rows"] = np.random.default_rng(seed).permutation(np.arange(count) % parts)
    if observed.recording.time is not None:
        order = np.argsort(np.argsort(observed.recording.time, kind="stable"))
        folds["time blocks"] = (order * parts) // count
    payload = observed.recording.payload_mass
    if payload is not None:
        levels = np.unique(np.round(payload, 3))
        if 2 <= len(levels) <= 10:
            folds["payloads"] = np.searchsorted(levels, np.round(payload, 3)).astype(np.int64)
    return folds


def hardest(made: Mapping[str, Split]) -> Split:
    """The split that asks most: parts of the workspace, stretches of time where there are too few poses, else rows."""
    return next(made[name] for name in ("pose blocks", "time blocks", "random rows") if name in made)


def parts_of_workspace(observed: Observed) -> NDArray[np.int64]:
    """The part of the workspace in which each reading lies (N,), numbered: poses gathered by where the tip stands, four
    parts for each that is held out at a time where there are poses enough.

    Where there are fewer than two poses a part, each is a part: gathered, half of them may go at once, and what is left
    tells nothing.
    """
    pose, parts = poses(observed), _FOLDS
    if _few(observed):
        return pose
    first = np.array([np.flatnonzero(pose == number)[0] for number in range(pose.max() + 1)])
    tip = tip_of(observed)[first]
    if observed.recording.touches is not None:
        # What is touched is one place or plane however the arm stands: parts of the joints' space are left out then.
        q = observed.recording.q
        tip = (q / np.maximum(np.ptp(q, axis=0), 1e-12))[first]
    cells = max(parts, min(_MOST_PARTS, len(first) // 2))
    centers = [int(np.argmin(np.sum((tip - tip.mean(axis=0)) ** 2, axis=1)))]
    distance = np.sum((tip - tip[centers[0]]) ** 2, axis=1)
    while len(centers) < cells and distance.max() > 0.0:
        centers.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.sum((tip - tip[centers[-1]]) ** 2, axis=1))
    nearest = np.argmin(((tip[:, None, :] - tip[None, centers, :]) ** 2).sum(axis=2), axis=1)
    return nearest[pose].astype(np.int64)


def folds_of_rivals(observed: Observed, folds: Mapping[str, Folds]) -> Folds:
    """The folds by which what a file may hold is judged: of few poses those next to each other go into different folds,
    and those left out lie between the rest; else the hardest.

    With parts of the workspace left out of 24 poses, three free frames extrapolate badly, whatever the causes are.
    """
    pose, part = poses(observed), parts_of_workspace(observed)
    if _few(observed) or pose.max() >= 2 * _MOST_PARTS:
        return hardest(folds)
    first = np.array([np.flatnonzero(pose == number)[0] for number in range(int(pose.max()) + 1)])
    dealt = np.empty(len(first), dtype=np.int64)
    dealt[np.argsort(part[first], kind="stable")] = np.arange(len(first)) % _FOLDS
    return dealt[pose]


def _pose_blocks(observed: Observed) -> Folds:
    """Poses gathered into folds by where the tip stands, so that a fold is made of parts of the workspace; of few
    poses a fold each."""
    part = parts_of_workspace(observed)
    return part if _few(observed) else part % _FOLDS


def _few(observed: Observed) -> bool:
    """Whether there are fewer than two poses a part held out."""
    return int(poses(observed).max()) + 1 < 2 * _FOLDS


class HeldOut:
    """Fits to all folds but one, in turn, of any choice among some parts of a model.

    `columns` are the parts' displacements (N, C, d), `tethers` (d,) for each part what holds its sizes at zero: the
    reciprocal of their usual size over the scatter (None: nothing does). What the parts multiply to is worked out once
    a fold. Of the first `nuisances` parts, what no other fold tells (where a point is that is touched in one fold
    alone) is fitted to the fold's readings: nothing can foretell it, and it says nothing of the rest. Parts that
    are `shared` give under one set of unknown weights in each of these fits, as a file has one: to first order about
    all readings' fit.
    """

    def __init__(
        self,
        observed: Observed,
        columns: Sequence[Array],
        folds: Folds,
        tethers: Sequence[Array | None] | None = None,
        *,
        nuisances: int = 0,
        shared: Shared | None = None,
    ) -> None:
        self._observed, self._shared = observed, shared
        self._parts = list(columns) or [np.zeros((*observed.residual.shape, 0))]
        self._edges = np.cumsum([0, *(part.shape[2] for part in self._parts)])
        tethers_ = list(tethers) if tethers is not None else [None] * len(self._parts)
        held = [np.zeros(p.shape[2]) if t is None else t for p, t in zip(self._parts, tethers_, strict=True)]
        self._held = np.concatenate(held) ** 2
        scaled, target = self._scaled(), observed.scaled(observed.residual)
        size = np.sqrt(np.einsum("nci,nci->i", scaled, scaled) + self._held)
        self._size = np.where(size > 0.0, size, 1.0)
        scaled /= self._size
        # Fold by fold: every choice of parts goes through each of them. Products are kept and no columns, which of a
        # long recording are hundreds of megabytes.
        self._fold = np.unique(folds, return_inverse=True)[1].reshape(-1)
        self._rows = [self._fold == fold for fold in range(int(self._fold.max()) + 1)]
        self._products = [self._product(scaled[rows], target[rows]) for rows in self._rows]
        self._nuisances = scaled[:, :, : int(self._edges[nuisances])].copy()
        self._fold_only = [self._fold_only_directions(gram, int(self._edges[nuisances])) for gram, _ in self._products]

    def _scaled(self) -> Array:
        """All columns (N, C, d) over the scatter, put together part by part."""
        scaled = np.empty((*self._observed.residual.shape, int(self._edges[-1])))
        for part, (a, b) in zip(self._parts, itertools.pairwise(self._edges.tolist()), strict=True):
            scaled[:, :, a:b] = self._observed.scaled(part)
        return scaled

    @staticmethod
    def _product(part: Array, target: Array) -> tuple[Array, Array]:
        flat = part.reshape(part.shape[0] * part.shape[1], part.shape[2])
        return flat.T @ flat, flat.T @ target.reshape(-1)

    def _fold_only_directions(self, gram: Array, width: int) -> Array:
        """The directions (width, k) of the first columns' sizes that no fold but that of a product tells."""
        whole = sum(item[:width, :width] for item, _ in self._products)
        if width == 0 or len(self._products) == 1:
            return np.zeros((width, 0))
        values, vectors = np.linalg.eigh(whole - gram[:width, :width])
        mine = np.einsum("wk,wv,vk->k", vectors, gram[:width, :width], vectors)
        return vectors[:, (values <= _TOLD * values[-1]) & (mine > _TOLD * values[-1])]

    def _fold_only_part(self, left: Array, fold: int, directions: Array) -> Array:
        """What of a fold's readings left, (n, C, k), the directions that it alone tells take up of the tip, m."""
        width, out = len(directions), self._rows[fold]
        seen = np.tensordot(self._nuisances[out], directions, 1)
        flat = seen.reshape(-1, directions.shape[1])
        target = self._observed.scaled(self._whole(left, out))[out].reshape(len(flat), -1)
        values = (directions @ np.linalg.lstsq(flat, target, rcond=None)[0]) / self._size[:width, None]
        nuisances = zip(self._parts, self._edges[1:].tolist(), strict=True)
        beside = np.concatenate([part[out] for part, end in nuisances if end <= width], axis=2)
        return np.tensordot(beside[:, : self._observed.components], values, 1)

    def _moved(self, values: Array, rows: NDArray[np.bool_] | slice = slice(None)) -> Array:
        """What sizes (d, k) of all columns move in some rows, (n, C, k)."""
        spans = itertools.pairwise(self._edges.tolist())
        used = ((part, values[a:b]) for part, (a, b) in zip(self._parts, spans, strict=True) if values[a:b].any())
        count = self._observed.residual[rows].shape
        return sum((np.tensordot(part[rows], sizes, 1) for part, sizes in used), np.zeros((*count, values.shape[1])))

    def _along(self, target: Array, rows: NDArray[np.bool_]) -> Array:
        """The products (d, k) of the columns in some rows with a target (n, C, k)."""
        products = [np.tensordot(part[rows], target, ((0, 1), (0, 1))) for part in self._parts]
        return np.concatenate(products) / self._size[:, None]

    def _whole(self, left: Array, out: NDArray[np.bool_]) -> Array:
        """A fold's readings in their places among all, zero elsewhere."""
        whole = np.zeros((len(out), *left.shape[1:]))
        whole[out] = left
        return whole

    def residual(self, which: Sequence[int] | None = None, shown: Sequence[int] | None = None) -> Array:
        """The tip's residual (N, D), m, of each reading under a fit of some parts (all by default) that has not seen
        its fold; of what was fitted, only the parts `shown` are taken off (all by default)."""
        width = self._observed.components
        spans = [np.arange(*self._edges[k : k + 2]) for k in (range(len(self._edges) - 1) if which is None else which)]
        taken = np.concatenate([np.zeros(0, dtype=np.int64), *spans])
        if len(taken) == 0 or len(self._products) == 1:
            return self._observed.residual[:, :width].copy()
        at = np.ix_(taken, taken)
        whole = sum(gram[at] for gram, _ in self._products) + np.diag(self._held[taken] / self._size[taken] ** 2)
        against = sum(wanted[taken] for _, wanted in self._products)
        values = np.zeros((len(self._size), len(self._products)))
        steps = self._steps(which, taken)
        for fold, (gram, wanted) in enumerate(self._products):
            values[taken, fold] = self._fitted(whole - gram[at], (against - wanted[taken])[:, None], taken, steps)[:, 0]
        for part in () if shown is None else set(range(len(self._parts))) - set(shown):
            values[self._edges[part] : self._edges[part + 1]] = 0.0
        moved = self._moved(values)
        missed = self._observed.residual - moved[np.arange(len(moved)), :, self._fold]
        left = missed[:, :width]
        for fold, (directions, out) in enumerate(zip(self._fold_only, self._rows, strict=True)):
            if directions.shape[1] and (taken[: len(directions)] == np.arange(len(directions))).all():
                left[out] -= self._fold_only_part(missed[out][..., None], fold, directions)[..., 0]
        return left

    def _steps(self, which: Sequence[int] | None, taken: NDArray[np.int64]) -> Steps | None:
        """The coordinates in which some parts give under one set of weights, by the places of their sizes among those
        `taken`; None where fewer than two do."""
        if self._shared is None:
            return None
        place = {column: k for k, column in enumerate(taken.tolist())}
        among = range(len(self._edges) - 1) if which is None else which
        starts = {part: place[int(self._edges[part])] for part in among if part in self._shared.sizes}
        return self._shared.steps(len(taken), starts) if len(starts) > 1 else None

    def _fitted(
        self, gram: Array, against: Array, taken: NDArray[np.int64], steps: Steps | None, *, start: float = 1.0
    ) -> Array:
        """Sizes (t, k) by normal equations of scaled columns, with `steps` from their `start` times that of all
        readings."""
        size = self._size[taken][:, None]
        if steps is None or self._shared is None:
            return normal_solution(gram, against) / size
        begun, slopes = start * steps.begun[:, None] * size, steps.slopes * size
        held, asked = steps.held(self._shared.hold)
        # A column for the largest weight, which stands, is zero: its step stays at zero too.
        whole, right = slopes.T @ gram @ slopes + held.T @ held, slopes.T @ (against - gram @ begun)
        right += start * (held.T @ asked)[:, None]
        scale = np.sqrt(np.diag(whole))
        scale = np.where(scale > 0.0, scale, 1.0)
        step = normal_solution(whole / np.outer(scale, scale), right / scale[:, None]) / scale[:, None]
        return (begun + slopes @ step) / size

    def rms_of(self, drawn: Array) -> Array:
        """The RMS lengths (m, k) that fits of all parts leave held out of other residuals (N, C, k), m and rad."""
        width = self._observed.components
        left = drawn[:, :width].copy()
        if len(self._size) == 0 or len(self._products) == 1:
            return np.sqrt(np.mean(np.sum(left**2, axis=1), axis=0))
        target = self._observed.scaled(self._observed.scaled(drawn))
        against = [self._along(target[rows], rows) for rows in self._rows]
        whole = sum(gram for gram, _ in self._products) + np.diag(self._held / self._size**2)
        each = zip(self._products, against, self._fold_only, self._rows, strict=True)
        taken = np.arange(len(self._size))
        steps = self._steps(None, taken)
        for fold, ((gram, _), wanted, directions, out) in enumerate(each):
            values = self._fitted(whole - gram, sum(against) - wanted, taken, steps, start=0.0)
            missed = drawn[out] - self._moved(values, out)
            left[out] = missed[:, :width] - (
                self._fold_only_part(missed, fold, directions) if directions.shape[1] else 0.0
            )
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


def residual_held_out(observed: Observed, columns: Sequence[Array], folds: Folds, *, nuisances: int = 0) -> Array:
    """The tip's residual (N, D), m, of each reading under a fit that has not seen its fold.

    `columns` are the displacements (N, C, d) of whatever the model fits, the first `nuisances` of them no part of what
    is judged (see `HeldOut`).
    """
    return HeldOut(observed, columns, folds, nuisances=nuisances).residual()


def rms_held_out(observed: Observed, columns: Sequence[Array], folds: Folds) -> float:
    """The RMS length (m) of the residuals that `residual_held_out` gives."""
    return rms_length(residual_held_out(observed, columns, folds))
