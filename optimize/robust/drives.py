"""Actuators for what is uncertain: a robust optimum for every choice of them that may still win."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from linkwright.core.optimize.choice.actuators import MOST_ASSIGNMENTS, Assignment, assignments, count, with_actuators
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import DriveCandidate, OptimizationResult
from linkwright.core.units.quantities import NoAnswer

from .exchange import Log
from .run import robust_optimum


def robust_drives(
    problem: Problem,
    optimise: Callable[[Problem], OptimizationResult],
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> OptimizationResult:
    """The best robust optimum over the actuators; `optimise` finds that of a problem without uncertainty, `journal`
    knows what an earlier search has solved.

    The drives that are best for the arm as it is go first. The worst of all that may be is no less than what the arm as
    it is does, so that a nominal optimum bounds the robust one with its drives; for a share nothing is left out. Of
    more than `MOST_ASSIGNMENTS` choices only those first drives are looked at. Raises `NoAnswer` where no choice that
    was looked at has a robust optimum.
    """
    assert problem.uncertain is not None
    settings: Any = {"log": log, "progress": progress, "journal": journal}
    first = optimise(replace(problem, uncertain=None))
    if first.interrupted:
        return first
    few = count(problem) <= MOST_ASSIGNMENTS
    chosen = _names(first)
    picks = [pick for pick in assignments(problem) if named(pick) != chosen] if few else []
    best: OptimizationResult | None = None
    failed: NoAnswer | None = None
    found: list[tuple[float, DriveCandidate]] = []
    seconds = 0.0
    for done, pick in enumerate([None, *picks]):
        names = chosen if pick is None else named(pick)
        if progress is not None and pick is not None:
            progress(done, len(picks) + 1, f"actuators {', '.join(name or '-' for name in names)}")
        known = math.inf if best is None else best.objective
        try:
            arm = first.arm if pick is None else with_actuators(problem.arm, pick)
            own = problem if pick is None else replace(problem, arm=arm, actuators=None)
            nominal = first if pick is None else optimise(replace(own, uncertain=None))
            if problem.uncertain.worst and nominal.objective >= known and not nominal.interrupted:
                found.append((math.inf, DriveCandidate(names, None, "bounded out")))
                continue
            result = nominal if nominal.interrupted else robust_optimum(own, nominal, **settings)
        except NoAnswer as error:
            failed = failed or error
            found.append((math.inf, DriveCandidate(names, None, "infeasible")))
            continue
        seconds += result.seconds
        if nominal.interrupted:
            best = None if best is None else replace(best, interrupted=True, status="interrupted")
            break
        found.append((result.objective, DriveCandidate(names, result.objective, "solved")))
        if result.objective < known:
            best = result
        if result.interrupted:
            break
    if best is None:
        raise failed or NoAnswer("the search was stopped before any drives had a design for what is uncertain")
    found.sort(key=lambda each: each[0])
    candidates = [each for _, each in found]
    candidates[0] = replace(candidates[0], outcome="best")
    return replace(
        best,
        drives=tuple(candidates),
        drives_exhaustive=few,
        choices=first.choices,
        before=first.before,
        seconds=seconds,
    )


def named(pick: Assignment) -> tuple[str | None, ...]:
    """The actuators of a choice by name, None for a joint that keeps its own drive."""
    return tuple(None if actuator is None else actuator.name for actuator in pick)


def _names(result: OptimizationResult) -> tuple[str | None, ...]:
    """The drives of an optimum, by name."""
    return next(each.actuators for each in result.drives if each.outcome == "best")
