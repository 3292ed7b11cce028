"""How loud recordings are, how much each column scatters, which readings lie far off and what the noise remembers: from
what a rough model leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.robust_scale import HUBER
from linkwright.core.diagnose.residual.visits import blocks_of, looks_quieter
from linkwright.core.sections.numeric import Array


def first_scale(observed: Observed) -> Array:
    """Equal weights for the tip's components; for other channels, what makes them weigh alike."""
    spread = np.sqrt(np.mean(observed.residual**2, axis=0))
    width = observed.components
    tip = float(np.sqrt(np.mean(spread[:width] ** 2)))
    scale = np.where(spread > 0.0, spread, 1.0)
    scale[:width] = tip if tip > 0.0 else 1.0
    return scale


def bad_rows_down(observed: Observed, columns: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Patterns (N, C, d) as one (N, C, k), how much of each fits the readings best (k,), rows that lie far off weighed
    down, and the rows' weights (N,)."""
    stacked = np.concatenate(columns, axis=2)
    design, target = observed.scaled(stacked), observed.scaled(observed.residual)
    weight: Array = np.ones(len(target))
    values: Array = np.zeros(design.shape[2])
    for _ in range(6):
        root = np.sqrt(weight)[:, None]
        if len(values):
            rows = observed.without_memory(design * root[:, :, None]).reshape(-1, len(values))
            fitted = np.linalg.lstsq(rows, observed.without_memory(target * root).reshape(-1), rcond=1e-9)
            values = np.asarray(fitted[0], dtype=float)
        size = np.sqrt(np.sum((target - design @ values) ** 2, axis=1))
        middle = float(np.median(size))
        weight = np.minimum(1.0, HUBER * middle / np.maximum(size, 1e-300)) if middle > 0.0 else weight
    return stacked, values, weight


def loudness(left: Array, observed: Observed) -> Array | None:
    """How loud each of several recordings (and of kinds of numbers) is beside the others (R,), their geometric mean
    being one, by the robust scatter of the tip in what a rough model leaves (N, C); None of one."""
    which = observed.loud_with
    if not which.any():
        return None
    size = np.abs(left[:, : observed.components])
    medians = np.array(
        [np.median(size[which == one]) if (which == one).any() else 0.0 for one in range(which.max() + 1)]
    )
    medians = np.where(medians > 0.0, medians, max(float(np.median(size)), 1e-12))
    return medians / float(np.exp(np.mean(np.log(medians))))


def scatter_of(left: Array, observed: Observed) -> Array:
    """The robust scatter of each column: from the median absolute value, drawn towards a common one of the tip's
    components where readings are few."""
    spread = 1.4826 * np.median(np.abs(left), axis=0)
    plain = np.sqrt(np.mean(left**2, axis=0))
    spread = np.where(spread > 1e-3 * plain, spread, plain)
    spread = np.where(spread > 0.0, spread, observed.scale)
    width = observed.components
    common = float(np.exp(np.mean(np.log(spread[:width]))))
    trust = len(left) / (len(left) + observed.rules.fitting.own_scatter)
    spread[:width] = np.exp(trust * np.log(spread[:width]) + (1.0 - trust) * np.log(common))
    if observed.recording.sigma_angle is not None:
        spread[observed.turn_columns] = np.maximum(spread[observed.turn_columns], observed.recording.sigma_angle)
    return spread


def outliers_of(scaled: Array, observed: Observed) -> NDArray[np.bool_]:
    """Readings (N, C), over their scatter, that lie far off and are no part of the mismatch: a handful anywhere; where
    they are many, those that the other readings of their visit do not bear out. Repeats that are mostly alike to
    the last digit are one count of an encoder written down again, and bear nothing out."""
    width, rules = observed.components, observed.rules.fitting
    tip = scaled[:, :width]
    distance = np.sqrt(np.sum(tip**2, axis=1))
    limit = rules.outlier_margin * np.sqrt(chdtri(width, rules.far_tail / len(scaled)))
    far = distance > limit
    # Readings of one visit that all lie far off and agree with each other: that is the pose, not the readings.
    visit = np.unique(observed.block, return_inverse=True)[1].reshape(-1)
    count, outside = np.bincount(visit), np.bincount(visit, weights=far)
    whole = (count > 1) & (outside == count)
    means = np.stack([np.bincount(visit, weights=part) / count for part in tip.T], axis=1)
    apart = (
        np.bincount(visit, weights=np.sum((tip - means[visit]) ** 2, axis=1)) > (limit * np.maximum(count - 1, 1)) ** 2
    )
    far &= ~(whole & ~apart)[visit]
    far &= ~_warming_up(tip, far, observed)
    if far.mean() <= rules.most_outliers:
        return far
    if _mostly_alike(observed, visit, count):
        return np.zeros(len(far), dtype=bool)
    alone = far & ((count > outside) | (whole & apart))[visit]
    return alone if alone.mean() <= rules.most_alone else np.zeros(len(far), dtype=bool)


def _mostly_alike(observed: Observed, visit: NDArray[np.int64], count: NDArray[np.int64]) -> bool:
    """Whether most readings of visits (numbered, with so many readings each) that were repeated say just the same."""
    tip = observed.recording.tip
    repeated = np.flatnonzero((count[visit[1:]] > 1) & (visit[1:] == visit[:-1]))
    return len(repeated) > 0 and float(np.mean((tip[repeated + 1] == tip[repeated]).all(axis=1))) > 0.5


def _warming_up(tip: Array, far: NDArray[np.bool_], observed: Observed) -> NDArray[np.bool_]:
    """Which readings that lie far off (N, D) begin a recording together and come nearer the same way, the first that
    is not far off among them: something settles."""
    run = int(np.argmin(far)) if not far.all() else len(far)
    warming = np.zeros(len(far), dtype=bool)
    if run == 0:
        return warming
    first = tip[: run + 1]
    if len(first) < 2 or np.linalg.norm(first[-1]) < observed.rules.residual.beyond_chance:
        return warming
    unit = first / np.linalg.norm(first, axis=1)[:, None]
    same_way = np.sum(unit[1:] * unit[:-1], axis=1) > observed.rules.fitting.same_way
    warming[:run] = bool(same_way.all())
    return warming


def _mixed(observed: Observed) -> bool:
    """Whether each number is a separate reading, so that neighbours in the file are of different instruments."""
    slots = observed.recording.slots
    return slots is not None and bool((slots != slots[0]).any())


def memory_of(scaled: Array, observed: Observed) -> float:
    """The correlation of each reading's noise with the one before, from the tip's components at neighbours of different
    visits (what a visit's readings share may be the pose's own); 0 where it is not beyond doubt."""
    across, rules = np.flatnonzero(np.diff(observed.block) != 0), observed.rules.fitting
    if len(across) < rules.enough or _mixed(observed):
        return 0.0
    clipped = np.clip(scaled[:, : observed.components], -HUBER, HUBER)
    before, after = clipped[across], clipped[across + 1]
    size = np.sqrt(np.sum(before**2) * np.sum(after**2))
    rho = float(np.sum(before * after) / size) if size > 0.0 else 0.0
    return min(rho, rules.most_memory) if rho > observed.rules.residual.beyond_chance / np.sqrt(before.size) else 0.0


def independent_share(observed: Observed, left: Array, noise_floor: float | None) -> float:
    """One over the design effect of L. Kish, Survey Sampling (Wiley, 1965), 8.2, of visits as clusters, where a rough
    model leaves (N, C) far more than repeats of a pose differ by; else 1."""
    if noise_floor is None:
        return 1.0
    floor, remains = noise_floor * looks_quieter(observed), rms_length(observed.still(left[:, : observed.components]))
    if remains <= observed.rules.fitting.far_above * floor:
        return 1.0
    if not comes_anew(observed):
        return 1.0
    size = observed.rows / len(blocks_of(observed.block))
    return 1.0 / (1.0 + (size - 1.0) * (1.0 - (floor / remains) ** 2))


def comes_anew(observed: Observed) -> bool:
    """Whether the arm moved before most visits: a long stay that is cut into visits shares nothing within each."""
    new = np.flatnonzero(np.diff(observed.block) != 0)
    channels = [observed.recording.q, *(part for part in (observed.recording.sides,) if part is not None)]
    moved = np.any([(part[new + 1] != part[new]).any(axis=1) for part in channels], axis=0)
    return len(new) > 0 and float(np.mean(moved)) > 0.5
