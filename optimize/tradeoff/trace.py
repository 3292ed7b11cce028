"""The front of one group of a trade-off: its ends, the first points between them, and those that refine it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.choice.combinations import MOST_COMBINATIONS, count
from linkwright.core.optimize.problem import Problem

from .crew import Crew, Wanted, arm_with, record_of, search_for
from .front import Figures
from .journal import Journal, Record
from .listed import ListedSearch
from .point import Design, Search
from .question import Axis, Question
from .records import design_of
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
    """How far a trade-off has come: the front at work, its points, how many of all points a journal knew, the worst
    error of a straight line that is still to be dealt with (None at first), what is being done, and what share of the
    front's first points, and then of its refinement, is behind."""

    front: str
    points: int
    resumed: int
    error: float | None
    doing: str
    share: float


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
        self,
        asked: Question,
        name: str,
        problem: Problem,
        accuracy: float,
        book: Journal,
        told: Told | None,
        crew: Crew | None = None,
    ) -> None:
        """`crew` solves together what can be; without one, one point is solved after another."""
        self.asked, self.name, self._accuracy, self._book, self._told = asked, name, accuracy, book, told
        self._problem, self._crew = problem, crew
        self._fresh: set[tuple[str, ...]] = set()
        self.nodes: list[Node] = []
        self.refined: Refined[Node] | None = None
        self.capped = False
        self.resumed = 0
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
    def _listed(self) -> bool:
        return self._problem.sizes is not None

    @property
    def search(self) -> Search | ListedSearch:
        """The search, set up when it is first needed: what a journal knows needs none."""
        if self._search is None:
            self._search = search_for(self.asked, self._problem, self._say)
        return self._search

    def _say(self, text: str) -> None:
        if self._told is not None:
            self._told(Progress(self.name, len(self.nodes), self.resumed, self._error, text, self._share))

    @property
    def _share(self) -> float:
        """Of what the first point takes; of the first points; then, as the error of a straight line falls with the
        square of how many there are, of the points that the accuracy needs."""
        if not self.nodes:
            return 0.0 if self._search is None else self._search.share
        if self._error is None:
            return min(len(self.nodes) / self._first, 1.0)
        return min(math.sqrt(self._accuracy / self._error), 1.0) if self._error > 0.0 else 1.0

    def _key(self, push: int, held: float) -> tuple[str, ...]:
        return (self.name, "x" if push == self.asked.x_limit else "y", float(held).hex())

    def solve(self, push: int, held: float, near: Sequence[Node], *, wide: bool = False) -> Node | None:
        """The point at which one figure is pushed and the other held; None where there is no design."""
        key = self._key(push, held)
        self._say("solving")
        if self._book.has(key):
            self.resumed += key not in self._fresh
            return self._noted(push, held)
        design = self.search.best(push, held, [node.design for node in near], wide=wide)
        self._say("solved")
        self._book.put(key, None if design is None else record_of(self.asked, self._problem, design))
        return self._noted(push, held)

    def _noted(self, push: int, held: float) -> Node | None:
        """A point as the book has it; None where it has no design."""
        record = self._book.get(self._key(push, held))
        if record is None:
            return None
        design, figures = design_of(record["design"], self._problem), record["figures"]
        x, y = float(figures[self.asked.x.name]), float(figures[self.asked.y.name])
        # A design from a list leaves some of what is allowed; where it stands is what it has.
        allowed = push == self.asked.y_limit and math.isfinite(held) and not self._listed
        level = held if allowed else self.asked.x.badness(x)
        return Node(self.name, level, x, y, design, figures)

    def arm(self, design: Design) -> Arm:
        """The arm of a design."""
        return arm_with(self._problem, design)

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
        together = 1 if self._crew is None else self._crew.together
        done = refine(
            self._axes, self.nodes, pairs, self._between, self._accuracy, together=together, listed=self._listed
        )
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

    def _between(self, stretches: Sequence[Stretch[Node]]) -> list[Node | None]:
        self._error = max(stretch.expected for stretch in stretches)
        if self._crew is not None:
            self._ahead(self._crew, stretches)
        nodes: list[Node | None] = []
        for item in stretches:
            node = self.solve(self.asked.y_limit, item.level, [item.left, item.right])
            if node is not None:
                self.nodes.append(node)
            nodes.append(node)
        return nodes

    def _ahead(self, crew: Crew, stretches: Sequence[Stretch[Node]]) -> None:
        """Have points solved together and put into the book; an interrupt leaves those that are done among the
        nodes."""
        push = self.asked.y_limit
        fresh = [stretch for stretch in stretches if not self._book.has(self._key(push, stretch.level))]
        if len(fresh) < 2:
            return
        wanted = [Wanted(push, item.level, (item.left.design, item.right.design)) for item in fresh]
        done: list[Stretch[Node]] = []

        def keep(number: int, record: Record | None) -> None:
            key = self._key(push, fresh[number].level)
            self._fresh.add(key)
            self._book.put(key, record)
            done.append(fresh[number])

        try:
            crew.solve(self.name, self.search, wanted, lambda: self._say("solving"), keep)
        except KeyboardInterrupt:
            self.nodes += [node for item in done if (node := self._noted(push, item.level)) is not None]
            raise

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
