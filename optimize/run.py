"""From a problem to its result: the one function that the command line calls."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from linkwright.core.arm.evaluation import Evaluation, error_map, evaluate
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.executors import Executor
from linkwright.core.optimize.balance.balance import settled
from linkwright.core.optimize.balance.chosen import balance_of
from linkwright.core.optimize.balance.motors import choose_placed
from linkwright.core.optimize.choice.actuators import first_driven
from linkwright.core.optimize.choice.combinations import Choice, Progress, count
from linkwright.core.optimize.exchange.design import arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.journal import Journal
from linkwright.core.units.quantities import NoAnswer

from .asked import choices_in_words, limits_in_words, map_of_given, whole_error
from .dropped import dropped_of
from .explain import binding_limits
from .infeasible.answer import Infeasible
from .infeasible.needed import explained
from .infeasible.quick import out_of_reach
from .problem import Problem
from .reaching import start_that_reaches
from .result import Iteration, OptimizationResult, Status, proved
from .robust.drives import robust_drives
from .robust.places import robust_places
from .robust.run import robust_optimum
from .sizes.driven import optimise_driven_lists
from .sizes.run import optimise_listed
from .ties import near_ties_of
from .trust import doubts_of, optimum_of

_NOUGHT = 1e-5
"""An error that is this share of what the arm as given has is none."""
Log = Callable[[Iteration], None]


def optimise(
    problem: Problem,
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    told: Callable[[str], None] | None = None,
    begun: Callable[[Evaluation], None] | None = None,
    executor: Executor | None = None,
    journal: Journal | None = None,
) -> OptimizationResult:
    """The best design for a problem; what falls apart into steps is done by `executor`, else by this process.

    `journal` answers what an earlier search for the same problem has solved, and notes what is solved.

    `told` hears at once of limits that no design can keep, before it is found out what they would have to be; `begun`
    of the arm as given, before the first round.
    `log` hears of every round of an exchange, `progress` of combinations tried; where either raises `KeyboardInterrupt`
    the best design so far is the result, marked `interrupted`. Where lengths are free and the arm as given does not
    reach a box or path, the search begins with lengths that do. Raises `NoAnswer` where it cannot be reached,
    `Infeasible` (one of them) where no design keeps the limits, which says what they would have to be, and `InputError`
    where a figure is missing that the problem needs.
    """
    start = start_that_reaches(problem)
    if start is not None:
        if told is not None:
            told(start.why)
        further: Any = {"log": log, "progress": progress, "told": told, "begun": begun}
        further |= {"executor": executor, "journal": journal}
        return replace(optimise(start.problem, **further), start=f'{start.why}, and "before" is that arm')
    if problem.uncertain is not None:
        settings: Any = {"log": log, "progress": progress}
        settings["journal"] = journal
        # With motors to place or drives to choose, each combination has a nominal and a robust optimum of its own.
        by_nominal = partial(optimise, **settings, told=told, executor=executor)
        if problem.motors:
            return robust_places(problem, by_nominal, **settings)
        if problem.actuators is not None:
            return robust_drives(problem, by_nominal, **settings)
        nominal = by_nominal(replace(problem, uncertain=None), begun=begun)
        return nominal if nominal.interrupted else robust_optimum(problem, nominal, **settings)
    if problem.sizes is not None and problem.actuators is not None:
        return optimise_driven_lists(problem, progress=progress, log=log, begun=begun)
    if problem.sizes is not None:
        return optimise_listed(problem, progress=progress, log=log, begun=begun)
    began = time.perf_counter()
    given = problem
    try:
        # With motors to place, its bounds would be those of the motors where they are.
        beyond = () if problem.motors else out_of_reach(problem)
        if beyond:
            if told is not None:
                for each in beyond:
                    told(each.text)
            context, names = first_driven(problem)
            raise Infeasible(explained(context, beyond=beyond, progress=progress), _looked_at(names))
        before = evaluate(problem.arm, problem.workspace, problem.load_cases)
        if begun is not None:
            begun(before)
        placed = choose_placed(problem, progress=progress, log=log, executor=executor, journal=journal)
        found = placed.driven
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None
    context, choice, problem = found.context, found.choice, found.context.problem
    if choice is None:
        why = explained(context, unsolved=found.unsolved, told=found.feasibility, progress=progress)
        raise Infeasible(why, _looked_at(found.names))
    arm = settled(arm_of(choice.space, choice.exchanged.x, choice.combination.materials))
    after = evaluate(arm, problem.workspace, problem.load_cases)
    lower_bound = choice.exchanged.solution.error if problem.minimize == "max_error" else choice.objective
    if problem.minimize == "max_error" and lower_bound < _NOUGHT * before.max_error:
        lower_bound = min(lower_bound, after.max_error)  # where loads cancel, what is left over is the solver's
    everywhere = choice.bound is not None and math.isfinite(choice.bound)
    if choice.bound is not None and everywhere:
        lower_bound = choice.bound
    doubts = doubts_of(context, choice, before, after, lower_bound)
    # Poses of a box or a path are found one by one, some ten times as slowly.
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    return OptimizationResult(
        problem_file=problem.file,
        minimize=problem.minimize,
        limits=limits_in_words(problem),
        choices=choices_in_words(given),
        status="doubtful" if doubts else _status(choice, context, after, searched=not found.exhaustive),
        arm=arm,
        before=before,
        after=after,
        objective=_objective(problem, after),
        lower_bound=lower_bound,
        binding=binding_limits(problem, choice, after),
        iterations=choice.history,
        candidates=choice.candidates,
        exhaustive=choice.exhaustive,
        seconds=time.perf_counter() - began,
        before_map=map_of_given(given, context, poses),
        after_map=error_map(whole_error(context), numeric_beams(arm, problem.load_cases), poses=poses),
        optimum=optimum_of(context, choice) if found.exhaustive and not doubts else "local",
        doubts=doubts,
        combinations=count(problem),
        gap=choice.gap,
        bound_of="all_designs" if everywhere else "binding_poses",
        near_ties=near_ties_of(context, choice.ties.solved),
        near_ties_left=choice.ties.left,
        drives=found.candidates,
        drives_exhaustive=found.exhaustive,
        figures=problem.figures,
        balance=balance_of(problem, choice),
        motor_places=placed.candidates,
        interrupted=choice.interrupted,
        dropped=() if choice.interrupted else dropped_of(context, choice),
    )


def _looked_at(names: str) -> str:
    """With which actuators the limits were looked at, for the end of a line."""
    return f" (looked at with {names})" if names else ""


def _status(choice: Choice, context: Context, after: Evaluation, *, searched: bool) -> Status:
    if choice.interrupted:
        return "interrupted"
    if not choice.exchanged.converged:
        return "stopped"
    if searched or not choice.exhaustive:
        return "searched"
    return proved(after) if choice.exchanged.certified and context.uses_error else "converged"


def _objective(problem: Problem, after: Evaluation) -> float:
    value = problem.objective.value(after)
    assert value is not None
    return value
