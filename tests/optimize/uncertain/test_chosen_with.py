"""Tapers, balances, motors' places and near ties chosen for an arm that is uncertain: closed forms, arms by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.expressions import expressions
from linkwright.core.optimize.exchange.scenarios import scenario_column, scenario_values
from linkwright.core.optimize.robust.search import robust_figure
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.uncertain import Scenario
from tests.optimize.builders import jointed, problem_of, ranged
from tests.optimize.built.test_balances import LENGTH, PAYLOAD, STIFFNESS, G, lifting, sag

SOFT = "robust: worst\nuncertain: {elastic_modulus: 10 %, size: 2 %, thickness: 10 %, stiffness: 20 %}\n"
SIZES = "section_size: [10 mm, 100 mm], thickness: [2 mm, 10 mm]"
TWO = jointed([400, 300], ranged("-60 60", "-90 90"))


@pytest.mark.parametrize("shape", ["circle", "tube", "i_section"])
def test_symbols_and_numbers_of_a_taper_are_one(shape: str, tmp_path: Path) -> None:
    text = f"{SOFT}choose: {{section: [{shape}]}}\nsubject_to: {{mass: '<= 9 kg', {SIZES}, taper: [0.4, 1]}}\n"
    problem = problem_of(tmp_path, TWO, text)
    space = design_space(problem, (shape, shape))
    materials = tuple(link.material for link in problem.arm.links)
    row = material_row(materials, problem)
    # Where a taper may be chosen warping counts as free, though a link without one holds it: the most tapered start.
    x = max(starting_points(space, row, 3), key=lambda start: np.abs(space.log_tapers(start)).min())
    scenario = Scenario((0.95, 1.05), (1.01, 0.98), (0.9, 1.1), (0.8, 1.0), (1.0, 1.0))
    symbols: Any = ca.SX.sym("x", len(x))  # pyright: ignore[reportCallIssue]
    column = scenario_column(space.problem.arm, expressions(space, symbols, row), scenario)
    result = ca.Function("column", [symbols], [column])(x)
    numbers = scenario_values(arm_of(space, x, materials), problem.load_cases, scenario)
    np.testing.assert_allclose(np.array(result).ravel(), numbers, rtol=1e-7, atol=1e-12)


@pytest.mark.slow
def test_a_tapered_arm_that_is_uncertain(tmp_path: Path) -> None:
    """No uniform design is better, no scenario worse than said, and the arm as it is better for none of it."""
    limits = f"subject_to: {{mass: '<= 3 kg', {SIZES}"
    soft, one = SOFT.replace("thickness: 10 %, ", ""), jointed([400], ranged("-30 30"))
    problem = problem_of(tmp_path, one, f"{soft}{limits}, taper: [0.5, 1]}}\n")
    result = optimise(problem)
    assert result.robust is not None
    assert result.doubts == ()
    uniform = optimise(problem_of(tmp_path, one, f"{soft}{limits}}}\n"))
    assert result.objective < 0.95 * uniform.objective
    assert robust_figure(result.arm, problem).value == pytest.approx(result.objective, rel=2e-4)
    assert result.robust.loses >= 0.0


def test_a_balancer_for_drives_that_may_be_softer(tmp_path: Path) -> None:
    """Bending stays, the drive's turn under what the balancer leaves of the torque grows by one over 0.8."""
    problem = lifting(tmp_path, "balancer: [{joint: 1, torque: [0 N*m, 25 N*m]}]", "")
    text = (tmp_path / "problem.yaml").read_text(encoding="utf-8") + "robust: worst\nuncertain: {stiffness: 20 %}\n"
    arm = (tmp_path / "arm.yaml").read_text(encoding="utf-8")
    problem = problem_of(tmp_path, arm, text.removeprefix("arm: arm.yaml\n"))

    def worst(mass: float) -> float:
        turn = LENGTH * (G * LENGTH * (PAYLOAD + 0.5 * mass) - 25.0) / STIFFNESS
        return sag(mass, 25.0) + 0.25 * abs(turn)

    expected: Any = minimize_scalar(worst, bounds=(0.5, 6.0), method="bounded")
    result = optimise(problem)
    assert result.balance[0].value == pytest.approx(25.0, rel=1e-3)
    assert result.objective == pytest.approx(float(expected.fun), rel=3e-4)
    assert result.doubts == ()
    assert result.arm.joints[0].counterbalance is not None


@pytest.mark.slow
def test_places_of_motors_for_drives_that_may_be_softer(tmp_path: Path) -> None:
    soft = "robust: worst\nuncertain: {stiffness: 30 %}\n"
    limits = f"subject_to: {{mass: '<= 6 kg', {SIZES}}}\n"
    on_base = "{on: base, mass: 5 kg, stiffness: 50 kN*m/rad}"
    places = f"[{{on: joint, mass: 4 kg}}, {on_base}, {on_base.replace('50', '5')}]"
    result = optimise(problem_of(tmp_path, TWO, f"{soft}choose: {{motor: [{{joint: 2, places: {places}}}]}}\n{limits}"))
    at_joint = jointed([400, 300], ranged("-60 60", "-90 90"))
    first, second = at_joint.rsplit("mass: 2 kg", 1)
    by_hand = optimise(problem_of(tmp_path, f"{first}mass: 6 kg{second}", f"{soft}{limits}"))
    on_base = f"{first}mass: 2 kg, motor: {{mass: 5 kg, on: base}}{second}"
    head, tail = on_base.rsplit("stiffness: 60", 1)
    moved = optimise(problem_of(tmp_path, f"{head}stiffness: 50{tail}", f"{soft}{limits}"))
    assert result.objective == pytest.approx(min(by_hand.objective, moved.objective), rel=1e-4)
    assert result.motor_places[0].outcome == "best"
    assert result.motor_places[-1].outcome in ("bounded out", "solved")
    assert len(result.motor_places) == 3


def test_near_ties_are_valued_by_what_is_uncertain(tmp_path: Path) -> None:
    text = (
        "robust: worst\nuncertain: {elastic_modulus: 10 %, stiffness: 20 %}\n"
        "choose: {material: [aluminium-6061-t6, aluminium-6082-t6, magnesium-az31b]}\n"
        f"subject_to: {{mass: '<= 6 kg', {SIZES}}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise(problem)
    assert result.robust is not None
    assert result.near_ties
    for tie in result.near_ties:
        assert tie.objective == pytest.approx(robust_figure(tie.arm, problem).value, rel=1e-6)
        assert result.objective * (1.0 - 2e-4) <= tie.objective <= 1.03 * result.objective * (1.0 + 1e-9)
