"""Cells that lie across the edge of what single links may be: the least of a sum over what is kept, not over corners.

A corner beyond a limit (a wall too slender) is no section, and the least there bounds badly what is inside. What a cell
keeps is bounded by Lagrange's multipliers instead: the least over all corners of the sum with multiples of the limits
added is no more than any section has that keeps them (Everett 1963, doi:10.1287/opre.11.3.399). The multiplier of one
limit is found exactly, from the corner on either side of it; of several in turn.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from linkwright.core.sections.numeric import Array

_SWEEPS, _MOST_TURNS = 3, 8
_LEAST = 1e-300


def multipliers(scores: Array, held: Array) -> Array:
    """Multipliers (N, H), none below zero, for the sums of columns at corners (N, C) and what must not be above
    zero there (N, C, H): they raise the least of `scores + held @ multipliers` over the corners."""
    multiplier = np.zeros((len(held), held.shape[2]))
    total = scores.copy()
    across = np.any(held > 0.0, axis=1) & np.any(held <= 0.0, axis=1)
    for _ in range(_SWEEPS):
        for k in np.flatnonzero(across.any(axis=0)).tolist():
            limit = held[:, :, k]
            rest = total - multiplier[:, k : k + 1] * limit
            multiplier[:, k] = np.where(across[:, k], _of_one(rest, limit), 0.0)
            total = rest + multiplier[:, k : k + 1] * limit
    return multiplier


def _of_one(scores: Array, held: Array) -> Array:
    """The best multiplier (N) of one limit: where the lower hull of (held, score) over the corners crosses zero."""
    every = np.arange(len(held))
    beyond = held > 0.0
    out = scores.argmin(axis=1)
    needed = beyond[every, out] & ~beyond.all(axis=1)
    within = np.where(beyond, np.inf, scores).argmin(axis=1)
    multiplier = np.zeros(len(held))
    for _ in range(_MOST_TURNS):
        run = np.where(needed, held[every, out] - held[every, within], 1.0)
        multiplier = np.where(needed, (scores[every, within] - scores[every, out]) / run, 0.0)
        least = (scores + multiplier[:, None] * held).argmin(axis=1)
        lower = beyond[every, least]
        if ((least == out) | (least == within) | ~needed).all():
            break
        out, within = np.where(lower, least, out), np.where(lower, within, least)
    return multiplier


def mixture(scores: Array, held: Array) -> tuple[Array, Array] | None:
    """Of one cell, the shares of the corners (C) that keep the limits (held (C, H)) with the least sum, and the
    multipliers (H) that prove it; None where none keep them."""
    violated = (held > 0.0).any(axis=0)
    size = max(float(np.ptp(scores)), _LEAST)
    result = linprog(
        (scores - scores.min()) / size,
        held[:, violated].T,
        np.zeros(int(violated.sum())),
        np.ones((1, len(scores))),
        np.ones(1),
        bounds=(0.0, None),
        method="highs",
    )
    if result.status != 0:
        return None
    multiplier = np.zeros(held.shape[1])
    multiplier[violated] = np.maximum(-result.ineqlin.marginals, 0.0) * size
    return np.asarray(result.x), multiplier
