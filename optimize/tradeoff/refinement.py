"""A front as points on a curve: refined until straight lines between them are near enough, and its knee.

The curve is the least badness of y for each badness of x allowed. Between two points it is first taken for straight (in
the figures as they are, not in logarithms); the problem is then solved half-way, and where the line was off by more
than asked, both halves are looked at in turn. A front of designs from lists is a staircase: where designs lie far
apart, the design just below the next one is asked for, and if it is the one before, there is nothing between the two.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from .question import Axis

_BELOW = 1e-6
"""How much less x (relative) than a design from a list has is asked for to find the one before it."""
_CLOSE = 2e-3
"""A design from a list that leaves less of what is allowed (relative) is where it was asked for."""
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


@dataclass(frozen=True)
class _Open(Generic[AnyNode]):
    """A stretch to be refined. Of designs from lists none beats the left one up to the badness of x `low`; with `last`,
    the design just below the right one is requested."""

    left: AnyNode
    right: AnyNode
    low: float
    last: bool = False


def refine(
    axes: tuple[Axis, Axis],
    nodes: Sequence[AnyNode],
    stretches: Sequence[tuple[AnyNode, AnyNode]],
    solve: Callable[[Stretch[AnyNode]], AnyNode | None],
    accuracy: float,
    most: int = MOST_POINTS,
    *,
    listed: bool = False,
) -> Refined[AnyNode]:
    """Halve stretches between points until the straight line is right within `accuracy` (relative, of y).

    `solve` gives the point within a stretch, None where it fails. Between designs that are `listed` there may be none;
    a step is then two neighbours between which y jumps by more.
    """
    work = _Refinement(axes, nodes, accuracy, listed)
    for left, right in stretches:
        off = abs(math.log(axes[1].badness(left.y) / axes[1].badness(right.y)))
        work.look_at(left, right, off, max(left.level, axes[0].badness(left.x)))
    while work.pending and len(work.nodes) < most:
        request = work.next()
        if request is not None:
            stretch, item = request
            work.answered(stretch.level, item, solve(stretch))
    nodes = sorted(work.nodes, key=lambda node: node.level)
    return Refined(tuple(nodes), work.worst, tuple(work.steps), tuple(work.failed), complete=not work.pending)


class _Refinement(Generic[AnyNode]):
    """A front being refined: points, stretches to be looked at by how far off they are, and what became of others."""

    def __init__(self, axes: tuple[Axis, Axis], nodes: Sequence[AnyNode], accuracy: float, listed: bool) -> None:
        self.axes, self.accuracy, self.listed = axes, accuracy, listed
        self.nodes = list(nodes)
        self.pending: list[tuple[float, int, _Open[AnyNode]]] = []
        self.worst = 0.0
        self.steps: list[tuple[AnyNode, AnyNode]] = []
        self.failed: list[float] = []
        self._order = itertools.count()

    def _x(self, node: AnyNode) -> float:
        return self.axes[0].badness(node.x)

    def _jump(self, left: AnyNode, right: AnyNode) -> float:
        return self.axes[1].badness(left.y) / self.axes[1].badness(right.y) - 1.0

    def look_at(self, left: AnyNode, right: AnyNode, off: float, low: float, *, last: bool = False) -> None:
        """Keep a stretch that is off by so much for later; of designs from lists, one where y jumps."""
        off = self._jump(left, right) if self.listed else off
        if not self.listed or off > self.accuracy:
            heapq.heappush(self.pending, (-off, next(self._order), _Open(left, right, low, last)))

    def next(self) -> tuple[Stretch[AnyNode], _Open[AnyNode]] | None:
        """The stretch that is off by most; None where that is as narrow as can be, and so a step."""
        urgency, _, stretch = heapq.heappop(self.pending)
        level = self._level_in(stretch)
        if level is not None:
            return Stretch(stretch.left, stretch.right, level, -urgency), stretch
        if self.listed or abs(stretch.left.y / stretch.right.y - 1.0) > self.accuracy:
            self.steps.append((stretch.left, stretch.right))
        return None

    def _level_in(self, stretch: _Open[AnyNode]) -> float | None:
        if not self.listed:
            wide = math.log(stretch.right.level / stretch.left.level) >= NARROWEST
            return math.sqrt(stretch.left.level * stretch.right.level) if wide else None
        below = self._x(stretch.right) * (1.0 - _BELOW)
        return None if below <= stretch.low else below if stretch.last else math.sqrt(stretch.low * below)

    def answered(self, level: float, each: _Open[AnyNode], middle: AnyNode | None) -> None:
        """Take up the point found within a stretch."""
        left, right = each.left, each.right
        if middle is None:
            self.failed.append(level)
            self.steps.append((left, right))
        elif self.listed and (self._jump(left, middle) <= 0.0 or self._x(middle) <= self._x(left)):
            if each.last:
                self.steps.append((left, right))
            else:
                self.look_at(left, right, 0.0, level, last=True)
        else:
            self.nodes.append(middle)
            off = abs(straight(self.axes[0], left, right, middle.level) / middle.y - 1.0)
            if off <= self.accuracy and (not self.listed or level <= self._x(middle) * (1.0 + _CLOSE)):
                self.worst = max(self.worst, off)
            else:
                self.look_at(left, middle, off, each.low)
                self.look_at(middle, right, off, level, last=each.last)


def straight(axis: Axis, left: Node, right: Node, level: float) -> float:
    """y on the straight line between two points, at a badness of x allowed."""
    x, start, end = (axis.badness(value) for value in (level, left.level, right.level))
    return left.y + (right.y - left.y) * (x - start) / (end - start)


def undominated(axes: tuple[Axis, Axis], nodes: Sequence[AnyNode]) -> list[AnyNode]:
    """The points than which no other is at least as good in both figures, from the least badness of x on."""
    ranked = sorted(nodes, key=lambda node: (axes[0].badness(node.x), axes[1].badness(node.y)))
    front: list[AnyNode] = []
    for node in ranked:
        if not front or axes[1].badness(node.y) < axes[1].badness(front[-1].y):
            front.append(node)
    return front


def envelope(axes: tuple[Axis, Axis], fronts: Sequence[Sequence[AnyNode]]) -> list[AnyNode]:
    """The points of several fronts that lie on the best of them: above none of the others' straight lines."""
    kept: list[AnyNode] = []
    for index, nodes in enumerate(fronts):
        others = [front for number, front in enumerate(fronts) if number != index and front]
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
