"""What a tracker makes of a position: anisotropic noise, correlated or heavy-tailed, outliers, a slow drift."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.blind.generator.vectors import Array


@dataclass(frozen=True)
class Tracker:
    """`sigma` is the RMS over the axes in m; `ratio` per axis about it; AR(1) from row to row; Student's t if tails."""

    sigma: float
    ratio: tuple[float, ...]
    correlation: float = 0.0
    degrees_of_freedom: float = 0.0  # 0: normal
    outlier_share: float = 0.0
    outlier_size: float = 12.0  # in sigma
    drift: float = 0.0  # m over the recording, as a wander
    declared_factor: float = 1.0  # declared sigma over the true one


def draw_ratio(axes: int, rng: np.random.Generator) -> tuple[float, ...]:
    """Axes that differ by up to a factor of two, RMS 1."""
    raw = rng.uniform(0.7, 1.4, axes)
    return tuple(float(x) for x in raw / np.sqrt(np.mean(raw**2)))


def noise(tracker: Tracker, axes: int, rows: int, rng: np.random.Generator) -> tuple[Array, list[int]]:
    """Errors (axes, rows) in m, and the rows that are outliers (from 0)."""
    shape = (axes, rows)
    if tracker.degrees_of_freedom > 0.0:
        nu = tracker.degrees_of_freedom
        white = rng.standard_t(nu, shape) * np.sqrt((nu - 2.0) / nu)
    else:
        white = rng.standard_normal(shape)
    rho = tracker.correlation
    errors = white.copy()
    for k in range(1, rows):
        errors[:, k] = rho * errors[:, k - 1] + np.sqrt(1.0 - rho**2) * white[:, k]
    errors *= tracker.sigma * np.array(tracker.ratio)[:, None]
    if tracker.drift > 0.0:
        walk = np.cumsum(rng.standard_normal(shape), axis=1)
        walk -= walk.mean(axis=1, keepdims=True)
        errors += tracker.drift * walk / max(float(np.abs(walk).max()), 1e-12)
    gross: list[int] = []
    if tracker.outlier_share > 0.0:
        count = max(1, round(tracker.outlier_share * rows))
        gross = sorted(int(k) for k in rng.choice(rows, count, replace=False))
        for k in gross:
            way = rng.standard_normal(axes)
            size = tracker.sigma * tracker.outlier_size * float(rng.uniform(0.7, 1.5))
            errors[:, k] += size * way / np.linalg.norm(way)
    return errors, gross


def clean_tracker(sigma: float, axes: int, rng: np.random.Generator) -> Tracker:
    """Normal noise; three recordings in ten have a few outliers, slight correlation or a little drift."""
    tracker = Tracker(sigma, draw_ratio(axes, rng))
    chance = rng.random()
    if chance < 0.15:
        return replace(tracker, outlier_share=0.01)
    if chance < 0.25:
        return replace(tracker, correlation=float(rng.uniform(0.05, 0.2)))
    if chance < 0.3:
        return replace(tracker, drift=0.3 * sigma)
    return tracker


def hostile_tracker(tracker: Tracker, number: int, rng: np.random.Generator) -> tuple[Tracker, tuple[str, ...]]:
    """Each hostile null has one or two vices; every recording has clock and thermometer, which mean nothing."""
    vices = ("heavy_tails", "autocorrelation", "sigma_half", "sigma_double", "outliers")
    chosen = {vices[number % 5]} | ({str(rng.choice(vices))} if rng.random() < 0.4 else set())
    if {"sigma_half", "sigma_double"} <= chosen:
        chosen.discard("sigma_double")
    if "heavy_tails" in chosen:
        tracker = replace(tracker, degrees_of_freedom=3.0)
    if "autocorrelation" in chosen:
        tracker = replace(tracker, correlation=float(rng.uniform(0.2, 0.6)))
    if "outliers" in chosen:
        tracker = replace(tracker, outlier_share=float(rng.uniform(0.01, 0.03)))
    factor = 0.5 if "sigma_half" in chosen else 2.0 if "sigma_double" in chosen else 1.0
    return replace(tracker, declared_factor=factor), tuple(sorted(chosen))
