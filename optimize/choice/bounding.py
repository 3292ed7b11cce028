"""Combinations bounded on one pool of poses by an executor's workers, each with compiled programs of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from linkwright.core.executors import Executor, Work
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem

from .picks import Combination

if TYPE_CHECKING:
    from .chooser import Chooser

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
