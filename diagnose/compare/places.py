"""How the mismatch of two recordings differs at poses that both hold, and region by region."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.answer.iso_figures import LEAST_VISITS, clusters
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import same_pose
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

_CELLS = 3
"""Regions along an axis, into which a table cuts the workspace."""


@dataclass(frozen=True)
class SharedPoses:
    """The poses (with the same load) that both recordings hold: how many, the RMS of the mean mismatch there in each
    (m), and `moved`, that of the difference; `by_chance` is what `moved` would be from noise alone (None: unknown)."""

    count: int
    first: float
    second: float
    moved: float
    by_chance: float | None


@dataclass(frozen=True)
class Region:
    """A box of the workspace (corners in m) with readings of both: the RMS mismatch in each (m), and their numbers."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    first: float
    second: float
    counts: tuple[int, int]


def shared_poses(arm: Arm, first: Diagnosis, second: Diagnosis, *, rules: Rules = RULES) -> SharedPoses | None:
    """How the mismatch differs at poses that both recordings hold under the same load; None where there are none."""
    recordings = (first.recording, second.recording)
    same = same_pose(arm, rules.residual)
    points = np.concatenate([recording.q / same for recording in recordings])
    loads = np.concatenate([_load(recording, arm) for recording in recordings])
    labels = clusters(np.concatenate([points, loads[:, None] / rules.residual.same_payload], axis=1))
    count = recordings[0].size
    parts = (labels[:count], labels[count:])
    both = np.intersect1d(*parts)
    if not len(both):
        return None
    means: list[Array] = []
    visits: list[Array] = []
    for residual, part in zip((first.residual_before, second.residual_before), parts, strict=True):
        means.append(np.stack([residual[part == label].mean(axis=0) for label in both]))
        visits.append(np.array([float(np.sum(part == label)) for label in both]))
    floors = (first.noise_floor, second.noise_floor)
    chance = None
    if floors[0] is not None and floors[1] is not None:
        chance = float(np.sqrt(np.mean(floors[0] ** 2 / visits[0] + floors[1] ** 2 / visits[1])))
    moved = rms_length(means[1] - means[0])
    return SharedPoses(len(both), rms_length(means[0]), rms_length(means[1]), moved, chance)


def _load(recording: Recording, arm: Arm) -> Array:
    if recording.payload_mass is None:
        return np.full(recording.size, arm.payload.mass)
    return recording.payload_mass


def regions(arm: Arm, first: Diagnosis, second: Diagnosis) -> tuple[Region, ...]:
    """The mismatch in boxes of the workspace where both recordings have readings."""
    residuals = (first.residual_before, second.residual_before)
    if residuals[0].shape[1] != residuals[1].shape[1]:
        return ()
    # Where the tip nominally is: measured positions may stand in a separate frame.
    tips = [tip_position(arm, item.recording.q)[:, : residuals[0].shape[1]] for item in (first, second)]
    every = np.concatenate(tips)
    lower, upper = every.min(axis=0), every.max(axis=0)
    span = np.where(upper > lower, upper - lower, 1.0)
    cells = [np.clip((_CELLS * (tip - lower) / span).astype(int), 0, _CELLS - 1) for tip in tips]
    regions_: list[Region] = []
    for cell in itertools.product(range(_CELLS), repeat=every.shape[1]):
        inside = [(item == np.array(cell)).all(axis=1) for item in cells]
        counts = (int(inside[0].sum()), int(inside[1].sum()))
        if min(counts) >= LEAST_VISITS:
            corner = lower + np.array(cell) * span / _CELLS
            sizes = [rms_length(residual[rows]) for residual, rows in zip(residuals, inside, strict=True)]
            end = corner + span / _CELLS
            regions_.append(Region(tuple(corner.tolist()), tuple(end.tolist()), sizes[0], sizes[1], counts))
    return tuple(regions_)
