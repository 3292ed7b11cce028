"""Uncertain payloads, lengths, temperatures and directions of forces: a bar's formulas, and arms built otherwise."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.robust.search import ScenarioSearch, robust_figure
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.uncertain import Scenario
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

E, RHO, GRAVITY, LENGTH, EXPANSION = 70e9, 2700.0, 9.81, 0.5, 23e-6
BAR = (
    "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg], stiffness: 20 kN*m/rad}\n"
    "    link: {length: 500 mm, section: {shape: circle, diameter: 40 mm}, material: {elastic_modulus: 70 GPa,\n"
    "      density: 2700 kg/m^3, poisson_ratio: 0.3, thermal_expansion: 23 um/(m*K)}}\n"
    "payload: {mass: 4 kg}\nleave_out: [shear_deformation]\n"
)
OFF = "uncertain: {payload: 10 %, link_length: 0.05 mm, temperature: 5 K}\n"
TWO = jointed([400, 420], ranged("-100 100", "-100 100"), rest="payload: {mass: 3 kg, force: [30 N, -20 N, 0 N]}\n")


def bar_error(diameter: float, payload: float = 1.0, longer: float = 0.0, warmer: float = 0.0) -> float:
    """A level bar: sag under the weights and the drive's turn, across; growth, along."""
    flexural = E * math.pi * diameter**4 / 64.0
    weight, carried = RHO * math.pi * diameter**2 / 4.0 * LENGTH * GRAVITY, 4.0 * payload * GRAVITY
    sag = carried * LENGTH**3 / (3.0 * flexural) + weight * LENGTH**3 / (8.0 * flexural)
    sag += (carried + weight / 2.0) * LENGTH**2 / 20e3
    return math.hypot(sag, longer + EXPANSION * LENGTH * warmer)


def test_a_bar_is_as_thick_as_the_worst_of_all_asks(tmp_path: Path) -> None:
    text = f"minimize: mass\nrobust: worst\n{OFF}subject_to: {{max_error: '<= 1.5 mm', section_size: [10 mm, 80 mm]}}\n"
    result = optimise(problem_of(tmp_path, BAR, text))
    worst = brentq(lambda d: bar_error(d, 1.1, 5e-5, 5.0) - 1.5e-3, 0.01, 0.08)
    plain = brentq(lambda d: bar_error(d) - 1.5e-3, 0.01, 0.08)
    section = result.arm.links[0].section
    assert section is not None
    assert float(section.properties(0.3).height) == pytest.approx(worst, rel=1e-4)
    assert result.robust is not None
    assert result.robust.nominal_design.value == pytest.approx(bar_error(plain, 1.1, 5e-5, 5.0), rel=1e-4)
    assert result.robust.costs == pytest.approx(RHO * math.pi * (worst**2 - plain**2) / 4.0 * LENGTH, rel=2e-3)


def test_a_share_is_the_quantile_of_the_bar_s_formula(tmp_path: Path) -> None:
    text = f"minimize: max_error\nrobust: 95 %\n{OFF}subject_to: {{mass: '<= 2 kg'}}\n"
    problem = problem_of(tmp_path, BAR, text)
    draws = np.random.default_rng(1).uniform(-1.0, 1.0, (40_000, 3))
    errors = [bar_error(0.04, 1.0 + 0.1 * a, 5e-5 * b, 5.0 * c) for a, b, c in draws]
    assert robust_figure(problem.arm, problem).value == pytest.approx(float(np.quantile(errors, 0.95)), rel=2e-3)


def built(arm: Arm, scenario: Scenario) -> Arm:
    """The arm really built as a scenario has it."""
    lengths = [
        EffectEntry("link_length", (k,), {"length": longer}) for k, longer in enumerate(scenario.link_length, start=1)
    ]
    warm = EffectEntry("thermal_expansion", (), {"warming": scenario.temperature[0]})
    turn, (x, y, _) = scenario.force_direction[0], arm.payload.force
    force = (math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y, 0.0)
    payload = replace(arm.payload, mass=arm.payload.mass * scenario.payload[0], force=force)
    return replace(arm, effects=(*arm.effects, *lengths, warm), payload=payload)


def test_every_vertex_errs_as_an_arm_built_so_and_the_worst_is_found(tmp_path: Path) -> None:
    off = "{payload: 20 %, link_length: [0.05 mm, 0.1 mm], temperature: 10 K, force_direction: 15 deg}"
    text = f"minimize: max_error\nrobust: worst\nuncertain: {off}\nsubject_to: {{mass: '<= 20 kg'}}\n"
    problem = problem_of(tmp_path, TWO, text)
    search = ScenarioSearch(problem, problem.arm)
    vertices = np.array(list(itertools.product((-1.0, 1.0), repeat=search.size)))
    errors = [search.exact(problem.arm, vertex).error for vertex in vertices]
    for vertex, error in list(zip(vertices, errors, strict=True))[::6]:
        really = built(problem.arm, search.uncertain.scenario(vertex))
        assert evaluate(really).max_error == pytest.approx(error, rel=1e-6)
    figure = robust_figure(problem.arm, problem, search)
    assert figure.value >= max(errors) * (1.0 - 1e-6)
    assert figure.nominal == pytest.approx(evaluate(problem.arm).max_error, rel=1e-6)


@pytest.mark.parametrize(
    ("off", "words"),
    [
        ("{force_direction: 10 deg}", "needs a force at the tip"),
        ("{payload: 120 %}", "how far off it may be"),
        ("{link_length: [1 mm, 2 mm]}", "is one figure for all"),
        ("{temperature: 5 mm}", "temperature"),
    ],
)
def test_what_cannot_be_uncertain_is_one_line(off: str, words: str, tmp_path: Path) -> None:
    arm = TWO.replace("force: [30 N, -20 N, 0 N]", "force: [0 N, 0 N, 0 N]")
    if "link_length" in off:
        off = "{link_length: [1 mm, 2 mm, 3 mm]}"
    with pytest.raises(InputError, match=words):
        problem_of(tmp_path, arm, f"robust: worst\nuncertain: {off}\nsubject_to: {{mass: '<= 20 kg'}}\n")
