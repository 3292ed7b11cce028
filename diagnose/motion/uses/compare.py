"""What changed between two motion logs of one arm: the same causes' sizes in each, and whether they differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.compare.compare import Change, changes_of
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.options import Options, Progress

from .by_log import by_log


@dataclass(frozen=True)
class MotionComparison:
    """Two logs: their diagnosis `together`, the `changes` of what was found in all its sizes, and the RMS (N*m) of what
    each log's own sizes leave."""

    together: MotionDiagnosis
    changes: tuple[Change, ...]
    left: tuple[float, float]


def compare_motion(
    arm: Arm, first: MotionLog, second: MotionLog, options: Options, progress: Progress
) -> MotionComparison:
    """Compare two logs of one arm. Differences are tested by their standard errors (Student's t, the fewer degrees of
    freedom of both) and adjusted for their number by Holm's method. Raises what `diagnose_motion` raises."""
    made = by_log(arm, (first, second), options, progress)
    before, after = made.sizes
    sizes = list(zip(made.effects, before, after, strict=True))
    errors = np.hypot(made.errors(0), made.errors(1)).tolist()
    changes = changes_of(sizes, errors, min(made.freedom), options.rules.compare.level)
    return MotionComparison(made.together, changes, (made.left[0], made.left[1]))
