"""From a nominal optimum to a robust one, with what the nominal one loses."""

from __future__ import annotations

import time
from dataclasses import replace

from arm.evaluation import error_map, evaluate
from optimize.choice.combinations import Progress
from optimize.exchange.design import numeric_beams
from optimize.explain import binding_limits
from optimize.infeasible.answer import Infeasible
from optimize.infeasible.needed import explained
from optimize.journal import Journal
from optimize.limits import excess
from optimize.problem import Problem
from optimize.result import OptimizationResult, Status
from optimize.trust import GAP
from units.quantities import format_quantity

from .exchange import SAMPLES, Log, RobustExchange
from .exchange import RobustDesign as Design
from .figure import robust_figure
from .result import Robust, RobustFigure

_POSES = 50_000
_SAME = 1e-9


def robust_optimum(
    problem: Problem,
    nominal: OptimizationResult,
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    journal: Journal | None = None,
) -> OptimizationResult:
    """The best design of a problem for what is uncertain, as the nominal optimum's result is; drives are those of the
    nominal optimum. `journal` answers what an earlier search has solved, and notes what is solved. Raises
    `Infeasible` where no design keeps the limits so."""
    began = time.perf_counter()
    assert problem.uncertain is not None
    worst = problem.uncertain.worst
    problem = replace(problem, arm=replace(problem.arm, joints=nominal.arm.joints), actuators=None)
    exchange = RobustExchange(problem, progress, log, journal)
    found = exchange.worst() if worst else exchange.share(nominal.arm)
    if not isinstance(found, Design):
        raise Infeasible(explained(found, progress=progress))
    # Both designs are judged alike, by scenarios that neither was made with.
    own, before = (robust_figure(arm, problem, exchange.search) for arm in (found.arm, nominal.arm))
    by_error = problem.minimize == "max_error"
    if by_error and before.value < own.value * (1.0 - _SAME) and _keeps(problem, before):
        return _kept(
            nominal, Robust(before, before, before.value, (), found.rounds, _samples(problem), True, ()), began
        )
    return _result(problem, nominal, found, own, before, began)


def _samples(problem: Problem) -> int:
    assert problem.uncertain is not None
    return 0 if problem.uncertain.worst else SAMPLES


def _keeps(problem: Problem, figure: RobustFigure) -> bool:
    return all(excess(limit, figure.value) <= GAP for limit in problem.limit("max_error"))


def _kept(nominal: OptimizationResult, robust: Robust, began: float) -> OptimizationResult:
    """The nominal optimum as the answer: no design was found that is better for what is uncertain."""
    return replace(
        nominal,
        status=_status(nominal.status, settled=True),
        objective=robust.design.value,
        optimum="local",
        robust=robust,
        seconds=nominal.seconds + time.perf_counter() - began,
    )


def _status(status: Status, *, settled: bool) -> Status:
    if not settled:
        return "stopped"
    return "converged" if status == "certified" else status


def _result(
    problem: Problem, nominal: OptimizationResult, found: Design, own: RobustFigure, before: RobustFigure, began: float
) -> OptimizationResult:
    choice, context = found.choice, found.context
    after = evaluate(found.arm, problem.workspace, problem.load_cases)
    doubts = _doubts(problem, found, own)
    for limit in problem.limits:
        if limit.name != "max_error" and excess(limit, limit.of(after)) > GAP:
            doubts = (*doubts, f"{limit.text} is not kept")
    robust = Robust(
        own,
        before,
        found.claimed,
        () if context.scenarios is None else context.scenarios.held,
        found.rounds,
        _samples(problem),
        False,
        doubts,
    )
    by_error = problem.minimize == "max_error"
    objective = own.value if by_error else problem.objective.value(after)
    assert objective is not None
    status: Status = "converged" if choice.exchanged.converged and found.settled else "stopped"
    status = "searched" if status == "converged" and not choice.exhaustive else status
    status = "interrupted" if choice.interrupted else "doubtful" if doubts else status
    return replace(
        nominal,
        arm=found.arm,
        after=after,
        status=status,
        objective=objective,
        lower_bound=min(choice.exchanged.solution.error, objective) if by_error else choice.objective,
        binding=binding_limits(problem, choice, after),
        iterations=choice.history,
        candidates=choice.candidates,
        exhaustive=choice.exhaustive,
        after_map=error_map(context.search, numeric_beams(found.arm, problem.load_cases), poses=_POSES),
        optimum="local",
        doubts=doubts,
        gap=choice.gap,
        interrupted=choice.interrupted,
        robust=robust,
        seconds=nominal.seconds + time.perf_counter() - began,
    )


def _doubts(problem: Problem, found: Design, own: RobustFigure) -> tuple[str, ...]:
    """What scenarios that the design was not made with speak against: of the worst, any that is worse; of a share, its
    limits alone, for samples differ."""

    def shown(value: float) -> str:
        return format_quantity(value, "length", digits=5)

    if problem.uncertain is None or not problem.uncertain.worst:
        return ()
    doubts: list[str] = []
    if problem.minimize == "max_error" and own.value > found.claimed * (1.0 + 10.0 * GAP):
        doubts.append(f"a fresh scenario has {shown(own.value)}, above the {shown(found.claimed)} of the exchange")
    broken = (limit for limit in problem.limit("max_error") if excess(limit, own.value) > 10.0 * GAP)
    return (*doubts, *(f"{limit.text} is not kept in a fresh scenario: {shown(own.value)}" for limit in broken))
