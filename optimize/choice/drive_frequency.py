"""What first frequency the drives allow at most: known before any link is designed."""

from __future__ import annotations

import math

from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.limits.slowest_pose import frequency_of_drives
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.limits.frequency import FIRST_FREQUENCY
from linkwright.core.optimize.problem import Problem


def frequency_asked(problem: Problem) -> float:
    """The first frequency (Hz) that a problem asks for at least; 0 where it asks for none."""
    return max((x.value for x in problem.limit(FIRST_FREQUENCY.name) if x.relation != "<="), default=0.0)


def frequency_allowed(problem: Problem) -> float:
    """The first frequency (Hz) that no design exceeds, for its drives: rigid links without weight, under the payloads
    and the joints' masses. Infinite where the drives are rigid or the lengths are free."""
    if problem.link_length is not None:
        return math.inf
    arm, cases = problem.arm, problem.load_cases
    beams = beams_of(arm, cases)
    search = WorstSearch(error_model(arm, cases), problem.workspace)
    found = frequency_of_drives(arm, search, beams, beam_values(beams), cases, weightless=True)
    return math.inf if found is None else found.value


__all__ = ["frequency_allowed", "frequency_asked"]
