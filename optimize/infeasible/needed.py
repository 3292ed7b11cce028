"""What each limit would have to be for a design to keep all others, and the smallest joint change of all.

An elastic problem: a limit may give way, and the least slack of its logarithm is sought (the least sum of slacks for
the joint change; J. W. Chinneck, Feasibility and Infeasibility in Optimization, Springer 2008, ch. 6). Poses enter as
in the exchange; what is said is judged on a whole evaluation of the arm that keeps it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from arm.chain.chain import Arm
from arm.evaluation import evaluate
from arm.worst.workspace import Unreachable
from optimize.choice.at_once.feasibility import Feasibility, feasibility_of
from optimize.choice.chooser import Progress
from optimize.choice.picks import Combination, combinations, count, uniform
from optimize.exchange.binding_poses import Pool
from optimize.exchange.design import arm_of, design_space, material_row, starting_points
from optimize.exchange.exchange import Context, Exchange, first_pool
from optimize.exchange.program import Program, Solution
from optimize.limits import Limit, OfLinks, excess
from optimize.problem import Problem
from optimize.trust import GAP
from sections.numeric import Array
from units.quantities import format_quantity, read_bound

from .answer import Change, Infeasibility, Needed, OutOfReach

_ALL = 12
"""Up to this many combinations every one is looked at."""
_NEAREST, _RANKED = 4, 2000
"""Of more, so many that come nearest, and so many in which all links agree, among so many that come nearest."""
_CLOSEST, _HALVINGS = 8, 4
"""So many more for each limit, where it is so much that it gives way alone."""
_FREE = 1e3
"""A limit so many times wider is none."""
_ROUNDS = 12
_STARTS = 2
_BROKEN = 1e-5
"""A limit whose logarithm has to give way by more than this is one that stands in the way."""
_CHEAP = 1e-3
"""The price of what may give way where it is asked whether the rest can be kept at all."""


@dataclass(frozen=True)
class _Found:
    """How a combination came out: the slacks of the limits and their sum, and the arm, where there is a design."""

    outcome: Literal["found", "none", "undecided"]
    total: float = math.inf
    slacks: tuple[float, ...] = ()
    arm: Arm | None = None


def explained(
    context: Context, *, beyond: Sequence[OutOfReach] = (), unsolved: int = 0, progress: Progress | None = None
) -> Infeasibility:
    """Why a problem has no answer; `beyond` are limits that no design keeps, and `unsolved` is on how many combinations
    the solver failed when a design was sought."""
    problem = context.problem
    # An error that nothing limits would otherwise be looked for at every pose.
    problem = replace(problem, minimize="mass")
    context = replace(context, problem=problem)
    total = count(problem)
    size = len(problem.limits)
    near = None if total <= _ALL else _nearest(context)
    if near is not None:
        picks, among = near.picks, "that come nearest by bounds on all of them"
    elif total <= _ALL:
        picks, among = combinations(problem), ""
    else:
        picks, among = uniform(problem), "in which the links agree"
    exchanges: dict[tuple[str | None, ...], Exchange] = {}
    trials = [_Trial(context, pick, exchanges) for pick in picks]
    questions = [(k,) for k in range(size)] + ([tuple(range(size))] if size > 1 else [])
    stuck = {problem.limits.index(each.limit) for each in beyond}
    answers: list[_Found] = []
    for number, question in enumerate(questions):
        if stuck - set(question) or (near is not None and near.none_keeps_without(question)):
            answers.append(_Found("none"))
            continue
        found: list[_Found] = []
        for done, trial in enumerate(trials):
            if progress is not None:
                progress(number * len(trials) + done, len(questions) * len(trials), "what the limits would have to be")
            found.append(trial.least(question, min((each.total for each in found), default=math.inf)))
        if near is not None and len(question) == 1:
            known = {trial.pick for trial in trials}
            for pick in near.closer(question[0], min((each.total for each in found), default=math.inf)):
                if pick not in known:
                    trials.append(_Trial(context, pick, exchanges))
                    found.append(trials[-1].least(question, min(each.total for each in found)))
        answers.append(_best(problem, found))
    limits = tuple(
        Needed(limit, _needed(limit, each.slacks[k]) if each.outcome == "found" else None, each.outcome)
        for k, (limit, each) in enumerate(zip(problem.limits, answers, strict=False))
    )
    joint = answers[-1] if size > 1 else _Found("undecided")
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
        rests_on=_rests_on(len(trials), total, among),
        kept=_sizes(problem),
    )


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
    told: Feasibility
    trial: _Trial
    x: Array
    pool: Pool

    def closer(self, number: int, least: float) -> list[Combination]:
        """The combinations that come nearest where one limit gives way alone, by less than the `least` change known (of
        its logarithm): halved until what is known to be too little is close to it."""
        limit = self.context.problem.limits[number]
        if limit.relation == "==" or isinstance(limit.figure.follows, OfLinks):
            return []  # what a single link keeps is in the cells of all bounds
        found: list[Combination] = []
        low, high = 0.0, min(least, math.log(_FREE))
        for _ in range(_HALVINGS):
            change = 0.5 * (low + high)
            value = limit.value * math.exp(change if limit.relation == "<=" else -change)
            limits = tuple(
                replace(each, value=value) if k == number else each
                for k, each in enumerate(self.context.problem.limits)
            )
            nearest = self.told.nearest(self.trial.exchange, self.x, self.trial.pick, self.pool, _CLOSEST, limits)
            if nearest:
                low, found = change, nearest
            else:
                high = change
        return found

    def none_keeps_without(self, question: tuple[int, ...]) -> bool:
        """Whether no combination keeps the limits that are not in question."""
        problem = self.context.problem
        if len(question) == len(problem.limits) or any(problem.limits[k].relation == "==" for k in question):
            return False
        limits = tuple(
            replace(limit, value=limit.value * (_FREE if limit.relation == "<=" else 1.0 / _FREE))
            if k in question
            else limit
            for k, limit in enumerate(problem.limits)
        )
        told = feasibility_of(replace(self.context, problem=replace(problem, limits=limits)))
        return told is not None and told.none_keeps(self.trial.exchange, self.x, self.trial.pick, self.pool)


def _nearest(context: Context) -> _Nearest | None:
    """The combinations that come nearest to keeping all limits; None where no bound tells."""
    told = feasibility_of(context)
    if told is None:
        return None
    price = np.ones(len(context.problem.limits))
    for pick in uniform(context.problem)[:_STARTS]:
        trial = _Trial(context, pick, {})
        try:
            pool = first_pool(context, trial.exchange.space, trial.starts[0], pick.materials)
        except Unreachable:
            continue
        solution = _elastic(trial.exchange.program(pool), trial.starts[0], trial.materials, pool, price)
        if isinstance(solution, _Found):
            continue
        pool = trial.exchange.worse_poses(solution, pick.materials, pool)
        picks = told.nearest(trial.exchange, solution.x, pick, pool, min(count(context.problem), _RANKED))
        if picks:
            # Bounds on mixtures of what a link can be like those best in which the links differ.
            alike = set(uniform(context.problem))
            agreeing = [each for each in picks if each in alike]
            picks = list(dict.fromkeys([*picks[:_NEAREST], *agreeing[:_NEAREST]]))
            return _Nearest(context, picks, told, trial, solution.x, pool)
    return None


def _sizes(problem: Problem) -> str:
    low, high = (format_quantity(each, "length") for each in problem.section_size)
    return f"section_size {low} to {high}"


def _best(problem: Problem, found: Sequence[_Found]) -> _Found:
    """The least change over combinations that a whole evaluation confirms; only where all of them have none is there
    none."""
    for each in sorted(found, key=lambda each: each.total):
        if each.arm is None:
            continue
        relaxed = _relaxed(problem, each.slacks)
        after = evaluate(each.arm, problem.workspace, problem.load_cases)
        if not any(excess(limit, limit.of(after)) > GAP for limit in relaxed):
            return each
    return _Found("none" if all(each.outcome == "none" for each in found) else "undecided")


class _Trial:
    """One combination, asked again and again with the poses that it has met."""

    def __init__(self, context: Context, pick: Combination, exchanges: dict[tuple[str | None, ...], Exchange]) -> None:
        self.context, self.pick = context, pick
        if pick.shapes not in exchanges:
            exchanges[pick.shapes] = Exchange(context, design_space(context.problem, pick.shapes))
        self.exchange = exchanges[pick.shapes]
        self.materials = material_row(pick.materials, context.problem)
        self.starts = starting_points(self.exchange.space, self.materials, _STARTS)
        self.pool: Pool | None = None

    def least(self, question: tuple[int, ...], known: float) -> _Found:
        """The least change of the limits in question; given up where it is above what is known."""
        price = np.zeros(len(self.context.problem.limits))
        price[list(question)] = 1.0
        outcomes: set[str] = set()
        for start in self.starts:
            try:
                found = self._from(price, start, known)
            except Unreachable:
                found = _Found("undecided")
            outcomes.add(found.outcome)
            if found.outcome == "found":
                return found
        return _Found("none" if outcomes == {"none"} else "undecided")

    def _from(self, price: Array, start: Array, known: float) -> _Found:
        context, space, chosen = self.context, self.exchange.space, self.pick.materials
        self.pool = self.pool or first_pool(context, space, start, chosen)
        x = start
        for _ in range(_ROUNDS):
            solution = _elastic(self.exchange.program(self.pool), x, self.materials, self.pool, price)
            if isinstance(solution, _Found):
                return solution
            slacks = tuple(slack if cost > 0.0 else 0.0 for slack, cost in zip(solution.slacks, price, strict=True))
            total = sum(map(abs, slacks))
            if total > known * (1.0 + 1e-6) + _BROKEN:
                return _Found("found", total, slacks)  # for these poses alone it is worse than another combination
            relaxed = replace(context.problem, limits=_relaxed(context.problem, slacks))
            judge = Exchange(replace(context, problem=relaxed), space)
            grown = judge.worse_poses(solution, chosen, self.pool)
            if grown.size == self.pool.size:
                return _Found("found", total, slacks, arm_of(space, solution.x, chosen))
            x, self.pool = solution.x, grown
        return _Found("undecided")


def _elastic(program: Program, x: Array, materials: Array, pool: Pool, price: Array) -> Solution | _Found:
    """The least slacks for a pool, or what became of it: whether the limits that are kept can be is a question of its
    own, for a solver's failure proves nothing."""
    solution = program.solve(x, materials, pool, elastic=price.tolist())
    if solution.solved:
        return solution
    held = price == 0.0
    softer = program.solve(x, materials, pool, elastic=np.where(held, 1.0, _CHEAP).tolist())
    if not softer.solved:
        return _Found("undecided")
    if any(abs(slack) > _BROKEN for slack in np.array(softer.slacks)[held]):
        return _Found("none")
    again = program.solve(softer.x, materials, pool, elastic=price.tolist())
    return again if again.solved else _Found("undecided")


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
