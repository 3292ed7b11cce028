"""The best design for an arm as it is: over drives and places, shapes and materials, and their dimensions."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from linkwright.core.arm.error_map import error_map
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.executors import Executor
from linkwright.core.optimize.balance.balance import settled
from linkwright.core.optimize.balance.chosen import balance_of
from linkwright.core.optimize.choice.actuators import first_driven, names_of
from linkwright.core.optimize.choice.at_once.feasibility import Feasibility
from linkwright.core.optimize.choice.combinations import Choice, NoChoice, Progress, chosen, count
from linkwright.core.optimize.choice.near_ties import NEAR, Tie, Ties
from linkwright.core.optimize.choice.picks import Combination
from linkwright.core.optimize.choice.picks import options as materials_of
from linkwright.core.optimize.choice.solution_cache import Solutions
from linkwright.core.optimize.exchange.design import arm_of, material_row, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.explain import dropped_of
from linkwright.core.units.quantities import NoAnswer

from .explain import binding_limits
from .infeasible.answer import Infeasible
from .infeasible.needed import explained
from .infeasible.quick import least_objective, out_of_reach
from .problem import Problem
from .problem_summary import choices_in_words, limits_in_words, map_of_given, whole_error
from .result import Iteration, OptimizationResult, Status, in_figure, proved
from .structures import Answer, Structure, StructureSearch
from .ties import near_ties_of
from .trust import doubts_of, optimum_of

Log = Callable[[Iteration], None]
_NOTHING = 1e-5
"""An error that is this share of what the arm as given has is none."""


@dataclass(frozen=True)
class Options:
    """How a search is run: the callbacks for its progress (see `run.optimise`), and the executor of its independent
    steps."""

    log: Log | None = None
    progress: Progress | None = None
    notify: Callable[[str], None] | None = None
    begun: Callable[[Evaluation], None] | None = None
    executor: Executor | None = None
    _before: list[Evaluation] = field(default_factory=list)

    def tell(self, text: str) -> None:
        """A sentence for whoever listens."""
        if self.notify is not None:
            self.notify(text)

    def evaluated(self, problem: Problem) -> Evaluation:
        """The arm as given, evaluated once, of which who listens hears before the first round.

        Raises `NoAnswer` where the workspace holds points that it cannot reach.
        """
        if not self._before:
            try:
                self._before.append(evaluate(problem.arm, problem.workspace, problem.load_cases))
            except Unreachable as error:
                raise NoAnswer(f"workspace: {error}") from None
            if self.begun is not None:
                self.begun(self._before[0])
        return self._before[0]


Driven = tuple[Context, Choice]
"""The context of the links' problem with drives and places chosen, and the best choice of its links."""


@dataclass
class _Solver:
    """Solves the links' problem of one structure after another."""

    options: Options
    alone: bool
    """Whether there is one structure only, which tells of its progress and its near ties."""
    unsolved: int = 0
    """On how many combinations of shapes and materials the solver failed where there was no design."""
    feasibility: Feasibility | None = None
    """What is known of how far all combinations of an only structure break the limits."""
    solutions: Solutions = field(default_factory=Solutions)
    """Near ties come back to combinations that were solved before."""

    def chosen(self, context: Context, known: float, **settings: Any) -> Choice | NoChoice:
        """The best choice of a context's links that is better than an objective (SI)."""
        return chosen(context, known=known, executor=self.options.executor, solutions=self.solutions, **settings)

    def solve(self, problem: Problem, known: float) -> Answer[Driven] | float:
        """As `structures.Solve`."""
        context = context_of(problem)
        progress = self.options.progress if self.alone else None
        result = self.chosen(context, known, progress=progress, log=self.options.log, ties=self.alone)
        if isinstance(result, NoChoice):
            self.unsolved += result.unsolved
            self.feasibility = result.feasibility if self.alone else None
            return result.bound(count(context.problem))
        return Answer(result.objective, (context, result), result.interrupted)

    def near_ties(self, search: StructureSearch[Driven], best: Choice) -> Ties:
        """What comes near the best, over all structures looked at that may hold any of it: of each, its best and
        what comes near that. What was solved before is not solved again."""
        limit = search.objective * (1.0 + NEAR)
        results: dict[tuple[Structure, Combination], Tie] = {}
        left, interrupted = 0, False
        for structure, noted in search.noted.items():
            least = noted.bound if noted.objective is None else noted.objective
            if noted.outcome == "infeasible" or least > limit:
                continue
            problem = search.problem_with(structure)
            if least_objective(problem) > limit:
                continue
            try:
                context = context_of(problem)
                choice = self.chosen(context, limit, progress=self.options.progress)
            except KeyboardInterrupt:
                interrupted = True
                break
            if isinstance(choice, NoChoice):
                continue
            arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
            for item in (Tie(choice.combination, choice.objective, arm), *choice.ties.solved):
                if item.objective <= limit:
                    results[structure, item.combination] = item
            left += choice.ties.left
            interrupted = choice.interrupted or choice.ties.interrupted
            if interrupted:
                break
        assert search.best is not None
        results.pop((search.best[0], best.combination), None)
        ties = tuple(sorted(results.values(), key=lambda each: each.objective))
        return Ties(ties, left, left == 0 and not interrupted, interrupted)


