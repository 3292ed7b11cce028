"""Which readings belong together: visits, poses, and repeats that are no plain ones.

Repeats are the noise where nothing but noise can have happened between them. In a stay of hours the arm warms: then
only neighbours are repeats, and what lies between them is drift. Where a pose is only ever come back to (the cycles of
ISO 9283), visits next to each other in time are the nearest to repeats that there is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES

from .observed import Observed

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

_STEPS, _EVEN = 1.5, 0.02
"""Coordinates closer than so many steps of an encoder differ by one at most; steps that are whole numbers of the least
to within this share are an encoder's counts."""


def visits(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> NDArray[np.int64]:
    """Which visit (from 0) each reading belongs to: consecutive readings at one pose, payload and side."""
    new = _moved_on(recording, arm, rules)
    for held in (recording.payload_mass, recording.sides, recording.force, recording.observed_as):
        if held is not None:
            changed = np.diff(held, axis=0) != 0.0
            new |= changed if changed.ndim == 1 else changed.any(axis=1)
    block = np.concatenate([[0], np.cumsum(new)]).astype(np.int64)
    return block if recording.time is None else _long_stays_cut(block, rules.short_stay)


def stays(observed: Observed) -> NDArray[np.int64]:
    """Which stay (from 0) each reading (N,) belongs to: consecutive readings of one tip at one pose, under whatever
    payload and from whatever side."""
    recording = observed.recording
    new = _moved_on(recording, observed.arm, observed.rules.residual)
    for other in (recording.which, recording.tips):
        new |= np.diff(other) != 0
    return np.concatenate([[0], np.cumsum(new)]).astype(np.int64)


def _moved_on(recording: Recording, arm: Arm, rules: ResidualRules) -> NDArray[np.bool_]:
    """Whether each reading but the first is at another pose than the one before, (N - 1,)."""
    return np.any(np.abs(np.diff(recording.q, axis=0)) > same_pose(arm, rules), axis=1)


def same_pose(arm: Arm, rules: ResidualRules) -> Array:
    """How close coordinates (n,) of one pose lie, rad and m."""
    return np.array([rules.same_coordinate(joint.revolute) for joint in arm.joints])


def _long_stays_cut(block: NDArray[np.int64], short: int) -> NDArray[np.int64]:
    """Visits with long stays as several of a few readings each: meanwhile arms warm and frames drift."""
    count = np.bincount(block)
    within = np.arange(len(block)) - np.repeat(np.cumsum(count) - count, count)
    part = np.where(count[block] >= 2 * short, within // short, 0)
    new = (np.diff(block) != 0) | (np.diff(part) != 0)
    return np.concatenate([[0], np.cumsum(new)]).astype(np.int64)


def looks_quieter(observed: Observed) -> float:
    """How many times quieter readings of one visit look than they are, since each shares noise with the one before."""
    rho = observed.correlation
    if rho <= 0.0:
        return 1.0
    shared, pairs = 0.0, 0.0
    for rows in blocks_of(observed.block):
        lags = np.arange(1, len(rows))
        # Each visit counts by its degrees of freedom; its readings differ by what they do not share on average.
        variance_share = 2.0 * float(np.sum((len(rows) - lags) * rho**lags)) / max(len(rows) * (len(rows) - 1), 1)
        shared += (len(rows) - 1) * variance_share
        pairs += len(rows) - 1
    return 1.0 / np.sqrt(1.0 - shared / pairs) if pairs > 0.0 else 1.0


def poses(observed: Observed) -> NDArray[np.int64]:
    """Which pose (from 0) each reading belongs to, however often and under whatever load it was visited."""
    same = same_pose(observed.arm, observed.rules.residual)
    recording = observed.recording
    rounded = np.round(recording.q / (observed.rules.residual.one_pose * same)).astype(np.int64)
    # Two tips measured at once are two places.
    places = np.column_stack([recording.tips, rounded])
    return np.unique(places, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def one_condition(observed: Observed) -> bool:
    """Whether all readings are of one pose, payload, side, force and temperature, however often it was read."""
    recording = observed.recording
    near = observed.rules.residual.one_pose * same_pose(observed.arm, observed.rules.residual)
    held = [item for item in (recording.payload_mass, recording.sides, recording.force) if item is not None]
    still = bool((np.ptp(recording.q, axis=0) <= near).all())
    warmed = [item for item in (recording.temperature, recording.link_temperature) if item is not None]
    still &= all(float(np.ptp(item, axis=0).max()) <= observed.rules.residual.other_temperature for item in warmed)
    return still and all(float(np.ptp(item, axis=0).max()) <= observed.rules.residual.same_payload for item in held)


def blocks_of(block: NDArray[np.int64]) -> Sequence[NDArray[np.int64]]:
    """The row numbers of each visit."""
    order = np.argsort(block, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(block[order])) + 1)


def repeat_groups(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> tuple[Rows, ...]:
    """Visits: consecutive readings at one pose and condition, as indices (from 0) into the recording.

    Every reading is in one group, often alone. A pause of more than ten usual intervals begins a new group.
    """
    same = pose_tolerance(recording, arm, rules=rules)
    usual = np.inf
    if recording.time is not None and recording.size > 1:
        steps = np.diff(recording.time)
        usual = rules.long_pause * float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else np.inf
    held = [item for item in (recording.payload_mass, recording.sides, recording.force) if item is not None]
    changed = np.zeros(recording.size, dtype=bool)
    for each in held:
        columns = each.reshape(recording.size, -1)
        changed[1:] |= (np.abs(np.diff(columns, axis=0)) > 1e-6 + rules.same_payload * np.abs(columns[1:])).any(axis=1)
    if recording.observed_as is not None:
        changed[1:] |= (np.diff(recording.observed_as, axis=0) != 0).any(axis=1)
    if recording.velocity is not None:
        limit = 1e-3 + rules.other_speed * np.abs(recording.velocity[1:])
        changed[1:] |= (np.abs(np.diff(recording.velocity, axis=0)) > limit).any(axis=1)
    if recording.time is not None:
        changed[1:] |= np.abs(np.diff(recording.time)) > usual
    groups: list[list[int]] = [[0]] if recording.size else []
    for index in range(1, recording.size):
        first = groups[-1][0]
        apart = np.abs(recording.q[index] - recording.q[first]) > same
        if changed[index] or apart.any():
            groups.append([index])
        else:
            groups[-1].append(index)
    return tuple(np.array(group, dtype=np.int64) for group in groups)


def pose_tolerance(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> Array:
    """How far coordinates (n,) may differ at one pose: rad, m."""
    tolerances: list[float] = []
    for index, joint in enumerate(arm.joints):
        least = rules.same_coordinate(joint.revolute)
        most = rules.coarsest * least
        tolerances.append(min(max(_STEPS * _count(recording.q[:, index], most), least), most))
    return np.array(tolerances)


def _count(values: Array, largest: float) -> float:
    """The step of an encoder that counts coarsely, 0 where there is none below `largest`."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > 1e-9]
    if len(steps) < 2 or (least := float(steps.min())) > largest:
        return 0.0
    counts = steps / least
    return least if np.all(np.abs(counts - np.round(counts)) < _EVEN * np.maximum(counts, 1.0)) else 0.0


def visits_of_a_pose(visits: Sequence[Rows], recording: Recording, arm: Arm, rules: ResidualRules) -> list[list[Rows]]:
    """Visits together that were of one pose and condition."""
    same = rules.one_pose * pose_tolerance(recording, arm, rules=rules)
    keys: dict[tuple[int, ...], list[Rows]] = {}
    for visit in visits:
        key = [*np.round(recording.q[visit].mean(axis=0) / same).astype(int).tolist()]
        for held in (recording.payload_mass, recording.sides, recording.force, recording.observed_as):
            if held is not None:
                key += np.round(held.reshape(recording.size, -1)[visit[0]] / 1e-3).astype(int).tolist()
        keys.setdefault(tuple(key), []).append(visit)
    return list(keys.values())


def readings_of_a_pose(groups: Sequence[Rows], recording: Recording, arm: Arm, rules: ResidualRules) -> list[Rows]:
    """The readings of each pose and condition in the order of time."""
    visits: list[Rows] = []
    for again in visits_of_a_pose(groups, recording, arm, rules):
        rows = np.concatenate(again)
        visits.append(rows if recording.time is None else rows[np.argsort(recording.time[rows], kind="stable")])
    return visits


def without_drift(
    residual: Array, groups: Sequence[Rows], *, rules: ResidualRules = RULES.residual
) -> tuple[Rows, ...]:
    """Groups of repeats (indices of `residual`, (N, D) m), long ones that drift cut into short runs.

    Whether they drift tells the scatter of the runs' means against that within runs (F test over all components).
    """
    rows_kept: list[Rows] = []
    for group in groups:
        drifts = len(group) >= 3 * rules.neighbours and _drifts(residual[group], rules)
        rows_kept += _runs(group, rules.neighbours) if drifts else [group]
    return tuple(rows_kept)


def _runs(group: Rows, together: int) -> list[Rows]:
    return np.array_split(group, len(group) // together)


def _drifts(values: Array, rules: ResidualRules) -> bool:
    runs = [values[run] for run in _runs(np.arange(len(values)), rules.neighbours)]
    within = sum(float(np.sum((run - run.mean(axis=0)) ** 2)) for run in runs)
    middle = values.mean(axis=0)
    between = sum(len(run) * float(np.sum((run.mean(axis=0) - middle) ** 2)) for run in runs)
    width = values.shape[1]
    of_within, of_between = width * (len(values) - len(runs)), width * (len(runs) - 1)
    if within <= 0.0:
        return between > 0.0
    ratio = between / of_between / (within / of_within)
    return float(fdtrc(of_between, of_within, ratio)) < rules.surely


def differences_of_revisits(residual: Array, visits: Sequence[Rows]) -> Array:
    """Differences (m, D), m, of readings at one pose and condition that follow each other in time, each with the
    variance of one reading; `visits` are the readings of each pose and condition in the order of time.

    Slow drift is nearly out of them (J. von Neumann, Ann. Math. Statist. 12 (1941) 367, doi:10.1214/aoms/1177731677).
    """
    differences = [np.diff(residual[rows], axis=0) / np.sqrt(2.0) for rows in visits if len(rows) > 1]
    return np.concatenate(differences) if differences else np.zeros((0, residual.shape[1]))
