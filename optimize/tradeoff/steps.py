"""A front of designs from lists, which is a staircase: refined until every step that counts is exact.

Where designs lie close, a stretch is straight as any other front's is (`refinement.refine`). Where they do not, the
design just below the next one is asked for: if it is the one before, there is nothing between the two.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .question import Axis
from .refinement import MOST_POINTS, AnyNode, Refined, Stretch, straight

_BELOW = 1e-6
"""How much less x (relative) than a design has is asked for to find the one before it."""
_CLOSE = 2e-3
"""A design that leaves less of what is allowed (relative) is where it was asked for."""


@dataclass(frozen=True)
class _Open:
    """A stretch between two designs; up to the badness of x `low` there is nothing better than the left one."""

    low: float
    last: bool


def refine_steps(
    axes: tuple[Axis, Axis],
    nodes: Sequence[AnyNode],
    stretches: Sequence[tuple[AnyNode, AnyNode]],
    solve: Callable[[Sequence[Stretch[AnyNode]]], Sequence[AnyNode | None]],
    accuracy: float,
    most: int = MOST_POINTS,
    together: int = 1,
) -> Refined[AnyNode]:
    """As `refine`, for designs of which there may be none between two; a step is two neighbours between which y jumps
    by more than `accuracy` (relative)."""
    found = list(nodes)
    order = itertools.count()
    pending: list[tuple[float, int, AnyNode, AnyNode, _Open]] = []
    worst = 0.0
    steps: list[tuple[AnyNode, AnyNode]] = []
    failed: list[float] = []

    def x(node: AnyNode) -> float:
        return axes[0].badness(node.x)

    def jump(left: AnyNode, right: AnyNode) -> float:
        return axes[1].badness(left.y) / axes[1].badness(right.y) - 1.0

    def look_at(left: AnyNode, right: AnyNode, low: float, *, last: bool = False) -> None:
        if jump(left, right) > accuracy:
            heapq.heappush(pending, (-jump(left, right), next(order), left, right, _Open(low, last)))

    for left, right in stretches:
        look_at(left, right, max(left.level, x(left)))
    while pending and len(found) < most:
        asked: list[tuple[Stretch[AnyNode], _Open]] = []
        while pending and len(asked) < min(together, most - len(found)):
            urgency, _, left, right, open_ = heapq.heappop(pending)
            below = x(right) * (1.0 - _BELOW)
            if below <= open_.low:
                steps.append((left, right))
                continue
            level = below if open_.last else math.sqrt(open_.low * below)
            asked.append((Stretch(left, right, level, -urgency), open_))
        answers = solve([stretch for stretch, _ in asked]) if asked else ()
        for (stretch, open_), middle in zip(asked, answers, strict=True):
            left, right, level = stretch.left, stretch.right, stretch.level
            if middle is None:
                failed.append(level)
                steps.append((left, right))
            elif jump(left, middle) <= 0.0 or x(middle) <= x(left):
                if open_.last:
                    steps.append((left, right))
                else:
                    look_at(left, right, level, last=True)
            else:
                found.append(middle)
                off = abs(straight(axes[0], left, right, middle.level) / middle.y - 1.0)
                if level <= x(middle) * (1.0 + _CLOSE) and off <= accuracy:
                    worst = max(worst, off)
                else:
                    look_at(left, middle, open_.low)
                    look_at(middle, right, level, last=open_.last)
    found.sort(key=lambda node: node.level)
    return Refined(tuple(found), worst, tuple(steps), tuple(failed), complete=not pending)
