"""Combinations bounded on one pool of poses by an executor's workers, each with compiled programs of its own.

The multipliers of a solved combination, those of its relaxation about its solution (`at_once.relaxation`), make one
sum of its objective, its binding poses and its limits that no design of any combination can have above its objective
(Lagrange). Its least over the cells of each link's options bounds each combination by a sum of one number a link.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linkwright.core.executors import Executor, Work
from linkwright.core.optimize.choice.agreement import table
from linkwright.core.optimize.choice.at_once.feasibility import Feasibility
from linkwright.core.optimize.choice.picks import Combination, OptionTable, agreeing, option_table
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Exchange, context_of
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

if TYPE_CHECKING:
    from linkwright.core.optimize.choice.chooser import Chooser


@dataclass
class CombinationBounds:
    """A bound from below (SI) for every combination: `bounds` has an axis for each elastic link, with its options."""

    options: OptionTable
    bounds: Array
    impossible: NDArray[np.bool_]
    closed: NDArray[np.bool_]
    """Those that were solved or cannot be: nothing more is to be learnt about them."""
    unsolved: NDArray[np.bool_]
    """Those on which the solver failed: nothing is known of them but what bounds others."""
    feasibility: Feasibility
    """What relaxes the problem, and rules out others where one cannot keep the limits."""

    def rule_out(self, exchange: Exchange, solution: Solution, pick: Combination, pool: Pool) -> None:
        """Tell what cannot keep the limits from a combination that cannot, and the solution in which they give way as
        little as they can."""
        self.impossible[self.options.place(pick)] = True
        self.feasibility.learn(exchange, solution, pick, pool)
        self.impossible |= self.feasibility.impossible
        self.closed |= self.impossible

    def learn(
        self, exchange: Exchange, solution: Solution, pick: Combination, objective: float, enough: float = np.inf
    ) -> bool:
        """Raise the bounds by a solution, of those that are below `enough` (SI); `objective` (SI) is its own. False
        where the model is no sum of products."""
        bounds = self.feasibility.bounds_by(exchange, solution, pick, objective, enough)
        if bounds is None:
            return False
        np.maximum(self.bounds, bounds, out=self.bounds)
        return True


def combination_bounds(problem: Problem, feasibility: Feasibility | None) -> CombinationBounds | None:
    """Bounds for all combinations of a problem, none known yet; None where nothing relaxes it: too many combinations,
    lengths to be chosen, scenarios, or play that depends on the design."""
    if feasibility is None:
        return None
    options = option_table(problem)
    out = feasibility.impossible.copy()
    for codes, most in agreeing(problem, options):
        out |= ~table(codes, most)
    least, unsolved = np.full(options.shape, -np.inf), np.zeros(options.shape, dtype=bool)
    return CombinationBounds(options, least, out, out.copy(), unsolved, feasibility)


_TOGETHER = 4
"""Combinations of the same shapes, which share a program, that are sent together at most."""


@dataclass(frozen=True)
class Bounded:
    """A combination solved for the pool alone: its objective (SI) and the optimiser's numbers, or None and what became
    of it."""

    objective: float | None
    x: tuple[float, ...] = ()
    outcome: str = ""


Item: TypeAlias = tuple[tuple[Combination, ...], Pool]
Bounding: TypeAlias = "Work[Chooser, Item, tuple[Bounded, ...]]"


def bounding(problem: Problem) -> Bounding:
    """The work of bounding combinations of a problem."""
    return Work(partial(_chooser, problem), _bounded)


def _chooser(problem: Problem) -> Chooser:
    from .chooser import Chooser

    return Chooser(context_of(problem), None, None)


def _bounded(chooser: Chooser, item: Item) -> tuple[Bounded, ...]:
    picks, chooser.pool = item
    bounded: list[Bounded] = []
    for pick in picks:
        solved = chooser.solve_unless_ruled_out(pick)
        if solved is None or solved.objective is None or solved.solution is None:
            bounded.append(Bounded(None, outcome=chooser.candidates[pick].outcome))
        else:
            bounded.append(Bounded(solved.objective, tuple(solved.solution.x.tolist())))
    return tuple(bounded)


def bound_all(
    executor: Executor,
    work: Bounding,
    picks: Sequence[Combination],
    pool: Pool,
    notify: Callable[[int], None],
    keep: Callable[[Combination, Bounded], None],
) -> None:
    """What each combination comes to on a pool, which `keep` hears as it comes; `notify` hears often how many are
    done."""
    groups: list[list[Combination]] = []
    for pick in picks:
        if groups and groups[-1][0].shapes == pick.shapes and len(groups[-1]) < _TOGETHER:
            groups[-1].append(pick)
        else:
            groups.append([pick])
    done = 0

    def count(number: int, bounded: tuple[Bounded, ...]) -> None:
        nonlocal done
        done += len(bounded)
        for pick, item in zip(groups[number], bounded, strict=True):
            keep(pick, item)

    executor.map(work, [(tuple(group), pool) for group in groups], lambda: notify(done), count)
