"""Filters without phase, and where a joint moves."""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks.blind.generator.vectors import Array

CUTOFF = 8.0  # Hz


def low_passed(values: Array, rate: float, cutoff: float = CUTOFF) -> Array:
    """Without phase, along the first axis."""
    return sosfiltfilt(butter(2, cutoff, fs=rate, output="sos"), values, axis=0)


def moving(velocity: Array, rate: float) -> Array:
    """(N,) where a joint moves, 0.1 s away from each reversal."""
    still = np.abs(velocity) < 0.03
    turns = np.concatenate([[False], np.sign(velocity[1:]) != np.sign(velocity[:-1])])
    near = np.convolve(turns, np.ones(2 * round(0.1 * rate) + 1), mode="same") > 0.5
    return ~(still | near)


def rms(values: Array) -> Array:
    """Along the first axis."""
    return np.sqrt(np.mean(values**2, axis=0))
