"""Whether readings of one pose refute a fit: the lack-of-fit test against pure error, and what noise leaves held out.

What is left splits into what readings of one visit differ by (pure error, no model changes it) and what their mean is
off by. With the right model both tell the same noise, and their ratio is F distributed (N. R. Draper & H. Smith,
Applied Regression Analysis, 3rd ed., Wiley 1998, 2.1). Noise with a memory makes readings of a visit look quieter than
they are and their mean noisier; both expectations are known then, and so are the degrees of freedom that count
(F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110, doi:10.2307/3002019; M. S. Bartlett, J. R. Statist. Soc. 98
(1935) 536, doi:10.2307/2342284). Where an arm comes back to poses less exactly than it stays there, visits of one pose
are the pure error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded
from scipy.special import fdtrc

from linkwright.core.diagnose.fitting.held_out import HeldOut
from linkwright.core.diagnose.fitting.room.small_causes import SmallCauses
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.robust_scale import resolution
from linkwright.core.diagnose.residual.visits import poses
from linkwright.core.diagnose.residual.wander import walks
from linkwright.core.diagnose.result import LackOfFit
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_ONE_SIDED = 1.64
"""Standard errors, one-sided 95 %: so much more than was found noise may remember, by either of two signs."""
_DRAWS = 99
"""Of noise, for what the fit would leave of it on parts of the workspace held out."""


Groups = NDArray[np.int64]


@dataclass(frozen=True)
class Split:
    """Sums of squares of (N, D) values about the means of their groups (`within`) and of those means (`between`), each
    with the degrees of freedom of one component, and with what it is expected to be for unit variance."""

    within: Array
    between: Array
    freedom: tuple[float, float]
    expected: tuple[float, float]


def split(values: Array, group: Groups, memory: float = 0.0) -> Split:
    """Split values, of which each is correlated by `memory` with the one before within its group."""
    count = np.bincount(group)
    means = np.stack([np.bincount(group, weights=column) / count for column in values.T], axis=1)
    within = np.sum((values - means[group]) ** 2, axis=0)
    between = np.sum(count[:, None] * means**2, axis=0)
    freedom, expected = _of_memory(count, memory)
    return Split(within, between, freedom, expected)


def _of_memory(count: Groups, memory: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Degrees of freedom within and between groups of so many values, and what the sums of squares are expected to be.

    Means of neighbouring groups are correlated too, which leaves fewer degrees of freedom (Bartlett)."""
    if memory <= 0.0:
        plain = (float(np.sum(count - 1)), float(len(count)))
        return plain, plain
    within, squared, between, kept = 0.0, 0.0, 0.0, 0.0
    for size, times in zip(*np.unique(count, return_counts=True), strict=True):
        lag = np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
        shared = memory**lag
        centred = shared - shared.mean(axis=0)
        mean = float(shared.sum()) / size
        within += times * (size - mean)
        squared += times * float(np.sum(centred * centred.T))
        between += times * mean
        beside = float(np.sum(memory ** (1.0 + np.add.outer(np.arange(size), np.arange(size))))) / size / mean
        kept += times * (1.0 - beside**2) / (1.0 + beside**2)
    return (within**2 / squared if squared > 0.0 else 0.0, kept), (within, between)


@dataclass(frozen=True)
class Ratio:
    """An F ratio, memory allowed for, its degrees of freedom and its p-value."""

    value: float
    freedom: tuple[float, float]
    p_value: float


def lack_of_fit(parts: Split, parameters: float) -> Ratio:
    """F of what a fit of so many parameters leaves, means against pure error.

    Components of different scatter count by their variances (G. E. P. Box, Ann. Math. Statist. 25 (1954) 290)."""
    width = len(parts.within)
    sigma2 = parts.within / max(parts.expected[0], 1e-300)
    equal = float(np.mean(sigma2) ** 2 / np.mean(sigma2**2)) if (sigma2 > 0.0).any() else 1.0
    fitted = 1.0 - parameters / (width * parts.expected[1]) if parts.expected[1] else 0.0
    below = float(np.sum(sigma2))
    if fitted <= 0.0 or below <= 0.0:
        return Ratio(float("nan"), (0.0, 0.0), 1.0)
    above = float(np.sum(parts.between)) / (parts.expected[1] * fitted)
    freedom = (width * equal * parts.freedom[1] * fitted, width * equal * parts.freedom[0])
    value = above / below
    return Ratio(value, freedom, float(fdtrc(*freedom, value)))


