"""What changed between two motion logs of one arm: the same causes' sizes in each, and whether they differ."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.compare.compare import Change, changes_of
from linkwright.core.diagnose.motion.events.changed import SURE
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.options import Options, Progress
from linkwright.core.diagnose.result import FittedParameter

from .by_log import by_log


@dataclass(frozen=True)
class MotionComparison:
    """Two logs: their diagnosis `together`, the `changes` of what was found in all its sizes, and the RMS (N*m) of what
    each log's sizes leave."""

    together: MotionDiagnosis
    changes: tuple[Change, ...]
    left: tuple[float, float]


def compare_motion(
    arm: Arm, first: MotionLog, second: MotionLog, options: Options, progress: Progress
) -> MotionComparison:
    """Compare two logs of one arm. Differences are tested by their standard errors (Student's t, the fewer degrees of
    freedom of both) and adjusted for their number by Holm's method. Raises what `diagnose_motion` raises."""
    made = by_log(arm, (first, second), options, progress)
    before, after = (list(sizes) for sizes in made.sizes)
    errors = np.hypot(made.errors(0), made.errors(1)).tolist()
    # How much more one log has is known far better than how much each has: what all share hides in both alike.
    for finding in (item for item in made.together.findings if item.recording):
        for size in finding.parameters:
            for place, one in enumerate(before):
                if (made.effects[place], one.at, one.parameter) == (finding.effect, size.at, size.parameter):
                    first_alone = finding.recording == Path(first.file).name
                    before[place], after[place] = _apart(one, after[place], size, first_alone=first_alone)
                    errors[place] = 0.5 * (size.interval[1] - size.interval[0]) / SURE
    sizes = list(zip(made.effects, before, after, strict=True))
    changes = changes_of(sizes, errors, min(made.freedom), options.rules.compare.level)
    return MotionComparison(made.together, changes, (made.left[0], made.left[1]))


def _apart(
    first: FittedParameter, second: FittedParameter, more: FittedParameter, *, first_alone: bool
) -> tuple[FittedParameter, FittedParameter]:
    """A size in both logs where one has so much more of it than the other."""

    def beyond(one: FittedParameter, other: FittedParameter) -> FittedParameter:
        shift = other.value + more.value - one.value
        return replace(one, value=one.value + shift, interval=(one.interval[0] + shift, one.interval[1] + shift))

    return (beyond(first, second), second) if first_alone else (first, beyond(second, first))
