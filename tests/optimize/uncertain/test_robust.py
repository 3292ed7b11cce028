"""Designs held for what is uncertain: bars with analytic answers, arms really built otherwise, and invariants."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq

import linkwright as lw
from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.expressions import expressions
from linkwright.core.optimize.exchange.scenarios import resized, scenario_column, scenario_values
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.robust.result import Robust
from linkwright.core.optimize.robust.search import ScenarioSearch, robust_figure, upper_rank
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.optimize.uncertain import Scenario
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

E, RHO, GRAVITY, LENGTH, PAYLOAD = 70e9, 2700.0, 9.81, 0.5, 4.0
STIFFNESS, BACKLASH = 20e3, 3e-4
BAR = (
    "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg], stiffness: 20 kN*m/rad, backlash: 0.3 mrad}\n"
    "    link: {length: 500 mm, section: {shape: circle, diameter: 40 mm},\n"
    "      material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3}}\n"
    "payload: {mass: 4 kg}\nleave_out: [shear_deformation]\n"
)
TWO = jointed(
    [400, 420], ranged("-100 100", "-100 100", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin")
)
SIZES = "section_size: [10 mm, 100 mm], thickness: [2 mm, 10 mm]"
ALL = "{elastic_modulus: 5 %, size: 1 %, stiffness: [20 %, 40 %], backlash: 30 %, thickness: 10 %}"


def robust(folder: Path, arm: str, text: str) -> tuple[OptimizationResult, Robust]:
    result = optimise(problem_of(folder, arm, text))
    assert result.robust is not None
    assert result.doubts == ()
    return result, result.robust


def bar_error(diameter: float, modulus: float = 1.0, stiffness: float = 1.0, backlash: float = 1.0) -> float:
    """Sag under the weights, the drive's turn under their moment, and half of the lost motion."""
    flexural = modulus * E * math.pi * diameter**4 / 64.0
    weight = bar_mass(diameter) * GRAVITY
    bent = PAYLOAD * GRAVITY * LENGTH**3 / (3.0 * flexural) + weight * LENGTH**3 / (8.0 * flexural)
    turned = (PAYLOAD * GRAVITY + weight / 2.0) * LENGTH**2 / (stiffness * STIFFNESS)
    return bent + turned + 0.5 * backlash * BACKLASH * LENGTH


def bar_mass(diameter: float) -> float:
    return RHO * math.pi * diameter**2 / 4.0 * LENGTH


def test_worst_of_a_bar_is_the_soft_vertex(tmp_path: Path) -> None:
    result, told = robust(
        tmp_path,
        BAR,
        "robust: worst\nuncertain: {elastic_modulus: 10 %, stiffness: 20 %, backlash: 30 %}\n"
        "subject_to: {mass: '<= 1.2 kg', section_size: [10 mm, 100 mm]}\n",
    )
    thick = math.sqrt(4.0 * 1.2 / (math.pi * RHO * LENGTH))
    assert result.objective == pytest.approx(bar_error(thick, 0.9, 0.8, 1.3), rel=1e-4)
    assert told.design.nominal == pytest.approx(bar_error(thick), rel=1e-4)
    assert told.design.scenario == Scenario((0.9,), (1.0,), (1.0,), (0.8,), (1.3,))
    assert told.rounds == 1


def softened(folder: Path, least: str) -> tuple[OptimizationResult, Robust, float]:
    """The bar of which a figure is least while its error keeps 1.2 mm however soft it is, and its diameter (m)."""
    result, told = robust(
        folder,
        BAR,
        f"minimize: {least}\nrobust: worst\nuncertain: {{elastic_modulus: 10 %, stiffness: 20 %}}\n"
        "subject_to: {max_error: '<= 1.2 mm', section_size: [10 mm, 100 mm]}\n",
    )
    return result, told, brentq(lambda d: bar_error(d, 0.9, 0.8) - 1.2e-3, 0.01, 0.05)


