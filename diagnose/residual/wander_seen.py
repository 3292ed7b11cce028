"""Whether an instrument is seen to wander: by what does not move, or by poses that are come back to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .observed import Observed
from .time_vs_path import come_back_to
from .visits import poses
from .wander import clock, wander_in


def seen_to_wander(observed: Observed, left: Array) -> str:
    """What shows that an instrument wanders, as words; empty where nothing does. `left` (N, D), m, is what is left of
    the tip. What changes with time in the arm, or with its pose, leaves a target on the base where it is; of poses that
    are come back to it is the mean at each that the pose has part in."""
    recording, which, rules = observed.recording, observed.which, observed.rules.fitting
    _, first, visit = np.unique(observed.block, return_index=True, return_inverse=True)
    visit = visit.reshape(-1)
    count = np.bincount(visit)

    def means(values: Array) -> Array:
        return np.stack([np.bincount(visit, weights=column) / count for column in values.T], axis=1)

    def wanders(values: Array, at: NDArray[np.int64]) -> bool:
        nothing = np.zeros((*values.shape, 0))
        time = means(clock(recording)[:, None])[at, 0]
        return wander_in(values, time, which[first][at], nothing, rules=rules).rate > 0.0

    if recording.base_target is not None:
        target = means(recording.base_target)
        if wanders(target - target.mean(axis=0), np.arange(len(first), dtype=np.int64)):
            return "the target on the base"
    returns = come_back_to(recording, poses(observed), first, rules=rules)
    if returns is not None and wanders(returns.of(means(left)), returns.visit):
        return "what was read again at poses visited again"
    return ""
