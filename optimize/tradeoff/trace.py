"""The front of one group of a trade-off: its ends, the first points between them, and those that refine it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import Figure, figures_of
from linkwright.core.optimize.choice.combinations import MOST_COMBINATIONS, count
from linkwright.core.optimize.exchange.design import arm_of, design_space
from linkwright.core.optimize.problem import Problem

from .front import Figures
from .listed import ListedSearch, listed_arm
from .point import Design, Search
from .question import Axis, Question
from .refinement import Refined, Stretch, refine

_STEP = 0.2
"""First distance of the points, in the logarithm of x."""
_LEAST_POINTS = 5
_HAIR = 1e-5
"""How much more than the least x is allowed where the best y at the least x is sought."""
_AT_BEST_Y = 1e-4
"""How much worse than the best y may be where the least x at the best y is sought."""


@dataclass(frozen=True)
class Progress:
    """How far a trade-off has come: the front at work, its points, the worst error of a straight line that is still to
    be dealt with (None at first), what is being done, and what share of the front's first points, and then of its
    refinement, is behind."""

    front: str
    points: int
    error: float | None
    doing: str
    share: float


Notify = Callable[[Progress], None]


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
    """The front of one group, one point after another; a point that is wanted again is not solved again."""

    def __init__(self, asked: Question, name: str, problem: Problem, accuracy: float, notify: Notify | None) -> None:
        self.asked, self.name, self._accuracy, self._notify = asked, name, accuracy, notify
        self._problem = problem
        self._solved: dict[tuple[int, float], Node | None] = {}
        self.nodes: list[Node] = []
        self.refined: Refined[Node] | None = None
        self.capped = False
        self._error: float | None = None
        self._first = _LEAST_POINTS
        self._search: Search | ListedSearch | None = None

    @property
    def exhaustive(self) -> bool:
        """Whether every combination was solved or excluded at each point."""
        if self._listed:
            return all(node.design.converged for node in self.nodes)
        return count(self._problem) <= MOST_COMBINATIONS and not self.undecided

    @property
    def undecided(self) -> int:
        """At how many points the solver failed on a combination that could be better."""
        return sum(node.design.unsolved > 0 for node in self.nodes)

    @property
    def solved(self) -> int:
        """How many points were solved, those without a design among them."""
        return len(self._solved)

    @property
    def _listed(self) -> bool:
        return self._problem.sizes is not None

    @property
    def search(self) -> Search | ListedSearch:
        """The search, set up when it is first needed."""
        if self._search is None:
            kind = ListedSearch if self._listed else Search
            self._search = kind(self.asked, self._problem, self._say)
        return self._search

    def _say(self, text: str) -> None:
        if self._notify is not None:
            self._notify(Progress(self.name, len(self.nodes), self._error, text, self._share))

    @property
    def _share(self) -> float:
        """Of what the first point takes; of the first points; then, as the error of a straight line falls with the
        square of how many there are, of the points that the accuracy needs."""
        if not self.nodes:
            return 0.0 if self._search is None else self._search.share
        if self._error is None:
            return min(len(self.nodes) / self._first, 1.0)
        return min(math.sqrt(self._accuracy / self._error), 1.0) if self._error > 0.0 else 1.0

    def solve(self, push: int, held: float, near: Sequence[Node], *, wide: bool = False) -> Node | None:
        """The point at which one figure is pushed and the other held; None where there is no design."""
        self._say("solving for a point")
        if (push, held) not in self._solved:
            design = self.search.best(push, held, [node.design for node in near], wide=wide)
            self._say("choosing the next point")
            self._solved[push, held] = None if design is None else self._node(design, push, held)
        return self._solved[push, held]

    def _node(self, design: Design, push: int, held: float) -> Node | None:
        """A design with its figures; None where it leaves what it must reach."""
        whole = self.asked.problem
        evaluation = evaluate(self.arm(design), whole.workspace, whole.load_cases)
        if self._problem.must_reach and evaluation.unreached is not None:
            return None
        figures = _figures(evaluation, whole.figures)
        x, y = float(figures[self.asked.x.name]), float(figures[self.asked.y.name])
        # A design from a list leaves some of what is allowed; where it stands is what it has.
        allowed = push == self.asked.y_limit and math.isfinite(held) and not self._listed
        level = held if allowed else self.asked.x.badness(x)
        return Node(self.name, level, x, y, design, figures)

    def arm(self, design: Design) -> Arm:
        """The arm of a design."""
        if self._listed:
            return listed_arm(self._problem, design.numbers)
        pick = design.combination
        return arm_of(design_space(self._problem, pick.shapes), np.array(design.numbers), pick.materials)

    def trace(self) -> bool:
        """Find the ends and refine between them; False where there is no design at all."""
        question = self.asked
        least = self.solve(question.x_limit, question.cap(question.y_limit), [])
        if least is None:
            return False
        left = self.solve(question.y_limit, least.level * (1.0 + _HAIR), [least]) or least
        self.nodes.append(left)
        most = question.cap(question.x_limit)
        right = self.solve(question.y_limit, most, [left], wide=True)
        if right is None:
            # The first end's design keeps the limits, so that there must be one here.
            failed = (most,) if math.isfinite(most) else ()
            self.refined = Refined(tuple(self.nodes), 0.0, (), failed, complete=False)
            return True
        self.capped = question.x.badness(right.x) > most * (1.0 - 1e-4)
        if self._listed:
            # The least x of designs as good in y is sought at every point; a limit on x falls between two designs.
            self.capped = math.isfinite(most)
        elif not self.capped:
            best = question.y.badness(right.y) * (1.0 + _AT_BEST_Y)
            right = self.solve(question.x_limit, best, [right]) or right
            right = replace(right, level=question.x.badness(right.x))
        if right.level <= left.level * (1.0 + 1e-6):
            # The ends are one in x: where they are two in y, the better one is best in both.
            self.nodes = [min((left, right), key=lambda node: question.y.badness(node.y))]
            return True
        missed = self._spread(left, right)
        pairs = list(itertools.pairwise(self.nodes))
        done = refine(self._axes, self.nodes, pairs, self._between, self._accuracy, listed=self._listed)
        failed = (*missed, *done.failed)
        self.refined = replace(done, failed=failed, complete=done.complete and not failed)
        return True

    @property
    def _axes(self) -> tuple[Axis, Axis]:
        return self.asked.x, self.asked.y

    def _spread(self, left: Node, right: Node) -> list[float]:
        """The first points, from the loose end to the tight one: what is known of combinations there rules them out.
        Returns the badness of x at which no design was found though there must be one."""
        width = math.log(right.level / left.level)
        count = max(_LEAST_POINTS - 1, math.ceil(width / _STEP))
        self._first = count + 1
        made, missed = [right], list[float]()
        self.nodes.append(right)
        for number in range(count - 1, 0, -1):
            level = left.level * math.exp(width * number / count)
            node = self.solve(self.asked.y_limit, level, [left, made[-1]])
            if node is None:
                missed.append(level)
            else:
                made.append(node)
                self.nodes.append(node)
        self.nodes = [left, *reversed(made)]
        return missed

    def _between(self, stretch: Stretch[Node]) -> Node | None:
        self._error = stretch.expected
        node = self.solve(self.asked.y_limit, stretch.level, [stretch.left, stretch.right])
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
    """What is known of a point in SI; None where it is not."""
    values = figures_of(evaluation, figures)
    return {
        **{name: None if math.isnan(value) else value for name, value in values.items()},
        "upper_bound": evaluation.upper_bound,
        "certified": evaluation.worst.certified,
        "link_masses": list(evaluation.link_masses),
        "unreached_share": 0.0 if evaluation.unreached is None else evaluation.unreached.share,
        "warnings": list(evaluation.warnings),
    }
