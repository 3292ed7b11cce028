"""Ways to hold readings out: each gives a fold number (0 to 4) for every reading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FOLDS = 5
Folds = NDArray[np.int64]


def dealt(groups: NDArray[np.int64], seed: int) -> Folds:
    """Whole groups of readings, dealt at random."""
    number = np.unique(groups, return_inverse=True)[1].reshape(-1)
    return (np.random.default_rng(seed).permutation(number.max() + 1) % FOLDS)[number].astype(np.int64)


def rows(count: int, seed: int) -> Folds:
    """Single readings, dealt at random."""
    return dealt(np.arange(count), seed)


def blocks(count: int, many: int = FOLDS) -> Folds:
    """Stretches of `many` equal numbers of readings in the order of the recording, dealt in turn."""
    return ((np.arange(count) * many) // count % FOLDS).astype(np.int64)


def angle_cells(q: NDArray[np.float64], joints: tuple[int, ...], degrees: float, seed: int) -> Folds:
    """Cells of so many degrees of some joints (from 0), dealt at random."""
    cell = np.floor(np.degrees(q[:, list(joints)]) / degrees).astype(np.int64)
    return dealt(np.unique(cell, axis=0, return_inverse=True)[1].reshape(-1), seed)
