"""Trajectories that excite an arm: Fourier series within its limits, begun and ended at rest.

J. Swevers et al., Optimal robot excitation and identification, IEEE Trans. Robotics and Automation 13 (1997), 730-740,
doi:10.1109/70.631234.
"""

from __future__ import annotations

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import STEP, Arm
from benchmarks.motion.generator.moved import Moved

FADE = 1.5  # s


def draw_reference(arm: Arm, seconds: float, rng: np.random.Generator) -> Moved:
    """A trajectory of 5 to 12 harmonics of 0.05 to 0.1 Hz, as fast as a share of each joint's limits."""
    time = np.arange(0.0, seconds, STEP)
    count = int(rng.integers(5, 13))
    omega = 2.0 * np.pi * float(rng.uniform(0.05, 0.1)) * np.arange(1, count + 1)
    s, c = np.sin(np.outer(time, omega)), np.cos(np.outer(time, omega))
    fade, fade1, fade2 = _fade(time, seconds)
    results: list[list[Array]] = [[], [], []]
    for axis in arm.axes:
        one, two = rng.normal(size=(2, count)) / np.sqrt(np.arange(1, count + 1))
        x, x1, x2 = (
            s @ one + c @ two,
            (c * omega) @ one - (s * omega) @ two,
            -(s * omega**2) @ one - (c * omega**2) @ two,
        )
        x1, x2, x = fade * x1 + fade1 * x, fade * x2 + 2 * fade1 * x1 + fade2 * x, fade * x
        share = float(rng.uniform(0.6, 1.0))
        half = (axis.reach[1] - axis.reach[0]) / 2.0
        room = [half / np.abs(x).max(), axis.speed / np.abs(x1).max(), axis.acceleration / np.abs(x2).max()]
        factor = share * float(min(room))
        for result, values in zip(results, (sum(axis.reach) / 2.0 + factor * x, factor * x1, factor * x2), strict=True):
            result.append(values)
    return Moved(arm, time, *(np.stack(item, axis=1) for item in results))


def _fade(time: Array, seconds: float) -> tuple[Array, Array, Array]:
    """From 0 to 1 and back, by a polynomial of fifth order, with its derivatives."""
    inside, after = time / FADE, (seconds - STEP - time) / FADE
    first = inside < after
    x = np.clip(np.where(first, inside, after), 0.0, 1.0)
    sign = np.where(first, 1.0, -1.0)
    value = x**3 * (10 - 15 * x + 6 * x**2)
    return value, sign * 30 * x**2 * (1 - x) ** 2 / FADE, 60 * x * (1 - x) * (1 - 2 * x) / FADE**2
