"""Torques that repeat with a joint's angle, by their order: a scan of what the whole library leaves.

Slow orders are proposed as candidates like others. Fast ones lie beyond the low-pass of both sides: they are sought in
torque that is not filtered, on slow motion (at speed a control loop turns them into accelerations), without what is
slower than they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.motion.preparation import low_pass
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .rows import LogRows

_EACH = 3
"""Orders that are sought at a joint."""
_QUICK, _SLOW = 0.25, 0.5
"""Parts of the low-pass: from the first on orders are sought without it, up to the second with it, which lets them
through nearly as they are."""
_PERIODS = 1.0
"""Periods, in a block, of the slowest order that is sought without the low-pass: what is left remembers no longer."""
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
    """What is left of a joint's torque (M,), its phase for order one (rad), speed of that phase (rad/s) and blocks;
    `wave` gives what such a rest holds (M, complex) of a torque that goes with the cosine of an order (real part) and
    with its sine."""

    left: Array
    phase: Array
    speed: Array
    block: NDArray[np.int64]
    wave: Callable[[float], NDArray[np.complex128]]


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
    cutoff = max(row.prepared.cutoff for row in rows)
    band = (_QUICK * cutoff, 0.4 * min(row.prepared.rate for row in rows)) if fast else (0.0, _SLOW * cutoff)
    ripples_: list[Ripple] = []
    left = signal.left.copy()
    rng = np.random.default_rng(seed)
    for _ in range(_EACH):
        best = _strongest(_scores(replace(signal, left=left), orders, band, fewest), rng, rules)
        if best is None:
            break
        at, p_value = best
        order = orders[at]
        wave = signal.wave(order)
        waves = np.column_stack([wave.imag, wave.real])
        use = _in_band(signal, order, band)
        size, half = _size(np.where(use[:, None], waves, 0.0), left, signal.block)
        after = left - waves @ size
        evidence = 0.5 * float(np.sum(left[use] ** 2) - np.sum(after[use] ** 2)) / max(float(np.var(left)), 1e-300)
        ripples_.append(Ripple(joint, order, float(size[0]), float(size[1]), half, p_value, evidence, fast))
        left = after
    return ripples_


def _size(waves: Array, left: Array, block: NDArray[np.int64]) -> tuple[Array, float]:
    """Sizes (2,) of waves (M, 2) by least squares, and half the width of their 95 % intervals by what they leave from
    block to block."""
    edges = np.flatnonzero(np.diff(block, prepend=-1))
    spread = np.linalg.pinv(waves.T @ waves)
    size = spread @ (waves.T @ left)
    pull = np.add.reduceat(waves * (left - waves @ size)[:, None], edges)
    return size, 2.2 * float(np.sqrt(np.max(np.diagonal(spread @ (pull.T @ pull) @ spread))))


def _in_band(signal: _Signal, order: float, band: tuple[float, float]) -> NDArray[np.bool_]:
    frequency = order * np.abs(signal.speed) / (2.0 * np.pi)
    return (frequency >= band[0]) & (frequency <= band[1])


def _joined(parts: Sequence[_Signal]) -> _Signal:
    offset = np.cumsum([0, *(int(part.block.max(initial=-1)) + 1 for part in parts)])
    return _Signal(
        np.concatenate([part.left for part in parts]),
        np.concatenate([part.phase for part in parts]),
        np.concatenate([part.speed for part in parts]),
        np.concatenate([part.block + more for part, more in zip(parts, offset, strict=False)]),
        lambda order: np.concatenate([part.wave(order) for part in parts]),
    )


def _slow(rows: LogRows, sizes: Array, joint: int) -> _Signal:
    prepared = rows.prepared
    use = prepared.moving[:, joint]
    at = prepared.kept[use]
    left = (rows.target[:, joint] - rows.design[joint] @ sizes[rows.columns[joint]])[use]
    turn = _turn(rows, joint)
    phase = turn * prepared.motion.q[at, joint]
    speed = turn * prepared.motion.velocity[at, joint]
    return _Signal(left, phase, speed, rows.block[use], lambda order: np.exp(1j * order * phase))


def _fast(rows: LogRows, sizes: Array, joint: int, rules: Rules) -> _Signal:
    prepared = rows.prepared
    motion = prepared.motion
    explained = rows.design[joint] @ sizes[rows.columns[joint]]
    left = prepared.measured[:, joint] - rows.nominal[:, joint]
    left = left - np.interp(motion.time, motion.time[prepared.kept], explained)
    margin = round(prepared.rate)
    inside = np.zeros(motion.size, dtype=bool)
    for stretch in prepared.stretches:
        inside[stretch.start + margin : max(stretch.stop - margin, stretch.start + margin)] = True
    speed = motion.velocity[:, joint]
    # Friction that turns round is no wave, but is there again at the same angle.
    steady = np.interp(motion.time, motion.time[prepared.kept], prepared.moving[:, joint].astype(float)) == 1.0
    use = inside & steady & (np.abs(speed) > rules.motion.slow) & (np.abs(speed) < rules.motion.ripple_speed)
    turn = _turn(rows, joint)
    phase = turn * motion.q[:, joint]

    edge = _QUICK * prepared.cutoff

    def quick(torque: Array) -> Array:
        """What a torque holds beyond slow changes."""
        kept = torque.copy()
        for stretch in prepared.stretches:
            part = slice(stretch.start, stretch.stop)
            kept[part] -= low_pass(torque[part], edge / 1.5, prepared.rate)
        return kept[use]

    length = min(rows.length, _PERIODS / edge)
    block = np.unique(np.floor(motion.time[use] / length), return_inverse=True)[1].astype(np.int64)
    return _Signal(
        quick(left),
        phase[use],
        turn * speed[use],
        block,
        lambda order: quick(np.cos(order * phase)) + 1j * quick(np.sin(order * phase)),
    )


def _turn(rows: LogRows, joint: int) -> float:
    """Radians of phase for a unit of the coordinate: one on joints that turn, a whole turn a metre on slides."""
    return 1.0 if rows.prepared.motion.arm.joints[joint].revolute else 2.0 * np.pi


@dataclass(frozen=True)
class _Scores:
    """For each block and order: the sum (B, K) of what is left times the turning phase, and the rows that count; for
    each order the square (K,) of what is left on these rows. Orders with fewer rows than `fewest` are not seen."""

    sums: NDArray[np.complex128]
    count: Array
    square: Array
    fewest: int

    def power(self, signs: Array) -> Array:
        """The power (..., K) where blocks have these signs (..., B)."""
        rows = self.count.sum(axis=0)
        return np.where(rows > self.fewest, np.abs(signs @ self.sums) ** 2 / np.maximum(rows, 1.0), 0.0)


def _scores(signal: _Signal, orders: Sequence[float], band: tuple[float, float], fewest: int) -> _Scores:
    edges = np.flatnonzero(np.diff(signal.block, prepend=-1))
    sums = np.zeros((len(edges), len(orders)), dtype=np.complex128)
    count = np.zeros((len(edges), len(orders)))
    square = np.zeros(len(orders))
    for number, order in enumerate(orders):
        left = np.where(_in_band(signal, order, band), signal.left, 0.0)
        sums[:, number] = np.add.reduceat(left * np.exp(1j * order * signal.phase), edges)
        count[:, number] = np.add.reduceat((left != 0.0).astype(float), edges)
        square[number] = left @ left
    return _Scores(sums, count, square, fewest)


def _strongest(scores: _Scores, rng: np.random.Generator, rules: Rules) -> tuple[int, float] | None:
    """The order that stands out most, of its neighbours or of what is left, with the p-value of that; None where
    chance does as much."""
    blocks = len(scores.sums)
    power = scores.power(np.ones(blocks))
    seen = power > 0.0
    if seen.sum() < 4:
        return None
    enough = np.minimum(rules.motion.stands_out * _beside(power, seen), 0.5 * rules.motion.stands_alone * scores.square)
    standing = power / np.maximum(enough, 1e-300)
    at = int(np.argmax(standing))
    if standing[at] < 1.0:
        return None
    drawn = scores.power(rng.choice((-1.0, 1.0), size=(DRAWS, blocks))) / np.maximum(enough, 1e-300)
    p_value = float((1 + np.sum(drawn.max(axis=1) >= standing[at])) / (DRAWS + 1))
    return (at, p_value) if p_value <= rules.residual.level else None


def _beside(power: Array, seen: NDArray[np.bool_]) -> Array:
    """The median power of forty orders on either side (K,)."""
    values = np.where(seen, power, np.nan)
    ratios = np.empty(len(power))
    for k in range(len(power)):
        near = values[max(0, k - 40) : k + 41]
        ratios[k] = np.nanmedian(near) if np.isfinite(near).any() else 0.0
    return ratios
