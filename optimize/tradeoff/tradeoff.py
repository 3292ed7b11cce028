"""Trade-offs between two figures of a design: the Pareto front by the epsilon-constraint method.

minimise y subject to x <= epsilon and the problem's limits, for as many epsilon as it takes until straight lines
between the points are right within the accuracy asked for (Haimes, Lasdon and Wismer, On a bicriterion formulation of
the problems of integrated system identification and system optimization, IEEE Transactions on Systems, Man, and
Cybernetics 1 (1971) 296-297, doi:10.1109/TSMC.1971.4308298). The ends are the least x that any design has, with the
best y at that, and the least y, with the best x at that. Each point starts from its neighbours; the multiplier of the
limit on x is the slope of the front there.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.picks import options
from linkwright.core.optimize.exchange.design import material_row
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.infeasible.answer import Infeasibility, Infeasible
from linkwright.core.optimize.infeasible.needed import explained
from linkwright.core.optimize.reaching import start_that_reaches
from linkwright.core.units.quantities import NoAnswer

from .front import Front, Point, Tradeoff
from .question import Question
from .refinement import Refined, Stretch, envelope, knee, logarithmic, refine, undominated
from .trace import Node, Notify, Tracer

ACCURACY = 0.01
"""The relative error that straight lines between the points may have."""
_USED = 2e-3
"""Allowed x that stays unused by less than this share is used."""


def trade_off(
    asked: Question,
    *,
    accuracy: float = ACCURACY,
    notify: Notify | None = None,
) -> Tradeoff:
    """The fronts of a question and their envelope.

    `notify` hears of progress. Where that raises `KeyboardInterrupt`, the points so far are the result, marked
    `interrupted`. Raises `NoAnswer` where no design keeps the limits, `InputError` where a figure is missing that the
    question needs.
    """
    began = time.perf_counter()
    start = start_that_reaches(asked.given)
    if start is not None:
        own = replace(asked.problem, arm=start.problem.arm)
        asked = replace(asked, given=start.problem, problem=own)
    for materials in options(asked.problem)[1]:
        material_row(materials, asked.problem)  # what a material lacks is reported before anything is solved
    tracers, without, interrupted = _traced(asked, accuracy, notify)
    best = None
    if len(tracers) > 1:
        try:
            best = _unrefined(asked, tracers) if interrupted else _envelope(asked, tracers, accuracy)
        except KeyboardInterrupt:
            best, interrupted = _unrefined(asked, tracers), True
    seconds = time.perf_counter() - began
    tradeoff = _result(asked, accuracy, tracers, best, tuple(without), seconds)
    tradeoff = replace(tradeoff, start=None if start is None else start.why)
    if not interrupted:
        return tradeoff
    fronts = tuple(replace(front, complete=False) for front in tradeoff.fronts)
    return replace(tradeoff, fronts=fronts, envelope=replace(tradeoff.envelope, complete=False), interrupted=True)


def _traced(
    question: Question, accuracy: float, notify: Notify | None
) -> tuple[list[Tracer], list[tuple[str, str]], bool]:
    """The fronts of all groups, those that have none with the reason, and whether an interrupt ended the work; raises
    where there is none at all."""
    tracers: list[Tracer] = []
    without: list[tuple[str, str]] = []
    blocked: list[Infeasibility] = []
    for name, problem in question.groups():
        tracer = Tracer(question, name, problem, accuracy, notify)
        try:
            if tracer.trace():
                tracers.append(tracer)
            else:
                without.append((name, "no combination of the sizes listed keeps all limits"))
                if problem.sizes is None:
                    blocked.append(explained(context_of(question.unlimited(problem))))
                    without[-1] = name, blocked[-1].text
        except Unreachable as error:
            without.append((name, f"workspace: {error}"))
        except NoAnswer as error:
            without.append((name, str(error)))
        except KeyboardInterrupt:
            if tracer.nodes:
                tracers.append(tracer)
            if not tracers:
                raise
            return tracers, without, True
    if not tracers:
        raise Infeasible(blocked[0]) if blocked else NoAnswer(without[0][1])
    return tracers, without, False


def _unrefined(question: Question, tracers: Sequence[Tracer]) -> Refined[Node]:
    """The best of all fronts as far as they came."""
    axes = (question.x, question.y)
    nodes = _best_of(question, [undominated(axes, tracer.nodes) for tracer in tracers])
    return Refined(tuple(nodes), 0.0, (), (), complete=False)


def _best_of(question: Question, fronts: Sequence[Sequence[Node]]) -> list[Node]:
    """The points on the best of several fronts; between designs from lists there are none."""
    axes = (question.x, question.y)
    if question.given.sizes is not None:
        return undominated(axes, [node for front in fronts for node in front])
    return envelope(axes, fronts)


def _envelope(question: Question, tracers: Sequence[Tracer], accuracy: float) -> Refined[Node]:
    """The best of all fronts: where one takes over from another, both are solved between the points until the straight
    line is right there too."""
    axes = (question.x, question.y)
    named = {tracer.name: tracer for tracer in tracers}
    nodes = _best_of(question, [undominated(axes, tracer.nodes) for tracer in tracers])
    changes = [(a, b) for a, b in itertools.pairwise(nodes) if a.group != b.group]

    def best(stretch: Stretch[Node]) -> Node | None:
        names = dict.fromkeys((stretch.left.group, stretch.right.group))
        results = [node for name in names if (node := named[name].at(stretch.level)) is not None]
        return min(results, key=lambda node: axes[1].badness(node.y), default=None)

    most = len(nodes) + 40 * max(len(changes), 1)
    return refine(axes, nodes, changes, best, accuracy, most=most, listed=question.given.sizes is not None)


def _result(
    question: Question,
    accuracy: float,
    tracers: Sequence[Tracer],
    best: Refined[Node] | None,
    without: tuple[tuple[str, str], ...],
    seconds: float,
) -> Tradeoff:
    axes = (question.x, question.y)
    kept = {tracer.name: undominated(axes, tracer.nodes) for tracer in tracers}
    numbered = [node for nodes in kept.values() for node in nodes]
    number = {id(node): k for k, node in enumerate(numbered, start=1)}
    logs = (logarithmic([node.x for node in numbered]), logarithmic([node.y for node in numbered]))
    named = {tracer.name: tracer for tracer in tracers}
    points = tuple(_point(question, named[node.group], node, k) for k, node in enumerate(numbered, start=1))

    def front(name: str, nodes: Sequence[Node], refined: Refined[Node] | None, last: Tracer) -> Front:
        of = [tracer for tracer in tracers if name in (tracer.name, "envelope")]
        return _front(question, name, nodes, [number[id(node)] for node in nodes], refined, logs, last.capped, of)

    fronts = tuple(front(tracer.name, kept[tracer.name], tracer.refined, tracer) for tracer in tracers)
    whole = fronts[0]
    if best is not None:
        nodes = _best_of(question, list(kept.values()))
        both = _together(best, [tracer.refined for tracer in tracers if tracer.refined is not None])
        whole = front("envelope", nodes, both, named[nodes[-1].group])
    solved = sum(tracer.solved for tracer in tracers)
    return Tradeoff(question, accuracy, points, fronts, whole, without, logs, seconds, solved)


def _front(
    question: Question,
    name: str,
    nodes: Sequence[Node],
    numbers: Sequence[int],
    refined: Refined[Node] | None,
    logs: tuple[bool, bool],
    capped: bool,
    tracers: Sequence[Tracer],
) -> Front:
    """A front of numbered points, of one group or of several."""
    at = knee((question.x, question.y), [node.x for node in nodes], [node.y for node in nodes], logs)
    done = refined or Refined((), 0.0, (), (), complete=True)
    return Front(
        name=name,
        points=tuple(numbers),
        knee=None if at is None else numbers[at],
        error=done.error,
        steps=_steps(question, nodes, numbers, done),
        # Between two designs from lists there are none, so that every stretch would be idle.
        idle=_idle(question, done.nodes if question.given.sizes is None else []),
        failed=tuple(question.x.badness(level) for level in done.failed),
        capped=capped,
        complete=done.complete,
        exhaustive=all(tracer.exhaustive for tracer in tracers),
        undecided=sum(tracer.undecided for tracer in tracers),
    )


def _together(best: Refined[Node], parts: Sequence[Refined[Node]]) -> Refined[Node]:
    """The envelope with what was let stand on each front."""
    return replace(
        best,
        error=max([best.error, *(part.error for part in parts)]),
        steps=(*best.steps, *(step for part in parts for step in part.steps)),
        failed=(*best.failed, *(level for part in parts for level in part.failed)),
        complete=best.complete and all(part.complete for part in parts),
    )


def _steps(
    question: Question, nodes: Sequence[Node], numbers: Sequence[int], refined: Refined[Node]
) -> tuple[tuple[int, int], ...]:
    """The neighbours on the front between which a stretch stayed a step."""
    steps: list[tuple[int, int]] = []
    for _, right in refined.steps:
        for k in range(1, len(nodes)):
            here, before = (question.x.badness(nodes[item].x) for item in (k, k - 1))
            if before < right.level * (1.0 - 1e-9) <= here * (1.0 + 1e-4) and nodes[k].y != nodes[k - 1].y:
                steps.append((numbers[k - 1], numbers[k]))
                break
    return tuple(dict.fromkeys(steps))


def _idle(question: Question, nodes: Sequence[Node]) -> tuple[tuple[float, float], ...]:
    """Where more x is allowed and the best design makes no use of it."""
    spans: dict[float, float] = {}
    for node in nodes:
        used = question.x.badness(node.x)
        if node.level > used * (1.0 + _USED):
            at = next((start for start in spans if abs(start / used - 1.0) < _USED), used)
            spans[at] = max(spans.get(at, 0.0), node.level)
    return tuple((question.x.badness(start), question.x.badness(end)) for start, end in sorted(spans.items()))


def _point(question: Question, tracer: Tracer, node: Node, number: int) -> Point:
    design = node.design
    slope = None
    if design.elasticity is not None:
        # Of badness to badness; a figure of which more is better falls where its badness grows.
        sign = -1.0 if question.x.more_is_better != question.y.more_is_better else 1.0
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
