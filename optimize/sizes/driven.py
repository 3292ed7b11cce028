"""Drives chosen together with sections from lists: the lists are searched for each choice of drives that may still win.

Stiffness, backlash and mass of drives are constants of an error model, so each choice is a search of its own; after the
first it looks only for designs better than the best so far, which its bounds rule out early where there are none.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.asked import choices_in_words, limits_in_words, map_of_given
from linkwright.core.optimize.choice.actuators import (
    MOST_ASSIGNMENTS,
    Assignment,
    assignments,
    count,
    promising,
    with_actuators,
)
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.limits import Limit
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import DriveCandidate, Iteration, OptimizationResult
from linkwright.core.units.quantities import NoAnswer

from .run import NoListed, optimise_listed
from .search import CLOSE

_BETTER = 1e-6
"""By how much (relative) another choice of drives must be better to be looked for."""


def optimise_driven_lists(
    problem: Problem,
    *,
    progress: Progress | None = None,
    log: Callable[[Iteration], None] | None = None,
    begun: Callable[[Evaluation], None] | None = None,
) -> OptimizationResult:
    """The best design of a problem with `sizes` and `actuators`; `progress`, `log` and `begun` as in `optimise`.

    Every choice of drives is looked at up to `MOST_ASSIGNMENTS` of them, else joint by joint. Raises `NoAnswer` where
    none has a design that keeps the limits, or none was found.
    """
    began = time.perf_counter()
    try:
        before = evaluate(problem.arm, problem.workspace, problem.load_cases)
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None
    if begun is not None:
        begun(before)
    search = _Drives(problem, progress, log)
    exhaustive = count(problem) <= MOST_ASSIGNMENTS or "actuator" in problem.same
    picks = assignments(problem) if exhaustive else []
    if exhaustive and not picks:
        raise NoAnswer("same: [actuator]: the joints' lists have no actuator in common")
    interrupted = False
    try:
        if exhaustive:
            search.try_all(picks)
        else:
            search.joint_by_joint()
    except KeyboardInterrupt:
        if search.best is None:
            raise
        interrupted = True
    if search.best is None:
        raise NoAnswer(search.why_not)
    pick, best = search.best
    interrupted = interrupted or best.interrupted
    known = exhaustive and not interrupted and search.bounded
    lower_bound = min(search.bound, best.objective)
    gap = max(0.0, 1.0 - lower_bound / best.objective) if known and best.objective else None
    proven = gap is not None and gap <= 2.0 * CLOSE
    context = context_of(search.problem_with(pick, sizes=False))
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    found = replace(
        best,
        limits=limits_in_words(problem),
        choices=choices_in_words(problem),
        before=before,
        before_map=map_of_given(problem, context, poses),
        drives=search.ranked(),
        drives_exhaustive=exhaustive and not interrupted,
        lower_bound=lower_bound if known else best.objective,
        bound_of="all_designs" if known else "binding_poses",
        gap=gap,
        exhaustive=proven,
        iterations=tuple(replace(each, number=k) for k, each in enumerate(search.history, start=1)),
        seconds=time.perf_counter() - began,
        interrupted=interrupted,
    )
    if interrupted:
        return replace(found, status="interrupted", optimum="local")
    if proven or best.status == "doubtful":
        return found
    return replace(found, status="searched", optimum="local")


class _Drives:
    """Works through choices of drives with one best design."""

    def __init__(self, problem: Problem, progress: Progress | None, log: Callable[[Iteration], None] | None) -> None:
        self.problem, self._progress, self._log = problem, progress, log
        self.best: tuple[Assignment, OptimizationResult] | None = None
        self.bound = math.inf
        """The least bound (SI) of all that were looked at; where `bounded`, no design of theirs goes below it."""
        self.bounded = True
        self.why_not = "no choice of drives keeps all limits"
        self.history: list[Iteration] = []
        self._candidates: dict[Assignment, DriveCandidate] = {}

    @property
    def _objective(self) -> float:
        return math.inf if self.best is None else self.best[1].objective

    def problem_with(self, pick: Assignment, *, sizes: bool = True) -> Problem:
        """The problem once the drives are chosen; without `sizes` no section is from a list."""
        own = replace(self.problem, arm=with_actuators(self.problem.arm, pick), actuators=None)
        return own if sizes else replace(own, sizes=None)

    def try_all(self, picks: Sequence[Assignment]) -> None:
        """Look at choices, those first with which the arm as given errs least."""
        fresh = [pick for pick in picks if pick not in self._candidates]
        left = promising(replace(self.problem, sizes=None), fresh)
        for pick in fresh:
            if pick not in left:
                self._note(pick, None, "infeasible")
        for pick in left:
            self._look_at(pick)

    def joint_by_joint(self) -> None:
        """Choices in which the joints agree as far as they can, then one joint at a time until none improves."""
        lists: list[tuple[Actuator | None, ...]] = [own or (None,) for own in self.problem.actuators or ()]
        longest = max(len(own) for own in lists)
        self.try_all(list(dict.fromkeys(tuple(own[min(k, len(own) - 1)] for own in lists) for k in range(longest))))
        improved = True
        while improved and self.best is not None:
            before = self._objective
            for joint, own in enumerate(lists):
                pick = self.best[0]
                self.try_all([(*pick[:joint], other, *pick[joint + 1 :]) for other in own])
            improved = self._objective < before * (1.0 - _BETTER)

    def ranked(self) -> tuple[DriveCandidate, ...]:
        """What became of the choices, the best first."""
        assert self.best is not None
        found = [
            replace(each, outcome="best") if pick == self.best[0] else each for pick, each in self._candidates.items()
        ]
        return tuple(sorted(found, key=lambda each: math.inf if each.objective is None else each.objective))

    def _look_at(self, pick: Assignment) -> None:
        known = self._objective
        own = self.problem_with(pick)
        if math.isfinite(known):
            better = Limit(self.problem.objective, "<=", known * (1.0 - _BETTER))
            own = replace(own, limits=(*own.limits, better))
        try:
            found = optimise_listed(own, progress=self._progress, log=self._heard)
        except NoListed as none:
            self.bounded = self.bounded and none.proven
            self.bound = min(self.bound, known * (1.0 - _BETTER))
            self._note(pick, None, "infeasible" if math.isinf(known) else "bounded out")
            if math.isinf(known):
                self.why_not = str(none)
            return
        self.bounded = self.bounded and found.bound_of == "all_designs"
        self.bound = min(self.bound, found.lower_bound)
        self._note(pick, found.objective, "solved")
        if found.objective < known:
            self.best = (pick, found)
        if found.interrupted:
            raise KeyboardInterrupt

    def _heard(self, iteration: Iteration) -> None:
        self.history.append(iteration)
        if self._log is not None:
            self._log(replace(iteration, number=len(self.history)))

    def _note(
        self, pick: Assignment, objective: float | None, outcome: Literal["solved", "bounded out", "infeasible"]
    ) -> None:
        names = tuple(None if actuator is None else actuator.name for actuator in pick)
        self._candidates[pick] = DriveCandidate(names, objective, outcome)
