"""The noise floor of a recording: how far readings of one pose, one after the other, differ.

Poses are compared after taking the nominal tip off, so that the last digits of the encoders do not count. Within each
group of repeats the scatter about the mean is the noise; rows that stand out are named, not used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtr, chdtrc, fdtri

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.level import stand_of
from linkwright.core.diagnose.instruments.placement import placed
from linkwright.core.diagnose.instruments.registry import kind_at
from linkwright.core.diagnose.instruments.view import viewed
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import format_quantity

from .robust_scale import qn, resolution
from .visits import differences_of_revisits, readings_of_a_pose, repeat_groups, visits_of_a_pose, without_drift

Rows = NDArray[np.int64]
Source = Literal["repeats", "declared", "revisits", "none"]

_FINEST = 1e-9
"""Metres: no instrument of an arm's size resolves less."""


@dataclass(frozen=True)
class NoiseFloor:
    """What one reading of the tip is off by where nothing is wrong.

    `sigma` (m) is the standard deviation of each component, None where nobody knows (`source` none);
    `degrees_of_freedom` that it rests on for each component (0: declared); with `source` revisits it is from poses that
    were come back to, and what changed between two visits is in it. `rms_m` is the RMS length of the error
    vector. `drift_m` is the RMS length by which poses that were visited again later had moved, noise taken off (where
    it is known), None where none were; `drift_degrees_of_freedom` of that. `outliers` are rows that stand out from
    repeats of their pose, `doubtful` rows that disagree in halves, of which nobody can say which is wrong.
    `resolution` (m) is given where readings are too coarse to show their noise. `sentence` says it all for people,
    `warnings` what is odd.
    """

    sigma: tuple[float, ...] | None
    source: Source
    degrees_of_freedom: int
    rms_m: float | None
    sentence: str
    drift_m: float | None = None
    drift_degrees_of_freedom: int = 0
    outliers: tuple[RejectedRow, ...] = ()
    doubtful: tuple[int, ...] = ()
    resolution: float | None = None
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Cleaned:
    """Groups of repeats without outliers: sums of squares about the means (D,), and where the groups are."""

    groups: tuple[Rows, ...]
    squares: Array
    degrees_of_freedom: int
    outliers: tuple[RejectedRow, ...]
    doubtful: tuple[int, ...]


