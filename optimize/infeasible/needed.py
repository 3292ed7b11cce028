"""What each limit would have to be for a design to keep all others, and the smallest joint change of all.

An elastic problem: a limit may give way, and the least slack of its logarithm is sought (the least sum of slacks for
the joint change; J. W. Chinneck, Feasibility and Infeasibility in Optimization, Springer 2008, ch. 6). Poses enter as
in the exchange; what is said is judged on a whole evaluation of the arm that keeps it.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import Limit, OfKinds, OfLinks, excess
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.at_once.feasibility import Feasibility, feasibility_of
from linkwright.core.optimize.choice.chooser import Progress
from linkwright.core.optimize.choice.picks import Combination, combinations, count, uniform
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Context, Exchange, context_of, first_pool
from linkwright.core.optimize.exchange.program import Ask, Program, Solution
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.problem_summary import span_by_link
from linkwright.core.optimize.trust import GAP
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity, read_bound

from .answer import Change, Infeasibility, Needed, OutOfReach

_ALL = 12
"""Up to this many combinations every one is looked at."""
_NEAREST, _AGREEING, _RANKED = 4, 4, 2000
"""Of more, so many that come nearest, and so many in which all links agree, among so many that come nearest."""
_CLOSEST, _KINDS, _CLOSER = 12, 2, 2
"""So many more for each question, of so many kinds of shapes; and so often again about the best of them."""
_FREE = 1e3
"""A limit so many times wider is none."""
_ROUNDS = 12
_STARTS = 2
_BROKEN = 1e-5
"""A limit whose logarithm has to give way by more than this is one that stands in the way."""
_DEAR = 1e3
"""The price of what must not give way, over that of what may: where it does nevertheless, the rest cannot be kept."""


@dataclass(frozen=True)
class _Outcome:
    """How combinations came out: the slacks of the limits and their sum, where there is a design."""

    outcome: Literal["found", "none", "undecided"]
    total: float = math.inf
    slacks: tuple[float, ...] = ()


def explained(
    context: Context,
    *,
    beyond: Sequence[OutOfReach] = (),
    unsolved: int = 0,
    feasibility: Feasibility | None = None,
    progress: Progress | None = None,
) -> Infeasibility:
    """Why a problem has no answer; `beyond` are limits that no design keeps, `unsolved` is on how many combinations the
    solver failed when a design was sought, and `feasibility` what is known from there of how far all break the
    limits."""
    problem = context.problem
    # An error that nothing limits would otherwise be looked for at every pose.
    problem = replace(problem, minimize="mass", limits=tuple(limit for limit in problem.limits if not limit.aim))
    context = replace(context, problem=problem) if context.aim is None else context_of(problem)
    feasibility = feasibility if context.aim is None else None
    total = count(problem)
    # Numbers of kinds stay: what they leave is looked at.
    every = tuple(k for k, limit in enumerate(problem.limits) if not isinstance(limit.figure.follows, OfKinds))
    asker = _Asker(context, feasibility, progress)
    answers = asker.answers(every, stuck={problem.limits.index(item.limit) for item in beyond})
    limits = tuple(_alone(problem.limits[k], answers[k,], k) for k in every)
    joint = answers[every] if len(every) > 1 else _Outcome("undecided")
    changes = tuple(
        Change(limit, _needed(limit, slack))
        for limit, slack in zip(problem.limits, joint.slacks, strict=False)
        if abs(slack) > _BROKEN
    )
    return Infeasibility(
        verdict="undecided" if unsolved and not beyond else "infeasible",
        out_of_reach=tuple(beyond),
        limits=limits,
        joint=changes,
        joint_sum=joint.total if changes else None,
        combinations=total,
        looked_at=total,
        unsolved=unsolved,
        rests_on=_rests_on(len(asker.trials), total, asker.among),
        kept=_sizes(problem),
    )


def _alone(limit: Limit, answer: _Outcome, number: int) -> Needed:
    needed = _needed(limit, answer.slacks[number]) if answer.outcome == "found" else None
    return Needed(limit, needed, answer.outcome)


class _Asker:
    """Solves for the least change of some limits that is feasible: over all combinations where they are few, else over
    the nearest ones, whose number grows with each question."""

    def __init__(self, context: Context, feasibility: Feasibility | None, progress: Progress | None) -> None:
        self._context, self._progress = context, progress
        self._exchanges: dict[tuple[str | None, ...], Exchange] = {}
        problem = context.problem
        few = count(problem) <= _ALL
        self._near = None if few else _nearest(context, feasibility, self._exchanges)
        if self._near is not None:
            picks, self.among = self._near.picks, "that come nearest by bounds on all of them"
        elif few:
            picks, self.among = combinations(problem), ""
        else:
            picks, self.among = uniform(problem), "in which the links agree"
        self.trials: dict[Combination, _Trial] = {}
        self._added(picks)

    def _added(self, picks: Sequence[Combination]) -> list[_Trial]:
        """Trials of combinations that are not looked at yet."""
        pool = None if self._near is None else self._near.pool
        fresh = [pick for pick in picks if pick not in self.trials]
        self.trials |= {pick: _Trial(self._context, pick, self._exchanges, pool) for pick in fresh}
        return [self.trials[pick] for pick in fresh]

    def answers(self, every: tuple[int, ...], *, stuck: Set[int]) -> dict[tuple[int, ...], _Outcome]:
        """The least change of all limits together and of each alone (by their numbers); where one that is `stuck` has
        to stay there is none."""
        # What the joint change comes to is where the others begin.
        questions = ([every] if len(every) > 1 else []) + [(k,) for k in every]
        return {
            question: _Outcome("none") if stuck - set(question) else self.answer(question, (number, len(questions)))
            for number, question in enumerate(questions)
        }

    def answer(self, question: tuple[int, ...], share: tuple[int, int]) -> _Outcome:
        """The least change of the limits of a question (their numbers); it is the one of so many."""
        closer = self._near.closer(question) if self._near is not None and len(question) == 1 else []
        if closer is None:
            return _Outcome("none")
        self._added(closer)
        current = _Question(self._context.problem, question)
        many = len(self.trials)
        for done, trial in enumerate(self.trials.values()):
            if self._progress is not None:
                self._progress(share[0] * many + done, share[1] * many, "finding what the limits would have to be")
            current.put(trial, starts=_STARTS if self._near is None or done < _NEAREST else 1)
        answer = current.answer()
        for _ in range(_CLOSER if len(question) == 1 else 1):
            if self._near is None or current.best is None or current.best[1].x is self._near.x:
                break
            # About a design that comes near, bounds tell more.
            self._near = self._near.about(*current.best)
            for trial in self._added(self._near.closer(question) or ()):
                current.put(trial)
            answer = current.answer()
        return answer


def _rests_on(looked_at: int, total: int, among: str) -> str:
    local = "solved locally from several starts"
    if not among:
        return f"over {'the only combination' if total == 1 else f'all {total} combinations'}, {local}"
    return f"over the {looked_at} of {total} combinations {among}, {local}"


@dataclass(frozen=True)
class _Nearest:
    """The combinations that come nearest to keeping all limits, and one of them with numbers at which limits give way,
    about which the bounds on all are read off."""

    context: Context
    picks: list[Combination]
    feasibility: Feasibility
    trial: _Trial
    x: Array
    pool: Pool

    def about(self, trial: _Trial, solution: Solution) -> _Nearest:
        """The same, with bounds read off about another combination's solution, at the poses that hold it."""
        return replace(self, trial=trial, x=solution.x, pool=solution.active)

    def closer(self, question: tuple[int, ...]) -> list[Combination] | None:
        """The combinations that come nearest where one limit gives way alone, or where all may; None where none keeps
        the others."""
        exchange, pick = self.trial.exchange, self.trial.pick
        problem = self.context.problem
        if len(question) != 1:
            return _kinds(self.feasibility.nearest(exchange, self.x, pick, self.pool, _RANKED), _CLOSEST)
        limit = problem.limits[question[0]]
        if limit.relation == "==":
            return []
        if not isinstance(limit.figure.follows, OfLinks):
            nearest = self.feasibility.nearest_by_one(exchange, self.x, pick, self.pool, _RANKED, question[0])
            return None if nearest is None else _kinds(nearest, _CLOSEST)
        # What a single link keeps is in the cells of all bounds.
        free = replace(limit, value=limit.value * (_FREE if limit.relation == "<=" else 1.0 / _FREE))
        limits = tuple(free if k == question[0] else item for k, item in enumerate(problem.limits))
        feasibility = feasibility_of(replace(self.context, problem=replace(problem, limits=limits)))
        return None if feasibility is not None and feasibility.none_keeps(exchange, self.x, pick, self.pool) else []


