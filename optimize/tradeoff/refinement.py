"""A front as points on a curve: refined until straight lines between them are near enough, and its knee.

The curve is the least badness of y for each badness of x allowed. Between two points it is first taken for straight (in
the figures as they are, not in logarithms); the problem is then solved half-way, and where the line was off by more
than asked, both halves are looked at in turn.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from .question import Axis

NARROWEST = 1e-3
"""Relative width of x below which a stretch is not halved again: what still jumps there is called a step."""
MOST_POINTS = 200
"""Points of one front at which the refinement gives up."""


class Node(Protocol):
    """A design on the curve: the badness of x allowed for it, and what it attains of both figures."""

    @property
    def level(self) -> float: ...  # noqa: D102

    @property
    def x(self) -> float: ...  # noqa: D102

    @property
    def y(self) -> float: ...  # noqa: D102


AnyNode = TypeVar("AnyNode", bound=Node)


@dataclass(frozen=True)
class Refined(Generic[AnyNode]):
    """The points in order of badness of x; the largest relative error of a straight line, measured half-way, that was
    let stand; the stretches that stayed steps; the badness of x at which no design was found; whether all was done."""

    nodes: tuple[AnyNode, ...]
    error: float
    steps: tuple[tuple[AnyNode, AnyNode], ...]
    failed: tuple[float, ...]
    complete: bool


@dataclass(frozen=True)
class Stretch(Generic[AnyNode]):
    """A front between two points, to be solved at a badness of x in between; `expected` is how far off (relative, of
    y) a straight line is thought to be there."""

    left: AnyNode
    right: AnyNode
    level: float
    expected: float


def refine(
    axes: tuple[Axis, Axis],
    nodes: Sequence[AnyNode],
    stretches: Sequence[tuple[AnyNode, AnyNode]],
    solve: Callable[[Sequence[Stretch[AnyNode]]], Sequence[AnyNode | None]],
    accuracy: float,
    most: int = MOST_POINTS,
    together: int = 1,
) -> Refined[AnyNode]:
    """Halve stretches between points until the straight line is right within `accuracy` (relative, of y).

    `solve` gives the point within each of some stretches (at most so many `together`), None where it fails.
    """
    found = list(nodes)
    order = itertools.count()
    pending: list[tuple[float, int, AnyNode, AnyNode]] = []

    def look_at(left: AnyNode, right: AnyNode, expected: float) -> None:
        heapq.heappush(pending, (-expected, next(order), left, right))

    for left, right in stretches:
        look_at(left, right, abs(math.log(axes[1].badness(left.y) / axes[1].badness(right.y))))
    worst = 0.0
    steps: list[tuple[AnyNode, AnyNode]] = []
    failed: list[float] = []
    while pending and len(found) < most:
        wide: list[Stretch[AnyNode]] = []
        while pending and len(wide) < min(together, most - len(found)):
            urgency, _, left, right = heapq.heappop(pending)
            if math.log(right.level / left.level) >= NARROWEST:
                wide.append(Stretch(left, right, math.sqrt(left.level * right.level), -urgency))
            elif abs(left.y / right.y - 1.0) > accuracy:
                steps.append((left, right))
        for stretch, middle in zip(wide, solve(wide) if wide else (), strict=True):
            left, right, level = stretch.left, stretch.right, stretch.level
            if middle is None:
                failed.append(level)
                steps.append((left, right))
                continue
            found.append(middle)
            off = abs(straight(axes[0], left, right, level) / middle.y - 1.0)
            if off <= accuracy:
                worst = max(worst, off)
            else:
                look_at(left, middle, off)
                look_at(middle, right, off)
    found.sort(key=lambda node: node.level)
    return Refined(tuple(found), worst, tuple(steps), tuple(failed), complete=not pending)


def straight(axis: Axis, left: Node, right: Node, level: float) -> float:
    """y on the straight line between two points, at a badness of x allowed."""
    x, start, end = (axis.badness(value) for value in (level, left.level, right.level))
    return left.y + (right.y - left.y) * (x - start) / (end - start)


def undominated(axes: tuple[Axis, Axis], nodes: Sequence[AnyNode]) -> list[AnyNode]:
    """The points than which no other is at least as good in both figures, from the least badness of x on."""
    ranked = sorted(nodes, key=lambda node: (axes[0].badness(node.x), axes[1].badness(node.y)))
    kept: list[AnyNode] = []
    for node in ranked:
        if not kept or axes[1].badness(node.y) < axes[1].badness(kept[-1].y):
            kept.append(node)
    return kept


def envelope(axes: tuple[Axis, Axis], fronts: Sequence[Sequence[AnyNode]]) -> list[AnyNode]:
    """The points of several fronts that lie on the best of them: above none of the others' straight lines."""
    kept: list[AnyNode] = []
    for own, nodes in enumerate(fronts):
        others = [front for number, front in enumerate(fronts) if number != own and front]
        kept += [
            node
            for node in nodes
            if not any(_at(axes, front, node.x) < axes[1].badness(node.y) * (1.0 - 1e-9) for front in others)
        ]
    return undominated(axes, kept)


def _at(axes: tuple[Axis, Axis], front: Sequence[Node], x: float) -> float:
    """The badness of y on a front's straight lines, at an x; infinite where the front has no design."""
    allowed = axes[0].badness(x)
    within = [k for k, node in enumerate(front) if axes[0].badness(node.x) <= allowed]
    if not within:
        return math.inf
    left = front[within[-1]]
    if within[-1] + 1 == len(front):
        return axes[1].badness(left.y)
    right = front[within[-1] + 1]
    return axes[1].badness(left.y + (right.y - left.y) * (x - left.x) / (right.x - left.x))


def logarithmic(values: Sequence[float]) -> bool:
    """Whether an axis spans more than a factor of ten, and so is drawn (and the knee measured) in logarithms."""
    return max(values) > 10.0 * min(values)


def knee(axes: tuple[Axis, Axis], x: Sequence[float], y: Sequence[float], logs: tuple[bool, bool]) -> int | None:
    """The point farthest from the chord between the front's ends, on its better side; None where none lies there.

    Distances are measured with both axes scaled to run from 0 to 1 between the ends, in logarithms where `logs` says.
    After Das, On characterizing the "knee" of the Pareto curve based on Normal-Boundary Intersection, Structural
    Optimization 18 (1999) 107-115, doi:10.1007/BF01195985.
    """
    if len(x) < 3:
        return None
    columns: list[list[float]] = []
    for axis, values, log in zip(axes, (x, y), logs, strict=True):
        scaled = [math.log(value) if log else value for value in values]
        way = -1.0 if axis.more_is_better else 1.0
        width = abs(scaled[-1] - scaled[0]) or 1.0
        columns.append([way * value / width for value in scaled])
    across, up = columns
    # Both ends are one apart on either axis: the chord falls by one where x grows by one.
    below = [(across[0] - a) + (up[0] - b) for a, b in zip(across, up, strict=True)]
    best = max(range(len(x)), key=lambda k: below[k])
    return best if below[best] > 1e-6 else None