def test_lightest_bar_keeps_its_error_however_soft_it_is(tmp_path: Path) -> None:
    result, told, thick = softened(tmp_path, "mass")
    assert result.objective == pytest.approx(bar_mass(thick), rel=1e-4)
    assert told.design.value == pytest.approx(1.2e-3, rel=1e-4)
    # The nominal optimum keeps the limit only as it is.
    thin = brentq(lambda d: bar_error(d) - 1.2e-3, 0.01, 0.05)
    assert told.nominal_design.nominal == pytest.approx(1.2e-3, rel=1e-4)
    assert told.nominal_design.value == pytest.approx(bar_error(thin, 0.9, 0.8), rel=1e-3)


def test_thinnest_bar_keeps_its_error_however_soft_it_is(tmp_path: Path) -> None:
    """The same bar, by another figure than a sum."""
    result, _, thick = softened(tmp_path, "section_height")
    assert result.objective == pytest.approx(thick, rel=1e-4)
    assert [limit.name for limit in result.binding] == ["max_error"]


def test_share_of_a_bar_is_a_quantile(tmp_path: Path) -> None:
    """With one uniform factor of the modulus from 0.8 to 1.2, one in twenty is below 0.82."""
    result, told = robust(
        tmp_path,
        BAR,
        "robust: 95 %\nuncertain: {elastic_modulus: 20 %}\n"
        "subject_to: {mass: '<= 1.2 kg', section_size: [10 mm, 100 mm]}\n",
    )
    thick = math.sqrt(4.0 * 1.2 / (math.pi * RHO * LENGTH))
    exact = bar_error(thick, 0.82)
    assert told.design.upper is not None
    assert told.design.value == pytest.approx(exact, rel=5e-3)
    assert exact <= told.design.upper <= bar_error(thick, 0.8)
    assert result.objective == told.design.value
    assert told.samples > 0


def test_confidence_bound_is_the_textbook_rank() -> None:
    """59 samples are the least of which the largest bounds the 95 % quantile with 95 % confidence (Wilks 1941)."""
    assert upper_rank(0.95, 59) == 59
    assert upper_rank(0.95, 58) is None


@pytest.mark.parametrize("kind", [pytest.param("worst", marks=pytest.mark.slow), "90 %"])
def test_no_worse_than_the_nominal_optimum(kind: str, tmp_path: Path) -> None:
    text = f"robust: {kind}\nuncertain: {ALL}\nsubject_to: {{mass: '<= 9 kg', {SIZES}}}\nchoose: {{section: [tube]}}\n"
    problem = problem_of(tmp_path, TWO, text)
    result = optimise(problem)
    told = result.robust
    assert told is not None
    assert told.loses >= 0.0
    for figure in (told.design, told.nominal_design):
        assert figure.value >= figure.nominal
    assert told.nominal_design.nominal <= told.design.nominal * (1.0 + 2e-4)
    if kind == "worst":
        assert result.doubts == ()
        search = ScenarioSearch(problem)
        shares = np.vstack([search.samples(100, 77), np.sign(search.samples(100, 78))])
        errors = search.errors(result.arm, shares, search.poses(result.arm, 79))
        assert errors.max() <= told.design.value * (1.0 + 1e-4)


def _built(arm: Arm, scenario: Scenario) -> Arm:
    """The arm really built as a scenario has it."""
    links: list[Any] = []
    for k, link in enumerate(arm.links):
        assert link.section is not None
        assert link.material is not None
        links.append(replace(link, section=resized(link.section, scenario.size[k], scenario.thickness[k])))
    joints = [
        replace(joint, stiffness=(joint.stiffness or 0.0) * stiffer, backlash=joint.backlash * looser)
        for joint, stiffer, looser in zip(arm.joints, scenario.stiffness, scenario.backlash, strict=True)
    ]
    return replace(arm, joints=tuple(joints), links=tuple(links))


