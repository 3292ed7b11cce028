"""The front of one group of a trade-off: its ends, the first points between them, and those that refine it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from arm.chain.chain import Arm
from arm.evaluation import Evaluation, evaluate
from optimize.choice.combinations import MOST_COMBINATIONS, count
from optimize.exchange.design import arm_of, design_space
from optimize.limits import Figure, figures_of
from optimize.problem import Problem

from .front import Figures
from .journal import Journal, design_of, design_record
from .point import Design, Search
from .question import Axis, Question
from .refinement import Refined, refine, undominated

_STEP = 0.2
"""First distance of the points, in the logarithm of x."""
_LEAST_POINTS = 5
_HAIR = 1e-5
"""How much more than the least x is allowed where the best y at the least x is sought."""
_AT_BEST_Y = 1e-4
"""How much worse than the best y may be where the least x at the best y is sought."""


@dataclass(frozen=True)
class Progress:
    """How far a trade-off has come: the front at work, its points, how many of all points a journal knew, the worst
    error of a straight line that is still to be dealt with (None at first), and what is being done."""

    front: str
    points: int
    resumed: int
    error: float | None
    doing: str


Told = Callable[[Progress], None]


@dataclass(frozen=True)
class Node:
    """A solved point of one group: the badness of x that was allowed for it, and its figures (SI)."""

    group: str
    level: float
    x: float
    y: float
    design: Design
    figures: Figures


class Tracer:
    """The front of one group: points solved, or answered by the journal."""

    def __init__(
        self, asked: Question, name: str, problem: Problem, accuracy: float, book: Journal, told: Told | None
    ) -> None:
        self.asked, self.name, self._accuracy, self._book, self._told = asked, name, accuracy, book, told
        self._problem = problem
        self.nodes: list[Node] = []
        self.refined: Refined[Node] | None = None
        self.capped = False
        self.resumed = 0
        self._error: float | None = None
        self._search: Search | None = None

    @property
    def exhaustive(self) -> bool:
        """Whether every combination is in the running at each point."""
        return count(self._problem) <= MOST_COMBINATIONS

    @property
    def search(self) -> Search:
        """The search, set up when it is first needed: what a journal knows needs none."""
        if self._search is None:
            self._search = Search(self.asked, self._problem, self._say)
        return self._search

    def _say(self, text: str) -> None:
        if self._told is not None:
            self._told(Progress(self.name, len(self.nodes), self.resumed, self._error, text))

    def solve(self, push: int, held: float, near: Sequence[Node], *, wide: bool = False) -> Node | None:
        """The point at which one figure is pushed and the other held; None where there is no design."""
        key = (self.name, "x" if push == self.asked.x_limit else "y", float(held).hex())
        self._say("solving")
        if self._book.has(key):
            self.resumed += 1
            record = self._book.get(key)
            if record is None:
                return None
            return self._node(push, held, design_of(record["design"], self._problem), record["figures"])
        design = self.search.best(push, held, [node.design for node in near], wide=wide)
        self._say("solved")
        if design is None:
            self._book.put(key, None)
            return None
        problem = self.asked.problem
        figures = _figures(evaluate(self.arm(design), problem.workspace, problem.load_cases), problem.figures)
        self._book.put(key, {"design": design_record(design), "figures": figures})
        return self._node(push, held, design, figures)

    def _node(self, push: int, held: float, design: Design, figures: Figures) -> Node:
        x, y = float(figures[self.asked.x.name]), float(figures[self.asked.y.name])
        level = held if push == self.asked.y_limit and math.isfinite(held) else self.asked.x.badness(x)
        return Node(self.name, level, x, y, design, figures)

    def arm(self, design: Design) -> Arm:
        """The arm of a design."""
        pick = design.combination
        return arm_of(design_space(self._problem, pick.shapes), np.array(design.numbers), pick.materials)

    def trace(self) -> bool:
        """Find the ends and refine between them; False where there is no design at all."""
        asked = self.asked
        least = self.solve(asked.x_limit, asked.cap(asked.y_limit), [])
        if least is None:
            return False
        left = self.solve(asked.y_limit, least.level * (1.0 + _HAIR), [least]) or least
        self.nodes.append(left)
        most = asked.cap(asked.x_limit)
        right = self.solve(asked.y_limit, most, [left], wide=True)
        if right is None:
            return True
        self.capped = asked.x.badness(right.x) > most * (1.0 - 1e-4)
        if not self.capped:
            best = asked.y.badness(right.y) * (1.0 + _AT_BEST_Y)
            right = self.solve(asked.x_limit, best, [right]) or right
            right = replace(right, level=asked.x.badness(right.x))
        if right.level <= left.level * (1.0 + 1e-6):
            self.nodes = undominated(self._axes, [left, right])
            return True
        self._spread(left, right)
        pairs = list(itertools.pairwise(self.nodes))
        self.refined = refine(self._axes, self.nodes, pairs, self._between, self._accuracy)
        return True

    @property
    def _axes(self) -> tuple[Axis, Axis]:
        return self.asked.x, self.asked.y

    def _spread(self, left: Node, right: Node) -> None:
        """The first points, from the loose end to the tight one: what is known of combinations there rules them out."""
        width = math.log(right.level / left.level)
        count = max(_LEAST_POINTS - 1, math.ceil(width / _STEP))
        made = [right]
        self.nodes.append(right)
        for number in range(count - 1, 0, -1):
            node = self.solve(self.asked.y_limit, left.level * math.exp(width * number / count), [left, made[-1]])
            if node is not None:
                made.append(node)
                self.nodes.append(node)
        self.nodes = [left, *reversed(made)]

    def _between(self, level: float, left: Node, right: Node, error: float) -> Node | None:
        self._error = error
        node = self.solve(self.asked.y_limit, level, [left, right])
        if node is not None:
            self.nodes.append(node)
        return node

    def at(self, level: float) -> Node | None:
        """A point of the front at a badness of x, started from the points on both sides of it."""
        before = [node for node in self.nodes if node.level <= level]
        if not before:
            return None
        after = [node for node in self.nodes if node.level > level]
        near = [max(before, key=lambda node: node.level)]
        if after:
            near.append(min(after, key=lambda node: node.level))
        node = self.solve(self.asked.y_limit, level, near)
        if node is not None:
            self.nodes.append(node)
        return node


def _figures(evaluation: Evaluation, figures: Mapping[str, Figure]) -> dict[str, Any]:
    """What is told of a point in SI; None where it is not known."""
    values = figures_of(evaluation, figures)
    return {
        **{name: None if math.isnan(value) else value for name, value in values.items()},
        "upper_bound": evaluation.upper_bound,
        "certified": evaluation.worst.certified,
        "link_masses": list(evaluation.link_masses),
        "warnings": list(evaluation.warnings),
    }
