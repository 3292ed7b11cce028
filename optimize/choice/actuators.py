"""Which actuator each joint may have, and what is known of a choice of them before any link is designed."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.figures.frequency import FIRST_FREQUENCY, frequency_of_drives
from linkwright.core.arm.figures.motion.cycle import MOTION_USE, least_use
from linkwright.core.arm.motion.cycle import cycles_of
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.balance.balance import with_least_counterweights
from linkwright.core.optimize.choice.driven import with_actuator
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.exchange.totals import carried_mass, drives_cost
from linkwright.core.optimize.problem import Problem

Assignment = tuple[Actuator | None, ...]
"""An actuator for each joint; None for a joint that keeps its drive."""

_SWUNG = 1.1
"""What links that swing on their gears take or leave of a drive's torque is less than a tenth of it."""
MOST_ASSIGNMENTS = 64
"""Up to this many choices every one is looked at."""


def with_actuators(arm: Arm, assignment: Assignment) -> Arm:
    """The arm with these actuators at its joints."""
    pairs = zip(arm.joints, assignment, strict=True)
    return replace(arm, joints=tuple(joint if drive is None else with_actuator(joint, drive) for joint, drive in pairs))


def assignments(problem: Problem) -> list[Assignment]:
    """Every choice of actuators that the problem allows; under `same: [actuator]` those in which all joints agree."""
    lists = [tuple[Actuator | None, ...](joint_actuators) or (None,) for joint_actuators in problem.actuators or ()]
    picks = itertools.product(*lists)
    if "actuator" not in problem.same:
        return list(picks)
    return [pick for pick in picks if len({item.name for item in pick if item is not None}) <= 1]


def count(problem: Problem) -> int:
    """How many choices there are, without listing them."""
    sizes = [max(len(joint_actuators), 1) for joint_actuators in problem.actuators or ()]
    return max(sizes) if "actuator" in problem.same else math.prod(sizes)


def few(problem: Problem) -> bool:
    """Whether every choice of actuators can be looked at."""
    return problem.actuators is None or count(problem) <= MOST_ASSIGNMENTS or "actuator" in problem.same


def hopeless(problem: Problem) -> bool:
    """Whether the drives that a problem's arm has break, by themselves, the limit on the total mass, the cost or the
    first frequency (on rigid links without weight), or cannot drive a cycle whatever its links weigh."""
    lightest = replace(problem, arm=with_least_counterweights(problem.arm, problem.balances))
    heavy = any(x.relation != ">=" and carried_mass(lightest) >= x.value for x in problem.limit("total_mass"))
    dear = bool(problem.limit("cost")) and any(drives_cost(problem) >= x.value for x in problem.limit("cost"))
    required = max((x.value for x in problem.limit(FIRST_FREQUENCY.name) if x.relation != "<="), default=0.0)
    use = min((x.value for x in problem.limit(MOTION_USE.name)), default=math.inf)
    # What effects, counterweights and tapers change of a drive's torque does not go by the mass of links alone.
    by_mass = not (problem.arm.effects or problem.balances or problem.free_tapers)
    weak = by_mass and any(least_use(problem.arm, cycle) > _SWUNG * use for cycle in cycles_of(problem.load_cases))
    return heavy or dear or weak or (required > 0.0 and frequency_allowed(problem) < required)


def frequency_allowed(problem: Problem) -> float:
    """The first frequency (Hz) that no design exceeds, for its drives: rigid links without weight, under the payloads
    and the joints' masses. Infinite where the drives are rigid or the lengths are free."""
    if problem.free_lengths:
        return math.inf
    arm, cases = problem.arm, problem.load_cases
    beams = beams_of(arm, cases)
    search = WorstSearch(error_model(arm, cases), problem.workspace)
    frequency = frequency_of_drives(arm, search, beams, beam_values(beams), cases, weightless=True)
    return math.inf if frequency is None else frequency.value


def least_error(problem: Problem) -> float:
    """The worst error (m) of a problem's arm as it is, with the drives that it has."""
    context = context_of(replace(problem, sizes=None, uncertain=None))
    search = context.search
    if problem.workspace.error == "whole":
        search = WorstSearch(context.model, problem.workspace, scan=1024)
    return search.worst(numeric_beams(problem.arm, problem.load_cases), certify=False).error


def first_driven(problem: Problem) -> tuple[Problem, str]:
    """A problem with the first of its choices of actuators, and their names; without such a choice, with the drives
    that the arm has."""
    if problem.actuators is None:
        return problem, ""
    pick = tuple(joint_actuators[0] if joint_actuators else None for joint_actuators in problem.actuators)
    return replace(problem, arm=with_actuators(problem.arm, pick), actuators=None), names_of(pick)


def names_of(pick: Assignment) -> str:
    """The actuators of an assignment from the base out, in words."""
    return ", ".join("own drive" if actuator is None else actuator.name for actuator in pick)
