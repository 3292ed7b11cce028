"""Where what goes with time can be distinguished from what goes with the arm's pose.

A recording that goes from pose to neighbouring pose goes through its poses and through time together: what the arm
does there looks like an instrument that wanders. The two are distinguished by readings near in time and far in pose, or
by poses that are come back to; where there are neither, physics goes first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class JudgedVisits:
    """Visits by which a wander can be judged: their numbers `visit` (V,), and to which pose and condition each comes
    back (V,), where that is what tells; None where neighbours in time are far apart in pose."""

    visit: NDArray[np.int64]
    back: NDArray[np.int64] | None

    def of(self, means: Array) -> Array:
        """Means (all visits, D) as values (V, D) that no pose has part in: what comes back less the mean there."""
        values = means[self.visit]
        if self.back is None:
            return values
        count = np.bincount(self.back)
        middle = np.stack([np.bincount(self.back, weights=column) / count for column in values.T], axis=1)
        return values - middle[self.back]


def time_vs_path(
    recording: Recording, arm: Arm, pose: NDArray[np.int64], first: NDArray[np.int64], *, rules: FittingRules
) -> JudgedVisits | None:
    """The visits that tell, None where time and pose go together. `pose` (N,) numbers the poses of all readings,
    `first` (V,) is each visit's first."""
    at = places(recording.q[first], arm)
    if len(first) < rules.enough:
        return None
    if _shuffled(at, rules):
        return JudgedVisits(np.arange(len(first)), None)
    return come_back_to(recording, pose, first, rules=rules)


def come_back_to(
    recording: Recording, pose: NDArray[np.int64], first: NDArray[np.int64], *, rules: FittingRules
) -> JudgedVisits | None:
    """The visits of poses that are come back to under one condition, None where they are too few to tell."""
    conditions = [item for item in (pose, recording.payload_mass, recording.sides) if item is not None]
    held = [condition[first].reshape(len(first), -1).astype(np.float64) for condition in conditions]
    back = np.unique(np.concatenate(held, axis=1), axis=0, return_inverse=True)[1].reshape(-1)
    again = np.flatnonzero(np.bincount(back)[back] > 1)
    number = np.unique(back[again], return_inverse=True)[1].reshape(-1) if len(again) else again
    count = int(number.max()) + 1 if len(again) else 0
    if count < rules.poses_come_back_to or len(again) - count < rules.enough:
        return None
    return JudgedVisits(again, number.astype(np.int64))


def places(q: Array, arm: Arm) -> Array:
    """Coordinates (V, n) as what moves the arm alike: rad, and slides over the longest of them."""
    slides = np.array([not joint.revolute for joint in arm.joints])
    travel = float(np.ptp(q[:, slides], axis=0).max()) if slides.any() else 0.0
    return q / np.where(slides, travel if travel > 0.0 else 1.0, 1.0)


def rather_with_time(values: Array, at: Array, *, rules: FittingRules) -> bool:
    """Whether values (V, D) of visits at places (V, n) are alike where they are near in time and far in pose, more than
    where they are near in pose and far in time, which physics that a model lacks would have them."""
    usual = _usual(at)
    far = np.linalg.norm(np.diff(at, axis=0), axis=1) > rules.shuffled * usual
    if not far.any():
        return False
    values = values - values.mean(axis=0)
    in_time = float(np.mean(np.sum(values[1:] * values[:-1], axis=1)[far]))
    later = max(1, len(at) // rules.least_parts)
    distance, near = map(np.asarray, KDTree(at).query(at, k=min(len(at), 2 * later + 2)))
    number = np.arange(len(at))
    allowed = np.abs(near - number[:, None]) > later
    mask = allowed.any(axis=1)
    partner = near[number, np.argmax(allowed, axis=1)]
    close = mask & (distance[number, np.argmax(allowed, axis=1)] < rules.shuffled * usual)
    in_pose = float(np.mean(np.sum(values[close] * values[partner[close]], axis=1))) if close.any() else 0.0
    return in_time > max(in_pose, 0.0)


def _shuffled(at: Array, rules: FittingRules) -> bool:
    """Whether neighbouring visits are at places no nearer to each other than any two."""
    near = float(np.median(np.linalg.norm(np.diff(at, axis=0), axis=1)))
    return near > rules.shuffled * _usual(at)


def _usual(at: Array) -> float:
    """How far any two places lie from each other (root of the mean square)."""
    return float(np.sqrt(2.0 * np.sum(np.var(at, axis=0))))
