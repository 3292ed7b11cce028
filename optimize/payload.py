"""The largest payload that a design can carry within its limits (`maximize: payload`).

The payload is one mass, that of every load case which has one (of all, where none has). The optimiser makes a limited
figure as good as it can be for a payload; that design's largest payload follows by root finding; and so on from
there (after W. Dinkelbach, Management Science 13, 1967, 492-498, doi:10.1287/mnsc.13.7.492), until a payload larger by
`_WITHIN` has no design.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass
from linkwright.core.arm.errors.varied import AFTER_PAYLOAD, as_it_is
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import (
    PAYLOAD,
    DesignValues,
    Limit,
    OfDesign,
    OfKinds,
    OfLinks,
    ThroughPoses,
    WorstError,
    excess,
)
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.units.quantities import InputError, NoAnswer

from .infeasible.answer import Infeasible
from .nominal import Options
from .problem import Problem
from .problem_summary import limits_in_words, map_of
from .result import BindingLimit, Candidate, Iteration, OptimizationResult, proved
from .trust import GAP

Optimise = Callable[[Problem, Options], OptimizationResult]

_WITHIN = 1e-3
"""A payload that is larger by this share has no design."""
_MOST = 1e5
"""kg; what is carried beyond that is not limited."""
_FIRST = 1.0
"""kg; the payload to begin with where nobody says one."""
_STEP = 1e-2
"""By how much (relative) a payload is changed to see what it does to figures."""
_CLOSE = 1e-4
"""A limit that is broken by less, at a payload found by poses of its own, is met a little below that."""
_MOST_ROUNDS = 40
_MOST_TIES = 10
_NEAR = 0.03
_SCAN = 4096


def with_payload(cases: Sequence[LoadCase], mass: float) -> tuple[LoadCase, ...]:
    """Load cases with another payload (kg): of those that have one, or of all where none has."""
    named = any(case.mass > 0.0 for case in cases)
    return tuple(replace(case, mass=mass) if case.mass > 0.0 or not named else case for case in cases)


def evaluated_at(problem: Problem, arm: Arm, mass: float) -> Evaluation:
    """The evaluation of an arm that carries a payload (kg). Raises `NoAnswer` where it cannot reach the workspace."""
    try:
        return evaluate(arm, problem.workspace, with_payload(problem.load_cases, mass))
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None


def largest_payload_of(problem: Problem, arm: Arm, start: float = _FIRST) -> float | None:
    """The largest payload (kg) that an arm carries within a problem's limits; None where it breaks one with any.

    Limits are taken to be the easier to keep the nearer the payload is to one, none as a rule: a force that lifts the
    tip is easiest to bear with a payload that it carries. Raises `InputError` where none limits it.
    """
    fixed = [limit for limit in problem.limits if isinstance(limit.figure.follows, OfLinks | OfKinds)]
    fixed += [limit for limit in problem.limits if _is_sum(limit)]
    moving = [limit for limit in problem.limits if limit not in fixed]

    def beyond(mass: float, limits: Sequence[Limit] = moving) -> float:
        values = [excess(limit, value) for limit, value in _figures_at(problem, arm, mass, limits)]
        return max((value for value in values if not math.isnan(value)), default=-1.0)

    if fixed and beyond(0.0, fixed) > GAP:
        return None
    by_error = _beyond_error(problem, arm, moving)
    root = None if by_error is None else _where_kept(problem, by_error, start)
    if by_error is not None and root is None:
        return None
    if root is None or beyond(root) > _CLOSE:  # another limit than that on the error holds it
        root = _where_kept(problem, beyond, start if root is None else root)
    step = 1e-7
    while root is not None and beyond(root) > 0.0:
        root, step = root * (1.0 - step), 4.0 * step
    return root


def _figures_at(problem: Problem, arm: Arm, mass: float, limits: Sequence[Limit]) -> list[tuple[Limit, float]]:
    """The figures that limits are on, of an arm that carries a payload (kg): of all that an evaluation looks at, these
    alone where the worst error and figures through poses are limited."""
    followed = [limit.figure.follows for limit in limits if limit.poses is None and limit.demands is None]
    plain = len(followed) == len(limits) and all(isinstance(item, WorstError | ThroughPoses) for item in followed)
    if not plain or of_unknown_mass(arm):
        evaluation = evaluated_at(problem, arm, mass)
        return [(limit, limit.of(evaluation)) for limit in limits]
    cases = with_payload(problem.load_cases, mass)
    p, search = beam_values(beams_of(arm, cases)), worst_search(error_model(arm, cases), problem.workspace)
    try:
        worst = search.worst(p, certify=False)
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None
    design = DesignValues(arm, cases, search, p, _SCAN, tuple(pose.q for pose in worst.poses))
    by_family = {item.family.name: item.family.evaluate(design) for item in followed if isinstance(item, ThroughPoses)}
    figures: list[tuple[Limit, float]] = []
    for limit, follows in zip(limits, followed, strict=True):
        value: float | None = worst.error
        if isinstance(follows, ThroughPoses):
            result = by_family[follows.family.name]
            value = None if result is None else follows.family.values(result)[limit.name]
        figures.append((limit, math.nan if value is None else value))
    return figures


def _where_kept(problem: Problem, beyond: Callable[[float], float], start: float) -> float | None:
    """The largest payload (kg) at which a figure is not beyond its limit; None where it is with any. Raises
    `InputError` where it never is."""
    low, high = 0.0, start
    while beyond(high) <= 0.0:
        low, high = high, 4.0 * high
        if high > _MOST:
            would_do = "give one that a payload makes harder to keep, e.g. subject_to: {max_error: '<= 0.2 mm'}"
            raise InputError(problem.file, "maximize", f"no limit holds the payload back; {would_do}")
    if low == 0.0 and beyond(0.0) > 0.0:
        low = _easiest(beyond, high)
        if beyond(low) > 0.0:
            return None
    root: Any = brentq(beyond, low, high, xtol=1e-6 * high)
    return float(root)


def _easiest(beyond: Callable[[float], float], most: float) -> float:
    """The payload (kg), `most` at most, at which a figure is best. Of a worst error it is the only one, for the largest
    of norms of what is linear in the payload is convex."""
    best: Any = minimize_scalar(beyond, bounds=(0.0, most), method="bounded", options={"xatol": 1e-4 * most})
    return float(best.x)


def _beyond_error(problem: Problem, arm: Arm, limits: Sequence[Limit]) -> Callable[[float], float] | None:
    """How far the worst error is beyond the limits on it, by payload, with one model for all payloads; None where none
    is on it, or weights are not known."""
    errors = [limit for limit in limits if isinstance(limit.figure.follows, WorstError) and limit.poses is None]
    if not errors or of_unknown_mass(arm):
        return None
    cases = with_payload(problem.load_cases, 1.0)
    model = error_model(arm, cases, drives=True, varied=frozenset({"payload"}))
    search = worst_search(model, problem.workspace)
    p = np.concatenate([beam_values(beams_of(arm, cases)), as_it_is(arm.size)])
    place = p.size - AFTER_PAYLOAD

    def beyond(mass: float) -> float:
        row = p.copy()
        row[place] = mass
        error = search.worst(row, certify=False).error
        return max(excess(limit, error) for limit in errors)

    return beyond


def _is_sum(limit: Limit) -> bool:
    """Whether a limit is on a sum over the links, in which no payload counts."""
    return isinstance(limit.figure.follows, OfDesign) and limit.name != "total_mass"


def pushed_limit(problem: Problem) -> Limit | None:
    """The limit whose figure is made as good as it can be for a payload: that on the worst error, else the first that
    has a value at every pose; None where there is none."""
    able = [
        limit
        for limit in problem.limits
        if limit.figure.traded
        and limit.poses is None
        and limit.demands is None
        and limit.relation != "=="
        and not isinstance(limit.figure.follows, OfDesign | OfLinks | OfKinds)
    ]
    errors = [limit for limit in able if limit.name == "max_error"]
    return min(errors, key=lambda limit: limit.value) if errors else next(iter(able), None)


@dataclass
class _Search:
    """Payloads between `low`, which the best design so far carries, and `high`, which none does."""

    problem: Problem
    optimise: Optimise
    options: Options
    pushed: Limit | None
    low: float = 0.0
    best: OptimizationResult | None = None
    high: float = math.inf
    proven: bool = False
    refused: OptimizationResult | None = None
    """The best design for `high`, which breaks the pushed limit."""
    rounds: list[Iteration] = field(default_factory=list)
    interrupted: bool = False

    def inner(self, mass: float) -> Problem:
        """The problem of the best design for a payload (kg)."""
        problem = replace(self.problem, load_cases=with_payload(self.problem.load_cases, mass))
        figures = {name: figure for name, figure in problem.figures.items() if name != PAYLOAD.name}
        if self.pushed is None:
            return replace(problem, minimize="mass", figures=figures)
        name = self.pushed.name
        others = tuple(limit for limit in problem.limits if limit.name != name)
        return replace(problem, minimize=name, figures=figures, limits=others)

    def try_at(self, mass: float) -> bool:
        """Look for a design that carries a payload (kg); whether there is one."""

        def heard(iteration: Iteration) -> None:
            self.rounds.append(replace(iteration, objective=mass, number=len(self.rounds) + 1))
            if self.options.log is not None:
                self.options.log(self.rounds[-1])

        quiet = Options(heard, self.options.progress, None, None, self.options.executor)
        try:
            result = self.optimise(self.inner(mass), quiet)
        except Infeasible:
            if mass == 0.0:
                raise
            self.high, self.proven, self.refused = mass, False, None
            return False
        self.interrupted = result.interrupted
        carried = largest_payload_of(self.problem, result.arm, mass or _FIRST)
        if carried is not None and (self.best is None or carried > self.low):
            self.low, self.best = carried, result
        if carried is not None and carried >= mass * (1.0 - 1e-5):
            return True
        self.high, self.refused = mass, result
        limit = self.pushed
        self.proven = (
            limit is not None
            and result.basis != "local"
            and not result.doubts
            and excess(limit, result.lower_bound) > 0
        )
        return False

    def _try_easier(self, mass: float) -> None:
        """Look for a design at the payload that the best one for another payload (kg) bears best, and so on."""
        for _ in range(_MOST_ROUNDS):
            beyond = (
                None if self.refused is None else _beyond_error(self.problem, self.refused.arm, self.problem.limits)
            )
            if beyond is None or self.interrupted:
                return
            before, mass = mass, _easiest(beyond, 4.0 * mass)
            if mass <= _STEP * before or abs(mass - before) <= _WITHIN * before:
                return
            if self.try_at(mass) or self.best is not None:
                self.high, self.proven, self.refused = math.inf, False, None
                return

    def run(self) -> None:
        """Narrow the payloads down. Raises `NoAnswer` where no design keeps the limits without any."""
        given = max(case.mass for case in self.problem.load_cases) or _FIRST
        if not self.try_at(given) and self.best is None:
            self._try_easier(given)
        if self.best is None:
            self.try_at(0.0)
        if self.best is None:
            assert self.pushed is not None
            raise NoAnswer(f"no design keeps {self.pushed.text} within the other limits, even with no payload")
        step = _WITHIN
        for _ in range(_MOST_ROUNDS):
            if self.interrupted or self.high <= self.low * (1.0 + _WITHIN) * (1.0 + 1e-9) or self.low == 0.0:
                return
            before = self.low
            trial = self.low * (1.0 + step)
            if trial >= self.high:
                trial = math.sqrt(self.low * self.high)
                trial = max(min(trial, self.high), self.low * (1.0 + 0.5 * _WITHIN))
            step = 4.0 * step if self.try_at(trial) and self.low < before * (1.0 + 4.0 * step) else _WITHIN


def largest_payload(problem: Problem, options: Options, optimise: Optimise) -> OptimizationResult:
    """The design that carries most within a problem's limits; `optimise` gives the best design of the inner problems.

    Raises `InputError` where something is uncertain, or nothing limits the payload; `NoAnswer` where no design keeps
    the limits.
    """
    began = time.perf_counter()
    if problem.uncertain is not None:
        would_do = "minimise max_error over what is uncertain, for payloads one by one"
        raise InputError(problem.file, "uncertain", f"goes without maximize: payload; {would_do}")
    before = evaluated_at(problem, problem.arm, largest_payload_of(problem, problem.arm) or 0.0)
    if options.begun is not None:
        options.begun(before)
    search = _Search(problem, optimise, options, pushed_limit(problem))
    search.run()
    best = search.best
    assert best is not None
    after = evaluated_at(problem, best.arm, search.low)
    proven = search.proven and math.isfinite(search.high)
    status = "interrupted" if search.interrupted else best.status
    if status in ("certified", "certified_where_reached"):
        status = proved(after)
    ties = [
        replace(tie, objective=carried, max_error=evaluated_at(problem, tie.arm, carried).max_error)
        for tie in best.near_ties[:_MOST_TIES]
        if (carried := largest_payload_of(problem, tie.arm, search.low)) and carried >= search.low * (1.0 - _NEAR)
    ]
    return replace(
        best,
        minimize=PAYLOAD.name,
        limits=limits_in_words(problem),
        status=status,
        before=before,
        after=after,
        objective=search.low,
        lower_bound=search.high if math.isfinite(search.high) else search.low,
        optimum="global" if proven and not search.interrupted else "local",
        bound_of="binding_poses",
        binding=_priced(problem, search, after),
        iterations=tuple(search.rounds),
        candidates=tuple(_without_objective(item) for item in best.candidates),
        drives=tuple(replace(item, objective=None) for item in best.drives),
        motor_places=tuple(replace(item, objective=None) for item in best.motor_places),
        near_ties=tuple(sorted(ties, key=lambda tie: -tie.objective)),
        near_ties_left=best.near_ties_left + len(best.near_ties) - len(ties),
        before_map=map_of(problem, before),
        after_map=map_of(problem, after),
        figures=problem.figures,
        interrupted=search.interrupted,
        seconds=time.perf_counter() - began,
    )


def _without_objective(candidate: Candidate) -> Candidate:
    return replace(candidate, objective=None)


def _priced(problem: Problem, search: _Search, after: Evaluation) -> tuple[BindingLimit, ...]:
    """The limits that hold the payload, with what one unit more of each would change of it.

    With F the best of the pushed figure for a payload m, F(m, limits) is the pushed limit: dm is d(limit) / F_m, and
    -F_l dl / F_m for another limit l. F_l is the price in the inner problem, F_m by its multipliers (envelope theorem).
    """
    assert search.best is not None
    pushed, inner = search.pushed, (search.refused or search.best)
    if pushed is None or inner.listed:
        return ()
    less, more = (evaluated_at(problem, after.arm, search.low * (1.0 + sign * _STEP)) for sign in (-1.0, 1.0))

    def slope(limit: Limit) -> float:
        change = limit.of(more) - limit.of(less)
        return limit.figure.factor * change / (2.0 * _STEP * search.low)

    sense = -1.0 if pushed.figure.more_is_better else 1.0
    limits = {limit.text: limit for limit in problem.limits}
    others = [item for item in inner.binding if math.isfinite(item.price)]
    by_payload = slope(pushed)
    by_payload -= sum(sense * item.price * slope(limits[item.text]) for item in others if item.text in limits)
    if by_payload == 0.0 or not math.isfinite(by_payload):
        return ()
    own = BindingLimit(
        pushed.name,
        pushed.text,
        pushed.of(after) * pushed.figure.factor,
        pushed.value * pushed.figure.factor,
        pushed.figure.unit,
        -1.0 / by_payload,
        f"kg/{pushed.figure.unit}" if pushed.figure.unit else "kg",
    )
    return (
        own,
        *(
            replace(
                item,
                value=limits[item.text].of(after) * limits[item.text].figure.factor
                if item.text in limits
                else item.value,
                price=sense * item.price / by_payload,
                price_unit=f"kg/{item.unit}" if item.unit else "kg",
            )
            for item in others
        ),
    )
