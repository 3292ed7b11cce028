"""From a problem to its result: the one function that the command line calls."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import MappingProxyType

from arm.chain import Arm
from arm.evaluation import Evaluation, error_map, evaluate
from arm.workspace import Unreachable
from materials.quantities import format_quantity

from .choice import Choice, Progress, choose
from .design import arm_of, numeric_beams
from .exchange import Context, context_of
from .explain import binding_limits, why_infeasible
from .problem import NoAnswer, Problem
from .result import Iteration, LinkDesign, OptimizationResult, Status

Log = Callable[[Iteration], None]


def optimise(problem: Problem, *, log: Log | None = None, progress: Progress | None = None) -> OptimizationResult:
    """The best design for a problem.

    `log` hears of every round of an exchange, `progress` of combinations tried. Raises `NoAnswer` where no design keeps
    the limits or the workspace cannot be reached, and `InputError` where a figure is missing that the problem needs.
    """
    began = time.perf_counter()
    context = context_of(problem)
    try:
        before = evaluate(problem.arm, problem.workspace, problem.load_cases)
        choice = choose(context, progress=progress, log=log)
    except Unreachable as error:
        hint = "; start from an arm that reaches it" if problem.link_length is not None else ""
        raise NoAnswer(f"workspace: {error}{hint}") from None
    if choice is None:
        raise NoAnswer(why_infeasible(context))
    arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
    after = evaluate(arm, problem.workspace, problem.load_cases)
    lower_bound = choice.exchanged.solution.error if problem.minimize == "max_error" else choice.objective
    # Poses of a box or a path are found one by one, some ten times as slowly.
    poses = 200_000 if problem.workspace.kind == "joints" else 20_000
    return OptimizationResult(
        problem_file=problem.file,
        minimize=problem.minimize,
        limits=_limits(problem),
        choices=_choices(problem),
        status=_status(choice, context),
        arm=arm,
        before=before,
        after=after,
        links=_links(arm, after),
        objective=_objective(problem, after),
        lower_bound=lower_bound,
        binding=binding_limits(problem, choice, _figures(after)),
        iterations=choice.history,
        candidates=choice.candidates,
        exhaustive=choice.exhaustive,
        seconds=time.perf_counter() - began,
        before_map=error_map(context.search, numeric_beams(problem.arm, problem.load_cases), poses=poses),
        after_map=error_map(context.search, numeric_beams(arm, problem.load_cases), poses=poses),
    )


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
    if problem.same:
        found.append(f"the same for all links: {', '.join(sorted(problem.same))}")
    return tuple(found)


def _status(choice: Choice, context: Context) -> Status:
    if not choice.exchanged.converged:
        return "stopped"
    return "certified" if choice.exchanged.certified and context.uses_error else "converged"


def _figures(evaluation: Evaluation) -> dict[str, float]:
    strength, frequency = evaluation.strength, evaluation.frequency
    return {
        "max_error": evaluation.max_error,
        "mass": evaluation.mass,
        "total_mass": evaluation.total_mass,
        "reach": evaluation.reach,
        "cost": evaluation.cost if evaluation.cost is not None else float("nan"),
        "safety_factor": strength.least_safety_factor or float("nan"),
        "first_frequency": frequency.value if frequency is not None else float("nan"),
        "buckling": strength.least_buckling or float("nan"),
    }


def _objective(problem: Problem, after: Evaluation) -> float:
    return _figures(after)[problem.minimize]


def _links(arm: Arm, evaluation: Evaluation) -> tuple[LinkDesign, ...]:
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
