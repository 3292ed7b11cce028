"""Torsion and shear of shapes without symmetry in both axes, sampled by boundary elements over their dimensions.

Run ``python -m benchmarks.section_fits.samples FOLDER`` once (some minutes); `benchmarks.section_fits.open_sections`
reads what it leaves there. Every shape has height 1; each row holds the dimensions, then J and (a, c) of
A / A_s = a + c (nu / (1 + nu))^2 along y and along z.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from linkwright.core.sections.formulas.saint_venant import moments, solve

Loops = list[np.ndarray]
FILLET_CHORDS = 5


def centred(*loops: list[tuple[float, float]]) -> Loops:
    arrays = [np.array(loop, dtype=float) for loop in loops]
    m = moments(arrays)
    return [loop - np.array([m.first_y, m.first_z]) / m.area for loop in arrays]


def angle(width: float, thickness: float) -> Loops:
    t = thickness
    return centred([(0, 0), (width, 0), (width, t), (t, t), (t, 1), (0, 1)])


def channel(width: float, flange: float, web: float) -> Loops:
    low, high = flange, 1 - flange
    return centred([(0, 0), (width, 0), (width, low), (web, low), (web, high), (width, high), (width, 1), (0, 1)])


def t_section(width: float, flange: float, web: float) -> Loops:
    b, w, z = width / 2, web / 2, 1 - flange
    return centred([(-w, 0), (w, 0), (w, z), (b, z), (b, 1), (-b, 1), (-b, z), (-w, z)])


def triangular_tube(width: float, inner: float) -> Loops:
    """``inner`` is the size of the hollow as a fraction of the outer triangle."""
    side = math.hypot(0.5 * width, 1.0)
    radius = width / (width + 2.0 * side)
    outer = np.array([(-width / 2, 0.0), (width / 2, 0.0), (0.0, 1.0)])
    center = np.array([0.0, radius])
    hole = (center + inner * (outer - center))[::-1]
    return centred([tuple(p) for p in outer], [tuple(p) for p in hole])


def octagonal_tube(inner: float) -> Loops:
    """Of unit width across flats."""
    angles = math.pi / 8 + np.arange(8) * math.pi / 4
    outer = 0.5 / math.cos(math.pi / 8) * np.column_stack((np.cos(angles), np.sin(angles)))
    return [outer] if inner == 0.0 else [outer, inner * outer[::-1]]


def filleted_i_section(width: float, flange: float, web: float, radius: float) -> Loops:
    turn = np.linspace(0.0, math.pi / 2, FILLET_CHORDS + 1)
    rise = [(web / 2 + radius * (1 - math.cos(a)), 0.5 - flange - radius * (1 - math.sin(a))) for a in turn]
    quarter = [*rise, (width / 2, 0.5 - flange), (width / 2, 0.5)]
    right = [(y, -z) for y, z in quarter[::-1]] + quarter
    return [np.array(right + [(-y, -z) for y, z in right])]


def clustered(low: list[float], high: list[float], count: int, seed: int) -> np.ndarray:
    """Points between the bounds, geometrically spread and denser at the ends."""
    p = 0.5 - 0.5 * np.cos(np.pi * qmc.Sobol(len(low), seed=seed).random(count))
    return np.exp(np.log(low) + p * np.log(np.divide(high, low)))


def rows(make: Callable[..., Loops], points: np.ndarray) -> np.ndarray:
    out = []
    for point in points:
        solved = solve(make(*point))
        out.append((*point, solved.torsion_constant, *solved.shear_y, *solved.shear_z))
    return np.array(out)


def main() -> None:
    """Sample every shape and leave one array each in the folder."""
    folder = Path(sys.argv[1])
    hollow = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 40))
    hollow = 0.985 * hollow
    np.save(folder / "octagonal_tube.npy", rows(octagonal_tube, hollow[:, None]))
    points = clustered([0.28, 0.009], [3.6, 0.27], 128, 2)
    points[:, 1] *= np.minimum(points[:, 0], 1.0)
    np.save(folder / "angle.npy", rows(angle, points))
    for seed, make in enumerate((t_section, channel), start=3):
        points = clustered([0.28, 0.009, 0.009], [3.5, 0.27, 0.27], 256, seed)
        points[:, 2] *= points[:, 0]
        np.save(folder / f"{make.__name__}.npy", rows(make, points))
    points = clustered([0.33, 0.028, 0.42, 0.6], [1.08, 0.18, 0.85, 2.2], 192, 3)
    points[:, 2] *= points[:, 1]
    points[:, 3] *= points[:, 1]
    fits = (points[:, 2] / 2 + points[:, 3] < 0.48 * points[:, 0]) & (points[:, 1] + points[:, 3] < 0.48)
    np.save(folder / "filleted_i_section.npy", rows(filleted_i_section, points[fits]))
    points = clustered([0.28, 0.05], [3.6, 0.75], 128, 1)
    points[:, 1] = 1.0 - points[:, 1]
    np.save(folder / "triangular_tube.npy", rows(triangular_tube, points))


if __name__ == "__main__":
    main()
