"""Walls as they are sold: thicknesses in steps, all other dimensions free (`thickness: {steps: [2 mm, 3 mm]}`).

Branch and bound: the best design whose walls may be anything between the least and the greatest step; where a link's
walls are on none, it may have those up to the step below or from the step above, and the better of both counts. All
walls of a link are of one step. Each design is as good as the search that finds it (a local optimum where that is one).
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.infeasible.answer import Infeasible
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.units.quantities import NoAnswer

_ON = 1e-6
"""How near (relative) a wall is to a step that it is on."""
_BETTER = 1e-6


@dataclass(frozen=True, order=True)
class _Node:
    """A problem with narrower ranges of walls, which is no better than `bound` (a badness)."""

    bound: float
    number: int
    problem: Problem = field(compare=False)


def on_wall_steps(problem: Problem, optimised: Callable[[Problem], OptimizationResult]) -> OptimizationResult:
    """The best design whose walls are on a problem's steps, with the near ties whose walls are too. Raises as
    `optimised` does, and `NoAnswer` where designs keep the limits between steps alone, or an interrupt came before
    any on the steps was found."""
    if not problem.stepped:
        return optimised(problem)
    figure = problem.objective
    first = best = optimised(problem)
    stopped = first.interrupted
    queue, count, found = _branches(problem, first, figure.badness(first.objective), 0), 2, None
    if queue is None:
        return _with_its_ties(problem, first)
    seconds = first.seconds
    heapq.heapify(queue)
    while queue and not stopped:
        node = heapq.heappop(queue)
        if found is not None and node.bound >= found * (1.0 - _BETTER):
            break
        try:
            result = optimised(node.problem)
        except Infeasible:
            continue
        seconds += result.seconds
        badness = figure.badness(result.objective)
        stopped = result.interrupted
        if found is not None and badness >= found * (1.0 - _BETTER):
            continue
        further = _branches(node.problem, result, badness, count)
        if further is None:
            best, found = result, badness
        else:
            count += len(further)
            for item in further:
                heapq.heappush(queue, item)
    if found is None and stopped:
        raise NoAnswer("it was interrupted before a design with walls on the steps of thickness was found")
    if found is None:
        raise NoAnswer("designs keep all limits with walls between the steps of thickness alone; give more steps")
    best = replace(best, lower_bound=first.lower_bound, before=first.before, seconds=seconds, interrupted=stopped)
    return _with_its_ties(problem, best)


def _with_its_ties(problem: Problem, result: OptimizationResult) -> OptimizationResult:
    """A result with those near ties whose walls are on steps."""
    return replace(result, near_ties=tuple(tie for tie in result.near_ties if _off(problem, tie.arm) is None))


def _branches(problem: Problem, result: OptimizationResult, bound: float, count: int) -> list[_Node] | None:
    """Both halves of a problem where some link's walls are on no step; None where all are."""
    split = _off(problem, result.arm)
    if split is None:
        return None
    link, *halves = split
    alike = "size" in problem.same
    nodes: list[_Node] = []
    for number, half in enumerate(halves):
        ranges = tuple(
            replace(item, thickness=half) if (index == link or alike) and item.steps else item
            for index, item in enumerate(problem.ranges)
        )
        nodes.append(_Node(bound, count + number, replace(problem, ranges=ranges)))
    return nodes


def _off(problem: Problem, arm: Arm) -> tuple[int, tuple[float, float], tuple[float, float]] | None:
    """The link (from 0) whose walls are farthest off the steps, and the ranges (m) below and above them; None where all
    links' walls are on steps."""
    worst, split = 0.0, None
    for link, ranges in enumerate(problem.ranges):
        walls, steps = _walls(arm, link), _steps_in(ranges)
        if not walls or len(steps) < 2:
            continue
        off = max(min(abs(wall / step - 1.0) for step in steps) for wall in walls) + max(walls) / min(walls) - 1.0
        if off > max(worst, _ON):
            middle = sum(walls) / len(walls)
            below = sum(step <= middle * (1.0 + _ON) for step in steps)
            below = min(max(below, 1), len(steps) - 1)
            worst, split = off, (link, (steps[0], steps[below - 1]), (steps[below], steps[-1]))
    return split


def _steps_in(ranges: Ranges) -> list[float]:
    """The steps within what is left of a link's range."""
    low, high = ranges.sizes[1]
    return [step for step in ranges.steps if low * (1.0 - _ON) <= step <= high * (1.0 + _ON)]


def _walls(arm: Arm, link: int) -> list[float]:
    """The thicknesses (m) of a link's walls."""
    section = arm.links[link].section
    if section is None:
        return []
    given = section.given()
    return [float(given[item.name]) for item in section.dimensions if item.kind == "wall" and item.name in given]
