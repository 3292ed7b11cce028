"""Trade-offs between two figures of a design: the Pareto front by the epsilon-constraint method.

minimise y subject to x <= epsilon and the problem's own limits, for as many epsilon as it takes until straight lines
between the points are right within the accuracy asked for (Haimes, Lasdon and Wismer, On a bicriterion formulation of
the problems of integrated system identification and system optimization, IEEE Transactions on Systems, Man, and
Cybernetics 1 (1971) 296-297, doi:10.1109/TSMC.1971.4308298). The ends are the least x that any design has, with the
best y at that, and the least y, with the best x at that. Each point starts from its neighbours; the multiplier of the
limit on x is the slope of the front there.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from arm.chain import Arm
from arm.evaluation import Evaluation, evaluate
from arm.workspace import Unreachable

from .choice import options
from .design import arm_of, design_space, material_row
from .explain import why_infeasible
from .problem import NoAnswer, Problem
from .tradeoff_journal import Journal, design_of, design_record
from .tradeoff_question import Axis, Question
from .tradeoff_refine import Refined, envelope, knee, logarithmic, refine, undominated
from .tradeoff_search import Design, Search

ACCURACY = 0.01
"""The relative error that straight lines between the points may have."""
_STEP = 0.2
"""First distance of the points, in the logarithm of x."""
_LEAST_POINTS = 5
_HAIR = 1e-5
"""How much more than the least x is allowed where the best y at the least x is sought."""
_AT_BEST_Y = 1e-4
"""How much worse than the best y may be where the least x at the best y is sought."""
_USED = 2e-3
"""Allowed x that stays unused by less than this share is used."""

Figures = Mapping[str, Any]


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
class Point:
    """A design on a front, numbered through from 1 over all fronts.

    `x` and `y` are its figures (SI) as `evaluate` gives them, `figures` all of them. `slope` is dy/dx along the front
    (SI), from the multiplier of the limit on x; None where no multiplier tells. `converged`: the exchange ended by
    itself; `certified`: the worst error is proved.
    """

    number: int
    front: str
    x: float
    y: float
    slope: float | None
    arm: Arm
    shapes: tuple[str | None, ...]
    materials: tuple[str | None, ...]
    figures: Figures
    converged: bool

    @property
    def certified(self) -> bool:
        """Whether no pose is worse than the upper bound."""
        return bool(self.figures["certified"])


@dataclass(frozen=True)
class Front:
    """The designs none of which is beaten in both figures, in order of x; points by their numbers.

    `error` is the largest relative error of y on a straight line between two points, measured half-way before the point
    there joined them. `steps` are pairs of neighbouring points between which y jumps: nothing between is gained by more
    x until the second. `idle` are stretches of x (SI) along which more x buys nothing. `failed` are values of x (SI) at
    which the solver found no design though there must be one. `capped`: the end with the best y is where the problem's
    own limit on x ends it. `complete`: the refinement ended by itself.
    """

    name: str
    points: tuple[int, ...]
    knee: int | None
    error: float
    steps: tuple[tuple[int, int], ...]
    idle: tuple[tuple[float, float], ...]
    failed: tuple[float, ...]
    capped: bool
    complete: bool
    exhaustive: bool


@dataclass(frozen=True)
class Tradeoff:
    """A trade-off: its points, a front for each material or shape (or one for all), and the envelope of them.

    `without` are the names that have no design at all, with the reason. `logs`: whether x and y span more than a factor
    of ten. `resumed` is how many solutions came from a journal.
    """

    asked: Question
    accuracy: float
    points: tuple[Point, ...]
    fronts: tuple[Front, ...]
    envelope: Front
    without: tuple[tuple[str, str], ...]
    logs: tuple[bool, bool]
    seconds: float
    solved: int
    resumed: int

    def of(self, front: Front) -> tuple[Point, ...]:
        """The points of a front."""
        return tuple(self.points[number - 1] for number in front.points)


@dataclass(frozen=True)
class _Node:
    """A solved point of one group."""

    group: str
    level: float
    x: float
    y: float
    design: Design
    figures: Figures


def trade_off(
    asked: Question, *, accuracy: float = ACCURACY, journal: Journal | None = None, told: Told | None = None
) -> Tradeoff:
    """The fronts of a question and their envelope.

    `journal` answers what it knows and notes what is found; `told` hears of progress and may raise to stop. Raises
    `NoAnswer` where no design keeps the limits, `InputError` where a figure is missing that the question needs.
    """
    began = time.perf_counter()
    book = journal or Journal(None, "")
    known = book.size
    for materials in options(asked.problem)[1]:
        material_row(materials, asked.problem)  # what a material lacks is told before anything is solved
    tracers: list[_Tracer] = []
    without: list[tuple[str, str]] = []
    for name, problem in asked.groups():
        tracer = _Tracer(asked, name, problem, accuracy, book, told)
        try:
            if tracer.trace():
                tracers.append(tracer)
            else:
                without.append((name, why_infeasible(Search(asked, asked.unlimited(problem), _silent).context)))
        except Unreachable as error:
            hint = "; start from an arm that reaches it" if problem.link_length is not None else ""
            without.append((name, f"workspace: {error}{hint}"))
    if not tracers:
        raise NoAnswer(without[0][1])
    best = _envelope(asked, tracers, accuracy) if len(tracers) > 1 else None
    return _result(asked, accuracy, tracers, best, tuple(without), time.perf_counter() - began, book.size - known)


def _silent(_: str) -> None:
    return None


class _Tracer:
    """The front of one group: points solved, or answered by the journal."""

    def __init__(
        self, asked: Question, name: str, problem: Problem, accuracy: float, book: Journal, told: Told | None
    ) -> None:
        self.asked, self.name, self._accuracy, self._book, self._told = asked, name, accuracy, book, told
        self._problem = problem
        self.nodes: list[_Node] = []
        self.refined: Refined[_Node] | None = None
        self.capped = False
        self.resumed = 0
        self._error: float | None = None
        self._search: Search | None = None

    @property
    def exhaustive(self) -> bool:
        return self.search.exhaustive

    @property
    def search(self) -> Search:
        """The search, set up when it is first needed: what a journal knows needs none."""
        if self._search is None:
            self._search = Search(self.asked, self._problem, self._say)
        return self._search

    def _say(self, text: str) -> None:
        if self._told is not None:
            self._told(Progress(self.name, len(self.nodes), self.resumed, self._error, text))

    def solve(self, push: int, held: float, near: Sequence[_Node], *, wide: bool = False) -> _Node | None:
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
        figures = _figures(evaluate(self.arm(design), problem.workspace, problem.load_cases))
        self._book.put(key, {"design": design_record(design), "figures": figures})
        return self._node(push, held, design, figures)

    def _node(self, push: int, held: float, design: Design, figures: Figures) -> _Node:
        x, y = float(figures[self.asked.x.name]), float(figures[self.asked.y.name])
        level = held if push == self.asked.y_limit and math.isfinite(held) else self.asked.x.badness(x)
        return _Node(self.name, level, x, y, design, figures)

    def arm(self, design: Design) -> Arm:
        """The arm of a design."""
        pick = design.combination
        return arm_of(design_space(self._problem, pick.shapes), _array(design.numbers), pick.materials)

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

    def _spread(self, left: _Node, right: _Node) -> None:
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

    def _between(self, level: float, left: _Node, right: _Node, error: float) -> _Node | None:
        self._error = error
        node = self.solve(self.asked.y_limit, level, [left, right])
        if node is not None:
            self.nodes.append(node)
        return node

    def at(self, level: float) -> _Node | None:
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


def _array(numbers: Sequence[float]) -> Any:
    import numpy as np

    return np.array(numbers)


def _figures(evaluation: Evaluation) -> dict[str, Any]:
    """What is told of a point, by the names that `evaluate --json` has, in SI."""
    strength, frequency = evaluation.strength, evaluation.frequency
    return {
        "max_error": evaluation.max_error,
        "upper_bound": evaluation.worst.upper_bound,
        "certified": evaluation.worst.certified,
        "mass": evaluation.mass,
        "total_mass": evaluation.total_mass,
        "cost": evaluation.cost,
        "reach": evaluation.reach,
        "min_safety_factor": strength.least_safety_factor,
        "min_buckling": strength.least_buckling,
        "first_frequency": None if frequency is None else frequency.value,
        "link_masses": list(evaluation.link_masses),
        "warnings": list(evaluation.warnings),
    }


def _envelope(asked: Question, tracers: Sequence[_Tracer], accuracy: float) -> Refined[_Node]:
    """The best of all fronts: where one takes over from another, both are solved between the points until the straight
    line is right there too."""
    axes = (asked.x, asked.y)
    named = {tracer.name: tracer for tracer in tracers}
    nodes = envelope(axes, [undominated(axes, tracer.nodes) for tracer in tracers])
    changes = [(a, b) for a, b in itertools.pairwise(nodes) if a.group != b.group]

    def better(level: float, left: _Node, right: _Node, _: float) -> _Node | None:
        names = dict.fromkeys((left.group, right.group))
        found = [node for name in names if (node := named[name].at(level)) is not None]
        return min(found, key=lambda node: axes[1].badness(node.y), default=None)

    return refine(axes, nodes, changes, better, accuracy, most=len(nodes) + 40 * max(len(changes), 1))


def _result(
    asked: Question,
    accuracy: float,
    tracers: Sequence[_Tracer],
    best: Refined[_Node] | None,
    without: tuple[tuple[str, str], ...],
    seconds: float,
    solved: int,
) -> Tradeoff:
    axes = (asked.x, asked.y)
    kept = {tracer.name: undominated(axes, tracer.nodes) for tracer in tracers}
    numbered = [node for nodes in kept.values() for node in nodes]
    number = {id(node): k for k, node in enumerate(numbered, start=1)}
    logs = (logarithmic([node.x for node in numbered]), logarithmic([node.y for node in numbered]))
    named = {tracer.name: tracer for tracer in tracers}
    points = tuple(_point(asked, named[node.group], node, k) for k, node in enumerate(numbered, start=1))

    def front(name: str, nodes: Sequence[_Node], refined: Refined[_Node] | None, *, capped: bool) -> Front:
        numbers = [number[id(node)] for node in nodes]
        at = knee(axes, [node.x for node in nodes], [node.y for node in nodes], logs)
        return Front(
            name=name,
            points=tuple(numbers),
            knee=None if at is None else numbers[at],
            error=0.0 if refined is None else refined.error,
            steps=() if refined is None else _steps(asked, nodes, numbers, refined),
            idle=_idle(asked, [] if refined is None else refined.nodes),
            failed=() if refined is None else tuple(asked.x.badness(level) for level in refined.failed),
            capped=capped,
            complete=refined is None or refined.complete,
            exhaustive=all(each.exhaustive for each in tracers if name in (each.name, "envelope")),
        )

    fronts = tuple(front(each.name, kept[each.name], each.refined, capped=each.capped) for each in tracers)
    whole = fronts[0]
    if best is not None:
        nodes = envelope(axes, list(kept.values()))
        parts = [each.refined for each in tracers if each.refined is not None]
        both = replace(
            best,
            error=max([best.error, *(each.error for each in parts)]),
            steps=(*best.steps, *(step for each in parts for step in each.steps)),
            failed=(*best.failed, *(level for each in parts for level in each.failed)),
            complete=best.complete and all(each.complete for each in parts),
        )
        last = nodes[-1].group
        whole = front("envelope", nodes, both, capped=named[last].capped)
    resumed = sum(tracer.resumed for tracer in tracers)
    return Tradeoff(asked, accuracy, points, fronts, whole, without, logs, seconds, solved, resumed)


def _steps(
    asked: Question, nodes: Sequence[_Node], numbers: Sequence[int], refined: Refined[_Node]
) -> tuple[tuple[int, int], ...]:
    """The neighbours on the front between which a stretch stayed a step."""
    found: list[tuple[int, int]] = []
    for _, right in refined.steps:
        for k in range(1, len(nodes)):
            here, before = (asked.x.badness(nodes[each].x) for each in (k, k - 1))
            if before < right.level * (1.0 - 1e-9) <= here * (1.0 + 1e-4) and nodes[k].y != nodes[k - 1].y:
                found.append((numbers[k - 1], numbers[k]))
                break
    return tuple(dict.fromkeys(found))


def _idle(asked: Question, nodes: Sequence[_Node]) -> tuple[tuple[float, float], ...]:
    """Where more x is allowed and the best design makes no use of it."""
    spans: dict[float, float] = {}
    for node in nodes:
        used = asked.x.badness(node.x)
        if node.level > used * (1.0 + _USED):
            at = next((start for start in spans if abs(start / used - 1.0) < _USED), used)
            spans[at] = max(spans.get(at, 0.0), node.level)
    return tuple((asked.x.badness(start), asked.x.badness(end)) for start, end in sorted(spans.items()))


def _point(asked: Question, tracer: _Tracer, node: _Node, number: int) -> Point:
    design = node.design
    slope = None
    if design.elasticity is not None:
        # Of badness to badness; a figure of which more is better falls where its badness grows.
        sign = -1.0 if asked.x.more_is_better != asked.y.more_is_better else 1.0
        slope = sign * design.elasticity * node.y / node.x
    pick = design.combination
    return Point(
        number=number,
        front=node.group,
        x=node.x,
        y=node.y,
        slope=slope,
        arm=tracer.arm(design),
        shapes=pick.shapes,
        materials=tuple(None if material is None else material.name for material in pick.materials),
        figures=MappingProxyType(dict(node.figures)),
        converged=design.converged,
    )
