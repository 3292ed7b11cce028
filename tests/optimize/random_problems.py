"""Random problems with an answer, what must hold of it, and every combination solved on its own to hold it against.

Sound arms set the limits: each is a share of what the arm as given has, so that most problems have an answer and the
arm as given is one of those it must not be worse than.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import excess
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.picks import combinations
from linkwright.core.optimize.exchange.design import design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Exchange, context_of, first_pool, objective_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.trust import keeps_limits
from linkwright.core.units.quantities import NoAnswer
from tests.optimize.builders import ALUMINIUM, jointed, problem_of, ranged

GAP = 2e-4
METALS = (ALUMINIUM, "steel-s355", "titanium-ti-6al-4v", "magnesium-az31b")
SHAPES = ("circle", "tube", "rectangle", "ellipse", "rectangular_tube")


def random_problem(folder: Path, seed: int, *, free: bool = False, most: int = 2) -> Problem:
    """A problem of one or two links, with `free` of two rods whose lengths are free, and at most `most` shapes and
    materials; limits on mass, cost, strength, frequency or the error."""
    generator = np.random.default_rng(seed)
    links = 2 if free else int(generator.integers(1, 3))
    lengths = [round(float(x)) for x in generator.uniform(250, 550, links)]
    ranges = [f"{-int(low)} {int(high)}" for low, high in generator.uniform(10, 110, (links, 2))]
    force = ("0 N, 0 N, 0 N", "0 N, -30 N, 0 N", "40 N, 10 N, 0 N")[int(generator.integers(3))]
    arm = jointed(
        lengths, ranged(*ranges), rest=f"payload: {{mass: {generator.uniform(0.5, 4):.2f} kg, force: [{force}]}}\n"
    )
    # Each exchange with free lengths takes seconds.
    shapes = ["circle", *generator.choice(SHAPES[1:], 0 if free else most - 1, replace=False)]
    metals = [ALUMINIUM, *generator.choice(METALS[1:], most - 1, replace=False)]
    named = f"section: [{', '.join(shapes)}], material: [{', '.join(metals)}]"
    sizes = "section_size: [10 mm, 120 mm], thickness: [1 mm, 8 mm]"
    given = evaluate(problem_of(folder, arm, f"subject_to: {{mass: '<= 99 kg', {sizes}}}\n").arm)
    minimize = ("max_error", "mass", "cost")[int(generator.integers(3))]
    limits = [*_limits(given, minimize, generator), sizes]
    if free:
        limits.append(f"reach: '== {sum(lengths)} mm', link_length: [{0.7 * min(lengths):.0f} mm, {sum(lengths)} mm]")
    text = f"minimize: {minimize}\nchoose: {{{named}}}\nsubject_to: {{{', '.join(limits)}}}\n"
    return problem_of(folder, arm, text)


def _limits(evaluation: Evaluation, minimize: str, generator: np.random.Generator) -> list[str]:
    """What a design must keep, a share of what the arm as given has."""
    assert evaluation.cost is not None
    assert evaluation.frequency is not None
    assert evaluation.strength.least_safety_factor is not None
    shares = generator.uniform(0.7, 1.3, 5)
    limits: list[str] = []
    if minimize == "max_error":
        limits.append(f"mass: '<= {shares[0] * evaluation.mass:.3f} kg'")
    else:
        limits.append(f"max_error: '<= {1e3 * shares[0] * evaluation.max_error:.4f} mm'")
    if minimize != "cost" and generator.random() < 0.6:
        limits.append(f"cost: '<= {1.5 * shares[1] * evaluation.cost:.2f} EUR'")
    if generator.random() < 0.5:
        limits.append(f"safety_factor: '>= {0.8 * shares[2] * evaluation.strength.least_safety_factor:.3f}'")
    if generator.random() < 0.5:
        limits.append(f"first_frequency: '>= {0.9 * shares[3] * evaluation.frequency.value:.3f} Hz'")
    return limits


def held(problem: Problem) -> float | None:
    """The objective (SI) of a problem's answer, held against all that must be true; None where it has none."""
    before = evaluate(problem.arm, problem.workspace, problem.load_cases)
    kept = keeps_limits(problem, before)
    try:
        result = optimise(problem)
    except NoAnswer:
        assert not kept
        return None
    assert result.doubts == ()
    after = evaluate(result.arm, problem.workspace, problem.load_cases)
    objective = problem.objective.value(after)
    assert objective is not None
    room = GAP * objective + 1e-9
    assert result.objective == pytest.approx(objective, abs=room)
    assert result.lower_bound <= objective + room
    if after.worst.upper_bound is not None:
        assert after.max_error <= after.worst.upper_bound * (1.0 + 1e-9)
    assert not any(excess(limit, limit.of(after)) > GAP for limit in problem.limits)
    was = problem.objective.value(before)
    if kept and was is not None:
        assert objective <= was + room
    return objective


def best_of_all(problem: Problem) -> float:
    """The least objective (SI) of every combination with an exchange of its own, from two starts each; infinite where
    none has a solution."""
    context = context_of(problem)
    exchanges: dict[tuple[str | None, ...], Exchange] = {}
    best = math.inf
    for pick in combinations(problem):
        exchange = exchanges.setdefault(pick.shapes, Exchange(context, design_space(problem, pick.shapes)))
        materials = material_row(pick.materials, problem)
        for start in starting_points(exchange.space, materials, 2):
            pool = first_pool(context, exchange.space, start, pick.materials)
            try:
                done = exchange.run(materials, pick.materials, pool, start)
            except Unreachable:
                continue
            if done is not None and done.converged:
                error = done.solution.error if done.worst is None else done.worst.error
                value = objective_of(context, exchange.program(done.pool), done.x, materials, error)
                best = min(best, value)
    return best


def agreed(problem: Problem) -> bool:
    """Hold an answer against every combination on its own; whether there was one."""
    result, best = held(problem), best_of_all(problem)
    assert (result is None) == math.isinf(best)
    assert result is None or result <= best * (1.0 + GAP) + 1e-9
    return result is not None
