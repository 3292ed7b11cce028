"""Points of a front solved together by an executor's workers.

A worker caches the compiled programs of its search. What is known of combinations is sent with each point, so that the
solution of a point depends on the request alone, not on the worker that solves it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import Figure, figures_of
from linkwright.core.executors import Executor, Work
from linkwright.core.optimize.exchange.design import arm_of, design_space
from linkwright.core.optimize.problem import Problem

from .journal import Record
from .listed import ListedSearch, listed_arm
from .point import Design, Learnt, Search, Told
from .question import Question
from .records import design_record


@dataclass(frozen=True)
class Wanted:
    """A point: the limit whose figure is pushed (its number), the badness held of the other, and where to start."""

    push: int
    held: float
    near: tuple[Design, ...]


Item = tuple[str, Wanted, Learnt]
Found = tuple[Record | None, Learnt]


class Crew:
    """An executor at work on one question."""

    def __init__(self, executor: Executor, asked: Question) -> None:
        self._executor = executor
        self._work = Work(partial(_Searches, asked), _solved)
        self.together = 1_000_000
        """All points that are wanted, however many workers there are: the front is then the same."""

    def solve(
        self,
        group: str,
        search: Search | ListedSearch,
        wanted: Sequence[Wanted],
        pulse: Callable[[], None],
        keep: Callable[[int, Record | None], None],
    ) -> None:
        """Solve points of a group's front; `keep` hears of each (its number and record, None where there is no design)
        as it comes. What was learnt of combinations goes into the search."""
        learnt = search.learnt()
        items = [(group, item, learnt) for item in wanted]
        solved = self._executor.map(self._work, items, pulse, lambda number, item: keep(number, item[0]))
        for _, more in solved:
            search.learn_from(more)


class _Searches:
    """What a worker keeps: the search of the group that it was asked about last."""

    def __init__(self, asked: Question) -> None:
        self.asked = asked
        self._problems = dict(asked.groups())
        self._latest: tuple[str, Search | ListedSearch] | None = None

    def of(self, group: str) -> Search | ListedSearch:
        """The search of a group."""
        if self._latest is None or self._latest[0] != group:
            self._latest = group, search_for(self.asked, self._problems[group], _silent)
        return self._latest[1]


def _silent(_: str) -> None:
    return None


def _solved(searches: _Searches, item: Item) -> Found:
    group, wanted, learnt = item
    search = searches.of(group)
    search.begin_with(learnt)
    design = search.best(wanted.push, wanted.held, wanted.near)
    return None if design is None else record_of(searches.asked, search.problem, design), search.learnt()


def search_for(asked: Question, problem: Problem, told: Told) -> Search | ListedSearch:
    """The search for a group's problem, which tells how its sections are chosen."""
    return Search(asked, problem, told) if problem.sizes is None else ListedSearch(asked, problem, told)


def record_of(asked: Question, problem: Problem, design: Design) -> Record | None:
    """What is noted of a design: itself and its figures; nothing where it leaves what it must reach."""
    whole = asked.problem
    evaluation = evaluate(arm_with(problem, design), whole.workspace, whole.load_cases)
    if problem.must_reach and evaluation.unreached is not None:
        return None
    return {"design": design_record(design), "figures": _figures(evaluation, whole.figures)}


def arm_with(problem: Problem, design: Design) -> Arm:
    """The arm of a design."""
    if problem.sizes is not None:
        return listed_arm(problem, design.numbers)
    pick = design.combination
    return arm_of(design_space(problem, pick.shapes), np.array(design.numbers), pick.materials)


def _figures(evaluation: Evaluation, figures: Mapping[str, Figure]) -> dict[str, Any]:
    """What is told of a point in SI; None where it is not known."""
    values = figures_of(evaluation, figures)
    return {
        **{name: None if math.isnan(value) else value for name, value in values.items()},
        "upper_bound": evaluation.upper_bound,
        "certified": evaluation.worst.certified,
        "link_masses": list(evaluation.link_masses),
        "unreached_share": 0.0 if evaluation.unreached is None else evaluation.unreached.share,
        "warnings": list(evaluation.warnings),
    }