def _kinds(picks: Sequence[Combination], number: int) -> list[Combination]:
    """The first so many, of not more than `_KINDS` kinds of shapes: each kind takes a separate program."""
    kinds = list(dict.fromkeys(pick.shapes for pick in picks))[:_KINDS]
    return [pick for pick in picks if pick.shapes in kinds][:number]


def _nearest(
    context: Context, feasibility: Feasibility | None, exchanges: dict[tuple[str | None, ...], Exchange]
) -> _Nearest | None:
    """The combinations that come nearest to keeping all limits; None where no bound tells."""
    feasibility = feasibility or feasibility_of(context)
    if feasibility is None:
        return None
    most = min(count(context.problem), _RANKED)
    picks = feasibility.nearest_known(most)
    if feasibility.shown is not None and picks:
        shown = feasibility.shown
        pool = shown.pool if context.uses_error else replace(shown.pool, errors=())
        trial = _Trial(context, shown.pick, exchanges, pool)
        return _Nearest(context, _first(context, picks), feasibility, trial, shown.x, pool)
    price = np.ones(len(context.problem.limits))
    for pick in uniform(context.problem)[:_STARTS]:
        trial = _Trial(context, pick, exchanges)
        try:
            pool = first_pool(context, trial.exchange.space, trial.starts[0], pick.materials)
        except Unreachable:
            continue
        solution = _elastic(trial.exchange.program(pool), trial.starts[0], trial.materials, pool, price)
        if isinstance(solution, _Outcome):
            continue
        pool = trial.exchange.worse_poses(solution, pick.materials, pool)
        picks = feasibility.nearest(trial.exchange, solution.x, pick, pool, most)
        if picks:
            return _Nearest(context, _first(context, picks), feasibility, trial, solution.x, pool)
    return None


