"""From a nominal optimum to a robust one, with what the nominal one loses."""

from __future__ import annotations

import math
import time
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.error_map import error_map
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import excess
from linkwright.core.optimize.balance.balance import settled
from linkwright.core.optimize.balance.chosen import balance_of
from linkwright.core.optimize.choice.actuators import few
from linkwright.core.optimize.choice.near_ties import NEAR
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.explain import binding_limits
from linkwright.core.optimize.infeasible.answer import Infeasible
from linkwright.core.optimize.infeasible.needed import explained
from linkwright.core.optimize.nominal import Options, nominal_optimum
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import DriveCandidate, NearTie, OptimizationResult, Status, in_figure
from linkwright.core.optimize.robust.search import robust_figure
from linkwright.core.optimize.structures import Answer, StructureSearch
from linkwright.core.optimize.ties import near_ties_of
from linkwright.core.optimize.trust import GAP
from linkwright.core.units.quantities import NoAnswer, format_quantity

from .exchange import SAMPLES, RobustExchange
from .exchange import RobustDesign as Design
from .result import Robust, RobustFigure
from .search import ScenarioSearch

_POSES = 50_000
_SAME = 1e-9
_MOST_TIES = 20
"""So many near ties are held against what is uncertain."""


def robust_structures(problem: Problem, options: Options) -> OptimizationResult:
    """The best robust optimum over the drives and the places of motors that a problem chooses from.

    The worst of all that may be is no less than what the arm as it is does, so that a nominal optimum bounds the robust
    one with its drives and places; for a share nothing is left out. Of more drives than can all be looked at
    (`choice.actuators.few`), those that are best for the arm as it is are taken. Raises `NoAnswer` where no choice that
    was looked at has a robust optimum.
    """
    assert problem.uncertain is not None
    worst, every = problem.uncertain.worst, few(problem)
    seconds = 0.0

    def solve(problem_here: Problem, known: float) -> Answer[OptimizationResult] | float:
        nonlocal seconds
        problem_here = problem_here if every else replace(problem_here, actuators=problem.actuators)
        nominal = nominal_optimum(replace(problem_here, uncertain=None), options, problem)
        if nominal.interrupted:
            if math.isfinite(known):
                raise KeyboardInterrupt
            return Answer(nominal.objective, nominal, interrupted=True)
        if worst and nominal.objective >= known:
            return nominal.objective
        outcome = robust_optimum(problem_here, nominal, options)
        seconds += outcome.seconds
        return Answer(outcome.objective, outcome, outcome.interrupted)

    search = StructureSearch(problem if every else replace(problem, actuators=None), solve, options.progress)
    search.run()
    if search.best is None:
        raise search.failed or NoAnswer("no choice of drives and places has a design for what is uncertain")
    result = search.best[1]
    if search.interrupted and not result.interrupted:
        result = replace(result, interrupted=True, status="interrupted")
    drives = search.drives()
    if not every:
        chosen = next(drive.actuators for drive in result.drives if drive.outcome == "best")
        drives = (DriveCandidate(chosen, result.objective, "best"),)
    return replace(
        result,
        drives=drives,
        drives_exhaustive=every,
        motor_places=search.places(),
        seconds=seconds or result.seconds,
    )


def robust_optimum(problem: Problem, nominal: OptimizationResult, options: Options) -> OptimizationResult:
    """The best design of a problem for what is uncertain, as the nominal optimum's result is; drives are those of the
    nominal optimum. Raises `Infeasible` where no design keeps the limits so."""
    began = time.perf_counter()
    assert problem.uncertain is not None
    worst = problem.uncertain.worst
    problem = replace(problem, arm=_driven(problem.arm, nominal.arm), actuators=None)
    exchange = RobustExchange(problem, options.progress, options.log)
    design = exchange.worst() if worst else exchange.share(nominal.arm)
    if not isinstance(design, Design):
        raise Infeasible(explained(design, progress=options.progress))
    # Both designs are judged alike, by scenarios that neither was made with.
    figure = robust_figure(design.arm, problem, exchange.search)
    # Of an arm with nothing left to choose, balances are constants of its model.
    plain = ScenarioSearch(problem, nominal.arm) if problem.balances else exchange.search
    before = robust_figure(nominal.arm, problem, plain)
    by_error = problem.minimize == "max_error"
    if by_error and before.value < figure.value * (1.0 - _SAME) and _keeps(problem, before):
        robust = Robust(before, before, before.value, (), design.rounds, _samples(problem), True, ())
        return _kept(problem, nominal, robust, began)
    return _result(problem, nominal, design, figure, before, began)


def _driven(arm: Arm, nominal: Arm) -> Arm:
    """The arm with the drives of the nominal optimum, and with what is to be chosen of balances as it was."""
    pairs = zip(arm.joints, nominal.joints, strict=True)
    joints = tuple(
        replace(new, counterbalance=old.counterbalance, balancer_chosen=old.balancer_chosen) for old, new in pairs
    )
    return replace(arm, joints=joints)


def _samples(problem: Problem) -> int:
    assert problem.uncertain is not None
    return 0 if problem.uncertain.worst else SAMPLES


