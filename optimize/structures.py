"""Drives of joints and places of motors: what changes the error model itself, worked through with one incumbent.

Stiffness, backlash and mass of drives are constants of an error model, and so is where motors stand: each choice of
them is a separate problem for the links. The choices of drives are taken in the order of the error that they give the
arm as given; one that cannot beat the best so far is given up.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Literal, TypeVar

from linkwright.core.arm.actuators import Actuator
from linkwright.core.optimize.balance.motors import reaches_less, with_places
from linkwright.core.units.quantities import InputError, NoAnswer

from .balance.motor_places import MotorPlace
from .choice.actuators import Assignment, assignments, few, hopeless, least_error, names_of, with_actuators
from .choice.chooser import Progress
from .infeasible.quick import least_objective
from .problem import Problem
from .result import DriveCandidate, PlaceCandidate

Result = TypeVar("Result")
_BETTER = 1e-6
"""A choice joint by joint goes on while it wins more than this share."""


@dataclass(frozen=True)
class Answer(Generic[Result]):
    """The best design for one structure: its objective (SI), its result, and whether an interrupt ended its search."""

    objective: float
    result: Result
    interrupted: bool = False


Solve = Callable[[Problem, float], "Answer[Result] | float"]
"""The best design of a problem with drives and places chosen that is better than an objective (SI); where there is
none, what no design goes below (SI; minus infinity where nothing tells). May raise `NoAnswer`."""


@dataclass(frozen=True)
class Structure:
    """A drive for each joint (none of them where the problem chooses none), and a place for each motor to be placed."""

    drives: Assignment
    places: tuple[MotorPlace, ...]


@dataclass(frozen=True)
class _Noted:
    objective: float | None
    outcome: Literal["solved", "bounded out", "infeasible"]
    bound: float = -math.inf
    """What no design of the structure goes below (SI)."""


class StructureSearch(Generic[Result]):
    """Looks for the best structure of a problem; every choice of drives is looked at where they are few
    (`choice.actuators.few`), else they are chosen joint by joint."""

    def __init__(self, problem: Problem, solve: Solve[Result], progress: Progress | None) -> None:
        self.problem, self._solve, self._progress = problem, solve, progress
        self.best: tuple[Structure, Result] | None = None
        self.objective = math.inf
        """The best objective so far (SI)."""
        self.interrupted = False
        self.failed: NoAnswer | None = None
        """Why the first structure without an answer has none."""
        self.noted: dict[Structure, _Noted] = {}
        self._unreached: set[tuple[MotorPlace, ...]] = set()

    @property
    def exhaustive(self) -> bool:
        """Whether every choice of drives was looked at."""
        return few(self.problem) and not self.interrupted

    def run(self) -> None:
        """Look at all structures; an interrupt ends that with the best so far, and goes on where there is none yet.

        Raises `NoAnswer` where joints that must agree have no drive in common, `InputError` where no place of the
        motors reaches as much as the arm as given does.
        """
        if self.problem.actuators is not None and few(self.problem) and not assignments(self.problem):
            raise NoAnswer("same: [actuator]: the joints' lists have no actuator in common")
        every = list(itertools.product(*(choice.places for choice in self.problem.motors)))
        try:
            for done, places in enumerate(every):
                if places and self._progress is not None:
                    self._progress(done, len(every), f"trying motors {', '.join(place.words for place in places)}")
                self._look_at(places)
        except KeyboardInterrupt:
            if self.best is None:
                raise
            self.interrupted = True
        if not self.noted:
            message = "leaves more of the workspace unreached with rods at any of these places than the arm as given"
            raise InputError(self.problem.file, "choose.motor", f"{message} does; give the joint a wider range")

    def problem_with(self, structure: Structure) -> Problem:
        """The problem of the links once drives and places are chosen."""
        problem = self._placed(structure.places)
        if not structure.drives:
            return problem
        return replace(problem, arm=with_actuators(problem.arm, structure.drives), actuators=None)

    def _placed(self, places: tuple[MotorPlace, ...]) -> Problem:
        joints = (choice.joint for choice in self.problem.motors)
        arm = with_places(self.problem.arm, tuple(zip(joints, places, strict=True)))
        return self.problem if not places else replace(self.problem, arm=arm, motors=())

    def _look_at(self, places: tuple[MotorPlace, ...]) -> None:
        """All drives with motors at some places."""
        problem = self._placed(places)
        if any(place.rods is not None for place in places) and reaches_less(problem, self.problem):
            self._unreached.add(places)
        elif problem.actuators is None:
            self._try(Structure((), places))
        elif few(problem):
            self._try_all(assignments(problem), places)
        else:
            self._joint_by_joint(problem.actuators, places)

    def _try_all(self, picks: Sequence[Assignment], places: tuple[MotorPlace, ...]) -> None:
        """Look at choices of drives, those first with the least mass or price where that is the objective, else those
        with which the arm as given errs least; where that alone is worse than the best so far, no more is asked."""
        left: list[tuple[float, Structure]] = []
        for structure in (Structure(pick, places) for pick in picks):
            if structure in self.noted:
                continue
            problem = self.problem_with(structure)
            least = least_objective(problem)
            if least >= self.objective:
                self.noted[structure] = _Noted(None, "bounded out")
            elif hopeless(problem):
                self.noted[structure] = _Noted(None, "infeasible")
            else:
                left.append((least if math.isfinite(least) else least_error(problem), structure))
        left.sort(key=lambda item: item[0])
        for done, (_, structure) in enumerate(left):
            if self._progress is not None:
                self._progress(done, len(left), f"trying actuators {names_of(structure.drives)}")
            if least_objective(self.problem_with(structure)) >= self.objective:
                self.noted[structure] = _Noted(None, "bounded out")
            else:
                self._try(structure)

    def _try(self, structure: Structure) -> None:
        known = self.objective
        try:
            answer = self._solve(self.problem_with(structure), known)
        except NoAnswer as error:
            self.failed = self.failed or error
            self.noted[structure] = _Noted(None, "infeasible")
            return
        if not isinstance(answer, Answer):
            self.noted[structure] = _Noted(None, "infeasible" if math.isinf(known) else "bounded out", answer)
            return
        self.noted[structure] = _Noted(answer.objective, "solved")
        if answer.objective < known:
            self.best, self.objective = (structure, answer.result), answer.objective
        if answer.interrupted:
            raise KeyboardInterrupt

    def _joint_by_joint(self, chosen: Sequence[Sequence[Actuator]], places: tuple[MotorPlace, ...]) -> None:
        """Choices in which the joints agree as far as they can, then one joint at a time until none improves."""
        lists = [tuple[Actuator | None, ...](item) or (None,) for item in chosen]
        longest = max(len(link_list) for link_list in lists)
        same = (tuple(link_list[min(k, len(link_list) - 1)] for link_list in lists) for k in range(longest))
        self._try_all(list(dict.fromkeys(same)), places)
        improved = True
        while improved and self.best is not None and self.best[0].places == places:
            before = self.objective
            for joint, entry in enumerate(lists):
                pick = self.best[0].drives
                self._try_all([(*pick[:joint], other, *pick[joint + 1 :]) for other in entry], places)
            improved = self.objective < before * (1.0 - _BETTER)

    # ---- what became of all

    def drives(self) -> tuple[DriveCandidate, ...]:
        """What became of the choices of drives with the best places, the best first."""
        if self.problem.actuators is None or self.best is None:
            return ()
        best = self.best[0]
        candidates = [
            DriveCandidate(named(key.drives), noted.objective, "best" if key == best else noted.outcome)
            for key, noted in self.noted.items()
            if key.places == best.places
        ]
        return tuple(sorted(candidates, key=_rank))

    def places(self) -> tuple[PlaceCandidate, ...]:
        """What became of the places of motors, whatever the drives, the best first."""
        if not self.problem.motors:
            return ()
        candidates: list[PlaceCandidate] = []
        for places in dict.fromkeys([*(item.places for item in self.noted), *self._unreached]):
            solved = [noted for key, noted in self.noted.items() if key.places == places]
            values = [noted.objective for noted in solved if noted.objective is not None]
            outcome = "infeasible" if all(noted.outcome == "infeasible" for noted in solved) else "bounded out"
            outcome = "reaches less" if places in self._unreached else "solved" if values else outcome
            outcome = "best" if self.best is not None and places == self.best[0].places else outcome
            words = tuple(place.words for place in places)
            candidates.append(PlaceCandidate(words, min(values, default=None), outcome))  # type: ignore[arg-type]
        return tuple(sorted(candidates, key=_rank))


def _rank(candidate: DriveCandidate | PlaceCandidate) -> float:
    return math.inf if candidate.objective is None else candidate.objective


def named(pick: Assignment) -> tuple[str | None, ...]:
    """The actuators of a choice by name, None for a joint that keeps its drive."""
    return tuple(None if actuator is None else actuator.name for actuator in pick)
