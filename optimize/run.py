"""From a problem to its result: the one function that the command line calls."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import MappingProxyType

from arm.chain import Arm
from arm.evaluation import ErrorMap, Evaluation, error_map, evaluate
from arm.model import error_model
from arm.workspace import Unreachable
from arm.worst import WorstSearch
from materials.quantities import format_quantity

from .actuators import choose_driven
from .choice import Choice, Progress
from .design import arm_of, numeric_beams
from .exchange import Context
from .explain import binding_limits, why_infeasible
from .figures import figures_of
from .problem import NoAnswer, Problem
from .result import Iteration, LinkDesign, OptimizationResult, Status

Log = Callable[[Iteration], None]


def optimise(problem: Problem, *, log: Log | None = None, progress: Progress | None = None) -> OptimizationResult:
    """The best design for a problem.

    `log` hears of every round of an exchange, `progress` of combinations tried. Raises `NoAnswer` where no design keeps
    the limits or the workspace cannot be reached, and `InputError` where a figure is missing that the problem needs.
    """
    began = time.perf_counter()
    given = problem
    try:
        before = evaluate(problem.arm, problem.workspace, problem.load_cases)
        found = choose_driven(problem, progress=progress, log=log)
    except Unreachable as error:
        hint = "; start from an arm that reaches it" if problem.link_length is not None else ""
        raise NoAnswer(f"workspace: {error}{hint}") from None
    context, choice, problem = found.context, found.choice, found.context.problem
    if choice is None:
        words = f" (looked at with {found.names})" if found.names else ""
        raise NoAnswer(why_infeasible(context) + words)
    arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
    after = evaluate(arm, problem.workspace, problem.load_cases)
    lower_bound = choice.exchanged.solution.error if problem.minimize == "max_error" else choice.objective
    # Poses of a box or a path are found one by one, some ten times as slowly.
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    return OptimizationResult(
        problem_file=problem.file,
        minimize=problem.minimize,
        limits=_limits(problem),
        choices=_choices(given),
        status=_status(choice, context),
        arm=arm,
        before=before,
        after=after,
        links=links_of(arm, after),
        objective=_objective(problem, after),
        lower_bound=lower_bound,
        binding=binding_limits(problem, choice, figures_of(after)),
        iterations=choice.history,
        candidates=choice.candidates,
        exhaustive=choice.exhaustive,
        seconds=time.perf_counter() - began,
        before_map=_map_before(given, context, poses),
        after_map=error_map(context.search, numeric_beams(arm, problem.load_cases), poses=poses),
        drives=found.candidates,
        drives_exhaustive=found.exhaustive,
    )


def _map_before(given: Problem, context: Context, poses: int) -> ErrorMap:
    """The error map of the arm as given; with other drives it has an error model of its own."""
    search = context.search
    if given.actuators is not None:
        search = WorstSearch(error_model(given.arm, given.load_cases), given.workspace)
    return error_map(search, numeric_beams(given.arm, given.load_cases), poses=poses)


def _limits(problem: Problem) -> tuple[str, ...]:
    """The limits and ranges, as people write them."""
    ranges = {"section_size": problem.section_size, "thickness": problem.thickness, "link_length": problem.link_length}
    spans = [
        f"{name} {format_quantity(span[0], 'length')} to {format_quantity(span[1], 'length')}"
        for name, span in ranges.items()
        if span is not None
    ]
    return (*(limit.text for limit in problem.limits), *spans)


def _choices(problem: Problem) -> tuple[str, ...]:
    """What each link could be, as people write it."""
    found: list[str] = []
    if problem.shapes is not None:
        found.append(f"section: {', '.join(problem.shapes)}")
    if problem.materials is not None:
        found.append(f"material: {', '.join(material.name for material in problem.materials)}")
    if problem.actuators is not None:
        lists = [", ".join(each.name for each in own) for own in problem.actuators]
        each = [f"joint {number}: {names}" for number, names in enumerate(lists, start=1) if names]
        alike = len(each) == len(lists) and len(set(lists)) == 1
        found.append(f"actuator: {lists[0] if alike else '; '.join(each)}")
    if problem.same:
        found.append(f"the same for all links: {', '.join(sorted(problem.same))}")
    return tuple(found)


def _status(choice: Choice, context: Context) -> Status:
    if not choice.exchanged.converged:
        return "stopped"
    return "certified" if choice.exchanged.certified and context.uses_error else "converged"


def _objective(problem: Problem, after: Evaluation) -> float:
    return figures_of(after)[problem.minimize]


def links_of(arm: Arm, evaluation: Evaluation) -> tuple[LinkDesign, ...]:
    """The links of an evaluated arm."""
    found: list[LinkDesign] = []
    for index, (link, mass) in enumerate(zip(arm.links, evaluation.link_masses, strict=True)):
        dimensions = {} if link.section is None else {k: float(v) for k, v in link.section.given().items()}
        found.append(
            LinkDesign(
                number=index + 1,
                length=link.length,
                shape=None if link.section is None else link.section.shape,
                dimensions=MappingProxyType(dimensions),
                material=None if link.material is None else link.material.name,
                mass=mass,
            )
        )
    return tuple(found)
