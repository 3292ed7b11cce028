"""From a problem to its result: the one function that the command line calls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import PAYLOAD
from linkwright.core.executors import Executor
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.choice.picks import disagreement
from linkwright.core.units.quantities import NoAnswer

from .base.search import best_base
from .exchange.cycles import over_whole_cycles
from .nominal import Log, Options, nominal_optimum
from .payload import largest_payload
from .problem import Problem
from .reaching import start_that_reaches
from .result import Dropped, OptimizationResult
from .robust.run import robust_structures
from .sizes.options import without_stock
from .sizes.run import listed_structures
from .sizes.wall_steps import on_wall_steps


def optimise(
    problem: Problem,
    *,
    log: Log | None = None,
    progress: Progress | None = None,
    notify: Callable[[str], None] | None = None,
    begun: Callable[[Evaluation], None] | None = None,
    executor: Executor | None = None,
) -> OptimizationResult:
    """The best design for a problem; what falls apart into steps is done by `executor`, else by this process.

    `notify` hears at once of limits that no design can keep, before it is found out what they would have to be; `begun`
    of the arm as given, before the first round.
    `log` hears of every round of an exchange, `progress` of combinations tried; where either raises `KeyboardInterrupt`
    the best design so far is the result, marked `interrupted`. Where lengths are free and the arm as given does not
    reach a box or path, the search begins with lengths that do. Raises `NoAnswer` where it cannot be reached,
    `Infeasible` (one of them) where no design keeps the limits, which says what they would have to be, and `InputError`
    where a figure is missing that the problem needs.
    """
    return _optimised(problem, Options(log, progress, notify, begun, executor))


def _optimised(problem: Problem, options: Options) -> OptimizationResult:
    if problem.minimize == PAYLOAD.name:
        return largest_payload(problem, options, _optimised)
    if problem.base is not None:
        return best_base(problem, options, _optimised)
    start = start_that_reaches(problem)
    if start is not None:
        options.tell(start.why)
        problem = start.problem
    if why := disagreement(problem):
        raise NoAnswer(why)
    left_out = (*problem.left_out, *without_stock(problem))
    for item in left_out:
        options.tell(f"{item.material} is not looked at: {item.why}")
    result = over_whole_cycles(
        problem, lambda asked: on_wall_steps(asked, lambda part: _of_structures(part, options)), options.tell
    )
    dropped = tuple(Dropped("material", item.material, (), item.why) for item in left_out)
    result = replace(result, dropped=(*dropped, *result.dropped))
    return result if start is None else replace(result, start=f'{start.why}, and "before" is that arm')


def _of_structures(problem: Problem, options: Options) -> OptimizationResult:
    if problem.uncertain is not None:
        return robust_structures(problem, options)
    if problem.sizes is not None:
        return listed_structures(problem, options)
    return nominal_optimum(problem, options, problem)