def noise_floor(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> NoiseFloor:
    """The noise floor: from repeats where the recording has enough of them, else the declared sigma, else from poses
    that were come back to, else none.

    Outliers are sought with an F bound on the distance from the group's other readings, the scale being Qn
    first (Rousseeuw & Croux 1993, see `robust.qn`) and the pooled scatter of what is left after that.
    """
    if recording.slots is not None and (recording.slots != recording.slots[0]).any():
        return _of_each_kind(recording, arm, rules)
    residual = _against_nominal(recording, arm, rules)
    visited = repeat_groups(recording, arm, rules=rules)
    groups = without_drift(residual, visited, rules=rules)
    repeats = _repeats(residual, groups, recording, rules)
    known = _best_known(residual, groups, repeats, recording, arm, rules)
    drift, drift_dof = _drift(residual, groups, repeats.cleaned, known.sigma, recording, arm, rules)
    floor = None if known.sigma is None else float(np.sqrt(sum(item * item for item in known.sigma)))
    sentence = _sentence(floor, known.source, known.rested, len(repeats.cleaned.groups), recording.sigma)
    if known.source == "repeats" and len(groups) > len(visited):
        sentence = (
            f"The noise floor is {_length(floor or 0.0)} RMS ({known.rested} degrees of freedom a component), from "
            "neighbouring readings alone. The arm or the frame moved during the stay at a pose."
        )
    if repeats.coarse and known.source == "repeats":
        sentence += (
            f" Repeats are alike to the last digit, so it is the readings' resolution ({_length(repeats.step)})."
        )
    if drift is not None:
        moved = f"had moved by {_length(drift)} RMS" if drift > 0.0 else "had not moved"
        beyond = "noise included" if known.sigma is None else "beyond the noise"
        sentence += f" What was measured again at the same pose later {moved}, {beyond}."
    return NoiseFloor(
        known.sigma,
        known.source,
        known.rested,
        floor,
        sentence,
        drift,
        drift_dof,
        repeats.cleaned.outliers,
        repeats.cleaned.doubtful,
        repeats.step if repeats.coarse else None,
        tuple(_warnings(repeats, recording)),
    )


@dataclass(frozen=True)
class _Repeats:
    """What repeats say: their scatter (D,), m, where there are any; the least that rounding leaves (D,), m; the largest
    step of a column, m; whether the scatter is that of rounding; and whether it is beyond chance not the declared."""

    cleaned: _Cleaned
    measured: Array | None
    least: Array
    step: float
    coarse: bool
    disagree: bool


def _repeats(residual: Array, groups: Sequence[Rows], recording: Recording, rules: ResidualRules) -> _Repeats:
    width = recording.tip.shape[1]
    steps = [resolution(recording.tip[:, k]) or 0.0 for k in range(width)]
    least = np.array(steps) / np.sqrt(12.0)
    cleaned = _clean(residual, [group for group in groups if len(group) > 1], recording, least, rules)
    dof, declared = cleaned.degrees_of_freedom, recording.sigma
    if not dof:
        return _Repeats(cleaned, None, least, max(steps), False, False)
    measured = np.sqrt(cleaned.squares / dof)
    coarse = bool((measured <= least).all()) and bool(least.any())
    disagree = (
        declared is not None
        and not coarse
        and _differ(cleaned, declared_sigmas(recording, declared, width), width, rules.level)
    )
    return _Repeats(cleaned, np.maximum(np.maximum(measured, least), _FINEST), least, max(steps), coarse, disagree)


@dataclass(frozen=True)
class _Known:
    """The noise of each component (m), what it is from, and on how many degrees of freedom it rests."""

    sigma: tuple[float, ...] | None
    source: Source
    rested: int


def _best_known(
    residual: Array, groups: Sequence[Rows], repeats: _Repeats, recording: Recording, arm: Arm, rules: ResidualRules
) -> _Known:
    """From repeats where these are enough or contradict what is declared, else as declared, else from revisits."""
    width, dof, declared = recording.tip.shape[1], repeats.cleaned.degrees_of_freedom, recording.sigma
    enough = dof >= rules.enough_freedom and not repeats.coarse
    if repeats.measured is not None and (declared is None or repeats.disagree or enough):
        return _Known(tuple(float(item) for item in repeats.measured), "repeats", dof)
    if declared is not None:
        return _Known(
            tuple(np.maximum(declared_sigmas(recording, declared, width), repeats.least).tolist()), "declared", 0
        )
    again = differences_of_revisits(residual, readings_of_a_pose(groups, recording, arm, rules))
    # Neighbouring differences share a reading: two thirds of them are worth one each.
    rested = 2 * len(again) // 3
    if rested < rules.enough_freedom:
        return _Known(None, "none", rested)
    spread = (qn(np.concatenate([again[:, k], -again[:, k]])) for k in range(width))
    sigma = tuple(max(item, _FINEST, float(repeats.least[k])) for k, item in enumerate(spread))
    return _Known(sigma, "revisits", rested)


def _warnings(repeats: _Repeats, recording: Recording) -> Iterator[str]:
    """What is odd about repeats and what is declared."""
    cleaned, declared = repeats.cleaned, recording.sigma
    if repeats.disagree and repeats.measured is not None and declared is not None:
        yield (
            f"Repeats scatter by {_mean_text(repeats.measured)} a component, but the declared sigma is "
            f"{_length(declared)}: chance does not explain the difference ({cleaned.degrees_of_freedom} degrees of "
            "freedom)."
        )
    if declared is not None and declared < repeats.least.max():
        yield (
            f"The declared sigma of {_length(declared)} is less than readings in steps of {_length(repeats.step)} can "
            f"show. The rounding counts instead ({_length(float(repeats.least.max()))})."
        )
    if cleaned.doubtful:
        warning = f"Repeats disagree in {rows_text(cleaned.doubtful)}, and nothing says which are wrong."
        if recording.sides is None:
            warning += " Where a pose was reached from both sides, log them (dir1, ...)."
        yield warning


def _against_nominal(recording: Recording, arm: Arm, rules: ResidualRules) -> Array:
    """Measured less where the nominal arm would be (N, D), m, in the directions of the instrument."""
    if recording.slots is not None:
        tips, axes = nominal(arm, recording.q, 3)
        stand = stand_of(recording, arm)
        return viewed(recording, tips, axes, stand, flat=arm.planar(), rules=rules).residual
    free, tool = recording.frame == "free", recording.tool == "free"
    place = placed(arm, recording.q, recording.tip, frame=free, tool=tool)
    # Components are those of the measuring instrument: the residual is turned back into its frame.
    return place.residual @ place.rotation


def _of_each_kind(recording: Recording, arm: Arm, rules: ResidualRules) -> NoiseFloor:
    """The noise floor where each number is a separate reading: of each kind by itself, together by mean squares."""
    assert recording.slots is not None
    slots = recording.slots[:, 0]
    kinds = np.unique(slots).tolist()
    parts = [recording.kept(slots == kind) for kind in kinds]
    floors = [noise_floor(part, arm, rules=rules) for part in parts]
    share = np.array([part.size for part in parts]) / recording.size
    known = [floor.rms_m for floor in floors if floor.rms_m is not None]
    rms = float(np.sqrt(share @ np.square(known))) if len(known) == len(floors) else None
    return pooled_floor(floors, [kind_at(kind)[1].name for kind in kinds], None if rms is None else (rms,))


def pooled_floor(floors: Sequence[NoiseFloor], names: Sequence[str], sigma: tuple[float, ...] | None) -> NoiseFloor:
    """Several floors as one, of these standard deviations (m) and with all rows and sentences; from repeats only where
    each one is."""
    sources = {floor.source for floor in floors}
    source = floors[0].source if len(sources) == 1 else "none" if "none" in sources else "declared"
    labels = list(zip(names, floors, strict=True))
    return NoiseFloor(
        sigma,
        source,
        sum(floor.degrees_of_freedom for floor in floors) if source == "repeats" else 0,
        None if sigma is None else float(np.sqrt(sum(item * item for item in sigma))),
        " ".join(f"{name}: {floor.sentence}" for name, floor in labels),
        *_pooled_drift(floors),
        tuple(aside for floor in floors for aside in floor.outliers),
        tuple(sorted({row for floor in floors for row in floor.doubtful})),
        None,
        tuple(f"{name}: {text}" for name, floor in labels for text in floor.warnings),
    )


def _pooled_drift(floors: Sequence[NoiseFloor]) -> tuple[float | None, int]:
    """The drift (m) by mean squares, and its degrees of freedom."""
    again = [floor for floor in floors if floor.drift_m is not None]
    freedom = sum(item.drift_degrees_of_freedom for item in again)
    moved = sum((item.drift_m or 0.0) ** 2 * item.drift_degrees_of_freedom for item in again)
    return (float(np.sqrt(moved / freedom)) if freedom else None), freedom


def _clean(
    residual: Array, groups: Sequence[Rows], recording: Recording, least: Array, rules: ResidualRules
) -> _Cleaned:
    """Take rows that stand out of their groups, twice: by a robust scale, then by the scatter that is left; of a column
    that is constant or coarse the scale is what rounding leaves, `least` (D,), at least."""
    width = residual.shape[1]
    outliers: tuple[RejectedRow, ...] = ()
    doubtful: tuple[int, ...] = ()
    groups_kept = tuple(groups)
    squares, dof = _pooled(residual, groups_kept)
    for step in range(3):
        if dof < rules.enough_freedom:
            break
        if step == 0:
            contrasts = np.concatenate([_contrasts(residual[group]) for group in groups])
            scale = np.array([qn(np.concatenate([contrasts[:, k], -contrasts[:, k]])) for k in range(width)])
        else:
            scale = np.sqrt(squares / dof)
        scale = np.maximum(np.maximum(scale, least), _FINEST)
        if not (scale > _FINEST).any():
            break  # repeats alike to the last digit in all components, in steps of no decimal: they tell no scale
        groups_kept, outliers, doubtful = _without_outliers(residual / scale, groups, recording, rules)
        squares, dof = _pooled(residual, groups_kept)
    return _Cleaned(groups_kept, squares, dof, outliers, doubtful)


def _without_outliers(
    scaled: Array, groups: Sequence[Rows], recording: Recording, rules: ResidualRules
) -> tuple[tuple[Rows, ...], tuple[RejectedRow, ...], tuple[int, ...]]:
    count = sum(len(group) for group in groups)
    # The scale is an estimate itself, Qn's worth 0.8 of its degrees of freedom: hence F, not chi-square.
    width = scaled.shape[1]
    limit = width * float(fdtri(width, 0.8 * (count - len(groups)), 1.0 - rules.level / count))
    groups_kept: list[Rows] = []
    outliers: list[RejectedRow] = []
    doubtful: list[int] = []
    for group in groups:
        rows = group
        dropped: list[tuple[int, float]] = []
        while len(rows) > 2:
            others = (scaled[rows].sum(axis=0) - scaled[rows]) / (len(rows) - 1)
            squared = np.sum((scaled[rows] - others) ** 2, axis=1) * (len(rows) - 1) / len(rows)
            worst = int(np.argmax(squared))
            if squared[worst] <= limit:
                break
            in_order = scaled[rows] if worst == 0 else scaled[rows[::-1]]
            if worst in (0, len(rows) - 1) and _settles(in_order, rules):
                # Neither an outlier nor repeats: what was measured still moved.
                rows, dropped = rows[:0], []
                break
            dropped.append((int(rows[worst]), float(np.sqrt(squared[worst]))))
            rows = np.delete(rows, worst)
        if not len(rows):
            continue
        apart = len(rows) == 2 and np.sum((scaled[rows[0]] - scaled[rows[1]]) ** 2) / 2.0 > limit
        if apart or len(dropped) >= len(rows):  # halves, as two that differ, are no majority
            doubtful += [int(recording.row[index]) for index in group]
            continue
        for index, far in dropped:
            others = rows_text(recording.row[rows])
            reason = f"stands {far:.0f} standard deviations away from the repeats of its pose ({others})"
            outliers.append(RejectedRow(int(recording.row[index]), reason))
        groups_kept.append(rows)
    return tuple(groups_kept), tuple(sorted(outliers, key=lambda outlier: outlier.row)), tuple(sorted(doubtful))


def _settles(scaled: Array, rules: ResidualRules) -> bool:
    """Whether the second of three or more readings (m, D) of a visit, over their scatter, lies off the further ones the
    way the first does: an arm or an instrument that warms up."""
    later = scaled[2:].mean(axis=0)
    way = (scaled[0] - later) / np.linalg.norm(scaled[0] - later)
    return float((scaled[1] - later) @ way) > rules.beyond_chance * np.sqrt(1.0 + 1.0 / (len(scaled) - 2))


def _pooled(residual: Array, groups: Sequence[Rows]) -> tuple[Array, int]:
    squares = np.zeros(residual.shape[1])
    for group in groups:
        squares += np.sum((residual[group] - residual[group].mean(axis=0)) ** 2, axis=0)
    return squares, sum(len(group) - 1 for group in groups)


def _contrasts(values: Array) -> Array:
    """m readings (m, D) as m - 1 independent differences (Helmert's), each with the variance of one reading."""
    count = len(values)
    contrasts = [(values[:k].sum(axis=0) - k * values[k]) / np.sqrt(k * (k + 1.0)) for k in range(1, count)]
    return np.array(contrasts)


def declared_sigmas(recording: Recording, declared: float, width: int) -> Array:
    """The declared standard deviation of each component (D,), m."""
    axes = recording.sigma_axes
    return np.array(axes) if axes is not None and len(axes) == width else np.full(width, declared)


def _differ(cleaned: _Cleaned, declared: Array, width: int, chance: float) -> bool:
    """Whether the repeats' scatter is one that the declared sigma gives more seldom than `chance`."""
    total = float(np.sum(cleaned.squares / declared**2))
    dof = width * cleaned.degrees_of_freedom
    return min(float(chdtr(dof, total)), float(chdtrc(dof, total))) < chance / 2.0


def _drift(
    residual: Array,
    groups: Sequence[Rows],
    cleaned: _Cleaned,
    sigma: tuple[float, ...] | None,
    recording: Recording,
    arm: Arm,
    rules: ResidualRules,
) -> tuple[float | None, int]:
    """By how much (RMS length, m) visits of the same pose and condition differ beyond what noise explains."""
    bad = {outlier.row for outlier in cleaned.outliers} | set(cleaned.doubtful)
    good = [np.array([k for k in group if recording.row[k] not in bad], dtype=np.int64) for group in groups]
    squares, expected, dof = 0.0, 0.0, 0
    noise = 0.0 if sigma is None else sum(item * item for item in sigma)
    for again in visits_of_a_pose([group for group in good if len(group)], recording, arm, rules):
        if len(again) < 2:
            continue
        means = np.array([residual[visit].mean(axis=0) for visit in again])
        squares += float(np.sum((means - means.mean(axis=0)) ** 2))
        expected += noise * (1.0 - 1.0 / len(again)) * sum(1.0 / len(visit) for visit in again)
        dof += len(again) - 1
    if not dof:
        return None, 0
    over = squares - expected
    # Noise alone exceeds its expectation by about this much, which is then no drift.
    chance = rules.beyond_chance * expected * np.sqrt(2.0 / (dof * residual.shape[1]))
    return (float(np.sqrt(over / dof)) if over > chance else 0.0), dof


def _sentence(floor: float | None, source: Source, dof: int, groups: int, declared: float | None) -> str:
    if floor is None:
        return "There are no repeats and no declared sigma. Only the fit itself shows the noise."
    if source == "repeats":
        return (
            f"The noise floor is {_length(floor)} RMS, from {groups} poses read more than once "
            f"({dof} degrees of freedom a component)."
        )
    if source == "revisits":
        return (
            f"There are no repeats in a row. The noise floor of {_length(floor)} RMS is from poses visited again "
            f"({dof} degrees of freedom a component). Changes between two visits are included."
        )
    few = "too few repeats" if dof or groups else "no repeats"
    declared_text = "" if declared is None else f" of {_length(declared)} a component"
    return f"There are {few}, so the declared sigma{declared_text} counts: a noise floor of {_length(floor)} RMS."


def _length(value: float) -> str:
    return format_quantity(value, "length", digits=3)


def _mean_text(sigma: Array) -> str:
    return _length(float(np.sqrt(np.mean(sigma * sigma))))
