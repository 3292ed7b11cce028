"""The planes and bars that fit what was touched best."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array


def touched_planes(at: Array, touches: NDArray[np.int64], count: int, *, flat: bool) -> tuple[Array, Array, Array]:
    """The planes that fit what was touched best: normals (count, 3), offsets (count,) m and how far their touches reach
    along each of the plane's axes (count, 2), RMS, m; zero for labels without touches."""
    normals, offsets, reach = np.zeros((count, 3)), np.zeros(count), np.zeros((count, 2))
    width = 2 if flat else 3
    for label in range(count):
        points = at[touches == label][:, :width]
        if len(points) == 0:
            continue
        middle = points.mean(axis=0)
        _, size, axes = np.linalg.svd(points - middle, full_matrices=True)
        normals[label, :width] = axes[-1]
        offsets[label] = float(axes[-1] @ middle)
        sizes = np.concatenate([size, np.zeros(3)])[: width - 1] / np.sqrt(len(points))
        reach[label] = [*sizes, *([sizes[0]] if flat else [])]
    return normals, offsets, reach


def touched_bars(at: Array, touches: NDArray[np.int64], along: Array, count: int) -> tuple[Array, Array, Array]:
    """The bars that fit tips `at` (N, 3) best, m, which touch them so far `along` (N,): the middle of the touches
    (count, 3), which way they point (count, 3), unit, and how far from that middle each touch should be (N,). A bar
    that is touched at one place points nowhere."""
    middles, ways, away = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(len(at))
    for label in range(count):
        rows = touches == label
        if not rows.any():
            continue
        middles[label], away[rows] = at[rows].mean(axis=0), along[rows] - along[rows].mean()
        way = away[rows] @ (at[rows] - middles[label])
        ways[label] = way / max(float(np.linalg.norm(way)), 1e-300)
    return middles, ways, away
