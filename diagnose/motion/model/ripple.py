"""Torques that repeat with a joint's angle, by their order: a scan of what the whole library leaves.

Slow orders are proposed as candidates like others. Fast ones lie beyond the low-pass of both sides: they are sought in
torque that is not filtered, on slow motion (at speed a control loop turns them into accelerations), without what is
slower than they are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.motion.preparation import low_pass
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .rows import LogRows

_EACH = 3
"""Orders that are sought at a joint."""
DRAWS = 99
"""Draws of signs of blocks for each order that stands out."""


@dataclass(frozen=True)
class Ripple:
    """An order that stands out at a joint (from 0): sizes of sine and cosine (N*m, N) with the half width of their 95 %
    intervals, and how often chance makes some order stand out as much. `fast`: beyond the low-pass. `evidence` in
    nats."""

    joint: int
    order: float
    sine: float
    cosine: float
    half: float
    p_value: float
    evidence: float
    fast: bool

    @property
    def rms(self) -> float:
        """RMS of the torque, N*m (N)."""
        return math.hypot(self.sine, self.cosine) / math.sqrt(2.0)


@dataclass(frozen=True)
class _Signal:
    """What is left of a joint's torque (M,), its phase for order one (rad), speed of that phase (rad/s) and blocks."""

    left: Array
    phase: Array
    speed: Array
    block: NDArray[np.int64]


def ripples(
    rows: Sequence[LogRows],
    sizes: Array,
    orders: Sequence[float],
    joint: int,
    seed: int,
    *,
    fast: bool,
    rules: Rules,
) -> list[Ripple]:
    """Orders that stand out of what sizes (W,) of the model's columns leave of a joint's torque, the strongest first.

    Args:
        rows: The logs.
        sizes: Of the whole library.
        orders: Orders to seek.
        joint: From 0.
        seed: For the draws.
        fast: Orders beyond the low-pass, in torque that is not filtered.
        rules: What stands out.
    """
    fewest = rules.fitting.least_parts * rules.fitting.enough
    signal = _joined([_fast(row, sizes, joint, rules) if fast else _slow(row, sizes, joint) for row in rows])
    if len(signal.left) < fewest:
        return []
    top = min(0.4 * min(row.prepared.rate for row in rows), 1e9)
    cutoff = min(row.prepared.cutoff for row in rows)
    band = (rules.motion.ripple_band, top) if fast else (0.0, 0.5 * cutoff)
    ripples_: list[Ripple] = []
    left = signal.left.copy()
    rng = np.random.default_rng(seed)
    for _ in range(_EACH):
        table = _scores(_Signal(left, signal.phase, signal.speed, signal.block), orders, band, fewest)
        best = _strongest(table, rng, rules)
        if best is None:
            break
        at, p_value = best
        order = orders[at]
        sums, count, _ = table
        whole, rows_in = sums[:, at].sum(), count[:, at].sum()
        size = 2.0 * whole / rows_in
        noise = float(np.var(left))
        scatter = 2.0 * np.sqrt(np.sum(np.abs(sums[:, at] - 0.5 * size * count[:, at]) ** 2) / 2.0) / rows_in
        evidence = float(np.abs(whole) ** 2 / (rows_in * noise)) if noise > 0.0 else 0.0
        ripples_.append(
            Ripple(joint, order, float(size.imag), float(size.real), 2.2 * float(scatter), p_value, evidence, fast)
        )
        left -= size.real * np.cos(order * signal.phase) + size.imag * np.sin(order * signal.phase)
    return ripples_


def _joined(parts: Sequence[_Signal]) -> _Signal:
    offset = np.cumsum([0, *(int(part.block.max(initial=-1)) + 1 for part in parts)])
    return _Signal(
        np.concatenate([part.left for part in parts]),
        np.concatenate([part.phase for part in parts]),
        np.concatenate([part.speed for part in parts]),
        np.concatenate([part.block + more for part, more in zip(parts, offset, strict=False)]),
    )


def _slow(rows: LogRows, sizes: Array, joint: int) -> _Signal:
    prepared = rows.prepared
    use = prepared.moving[:, joint]
    at = prepared.kept[use]
    left = (rows.target[:, joint] - rows.design[joint] @ sizes[rows.columns[joint]])[use]
    turn = _turn(rows, joint)
    return _Signal(
        left, turn * prepared.motion.q[at, joint], turn * prepared.motion.velocity[at, joint], rows.block[use]
    )


