"""A finite problem put together of functions of single links: its derivatives are those of its values."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from linkwright.core.optimize.exchange.assembled import Compiled
from linkwright.core.optimize.exchange.design import design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Exchange, context_of, first_pool
from linkwright.core.optimize.exchange.program import Ask
from linkwright.core.sections.numeric import Array
from tests.optimize.builders import ALUMINIUM, DRIVE, jointed, problem_of

LIMITS = "safety_factor: '>= 2', local_buckling: '>= 2', first_frequency: '>= 5 Hz', section_size: [20 mm, 90 mm]"
PROBLEMS = {
    "thin": (f"subject_to: {{mass: '<= 3 kg', {LIMITS}}}\n", ("tube", "i_section")),
    "solid and thin": (
        f"minimize: mass\nsubject_to: {{max_error: '<= 2 mm', {LIMITS}}}\n",
        ("circle", "rectangular_tube"),
    ),
    "free lengths": (
        f"subject_to: {{mass: '<= 3 kg', reach: == 700 mm, link_length: [200 mm, 500 mm], {LIMITS}}}\n",
        ("tube", "rectangle"),
    ),
    "tapers": (f"subject_to: {{mass: '<= 3 kg', taper: [0.5, 1], {LIMITS}}}\n", ("tube", "rectangle")),
}


class Heard:
    """A solver that remembers what it was first asked."""

    def __init__(self, solver: Any) -> None:
        self.solver, self.stats = solver, solver.stats
        self.x, self.p = np.zeros(0), np.zeros(0)

    def __call__(self, **given: Any) -> Any:
        if not len(self.x):
            self.x, self.p = np.array(given["x0"]), np.array(given["p"])
        return self.solver(**given)


def by_difference(of: Callable[[Array], Array], x: Array) -> Array:
    return np.stack([(of(x + step) - of(x - step)) / 2e-6 for step in 1e-6 * np.eye(len(x))], axis=-1)


@pytest.mark.parametrize("name", PROBLEMS)
def test_derivatives_are_those_of_the_values(tmp_path: Path, name: str) -> None:
    text, shapes = PROBLEMS[name]
    chosen = f"choose: {{section: [{', '.join(shapes)}], material: [{ALUMINIUM}]}}\n"
    context = context_of(problem_of(tmp_path, jointed((400, 300), [DRIVE, DRIVE]), text + chosen))
    material = context.problem.materials_of(0)[0]
    materials = material_row((material, material), context.problem)
    compiled = Compiled()
    for pick in (shapes, shapes[::-1], (shapes[0], shapes[0])):
        space = design_space(context.problem, pick)
        start = starting_points(space, materials, 1)[0]
        pool = first_pool(context, space, start, (material, material))
        program = Exchange(context, space, compiled).program(pool)
        heard = program.solver = Heard(program.solver)
        assert program.solve(start, materials, pool, Ask(context.problem.limits, relax=True)).solved
        g, grad_f, jac_g, hess_l = (heard.solver.get_function(f"nlp_{n}") for n in ("g", "grad_f", "jac_g", "hess_l"))
        x, p, prices = heard.x + 0.01, heard.p, np.cos(np.arange(g.size1_out(0)))

        def rows(at: Array, g: Any = g, p: Array = p) -> Array:
            return np.array(g(at, p)).ravel()

        def slope(at: Array, grad_f: Any = grad_f, jac_g: Any = jac_g, p: Array = p, prices: Array = prices) -> Array:
            return 0.7 * np.array(grad_f(at, p)[1]).ravel() + prices @ np.array(jac_g(at, p)[1])

        jacobian, upper = np.array(jac_g(x, p)[1]), np.array(hess_l(x, p, 0.7, prices))
        hessian = upper + np.triu(upper, 1).T
        assert np.allclose(jacobian, by_difference(rows, x), rtol=1e-5, atol=1e-6 * np.abs(jacobian).max())
        # What the shapes of a combination move, not what any shape of the problem would: a rod has no walls.
        moved = np.zeros(jacobian.shape, dtype=bool)
        moved[tuple(program.moving)] = True
        assert np.array_equal(moved.any(axis=1), jacobian.any(axis=1))
        assert not jacobian[~moved].any()
        assert np.allclose(hessian, by_difference(slope, x), rtol=1e-4, atol=1e-6 * np.abs(hessian).max())


def test_combinations_share_one_problem_and_answer_as_alone(tmp_path: Path) -> None:
    """A problem that holds all shapes gives each combination the design, error and prices of a problem of its own."""
    text, shapes = PROBLEMS["free lengths"]
    context, alone = (
        context_of(
            problem_of(
                tmp_path,
                jointed((400, 300), [DRIVE, DRIVE]),
                f"{text}choose: {{section: [{', '.join(listed)}], material: [{ALUMINIUM}]}}\n",
            )
        )
        for listed in (shapes, shapes[:1])
    )
    material = context.problem.materials_of(0)[0]
    compiled, solvers = Compiled(), list[Any]()
    for pick in itertools.product(shapes, repeat=2):
        space = design_space(context.problem, pick)
        materials = material_row((material, material), context.problem)
        start = starting_points(space, materials, 1)[0]
        pool = first_pool(context, space, start, (material, material))
        program = Exchange(context, space, compiled).program(pool)
        solvers.append(program.solver)
        shared = program.solve(start, materials, pool)
        # Shapes that a problem does not list are put together for themselves.
        own = Exchange(alone, design_space(alone.problem, pick), Compiled()).program(pool)
        assert own.solver.size_in("x0")[0] <= program.solver.size_in("x0")[0]
        single = own.solve(start, materials, pool)
        assert shared.solved
        assert single.solved
        assert shared.error == pytest.approx(single.error, rel=1e-7)
        assert shared.x == pytest.approx(single.x, abs=1e-5)
        assert shared.limit_prices == pytest.approx(single.limit_prices, abs=1e-6)
        assert dict(shared.shape_prices) == pytest.approx(dict(single.shape_prices), abs=1e-6)
    assert len({id(solver) for solver in solvers}) < len(solvers)