def _first(context: Context, picks: Sequence[Combination]) -> list[Combination]:
    """The nearest, and the nearest in which the links agree: bounds on mixtures of what a link can be like those best
    in which the links differ."""
    same = set(uniform(context.problem))
    agreeing = [pick for pick in picks if pick in same]
    return list(dict.fromkeys([*_kinds(picks, _NEAREST), *_kinds(agreeing, _AGREEING)]))


def _sizes(problem: Problem) -> str:
    counts = [limit.text for limit in problem.limits if isinstance(limit.figure.follows, OfKinds)]
    return ", ".join([f"section_size {span_by_link(problem, 'section_size')}", *counts])


class _Trial:
    """One combination, asked again and again with the poses that it has met."""

    def __init__(
        self,
        context: Context,
        pick: Combination,
        exchanges: dict[tuple[str | None, ...], Exchange],
        pool: Pool | None = None,
    ) -> None:
        self.context, self.pick = context, pick
        if pick.shapes not in exchanges:
            compiled = next((item.compiled for item in exchanges.values()), None)
            exchanges[pick.shapes] = Exchange(context, design_space(context.problem, pick.shapes), compiled)
        self.exchange = exchanges[pick.shapes]
        self.materials = material_row(pick.materials, context.problem)
        self.pool = pool
        self._latest: Array | None = None

    @cached_property
    def starts(self) -> list[Array]:
        """Where to begin where nothing is known yet."""
        return starting_points(self.exchange.space, self.materials, _STARTS)

    def _from(self, number: int) -> Iterator[Array]:
        """So many starts: where the last answer was, and others."""
        if self._latest is not None:
            yield self._latest
            number -= 1
        if number > 0:
            yield from self.starts[:number]

    def least(self, price: Array, starts: int) -> Solution | _Outcome:
        """The least change of the limits that have a price, for the poses met so far, from so many starts until there
        is an answer."""
        outcomes: set[str] = set()
        for item in self._from(starts):
            try:
                self.pool = self.pool or first_pool(self.context, self.exchange.space, item, self.pick.materials)
            except Unreachable:
                outcomes.add("undecided")
                continue
            solution = _elastic(self.exchange.program(self.pool), item, self.materials, self.pool, price)
            if not isinstance(solution, _Outcome):
                self._latest = solution.x
                return solution
            outcomes.add(solution.outcome)
        return _Outcome("none" if outcomes == {"none"} else "undecided")

    def met(self, solution: Solution, slacks: Sequence[float]) -> bool:
        """Whether a solution, its limits given way, meets poses that break them; they are known from then on."""
        assert self.pool is not None
        relaxed = replace(self.context.problem, limits=_relaxed(self.context.problem, slacks))
        judge = Exchange(replace(self.context, problem=relaxed), self.exchange.space)
        grown = judge.worse_poses(solution, self.pick.materials, self.pool)
        more = grown.size > self.pool.size
        self.pool = grown
        return more

    def arm(self, x: Array) -> Arm:
        """The arm of the optimiser's numbers."""
        return arm_of(self.exchange.space, x, self.pick.materials)