def nominal_optimum(problem: Problem, options: Options, given: Problem) -> OptimizationResult:
    """The best design of a problem without sizes from lists, nothing of whose arm is uncertain; `given` is the problem
    as people wrote it. Raises as `run.optimise` does."""
    began = time.perf_counter()
    for link, materials in enumerate(materials_of(problem)[1]):
        for material in materials:
            material_row([material], problem, first=link)  # what a material lacks is reported before anything is solved
    # With motors to place, its bounds would be those of the motors where they are.
    beyond = () if problem.motors else out_of_reach(problem)
    if beyond:
        for item in beyond:
            options.tell(f"{item.text}; now finding what the limits would have to be")
        first, names = first_driven(problem)
        raise Infeasible(explained(context_of(first), beyond=beyond, progress=options.progress), _looked_at(names))
    solver = _Solver(options, problem.actuators is None and not problem.motors)
    search = StructureSearch(problem, solver.solve, options.progress)
    before = options.evaluated(given)
    try:
        search.run()
        context, choice = _best(search, solver)
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None
    result = _result(given, context, choice, before, searched=not search.exhaustive)
    return replace(
        result,
        seconds=time.perf_counter() - began,
        drives=in_figure(search.drives(), problem.objective),
        drives_exhaustive=search.exhaustive,
        motor_places=in_figure(search.places(), problem.objective),
    )


def _best(search: StructureSearch[Driven], solver: _Solver) -> Driven:
    """The best structure's choice, with what comes near it where only drives are chosen; raises `Infeasible`."""
    if search.best is None:
        first = next(iter(search.noted))
        context = context_of(search.problem_with(first))
        why = explained(
            context, unsolved=solver.unsolved, feasibility=solver.feasibility, progress=solver.options.progress
        )
        raise Infeasible(why, _looked_at(names_of(first.drives)))
    context, choice = search.best[1]
    if not solver.alone:
        ties = Ties()
        if not search.interrupted and not search.problem.motors:
            ties = solver.near_ties(search, choice)
        search.interrupted = search.interrupted or ties.interrupted
        choice = replace(choice, interrupted=search.interrupted, ties=ties)
    return context, choice


def _looked_at(names: str) -> str:
    """With which actuators the limits were looked at, for the end of a line."""
    return f" (looked at with {names})" if names else ""


def _result(
    given: Problem, context: Context, choice: Choice, before: Evaluation, *, searched: bool
) -> OptimizationResult:
    """A choice of links as a result; drives and places are not in it yet."""
    problem = context.problem
    arm = settled(arm_of(choice.space, choice.exchanged.x, choice.combination.materials))
    after = evaluate(arm, problem.workspace, problem.load_cases)
    figure = problem.objective
    lower_bound, everywhere = _bound(problem, choice, before, after)
    doubts = doubts_of(context, choice, before, after, lower_bound)
    # Poses of a box or a path are found one by one, some ten times as slowly.
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    objective = figure.value(after)
    assert objective is not None
    return OptimizationResult(
        problem_file=problem.file,
        minimize=problem.minimize,
        limits=limits_in_words(problem),
        choices=choices_in_words(given),
        status="doubtful" if doubts else _status(choice, context, after, searched=searched),
        arm=arm,
        before=before,
        after=after,
        objective=objective,
        lower_bound=figure.badness(lower_bound),
        binding=binding_limits(problem, choice, after),
        iterations=choice.history,
        candidates=in_figure(choice.candidates, figure),
        exhaustive=choice.exhaustive,
        seconds=0.0,
        before_map=map_of_given(given, context, poses),
        after_map=error_map(whole_error(context), numeric_beams(arm, problem.load_cases), poses=poses),
        optimum="local" if searched or doubts else optimum_of(context, choice),
        doubts=doubts,
        combinations=count(problem),
        gap=choice.gap,
        bound_of="all_designs" if everywhere else "binding_poses",
        near_ties=in_figure(near_ties_of(context, choice.ties.solved), figure),
        near_ties_left=choice.ties.left,
        figures=problem.figures,
        balance=balance_of(problem, choice),
        interrupted=choice.interrupted,
        dropped=() if choice.interrupted else dropped_of(context, choice),
    )


def _bound(problem: Problem, choice: Choice, before: Evaluation, after: Evaluation) -> tuple[float, bool]:
    """The badness that no design goes below, and whether that holds for all designs, not only for the binding poses."""
    if choice.bound is not None and math.isfinite(choice.bound):
        return choice.bound, True
    if problem.minimize != "max_error":
        return choice.objective, False
    error = choice.exchanged.solution.error
    # Where loads cancel, what is left over is the solver's.
    return min(error, after.max_error) if error < _NOTHING * before.max_error else error, False


def _status(choice: Choice, context: Context, after: Evaluation, *, searched: bool) -> Status:
    if choice.interrupted:
        return "interrupted"
    if not choice.exchanged.converged:
        return "stopped"
    if searched or not choice.exhaustive:
        return "searched"
    return proved(after) if choice.exchanged.certified and context.uses_error else "converged"


__all__ = ["Infeasible", "Log", "Options", "nominal_optimum"]
