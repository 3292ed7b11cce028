"""When what acts for a while begins and ends: each pair of instants by how likely the torques are with the best sizes.

What acts between two instants is cut to them before the low-pass that the torques have passed. Cut after it, a short
push would pass for a longer and weaker one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from linkwright.core.diagnose.motion.model.groups import Group
from linkwright.core.diagnose.motion.model.rows import LogRows
from linkwright.core.diagnose.motion.model.steps import Step, SteppedFit
from linkwright.core.diagnose.motion.preparation import low_pass
from linkwright.core.diagnose.motion.result import Instant
from linkwright.core.diagnose.result import HALF
from linkwright.core.sections.numeric import Array

_INSTANTS = 33
"""Instants that are tried at once on either side."""
_ROUNDS = 8
"""Times that instants are tried closer to where they are likely, at most."""
_BARELY = 8.0
"""Nats by which a pair of instants may be less likely than the best and still count."""
_AT_ONCE = 256
"""Rows that are cut to all instants at once: what is held grows with its square."""
SETTLED = 2.0
"""Low-pass periods after which one part in a thousand of an edge is left."""
_TAIL = 0.025
"""What lies beyond either end of a 95 % interval."""

_Span = tuple[float, float]
"""Instants, s."""


@dataclass(frozen=True)
class Pairs:
    """Pairs of `starts` and `ends` (K,) s, one end that is infinite for what lasts: how many nats each gains (`gain`,
    (K, K)), by `numbers` (K, K, d) of `spread` (K, K, d, d)."""

    starts: Array
    ends: Array
    gain: Array
    numbers: Array
    spread: Array

    @property
    def chance(self) -> Array:
        """How likely each is (K, K)."""
        likely = np.exp(self.gain - self.gain.max())
        return np.asarray(likely / likely.sum())

    def drawn(self, count: int, rng: np.random.Generator) -> Array:
        """So many draws of the numbers (count, d), each of a pair as it is likely."""
        rank = self.numbers.shape[-1]
        which = rng.choice(self.gain.size, count, p=self.chance.ravel())
        scale = np.linalg.cholesky(self.spread.reshape(-1, rank, rank)[which])
        off = np.einsum("ckl,cl->ck", scale, rng.standard_normal((count, rank)))
        return self.numbers.reshape(-1, rank)[which] + off


@dataclass(frozen=True)
class Placed:
    """A step with its instants (`end` None: the log's), its numbers and their covariance over all `pairs` of these; the
    sizes `common` (W,) of the model's columns beside it, and what it has `added` to the torques (M, n), N*m."""

    step: Step
    start: Instant
    end: Instant | None
    common: Array
    added: Array
    pairs: Pairs


def placed(rows: LogRows, fit: SteppedFit, step: Step, start: float, end: float | None) -> Placed:
    """A step beside the whole library, its instants sought from a `start` and an `end` (s; None: it lasts) on.

    Args:
        rows: The log's.
        fit: The whole library without any step.
        step: The group, and the parts of the log in which it acts.
        start: Where it may begin, s.
        end: Where it may end, s.
    """
    prepared, design = rows.prepared, _design(rows, step.group)
    clock = prepared.motion.time[prepared.kept]
    reach = 1.0 / min(prepared.cutoff, prepared.rate)
    spans = [(time - reach, time + reach) for time in (start, end) if time is not None]
    spans = [(max(low, clock[0]), min(high, clock[-1])) for low, high in spans]

    def tried(spans: Sequence[_Span]) -> Pairs:
        first, *last = (np.linspace(*span, _INSTANTS) for span in spans)
        return _pairs(rows, fit, step.group, design, first, last[0] if last else np.array([np.inf]))

    pairs = tried(spans)
    for _ in range(_ROUNDS):
        before, gain = spans, pairs.gain
        grids = (pairs.starts, pairs.ends)[: len(spans)]
        spans = [_closer(grid, gain.max(axis=1 - axis), clock) for axis, grid in enumerate(grids)]
        if all(
            then[0] <= now[0] and now[1] <= then[1] and now[1] - now[0] > HALF * (then[1] - then[0])
            for now, then in zip(spans, before, strict=True)
        ):
            break
        pairs = tried(spans)
    return _chosen(rows, fit, step, design, pairs)


def _closer(grid: Array, gain: Array, clock: Array) -> _Span:
    """The instants between which any is likely, by the best of each; beyond the grid where its ends are."""
    likely, apart = np.flatnonzero(gain > gain.max() - _BARELY), grid[1] - grid[0]
    beyond = _INSTANTS // 2 * apart
    low = grid[0] - beyond if likely[0] == 0 else grid[likely[0]] - apart
    high = grid[-1] + beyond if likely[-1] == len(grid) - 1 else grid[likely[-1]] + apart
    return float(max(low, clock[0])), float(min(high, clock[-1]))


def _design(rows: LogRows, group: Group) -> Array:
    """What one unit of each number of a group takes of the drives all the time (M, n, d), filtered."""
    width = 1 + max(int(columns.max(initial=0)) for columns in rows.columns)
    sizes = np.zeros((group.rank, width))
    sizes[:, group.columns] = group.mixing.T
    return np.stack([rows.explained(each) for each in sizes], axis=2)


def _since(rows: LogRows, design: Array, instants: Array, at: NDArray[np.int64]) -> Array:
    """The same at some rows (R,) of what acts from each of some instants (K,) on (K, R, n, d)."""
    prepared, finite = rows.prepared, instants[np.isfinite(instants)]
    time, kept, step = prepared.motion.time, prepared.kept, 1.0 / prepared.rate
    made = (time[kept[at]] >= instants[:, None])[..., None, None] * design[at]
    if prepared.low_pass is None or not len(finite):
        return made
    reach = SETTLED / prepared.cutoff
    near = (time[kept[at]] >= finite.min() - reach) & (time[kept[at]] <= finite.max() + reach)
    here = at[near]
    if not len(here):
        return made
    lags = int(np.ceil(reach * prepared.rate)) + 8
    pulse = low_pass((np.arange(2 * lags + 1) == lags).astype(float), prepared.cutoff, prepared.rate)
    samples = np.arange(max(int(kept[here[0]]) - lags, 0), min(int(kept[here[-1]]) + lags + 1, len(time)))
    lag = kept[here][:, None] - samples
    passed = np.where(np.abs(lag) <= lags, pulse[np.clip(lag + lags, 0, 2 * lags)], 0.0)
    stretch = np.searchsorted([part.start for part in prepared.stretches], np.arange(len(time)), side="right")
    passed *= stretch[kept[here]][:, None] == stretch[samples]
    passed /= passed.sum(axis=1, keepdims=True)
    around = slice(max(int(np.searchsorted(kept, samples[0])) - 2, 0), int(np.searchsorted(kept, samples[-1])) + 2)
    clock = time[kept[around]]
    curve = CubicSpline(clock, design[around].reshape(len(clock), -1))
    values = curve(np.clip(time[samples], clock[0], clock[-1]))
    acts = np.clip((time[samples] - instants[:, None]) / step + 0.5, 0.0, 1.0)  # a sample stands for the time about it
    weighed = (acts[:, None] * passed).reshape(-1, len(samples)) @ values
    # The curve goes through filtered columns: what the low-pass makes of it once more is given back.
    lost = design[here].reshape(len(here), -1) - passed @ values
    weighed = weighed.reshape(len(instants), len(here), -1) + (acts @ passed.T)[..., None] * lost
    made[:, near] = weighed.reshape(len(instants), len(here), *design.shape[1:])
    return made


def _near(rows: LogRows, *instants: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows that go by which of some starts and ends it is, and those between, where it does not matter."""
    prepared = rows.prepared
    clock = prepared.motion.time[prepared.kept]
    reach = 0.0 if prepared.low_pass is None else SETTLED / prepared.cutoff
    near = np.zeros(len(clock), dtype=bool)
    for each in instants:
        near |= (clock >= each.min() - reach) & (clock <= each.max() + reach)
    between = (clock > instants[0].max()) & (clock < instants[1].min()) & ~near
    return np.flatnonzero(near), np.flatnonzero(between)


def _pairs(rows: LogRows, fit: SteppedFit, group: Group, design: Array, starts: Array, ends: Array) -> Pairs:
    """What a group gains between each of some starts and each of some ends, beside the whole library."""
    at, between = _near(rows, starts, ends)
    count, rank = len(starts) + len(ends), group.rank
    gram, against = np.zeros((count * rank, count * rank)), np.zeros(count * rank)
    across = np.zeros((fit.motion.width, count * rank))

    def counted(numbers: NDArray[np.int64], columns: Array, copies: int) -> None:
        """What so many copies of columns (R, n, d) at rows (R,) add to the sums."""
        span = slice(0, copies * columns.shape[2])
        for joint, where in enumerate(rows.columns):
            here, held = columns[:, joint], rows.design[joint][numbers]
            weight = fit.weights[joint] * rows.prepared.moving[numbers, joint]
            left = rows.target[numbers, joint] - held @ fit.common[where]
            weighed = weight[:, None] * here
            gram[span, span] += np.tile(here.T @ weighed, (copies, copies))
            against[span] += np.tile(weighed.T @ left, copies)
            across[where, span] += np.tile(held.T @ weighed, copies)

    for some in np.array_split(at, 1 + len(at) // _AT_ONCE):
        one, other = (_since(rows, design, instants, some) for instants in (starts, ends))
        columns = np.concatenate((one, other)).transpose(1, 2, 0, 3)
        counted(some, columns.reshape(*columns.shape[:2], -1), 1)
    counted(between, design[between], len(starts))
    gram -= across.T @ fit.covariance[: len(across), : len(across)] @ across
    inner, score = gram.reshape(count, rank, count, rank), against.reshape(count, rank)
    first, last = np.arange(len(starts))[:, None], len(starts) + np.arange(len(ends))
    precision = np.diag(1.0 / group.usual**2)
    whole = inner[first, :, first, :] + inner[last, :, last, :] - inner[first, :, last, :] - inner[last, :, first, :]
    whole = whole + precision
    spread = np.asarray(np.linalg.inv(whole), dtype=float)
    told = score[first] - score[last]
    numbers = np.einsum("ijkl,ijl->ijk", spread, told)
    widths = np.linalg.slogdet(whole)[1] - np.linalg.slogdet(precision)[1]
    gain = 0.5 * (np.einsum("ijk,ijk->ij", told, numbers) - widths)
    apart = ends >= starts[:, None] + 1.0 / rows.prepared.rate
    return Pairs(starts, ends, np.where(apart, gain, -np.inf), numbers, spread)


def _chosen(rows: LogRows, fit: SteppedFit, step: Step, design: Array, pairs: Pairs) -> Placed:
    """The likeliest pair; numbers and their covariance are those of all pairs, each as it is likely."""
    likely = pairs.chance
    first, last = divmod(int(np.argmax(pairs.gain)), len(pairs.ends))
    numbers = np.einsum("ij,ijk->k", likely, pairs.numbers)
    off = pairs.numbers - numbers
    spread = np.einsum("ij,ijkl->kl", likely, pairs.spread + off[..., :, None] * off[..., None, :])
    half = 0.5 / rows.prepared.rate  # nobody knows what is between two samples

    def instant(instants: Array, chance: Array, best: int) -> Instant:
        total = np.cumsum(chance)
        low, high = np.searchsorted(total, (_TAIL, 1.0 - _TAIL))
        high = min(int(high), len(instants) - 1)
        return Instant(float(instants[best]), (float(instants[low]) - half, float(instants[high]) + half))

    every = np.arange(len(design))
    one, other = (
        _since(rows, design, instants[[best]], every)[0]
        for instants, best in ((pairs.starts, first), (pairs.ends, last))
    )
    columns, across = one - other, np.zeros((fit.motion.width, step.group.rank))
    for joint, where in enumerate(rows.columns):
        weight = fit.weights[joint] * rows.prepared.moving[:, joint]
        across[where] += rows.design[joint].T @ (weight[:, None] * columns[:, joint])
    # What is added is by the sizes of the likeliest pair, which the torques fit best.
    common = fit.common - fit.covariance[: len(across), : len(across)] @ (across @ pairs.numbers[first, last])
    return Placed(
        replace(step, numbers=numbers, covariance=spread, gain=float(pairs.gain.max())),
        instant(pairs.starts, likely.sum(axis=1), first),
        instant(pairs.ends, likely.sum(axis=0), last) if np.isfinite(pairs.ends).all() else None,
        common,
        columns @ pairs.numbers[first, last],
        pairs,
    )