def _fast(rows: LogRows, sizes: Array, joint: int, rules: Rules) -> _Signal:
    prepared = rows.prepared
    motion = prepared.motion
    explained = rows.design[joint] @ sizes[rows.columns[joint]]
    left = prepared.measured[:, joint] - rows.nominal[:, joint]
    left = left - np.interp(motion.time, motion.time[prepared.kept], explained)
    inner = np.zeros(motion.size, dtype=bool)
    margin = round(prepared.rate)
    for stretch in prepared.stretches:
        part = slice(stretch.start, stretch.stop)
        left[part] = left[part] - low_pass(left[part], rules.motion.ripple_band / 1.5, prepared.rate)
        inner[stretch.start + margin : max(stretch.stop - margin, stretch.start + margin)] = True
    speed = motion.velocity[:, joint]
    use = inner & (np.abs(speed) > rules.motion.slow) & (np.abs(speed) < rules.motion.ripple_speed)
    turn = _turn(rows, joint)
    block = np.unique(np.floor(motion.time[use] / rows.length), return_inverse=True)[1].astype(np.int64)
    return _Signal(left[use], turn * motion.q[use, joint], turn * speed[use], block)


def _turn(rows: LogRows, joint: int) -> float:
    """Radians of phase for a unit of the coordinate: one on joints that turn, a whole turn a metre on slides."""
    return 1.0 if rows.prepared.motion.arm.joints[joint].revolute else 2.0 * np.pi


def _scores(
    signal: _Signal, orders: Sequence[float], band: tuple[float, float], fewest: int
) -> tuple[NDArray[np.complex128], Array, Array]:
    """For each block and order (B, K): the sum of what is left times the turning phase, and the rows that count; and
    the power (K,)."""
    edges = np.flatnonzero(np.diff(signal.block, prepend=-1))
    sums = np.zeros((len(edges), len(orders)), dtype=np.complex128)
    count = np.zeros((len(edges), len(orders)))
    quick = np.abs(signal.speed) / (2.0 * np.pi)
    for number, order in enumerate(orders):
        use = (order * quick >= band[0]) & (order * quick <= band[1])
        wave = np.where(use, signal.left, 0.0) * np.exp(1j * order * signal.phase)
        sums[:, number] = np.add.reduceat(wave, edges)
        count[:, number] = np.add.reduceat(use.astype(float), edges)
    return sums, count, _power(sums.sum(axis=0), count.sum(axis=0), fewest)


def _power(whole: NDArray[np.complex128], rows: Array, fewest: int) -> Array:
    return np.where(rows > fewest, np.abs(whole) ** 2 / np.maximum(rows, 1.0), 0.0)


def _strongest(
    table: tuple[NDArray[np.complex128], Array, Array], rng: np.random.Generator, rules: Rules
) -> tuple[int, float] | None:
    """The order that stands out most of its neighbours, with the p-value of that; None where chance does as much."""
    sums, count, power = table
    seen = power > 0.0
    if seen.sum() < 4:
        return None
    middle = _beside(power, seen)
    standing = np.where(seen, power / np.maximum(middle, 1e-300), 0.0)
    at = int(np.argmax(standing))
    if standing[at] < rules.motion.stands_out:
        return None
    signs = rng.choice((-1.0, 1.0), size=(DRAWS, len(sums)))
    rows = count.sum(axis=0)
    drawn = np.abs(signs @ sums) ** 2 / np.maximum(rows, 1.0)
    drawn = np.where(seen, drawn / np.maximum(middle, 1e-300), 0.0).max(axis=1)
    p_value = float((1 + np.sum(drawn >= standing[at])) / (DRAWS + 1))
    return (at, p_value) if p_value <= rules.residual.level else None


def _beside(power: Array, seen: NDArray[np.bool_]) -> Array:
    """The median power of forty orders on either side (K,)."""
    values = np.where(seen, power, np.nan)
    ratios = np.empty(len(power))
    for k in range(len(power)):
        near = values[max(0, k - 40) : k + 41]
        ratios[k] = np.nanmedian(near) if np.isfinite(near).any() else 0.0
    return ratios
