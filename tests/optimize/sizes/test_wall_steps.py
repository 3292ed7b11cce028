"""Walls in steps: the best of every combination of them, each solved on its own, and a tube with an own formula."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import pytest
from scipy.optimize import brentq

from linkwright.core.optimize.infeasible.answer import Infeasible
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.sizes.wall_steps import on_wall_steps
from linkwright.core.sections import Section
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.costs import slow_but
from tests.optimize.builders import problem_of

E, RHO, GRAVITY, LENGTH = 70e9, 2700.0, 9.81, 0.5
METAL = "{elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3}"
TUBE = (
    "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg]}\n    link: {length: 500 mm,\n"
    f"      section: {{shape: tube, diameter: 40 mm, thickness: 2 mm}}, material: {METAL}}}\n"
    "payload: {mass: 4 kg}\nleave_out: [shear_deformation]\n"
)
JOINT = "  - joint: {range: [-60 deg, 60 deg], stiffness: 60 kN*m/rad, mass: 1 kg}\n"
LINK = "    link: {{length: {} mm, section: {{shape: {}, {}, thickness: 3 mm}}, material: aluminium-6061-t6}}\n"
TWO = (
    f"chain:\n{JOINT}{LINK.format(400, 'rectangular_tube', 'width: 50 mm, height: 60 mm')}"
    f"{JOINT}{LINK.format(350, 'tube', 'diameter: 50 mm')}payload: {{mass: 3 kg}}\n"
)


def walls_of(section: Section | None) -> list[float]:
    assert section is not None
    given = section.given()
    return [float(given[item.name]) for item in section.dimensions if item.kind == "wall" and item.name in given]


def tube_error(diameter: float, wall: float) -> float:
    inner = diameter - 2.0 * wall
    flexural = E * math.pi * (diameter**4 - inner**4) / 64.0
    weight = RHO * math.pi * (diameter**2 - inner**2) / 4.0 * LENGTH * GRAVITY
    return (4.0 * GRAVITY / 3.0 + weight / 8.0) * LENGTH**3 / flexural


def test_a_tube_of_bounded_diameter_has_the_least_step_that_bends_little_enough(tmp_path: Path) -> None:
    """The diameter may be 45 mm at most: any wall would do from 1.6 mm on, and 2 mm is the next that is sold."""
    most = tube_error(0.045, 1.6e-3)
    text = (
        f"minimize: mass\nsubject_to: {{max_error: '<= {1e3 * most:.9f} mm', section_size: [20 mm, 45 mm], "
        "thickness: {steps: [1 mm, 1.5 mm, 2 mm, 3 mm]}, local_buckling: off}\n"
    )
    result = optimise(problem_of(tmp_path, TUBE, text))
    section = result.arm.links[0].section
    assert section is not None
    assert walls_of(section) == [pytest.approx(2e-3, rel=1e-6)]
    diameter = brentq(lambda d: tube_error(d, 2e-3) - most, 0.02, 0.045)
    assert float(section.properties(0.3).height) == pytest.approx(diameter, rel=1e-4)
    assert result.lower_bound < result.objective


def test_an_interrupt_never_leaves_walls_between_steps(tmp_path: Path) -> None:
    """Nothing is answered where none on the steps was found; the best one on them where one was."""
    text = (
        f"minimize: mass\nsubject_to: {{max_error: '<= {1e3 * tube_error(0.045, 1.6e-3):.9f} mm', "
        "section_size: [20 mm, 45 mm], thickness: {steps: [1 mm, 2 mm, 3 mm]}, local_buckling: off}\n"
    )
    problem = problem_of(tmp_path, TUBE, text)
    between = optimise(replace(problem, ranges=tuple(replace(item, steps=()) for item in problem.ranges)))
    assert walls_of(between.arm.links[0].section)[0] == pytest.approx(1.6e-3, rel=1e-3)
    with pytest.raises(NoAnswer, match="interrupted before a design with walls on the steps"):
        on_wall_steps(problem, lambda _: replace(between, interrupted=True))
    best = optimise(problem)
    answers = iter([between, best, replace(between, interrupted=True)])
    stopped = on_wall_steps(problem, lambda _: next(answers))
    assert stopped.arm == best.arm


def best_of_all(problem: Problem) -> float:
    """The least mass over every combination of steps, each with its walls held."""
    best = math.inf
    for pick in itertools.product(*(ranges.steps for ranges in problem.ranges)):
        spans = zip(problem.ranges, pick, strict=True)
        held = tuple(replace(ranges, thickness=(step, step), steps=()) for ranges, step in spans)
        try:
            best = min(best, optimise(replace(problem, ranges=held)).objective)
        except Infeasible:
            continue
    return best


@pytest.mark.parametrize("error", slow_but([0.64, 0.75], 0.75))
def test_no_combination_of_steps_is_lighter(error: float, tmp_path: Path) -> None:
    text = (
        f"minimize: mass\nsubject_to: {{max_error: '<= {error} mm', section_size: [20 mm, 60 mm], "
        "thickness: {1: {steps: [2 mm, 3.5 mm, 6 mm]}, others: {steps: [1.5 mm, 3 mm]}}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise(problem)
    assert result.objective == pytest.approx(best_of_all(problem), rel=2e-4)
    for ranges, link in zip(problem.ranges, result.arm.links, strict=True):
        walls = walls_of(link.section)
        assert min(abs(walls[0] / step - 1.0) for step in ranges.steps) < 1e-5
        assert max(walls) == pytest.approx(min(walls), rel=1e-5)


@pytest.mark.parametrize(
    ("walls", "rest", "words"),
    [
        ("{steps: [2 mm]}", "", "two thicknesses or more"),
        ("{steps: [2 mm, 3 mm], step: 1 mm}", "", "step"),
        ("{steps: [2 mm, 3 mm]}", "choose: {section: [tube], sizes: {diameter: [40 mm], thickness: [2 mm]}}\n", "free"),
    ],
)
def test_what_no_steps_are_is_one_line(walls: str, rest: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        problem_of(tmp_path, TUBE, f"minimize: max_error\nsubject_to: {{mass: '<= 2 kg', thickness: {walls}}}\n{rest}")