def refuted_by(
    observed: Observed,
    left: Array,
    held_out: HeldOut,
    parameters: int,
    *,
    seed: int,
    rules: Rules,
    small: SmallCauses | None = None,
) -> LackOfFit | None:
    """Whether readings of one pose refute what a fit of so many parameters leaves of the tip (N, D), m; None where too
    few were repeated or come back to.

    `held_out` are the same fit's parts of the workspace held out. `small` are causes too small to be named, for which
    there is room: what is left is seen through them, and they are fitted to what is not held out.
    """
    if small is not None:
        left = left - small.beyond_noise[:, : left.shape[1]]
    visit = np.unique(observed.block, return_inverse=True)[1].reshape(-1).astype(np.int64)
    memory = memory_at_most(left, visit, rules=rules)
    repeats = split(left, visit, memory)
    enough = repeats.freedom[0] >= rules.fitting.enough
    means = np.stack([np.bincount(visit, weights=column) / np.bincount(visit) for column in left.T], axis=1)
    conditions = np.unique(_conditions(observed)[_first(visit)], return_inverse=True)[1].reshape(-1).astype(np.int64)
    returns = split(means, conditions)
    come_back = returns.freedom[0] >= rules.fitting.least_parts
    least = _rounding(observed, left.shape[1])
    # Readings of a visit are rounded alike: of all of them together no less is off than of one.
    repeats = _no_finer(repeats, least**2 * observed.rows / (visit[-1] + 1))
    returns = _no_finer(returns, least**2)
    if not (enough or come_back) or not (repeats.within if enough else returns.within).any():
        return None
    again = come_back and (not enough or _returns_worse(returns, repeats, visit, rules))
    ratio = lack_of_fit(returns if again else repeats, float(parameters))
    reading = np.sqrt(repeats.within / repeats.expected[0]) if enough else np.zeros(left.shape[1])
    # How far visits differ holds their readings' noise as well.
    apart = np.sqrt(returns.within / returns.expected[0]) if again else np.zeros(left.shape[1])
    floor = float(np.sqrt(np.sum(reading**2 if not again else np.maximum(reading, apart) ** 2)))
    rng = np.random.default_rng(seed)
    shape = (observed.rows, left.shape[1], _DRAWS)
    noise = np.zeros((observed.rows, observed.residual.shape[1], _DRAWS))
    noise[:, : left.shape[1]] = reading[:, None] * remembering(rng, shape, memory)
    noise[:, : left.shape[1]] += (apart[:, None] * rng.standard_normal((visit[-1] + 1, *shape[1:])))[visit]
    if observed.wander > 0.0:
        walk = walks(observed.wanders, rng.standard_normal(shape))
        noise[:, : left.shape[1]] += (observed.scale[: left.shape[1]] * observed.loudness[:, None])[..., None] * walk
    if small is not None:
        noise += small.drawn(rng, _DRAWS)
    drawn = held_out.rms_of(noise)
    return LackOfFit(
        ratio=ratio.value,
        freedom=ratio.freedom,
        p_value=ratio.p_value,
        against="returns" if again else "repeats",
        times=rms_length(left) / floor,
        held_out_times=held_out.rms() / float(np.median(drawn)),
        held_out_p=float(np.mean(drawn >= held_out.rms())),
    )


def refutes(test: LackOfFit, rules: Rules) -> bool:
    """Whether readings of one pose refute a fit, or those held out do."""
    # Of thousands of readings the least blemish is beyond chance: it must be above the floor besides.
    misfit = test.p_value < rules.residual.surely and test.times > rules.fitting.at_the_floor
    return misfit or (test.held_out_p <= 0.0 and test.held_out_times > rules.answer.held_out_beyond)


def _rounding(observed: Observed, width: int) -> Array:
    """What rounding to the instrument's steps is off by (D,), m; shared by all where the frame was turned."""
    steps = np.array([resolution(observed.recording.tip[:, axis]) or 0.0 for axis in range(width)]) / np.sqrt(12.0)
    turned = observed.recording.frame == "free"
    return np.full(width, np.sqrt(np.mean(steps**2))) if turned else steps


def _no_finer(parts: Split, variance: Array) -> Split:
    """A split whose pure error is no less than that of these variances (D,)."""
    return replace(parts, within=np.maximum(parts.within, parts.expected[0] * variance))


