"""From a problem whose sections are listed to its result."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from functools import partial

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.error_map import error_map
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import Limit, broken, excess
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.exchange.design import numeric_beams, with_chosen_links
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.nominal import Options
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.problem_summary import choices_in_words, limits_in_words, map_of_given, whole_error
from linkwright.core.optimize.result import Candidate, Iteration, OptimizationResult, Status, proved
from linkwright.core.optimize.rounding.nearest import nearest_design
from linkwright.core.optimize.structures import Answer, StructureSearch
from linkwright.core.optimize.trust import doubts
from linkwright.core.units.quantities import NoAnswer, format_quantity

from .free.search import FreeListSearch
from .listed_search import SearchOutcome
from .options import LinkList, link_lists
from .search import CLOSE, ListSearch

_BETTER = 1e-6
"""By how much (relative) another choice of drives must be better to be looked for."""
_MOST_EXCLUDED = 8
_SAMPLED = 20_000
"""Designs among which the one that breaks the limits least is looked for."""


class NoListed(NoAnswer):
    """No design of the lists was found; `proven` where none keeps the limits."""

    def __init__(self, message: str, *, proven: bool) -> None:
        super().__init__(message)
        self.proven = proven

    def __reduce__(self) -> tuple[object, ...]:
        """Keep what is known when the error crosses between processes."""
        return partial(NoListed, proven=self.proven), (str(self),)


def listed_structures(problem: Problem, options: Options) -> OptimizationResult:
    """The best design of a problem with `sizes` over the drives that it chooses from.

    After the first choice of drives only designs better than the best so far are looked for, which its bounds rule out
    early where there are none. Raises `NoAnswer` where no combination keeps the limits, or none was found;
    `InputError` where a figure is missing that the problem needs.
    """
    began = time.perf_counter()
    if problem.actuators is None:
        return listed_optimum(problem, options, problem)
    history: list[Iteration] = []
    bounds: list[float] = []
    bounded = True

    def heard(iteration: Iteration) -> None:
        history.append(replace(iteration, number=len(history) + 1))
        if options.log is not None:
            options.log(history[-1])

    def solve(problem_here: Problem, known: float) -> Answer[OptimizationResult] | float:
        nonlocal bounded
        enough = known * (1.0 - _BETTER)
        if math.isfinite(known):
            problem_here = replace(
                problem_here, limits=(*problem_here.limits, Limit(problem_here.objective, "<=", enough))
            )
        try:
            result = listed_optimum(problem_here, replace(options, log=heard), problem)
        except NoListed as none:
            bounded = bounded and none.proven
            bounds.append(enough)
            if math.isinf(known):
                raise
            return enough
        bounded = bounded and result.bound_of == "all_designs"
        bounds.append(result.lower_bound)
        return Answer(result.objective, result, result.interrupted)

    options.evaluated(problem)
    search = StructureSearch(problem, solve, options.progress)
    search.run()
    if search.best is None:
        raise search.failed or NoAnswer("no choice of drives keeps all limits")
    best = search.best[1]
    known = search.exhaustive and bounded
    lower_bound = min([best.objective, *bounds]) if known else best.objective
    gap = max(0.0, 1.0 - lower_bound / best.objective) if known and best.objective else None
    proven = gap is not None and gap <= 2.0 * CLOSE
    outcome = replace(
        best,
        limits=limits_in_words(problem),
        drives=search.drives(),
        drives_exhaustive=search.exhaustive,
        lower_bound=lower_bound,
        bound_of="all_designs" if known else "binding_poses",
        gap=gap,
        exhaustive=proven,
        iterations=tuple(history),
        seconds=time.perf_counter() - began,
        interrupted=search.interrupted,
    )
    if search.interrupted:
        return replace(outcome, status="interrupted", optimum="local")
    return outcome if proven or best.status == "doubtful" else replace(outcome, status="searched", optimum="local")


def listed_optimum(problem: Problem, options: Options, given: Problem) -> OptimizationResult:
    """The best design of a problem with `sizes` whose drives are chosen; `given` is the problem as people wrote it.
    Raises as `listed_structures` does."""
    began = time.perf_counter()
    context = context_of(replace(with_chosen_links(problem), sizes=None))
    before = options.evaluated(given)
    try:
        kind = FreeListSearch if problem.free_lengths else ListSearch
        search = kind(context, link_lists(problem), progress=options.progress, log=options.log)
        design, after = _outcome(search)
    except Unreachable as error:
        raise NoAnswer(f"workspace: {error}") from None
    objective = problem.objective.value(after)
    assert objective is not None
    gap = design.gap
    known = gap is not None
    lower_bound = min(design.bound, objective) if known else objective
    among = before.arm.joints == problem.arm.joints and _among(before.arm, search.lists)
    doubtful = doubts(problem, design.objective, before, after, lower_bound, given_allowed=among)
    proven = gap is not None and gap <= 2.0 * CLOSE
    links = after.arm.links
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    shapes = tuple(None if link.section is None else link.section.shape for link in links)
    material_names = tuple(
        None if link.section is None or link.material is None else link.material.name for link in links
    )
    return OptimizationResult(
        problem_file=problem.file,
        minimize=problem.minimize,
        limits=limits_in_words(problem),
        choices=choices_in_words(given),
        status="doubtful" if doubtful else _status(design, after, proven=proven, uses_error=context.uses_error),
        arm=after.arm,
        before=before,
        after=after,
        objective=objective,
        lower_bound=lower_bound,
        binding=(),
        iterations=tuple(search.history),
        candidates=(Candidate(shapes, material_names, objective, "best"),),
        exhaustive=proven,
        seconds=time.perf_counter() - began,
        before_map=map_of_given(given, context, poses),
        after_map=error_map(whole_error(context), numeric_beams(after.arm, problem.load_cases), poses=poses),
        optimum="global" if proven and not doubtful else "local",
        doubts=doubtful,
        combinations=search.combinations,
        gap=gap,
        bound_of="all_designs" if known else "binding_poses",
        interrupted=design.interrupted,
        listed=True,
        figures=problem.figures,
    )


def _outcome(search: ListSearch | FreeListSearch) -> tuple[SearchOutcome, Evaluation]:
    """The best design with its evaluation, which has the last word; raises `NoAnswer` where there is none."""
    problem = search.context.problem
    for _ in range(_MOST_EXCLUDED):
        result = search.run()
        if result.pick is None:
            proven = math.isinf(result.bound) and result.bound > 0.0
            raise NoListed(_why_not(search, proven=proven), proven=proven)
        arm = search.judge.table.arm_of(result.pick)
        after = evaluate(arm, problem.workspace, problem.load_cases)
        if result.interrupted or not broken(problem.limits, after):
            return result, after
        search.exclude(result.pick)
    raise NoListed("the best designs of listed sizes all break a limit when evaluated", proven=False)


def _status(result: SearchOutcome, after: Evaluation, *, proven: bool, uses_error: bool) -> Status:
    if result.interrupted:
        return "interrupted"
    if not proven:
        return "searched"
    return proved(after) if after.worst.certified and uses_error else "converged"


def _among(arm: Arm, lists: tuple[LinkList, ...]) -> bool:
    """Whether an arm is one of the designs to choose from."""
    return all(
        any(
            option.section == arm.links[link_list.link].section
            and option.material == arm.links[link_list.link].material
            for option in link_list.options
        )
        for link_list in lists
    )


def _why_not(search: ListSearch | FreeListSearch, *, proven: bool) -> str:
    """That no design keeps the limits, or none was found; and by what the nearest of a sample breaks them."""
    reason = (
        "no combination of the sizes listed keeps all limits" if proven else "no design that keeps all limits was found"
    )
    generator = np.random.default_rng(1)
    sizes = [len(link_list.options) for link_list in search.lists]
    picks = np.unique(np.stack([generator.integers(0, size, _SAMPLED) for size in sizes], axis=1), axis=0)
    near = nearest_design(search.judge, np.hstack([picks, np.zeros((len(picks), 1), dtype=np.intp)]))
    if near is None:
        return reason
    over = [(excess(limit, limit.of(near.evaluation)), limit) for limit in search.context.problem.limits]
    worst, limit = max((item for item in over if not math.isnan(item[0])), key=lambda item: item[0])
    if worst <= 0.0:
        return reason
    had = format_quantity(limit.of(near.evaluation), limit.figure.kind, digits=4)
    return f"{reason}: the nearest of {len(picks):,} looked at breaks {limit.text} with {had}"