@pytest.mark.parametrize("play", ["worst", "loaded"])
def test_a_scenario_is_the_arm_built_so(play: str, tmp_path: Path) -> None:
    tube = TWO.replace("{shape: circle, diameter: 60 mm}", "{shape: tube, diameter: 60 mm, thickness: 4 mm}")
    text = f"robust: worst\nuncertain: {ALL.replace('elastic_modulus: 5 %, ', '')}\nsubject_to: {{{SIZES}}}\n"
    problem = problem_of(tmp_path, f"{tube}play: {play}\n", text)
    assert problem.uncertain is not None
    search = ScenarioSearch(problem)
    for shares in search.samples(3, 8):
        built = _built(problem.arm, problem.uncertain.scenario(shares))
        own = WorstSearch(error_model(built), problem.workspace).worst(beam_values(beams_of(built)), certify=False)
        assert search.exact(problem.arm, shares).error == pytest.approx(own.error, rel=1e-6)


@pytest.mark.parametrize("shape", ["circle", "tube", "i_section"])
def test_symbols_and_numbers_are_one(shape: str, tmp_path: Path) -> None:
    text = f"robust: worst\nuncertain: {ALL}\nsubject_to: {{{SIZES}}}\nchoose: {{section: [{shape}]}}\n"
    problem = problem_of(tmp_path, TWO, text)
    assert problem.uncertain is not None
    space = design_space(problem, (shape, shape))
    chosen = [link.material for link in problem.arm.links]
    materials = material_row(chosen, problem)
    x = starting_points(space, materials, 1)[0]
    symbols: Any = ca.SX.sym("x", len(x))  # pyright: ignore[reportCallIssue]
    shares = np.random.default_rng(4).uniform(-1.0, 1.0, len(problem.uncertain.places))
    scenario = problem.uncertain.scenario(shares)
    entries = scenario_column(space.problem.arm, expressions(space, symbols, materials), scenario)
    column = ca.Function("column", [symbols], [entries])
    values = scenario_values(arm_of(space, x, chosen), problem.load_cases, scenario)
    known = values != 0.0
    np.testing.assert_allclose(np.array(column(x)).ravel()[known], values[known], rtol=1e-12)


def test_widths_of_a_diagnosis(tmp_path: Path) -> None:
    """Relative half widths of its 95 % intervals, where the arm has what they are of."""
    content = {
        "missing": [
            {
                "effect": "backlash",
                "at": [2],
                "parameters": {"total_2": {"value": 4e-4, "ci95": [3e-4, 5e-4], "parameter": "total", "at": 2}},
            },
            {
                "effect": "joint_compliance",
                "at": [1],
                "parameters": {"c": {"value": 2e-5, "ci95": [1.9e-5, 2.1e-5], "parameter": "compliance", "at": 1}},
            },
        ]
    }
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    keys = "robust: worst\nuncertain: {diagnosis: diagnosis.json, elastic_modulus: [0 %, 5 %]}\n"
    text = f"{keys}subject_to: {{{SIZES}}}\n"
    uncertain = problem_of(tmp_path, TWO, text).uncertain
    assert uncertain is not None
    assert uncertain.widths["backlash"] == pytest.approx((0.0, 0.25))
    assert uncertain.widths["stiffness"] == pytest.approx((0.05, 0.0))
    assert uncertain.places == (("elastic_modulus", 1), ("stiffness", 0), ("backlash", 1))


@pytest.mark.parametrize("at", [1.0, "1", {"joint": 1}, [[1]], True])
def test_a_finding_at_no_joint_widens_none(tmp_path: Path, at: object) -> None:
    """JSON that no diagnosis writes: a place that is no number of a joint."""
    parameter = {"value": 2e-5, "ci95": [1.9e-5, 2.1e-5], "parameter": "compliance", "at": at}
    content = {"missing": [{"effect": "joint_compliance", "parameters": {"c": parameter}}]}
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    text = f"robust: worst\nuncertain: {{diagnosis: diagnosis.json}}\nsubject_to: {{{SIZES}}}\n"
    with pytest.raises(InputError, match="holds no interval of a drive here"):
        problem_of(tmp_path, TWO, text)


