"""Where motors stand for what is uncertain: a robust optimum for every combination of places that may still win."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from linkwright.core.optimize.balance.motors import reaches_less, with_places
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult, PlaceCandidate
from linkwright.core.units.quantities import NoAnswer

from .exchange import Log
from .run import robust_optimum


def robust_places(
    problem: Problem,
    optimise: Callable[[Problem], OptimizationResult],
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> OptimizationResult:
    """The best robust optimum over the places of motors; `optimise` finds that of a problem without such a choice,
    `journal` knows what an earlier search has solved.

    The worst of all that may be is no less than what the arm as it is does, so that a nominal optimum bounds the robust
    one of its places; for a share nothing is left out. Raises `NoAnswer` where no combination of places has one.
    """
    assert problem.uncertain is not None
    best: OptimizationResult | None = None
    failed: NoAnswer | None = None
    found: list[tuple[float, PlaceCandidate]] = []
    picks = list(itertools.product(*(choice.places for choice in problem.motors)))
    settings: Any = {"log": log, "progress": progress, "journal": journal}
    seconds = 0.0
    for done, pick in enumerate(picks):
        words = tuple(place.words for place in pick)
        if progress is not None:
            progress(done, len(picks), f"motors {', '.join(words)}")
        places = tuple((choice.joint, place) for choice, place in zip(problem.motors, pick, strict=True))
        own = replace(problem, arm=with_places(problem.arm, places), motors=())
        if any(place.rods is not None for place in pick) and reaches_less(own, problem):
            found.append((math.inf, PlaceCandidate(words, None, "reaches less")))
            continue
        known = math.inf if best is None else best.objective
        try:
            nominal = optimise(replace(own, uncertain=None))
            if problem.uncertain.worst and nominal.objective >= known and not nominal.interrupted:
                found.append((math.inf, PlaceCandidate(words, None, "bounded out")))
                continue
            result = nominal if nominal.interrupted else robust_optimum(own, nominal, **settings)
        except NoAnswer as error:
            failed = failed or error
            found.append((math.inf, PlaceCandidate(words, None, "infeasible")))
            continue
        seconds += result.seconds
        if nominal.interrupted and best is not None:
            best = replace(best, interrupted=True, status="interrupted")
            break
        found.append((result.objective, PlaceCandidate(words, result.objective, "solved")))
        if result.objective < known:
            best = result
        if result.interrupted:
            break
    if best is None:
        raise failed or NoAnswer("no place of the motors reaches as much of the workspace as the arm as given does")
    found.sort(key=lambda each: each[0])
    candidates = [each for _, each in found]
    candidates[0] = replace(candidates[0], outcome="best")
    return replace(best, motor_places=tuple(candidates), seconds=seconds)