def _keeps(problem: Problem, figure: RobustFigure) -> bool:
    """Whether an arm keeps the limits on errors where all that is uncertain counts."""
    limits = (limit for limit in problem.limits if limit.name in figure.errors)
    return all(excess(limit, figure.errors[limit.name]) <= GAP for limit in limits)


def _kept(problem: Problem, nominal: OptimizationResult, robust: Robust, began: float) -> OptimizationResult:
    """The nominal optimum as the answer: no design was found that is better for what is uncertain."""
    first = nominal.near_ties[:_MOST_TIES]
    judged = ((item, _judged(problem, item.arm)) for item in first)
    valued = (replace(item, objective=figure.value) for item, figure in judged if _keeps(problem, figure))
    near = (item for item in valued if item.objective <= robust.design.value * (1.0 + NEAR))
    return replace(
        nominal,
        near_ties=tuple(sorted(near, key=lambda item: item.objective)),
        near_ties_left=nominal.near_ties_left + len(nominal.near_ties) - len(first),
        status=_status(nominal.status, settled=True),
        objective=robust.design.value,
        optimum="local",
        robust=robust,
        seconds=nominal.seconds + time.perf_counter() - began,
    )


def _status(status: Status, *, settled: bool) -> Status:
    if not settled:
        return "stopped"
    return "converged" if status in ("certified", "certified_where_reached") else status


def _result(
    problem: Problem,
    nominal: OptimizationResult,
    design: Design,
    new_figure: RobustFigure,
    before: RobustFigure,
    began: float,
) -> OptimizationResult:
    choice, context = design.choice, design.context
    arm = settled(design.arm)
    after = evaluate(arm, problem.workspace, problem.load_cases)
    doubts = _doubts(problem, design, new_figure)
    for limit in problem.limits:
        if limit.name != "max_error" and excess(limit, limit.of(after)) > GAP:
            doubts = (*doubts, f"{limit.text} is not kept")
    ties, left = _near_ties(problem, design, new_figure)
    by_error, figure = problem.minimize == "max_error", problem.objective
    objective = new_figure.value if by_error else figure.value(after)
    assert objective is not None
    costs = new_figure.nominal - before.nominal if by_error else objective - nominal.objective
    robust = Robust(
        new_figure,
        before,
        design.claimed,
        () if context.scenarios is None else context.scenarios.held,
        design.rounds,
        _samples(problem),
        False,
        doubts,
        -costs if figure.more_is_better else costs,
    )
    status: Status = "converged" if choice.exchanged.converged and design.settled else "stopped"
    status = "searched" if status == "converged" and not choice.exhaustive else status
    status = "interrupted" if choice.interrupted else "doubtful" if doubts else status
    return replace(
        nominal,
        arm=arm,
        after=after,
        status=status,
        objective=objective,
        lower_bound=min(choice.exchanged.solution.error, objective)
        if by_error
        else problem.objective.badness(choice.objective),
        binding=binding_limits(context.problem, choice, after),
        iterations=choice.history,
        candidates=in_figure(choice.candidates, figure),
        exhaustive=choice.exhaustive,
        after_map=error_map(context.search, numeric_beams(design.arm, problem.load_cases), poses=_POSES),
        optimum="local",
        doubts=doubts,
        gap=choice.gap,
        balance=balance_of(problem, choice),
        near_ties=in_figure(ties, figure),
        near_ties_left=left,
        interrupted=choice.interrupted,
        robust=robust,
        seconds=nominal.seconds + time.perf_counter() - began,
    )


def _near_ties(problem: Problem, design: Design, figure: RobustFigure) -> tuple[tuple[NearTie, ...], int]:
    """The near ties of the last choice, each with what it does for what is uncertain where the error is minimised, and
    how many more there may be."""
    ties = design.choice.ties
    solved = ties.solved[:_MOST_TIES]
    left = ties.left + len(ties.solved) - len(solved)
    if problem.minimize == "max_error":
        valued = [replace(item, objective=_judged(problem, item.arm).value) for item in solved]
        near = [item for item in valued if item.objective <= figure.value * (1.0 + NEAR)]
        solved = tuple(sorted(near, key=lambda item: item.objective))
    return near_ties_of(design.context, solved), left


def _judged(problem: Problem, arm: Arm) -> RobustFigure:
    return robust_figure(arm, problem, ScenarioSearch(problem, settled(arm)))


def _doubts(problem: Problem, design: Design, figure: RobustFigure) -> tuple[str, ...]:
    """What scenarios that the design was not made with speak against: of the worst, any that is worse; of a share, its
    limits alone, for samples differ."""

    def shown(value: float) -> str:
        return format_quantity(value, "length", digits=5)

    if problem.uncertain is None or not problem.uncertain.worst:
        return ()
    doubts: list[str] = []
    if problem.minimize == "max_error" and figure.value > design.claimed * (1.0 + 10.0 * GAP):
        doubts.append(f"a fresh scenario has {shown(figure.value)}, above the {shown(design.claimed)} of the exchange")
    held = [(limit, figure.errors[limit.name]) for limit in problem.limits if limit.name in figure.errors]
    broken = [(limit.text, error) for limit, error in held if excess(limit, error) > 10.0 * GAP]
    return (*doubts, *(f"{text} is not kept in a fresh scenario: {shown(error)}" for text, error in broken))