def test_a_finding_gives_as_its_drive_does(tmp_path: Path) -> None:
    """A compliance among an arm's effects is as uncertain as the stiffness of its drive."""
    more = TWO + "effects:\n  - {effect: joint_compliance, at: [2], compliance: 1.0e-5 rad/(N*m)}\n"
    problem = problem_of(tmp_path, more, f"robust: worst\nuncertain: {{stiffness: 20 %}}\nsubject_to: {{{SIZES}}}\n")
    entry = problem.arm.effects[0]
    softer = replace(entry, parameters={"compliance": entry.parameters["compliance"] / 0.8})
    built = _built(replace(problem.arm, effects=(softer,)), Scenario((1, 1), (1, 1), (1, 1), (0.8, 0.8), (1, 1)))
    own = WorstSearch(error_model(built), problem.workspace).worst(beam_values(beams_of(built)), certify=False)
    assert robust_figure(problem.arm, problem).value == pytest.approx(own.error, rel=1e-6)


WRONG = {
    "robust: worst\nuncertain: {stiffness: 5 %}\nworkspace: {path: [[600 mm, 0 m], [700 mm, 0 m]], error: across}\n": (
        "counts the whole error"
    ),
    "robust: 95 %\nuncertain: {stiffness: 5 %}\nload_cases: [{subject_to: {max_error: '<= 1 mm'}}]\n": (
        "one max_error for all load cases and points"
    ),
    "minimize: mass\nrobust: worst\nuncertain: {stiffness: 5 %}\n": "neither minimised nor limited",
    "robust: worst\n": "robust: needs what is uncertain",
    "uncertain: {stiffness: 5 %}\n": "uncertain: needs how it counts",
    "robust: 105 %\nuncertain: {stiffness: 5 %}\n": "robust: is worst, or a share",
    "robust: worst\nuncertain: {stiffnes: 5 %}\n": "stiffness",
    "robust: worst\nuncertain: {stiffness: 95 %}\n": "from 0 % to 90 %",
    "robust: worst\nuncertain: {stiffness: [5 %]}\n": "one for each of the 2 joints",
    "robust: worst\nuncertain: {stiffness: 0 %}\n": "names nothing",
    "robust: worst\nuncertain: {diagnosis: nothing.json}\n": "is no diagnosis.json",
}


@pytest.mark.parametrize("text", WRONG)
def test_wrong_input_is_one_line(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=WRONG[text]) as caught:
        problem_of(tmp_path, TWO, text + f"subject_to: {{{SIZES}}}\n")
    assert "\n" not in str(caught.value)


def _bar_problem(folder: Path) -> Problem:
    return problem_of(
        folder,
        BAR,
        "robust: worst\nuncertain: {elastic_modulus: 10 %}\n"
        "subject_to: {mass: '<= 1.2 kg', section_size: [10 mm, 100 mm]}\n",
    )


def test_trade_off_and_rounding_refuse(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match="uncertain"):
        question(_bar_problem(tmp_path), "mass", "max_error")
    assert outcome(["optimize", str(tmp_path / "problem.yaml"), "--round", "1 mm"]) == 2
    assert "uncertain: goes without --round" in capsys.readouterr().err


def test_commands_and_face_say_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _bar_problem(tmp_path)
    problem, target = tmp_path / "problem.yaml", tmp_path / "out.json"
    assert outcome(["optimize", str(problem), "--json", str(target)]) == 0
    assert "over what is uncertain" in capsys.readouterr().out
    told = json.loads(target.read_text(encoding="utf-8"))
    assert told["objective"]["value"] == pytest.approx(told["robust"]["max_error_mm"])
    assert told["robust"]["loses_mm"] >= 0.0
    assert outcome(["evaluate", str(tmp_path / "arm.yaml"), "--problem", str(problem), "--json", str(target)]) == 0
    assert "elastic modulus ± 10 %" in capsys.readouterr().out
    value = json.loads(target.read_text(encoding="utf-8"))["robust"]["max_error_mm"]
    assert value == pytest.approx(1e3 * bar_error(0.04, 0.9), rel=1e-4)
    result = lw.evaluate(lw.read_arm(tmp_path / "arm.yaml"), lw.read_problem(problem))
    assert result.robust is not None
    assert 1e3 * result.robust.value == pytest.approx(value)
