"""Which actuator each joint should have: every choice up to a number, else a search joint by joint.

Stiffness, backlash and mass of the drives are constants of an error model, so each choice is a problem of its own for
the links (`optimize.choice.combinations`). The choices are taken in the order of the error that they give the arm as it
stands; one whose design for its binding poses alone is worse than the best so far is given up.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.executors import Executor
from linkwright.core.optimize.balance.balance import with_counterweights
from linkwright.core.optimize.exchange.design import arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.exchange.program import carried_mass, drives_cost
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import DriveCandidate, Iteration
from linkwright.core.units.quantities import NoAnswer

from .at_once.feasibility import Feasibility
from .combinations import Choice, NoChoice, Progress, chosen
from .drive_frequency import frequency_allowed, frequency_asked
from .near_ties import NEAR, Tie, Ties
from .picks import Combination

Log = Callable[[Iteration], None]
Assignment = tuple[Actuator | None, ...]
"""An actuator for each joint; None for a joint that keeps its own drive."""

MOST_ASSIGNMENTS = 64
"""Up to this many choices every one is looked at."""


@dataclass(frozen=True)
class Driven:
    """The best choice of actuators: the problem with them in its arm (in `context`), and the links' choice.

    `choice` is None where no assignment has a design; the context is then that of the most promising one. `names` are
    the actuators, in words; empty where the problem chooses none.
    """

    context: Context
    choice: Choice | None
    candidates: tuple[DriveCandidate, ...]
    exhaustive: bool
    names: str
    unsolved: int = 0
    """On how many combinations of shapes and materials the solver failed, where there is no choice."""
    feasibility: Feasibility | None = None
    """What is known of how far all combinations break the limits, where there is no choice."""


def with_actuators(arm: Arm, assignment: Assignment) -> Arm:
    """The arm with these actuators: their stiffnesses, backlash, mass and price replace those of the joints."""
    joints = [
        joint
        if actuator is None
        else replace(
            joint,
            actuator=actuator,
            stiffness=actuator.stiffness,
            zones=actuator.zones,
            backlash=actuator.backlash,
            mass=actuator.mass,
            tilting_stiffness=actuator.tilting_stiffness,
            cost=None,
        )
        for joint, actuator in zip(arm.joints, assignment, strict=True)
    ]
    return replace(arm, joints=tuple(joints))


def assignments(problem: Problem) -> list[Assignment]:
    """Every choice of actuators that the problem allows; under `same: [actuator]` those in which all joints agree."""
    lists = [tuple[Actuator | None, ...](own) or (None,) for own in problem.actuators or ()]
    picks = itertools.product(*lists)
    if "actuator" not in problem.same:
        return list(picks)
    return [pick for pick in picks if len({each.name for each in pick if each is not None}) <= 1]


def count(problem: Problem) -> int:
    """How many choices there are, without listing them."""
    sizes = [max(len(own), 1) for own in problem.actuators or ()]
    return max(sizes) if "actuator" in problem.same else math.prod(sizes)


class _Search:
    """Works through assignments with one incumbent."""

    def __init__(
        self,
        problem: Problem,
        progress: Progress | None,
        log: Log | None,
        executor: Executor | None = None,
        journal: Journal | None = None,
    ) -> None:
        self.problem, self.progress, self.log, self.executor = problem, progress, log, executor
        # Near ties come back to combinations that were solved before.
        self.journal = journal or Journal(None, "")
        self.best: tuple[Assignment, Context, Choice] | None = None
        self.candidates: dict[Assignment, DriveCandidate] = {}
        self.unsolved = 0

    @property
    def objective(self) -> float:
        """The best objective so far (SI)."""
        return math.inf if self.best is None else self.best[2].objective

    def problem_with(self, pick: Assignment) -> Problem:
        """The problem of the links once the drives are chosen."""
        return replace(self.problem, arm=with_actuators(self.problem.arm, pick), actuators=None)

    def try_all(self, picks: list[Assignment]) -> None:
        """Look at assignments, those first with which the arm as given errs least."""
        fresh = self.promising([pick for pick in picks if pick not in self.candidates])
        for done, pick in enumerate(fresh):
            if self.progress is not None:
                self.progress(done, len(fresh), f"actuators {names_of(pick)}")
            context = context_of(self.problem_with(pick))
            before = math.inf if self.best is None else self.objective
            settings: Any = {"executor": self.executor, "journal": self.journal}
            choice = chosen(context, log=self.log, known=before, ties=False, **settings)
            if isinstance(choice, Choice):
                self._note(pick, choice.objective, "solved")
                if choice.objective < before:
                    self.best = (pick, context, choice)
                if choice.interrupted:
                    raise KeyboardInterrupt
            else:
                self.unsolved += choice.unsolved
                self._note(pick, None, "infeasible" if math.isinf(before) else "bounded out")

    def promising(self, picks: Sequence[Assignment]) -> list[Assignment]:
        """Those that are not hopeless, the arm as given erring least with the first."""
        return sorted((pick for pick in picks if not self._hopeless(pick)), key=self._error)

    def near_ties(self) -> Ties:
        """What comes near the best, over all drives looked at that may hold any of it: of each, its own best and what
        comes near that. What was solved before is not solved again."""
        assert self.best is not None
        limit = self.objective * (1.0 + NEAR)
        found: dict[tuple[Assignment, Combination], Tie] = {}
        left, interrupted = 0, False
        near = [
            pick
            for pick, each in self.candidates.items()
            if each.outcome != "infeasible" and (each.objective is None or each.objective <= limit)
        ]
        for pick in near:
            context = self.best[1] if pick == self.best[0] else context_of(self.problem_with(pick))
            settings: Any = {"executor": self.executor, "journal": self.journal, "progress": self.progress}
            try:
                choice = chosen(context, known=limit, **settings)
            except KeyboardInterrupt:
                interrupted = True
                break
            if isinstance(choice, NoChoice):
                continue
            arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
            for each in (Tie(choice.combination, choice.objective, arm), *choice.ties.solved):
                if each.objective <= limit:
                    found[pick, each.combination] = each
            left += choice.ties.left
            interrupted = choice.interrupted or choice.ties.interrupted
            if interrupted:
                break
        found.pop((self.best[0], self.best[2].combination), None)
        ties = tuple(sorted(found.values(), key=lambda each: each.objective))
        return Ties(ties, left, left == 0 and not interrupted, interrupted)

    def _hopeless(self, pick: Assignment) -> bool:
        """Whether the drives alone break the limit on the total mass or the cost."""
        problem = self.problem_with(pick)
        lightest = replace(problem, arm=with_counterweights(problem.arm, problem.balances, least=True))
        heavy = any(x.relation != ">=" and carried_mass(lightest) >= x.value for x in problem.limit("total_mass"))
        dear = bool(problem.limit("cost")) and any(drives_cost(problem) >= x.value for x in problem.limit("cost"))
        hopeless = heavy or dear or self._too_soft(problem)
        if hopeless:
            self._note(pick, None, "infeasible")
        return hopeless

    def _too_soft(self, problem: Problem) -> bool:
        """Whether the drives alone, on rigid links without weight, are slower than the problem asks."""
        asked = frequency_asked(problem)
        return asked > 0.0 and frequency_allowed(problem) < asked

    def _error(self, pick: Assignment) -> float:
        problem = self.problem_with(pick)
        context = context_of(problem)
        search = context.search
        if problem.workspace.error == "whole":
            search = WorstSearch(context.model, problem.workspace, scan=1024)
        return search.worst(numeric_beams(problem.arm, problem.load_cases), certify=False).error

    def _note(self, pick: Assignment, objective: float | None, outcome: str) -> None:
        names = tuple(None if actuator is None else actuator.name for actuator in pick)
        self.candidates[pick] = DriveCandidate(names, objective, outcome)  # type: ignore[arg-type]

    def joint_by_joint(self) -> None:
        """Assignments in which the joints agree as far as they can, then one joint at a time until none improves."""
        lists = [own or (None,) for own in self.problem.actuators or ()]
        longest = max(len(own) for own in lists)
        self.try_all(list(dict.fromkeys(tuple(own[min(k, len(own) - 1)] for own in lists) for k in range(longest))))
        improved = True
        while improved and self.best is not None:
            before = self.objective
            for joint, own in enumerate(lists):
                pick = self.best[0]
                self.try_all([(*pick[:joint], other, *pick[joint + 1 :]) for other in own])
            improved = self.objective < before * (1.0 - 1e-6)


def choose_driven(
    problem: Problem,
    *,
    progress: Progress | None = None,
    log: Log | None = None,
    executor: Executor | None = None,
    journal: Journal | None = None,
    known: float = math.inf,
    ties: bool = True,
) -> Driven:
    """The best actuators with the best links for them; without a choice of actuators, the best links (better than
    `known`, SI, and with near ties where `ties`).

    `executor` and `journal` as for `chosen`. A `KeyboardInterrupt` of `progress` or `log` ends the search as in
    `choose`.
    """
    if problem.actuators is None:
        context = context_of(problem)
        settings: Any = {"known": known, "ties": ties}
        found = chosen(context, progress=progress, log=log, executor=executor, journal=journal, **settings)
        if isinstance(found, NoChoice):
            return Driven(context, None, (), True, "", found.unsolved, found.feasibility)
        return Driven(context, found, (), True, "")
    search = _Search(problem, progress, log, executor, journal)
    exhaustive = count(problem) <= MOST_ASSIGNMENTS or "actuator" in problem.same
    picks = assignments(problem) if exhaustive else []
    if exhaustive and not picks:
        raise NoAnswer("same: [actuator]: the joints' lists have no actuator in common")
    interrupted = False
    near = Ties()
    try:
        if exhaustive:
            search.try_all(picks)
        else:
            search.joint_by_joint()
        if search.best is not None and ties:
            near = search.near_ties()
            interrupted = near.interrupted
    except KeyboardInterrupt:
        if search.best is None:
            raise
        interrupted = True
    candidates = [
        replace(each, outcome="best") if search.best is not None and pick == search.best[0] else each
        for pick, each in search.candidates.items()
    ]
    ranked = tuple(sorted(candidates, key=lambda each: math.inf if each.objective is None else each.objective))
    if search.best is not None:
        pick, context, choice = search.best
        ended = replace(choice, interrupted=interrupted, ties=near)
        return Driven(context, ended, ranked, exhaustive and not interrupted, names_of(pick))
    first = next(iter(search.candidates))
    context = context_of(search.problem_with(first))
    return Driven(context, None, ranked, exhaustive, names_of(first), search.unsolved)


def promising(problem: Problem, picks: Sequence[Assignment]) -> list[Assignment]:
    """The choices whose drives alone break no limit, those first with which the arm as given errs least."""
    search = _Search(problem, None, None)
    return search.promising(picks)


def first_driven(problem: Problem) -> tuple[Context, str]:
    """The context of a problem with the first of its choices of actuators, and their names; without such a choice, with
    the drives that the arm has."""
    if problem.actuators is None:
        return context_of(problem), ""
    pick = tuple(own[0] if own else None for own in problem.actuators)
    return context_of(_Search(problem, None, None).problem_with(pick)), names_of(pick)


def names_of(pick: Assignment) -> str:
    """The actuators of an assignment from the base out, in words."""
    return ", ".join("own drive" if actuator is None else actuator.name for actuator in pick)