class _Question:
    """The least feasible change of some limits over combinations: each is solved for its poses so far, and only the
    current best is searched for further ones."""

    def __init__(self, problem: Problem, question: tuple[int, ...]) -> None:
        self.problem = problem
        self.price = np.zeros(len(problem.limits))
        self.price[list(question)] = 1.0
        self._order = itertools.count()
        self._heap: list[tuple[float, int, int, _Trial, Solution]] = []
        self._outcomes: set[str] = set()
        self._least = _Outcome("undecided")
        self.best: tuple[_Trial, Solution] | None = None
        """The combination whose change is the least."""

    def put(self, trial: _Trial, starts: int = _STARTS) -> None:
        """One more combination, looked at from so many starts until it has an answer."""
        self._note(trial, trial.least(self.price, starts), 1)

    def _note(self, trial: _Trial, solution: Solution | _Outcome, rounds: int) -> None:
        if isinstance(solution, _Outcome):
            self._outcomes.add(solution.outcome)
        else:
            total = sum(map(abs, self._slacks(solution)))
            heapq.heappush(self._heap, (total, next(self._order), rounds, trial, solution))

    def _slacks(self, solution: Solution) -> tuple[float, ...]:
        return tuple(slack if cost > 0.0 else 0.0 for slack, cost in zip(solution.slacks, self.price, strict=True))

    def answer(self) -> _Outcome:
        """The least change that a whole evaluation confirms; only where all combinations have none is there none."""
        while self._heap and self._heap[0][0] < self._least.total:
            _, _, rounds, trial, solution = heapq.heappop(self._heap)
            slacks = self._slacks(solution)
            try:
                more = trial.met(solution, slacks)
            except Unreachable:
                self._outcomes.add("undecided")
                continue
            if more:
                again = trial.least(self.price, 1) if rounds < _ROUNDS else _Outcome("undecided")
                self._note(trial, again, rounds + 1)
                continue
            after = evaluate(trial.arm(solution.x), self.problem.workspace, self.problem.load_cases)
            if any(excess(limit, limit.of(after)) > GAP for limit in _relaxed(self.problem, slacks)):
                self._outcomes.add("undecided")
                continue
            self._least, self.best = _Outcome("found", sum(map(abs, slacks)), slacks), (trial, solution)
        if self._least.outcome == "found":
            return self._least
        return _Outcome("none" if self._outcomes == {"none"} else "undecided")


def _elastic(program: Program, x: Array, materials: Array, pool: Pool, price: Array) -> Solution | _Outcome:
    """The least slacks for a pool, or what became of it. What is kept may give way as well, at so high a price that it
    does only where it must: a start that breaks limits is no trouble then, and a solver's failure proves nothing."""
    held = price == 0.0
    solution = program.solve(x, materials, pool, Ask(elastic=np.where(held, _DEAR, price).tolist()))
    if not solution.solved:
        return _Outcome("undecided")
    if any(abs(slack) > _BROKEN for slack in np.array(solution.slacks)[held]):
        return _Outcome("none")
    return solution


def _relaxed(problem: Problem, slacks: Sequence[float]) -> tuple[Limit, ...]:
    return tuple(
        replace(limit, value=_needed(limit, slack)) if abs(slack) > _BROKEN else limit
        for limit, slack in zip(problem.limits, slacks, strict=True)
    )


def _needed(limit: Limit, slack: float) -> float:
    """The limit's value at the least relaxation, to four digits, rounded to the side that is feasible."""
    kind = limit.figure.kind
    way = 1.0 if (slack > 0.0) == (limit.relation != ">=") else -1.0
    exact = limit.value * math.exp(way * abs(slack)) * (1.0 + 1e-4 * way)
    need = exact
    for step in range(21):
        text = format_quantity(exact * (1.0 + 1e-4 * step * way), kind, digits=4)
        need = read_bound(f"<= {text}", kind, file="", key="").value
        if way * (need - exact) >= 0.0:
            break
    return need