def memory_at_most(left: Array, visit: Groups, *, rules: Rules) -> float:
    """The greatest correlation of each reading's noise with the one before that what is left (N, D) allows.

    Two signs must agree: readings next to each other of different visits, less what those of the visits after share as
    well (memory fades, physics that a block of visits has in common does not), and, where visits are of three readings
    or more, by how much more readings two apart differ than neighbours. What is left by wrong physics is alike at
    neighbouring poses, yet readings of one visit do not know of it.
    """
    scaled = left / np.maximum(np.sqrt(np.mean(left**2, axis=0)), 1e-300)
    next_to, lasting = _alike(scaled, visit)
    pairs = left.shape[1] * int(visit[-1])
    correlation = (next_to - lasting + _ONE_SIDED / np.sqrt(max(pairs, 1))) / (1.0 - lasting) if pairs else 0.0
    near, far = (np.flatnonzero(visit[lag:] == visit[:-lag]) for lag in (1, 2))
    if left.shape[1] * len(far) >= rules.fitting.enough:
        one, two = (float(np.mean((scaled[at + lag] - scaled[at]) ** 2)) for lag, at in ((1, near), (2, far)))
        error = np.sqrt(2.0 / (left.shape[1] * len(far)))
        correlation = min(correlation, two / max(one, 1e-300) * (1.0 + _ONE_SIDED * error) - 1.0)
    return min(max(correlation, 0.0), rules.answer.most_memory)


def _alike(scaled: Array, visit: Groups) -> tuple[float, float]:
    """The correlation of readings (N, D) with those just before of another visit, and the share of it that does not
    fade: w of w + (1 - w) rho^lag, which fits the correlations over three visits best, as few as tell w from rho."""
    reach = 3 * max(1, round(len(visit) / (int(visit[-1]) + 1)))
    lags, alike, pairs = list[int](), list[float](), list[int]()
    for lag in range(1, min(reach, len(visit) - 1) + 1):
        at = np.flatnonzero(visit[lag:] != visit[:-lag])
        before, after = scaled[at], scaled[at + lag]
        size = float(np.sqrt(np.sum(before**2) * np.sum(after**2)))
        if size > 0.0:
            lags.append(lag)
            alike.append(float(np.sum(before * after)) / size)
            pairs.append(before.size)
    if not lags:
        return 0.0, 0.0
    correlation, weight = np.array(alike), np.array(pairs, dtype=float)
    faded = np.linspace(0.0, 0.95, 96)[:, None] ** np.array(lags)
    lasting = np.sum(weight * (correlation - faded) * (1.0 - faded), axis=1) / np.sum(
        weight * (1.0 - faded) ** 2, axis=1
    )
    lasting = np.clip(lasting, 0.0, 0.95)
    missed = np.sum(weight * (correlation - faded - lasting[:, None] * (1.0 - faded)) ** 2, axis=1)
    return float(correlation[0]), float(lasting[np.argmin(missed)])


def _conditions(observed: Observed) -> Groups:
    """Which pose, payload, side and force (from 0) each reading is of."""
    recording = observed.recording
    held = [item for item in (recording.payload_mass, recording.sides, recording.force) if item is not None]
    rounded = [np.round(item.reshape(recording.size, -1) / observed.rules.residual.same_payload) for item in held]
    return (
        np.unique(np.column_stack([poses(observed), *rounded]), axis=0, return_inverse=True)[1]
        .reshape(-1)
        .astype(np.int64)
    )


def _first(visit: Groups) -> NDArray[np.int64]:
    return np.unique(visit, return_index=True)[1].astype(np.int64)


def _returns_worse(returns: Split, repeats: Split, visit: Groups, rules: Rules) -> bool:
    """Whether visits of one pose differ by more than their readings' noise explains."""
    means = float(np.mean(1.0 / np.bincount(visit))) * repeats.expected[1] / repeats.freedom[1]
    noise = float(np.sum(repeats.within)) / repeats.expected[0] * means
    width = len(repeats.within)
    ratio = float(np.sum(returns.within)) / returns.expected[0] / max(noise, 1e-300)
    return float(fdtrc(width * returns.freedom[0], width * repeats.freedom[0], ratio)) < rules.residual.level


def remembering(rng: np.random.Generator, shape: tuple[int, ...], memory: float) -> Array:
    """Noise of unit variance (N, ...) of which each reading keeps a share `memory` of the one before."""
    white = rng.standard_normal(shape)
    if memory <= 0.0:
        return white
    white[1:] *= np.sqrt(1.0 - memory * memory)
    kept = np.stack([np.ones(len(white)), np.full(len(white), -memory)])
    return solve_banded((1, 0), kept, white.reshape(len(white), -1)).reshape(shape)
