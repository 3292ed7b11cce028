"""Any figure with a sense is minimised or maximised: against a design by hand, and every combination on its own."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

import linkwright as lw
from linkwright.core.optimize.choice.picks import combinations
from linkwright.core.optimize.rounding.options import Rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-60 90", "-90 90"))
LIMITS = "subject_to: {section_size: [20 mm, 90 mm], thickness: [2 mm, 6 mm], mass: '<= 6 kg'%s}\n"
CHOICE = "choose: {section: [circle, tube], material: [steel-s355]}\n"


def test_the_stiffest_rod_is_as_heavy_as_it_may_be() -> None:
    """Of one rod the stiffest of a mass: its diameter by hand."""
    joint = lw.Joint(range=["-60 deg", "90 deg"], stiffness="60 kN*m/rad")
    steel, length, mass = "steel-s355", 0.5, 5.0
    link = lw.Link(length=length, section=lw.shapes.Circle(diameter="30 mm"), material=steel)
    arm = lw.Arm(chain=[(joint, link)], payload={"mass": 4.0})
    limits = {"section_size": ["10 mm", "200 mm"], "mass": f"<= {mass} kg"}
    result = lw.optimize(lw.Problem(arm, maximize="tip_stiffness", subject_to=limits))
    density = lw.materials[steel].at(293.15).density
    diameter = math.sqrt(4.0 * mass / (density * length * math.pi))
    by_hand = lw.evaluate(arm.replace("chain[1].link.section.diameter", diameter))
    assert result.found.objective == pytest.approx(by_hand.found.stiffness.value, rel=1e-6)
    assert result.found.objective <= result.found.lower_bound * (1.0 + 1e-6)
    (price,) = [item.price for item in result.found.binding if item.name == "mass"]
    heavier = lw.optimize(lw.Problem(arm, maximize="tip_stiffness", subject_to={**limits, "mass": "<= 5.01 kg"}))
    gained = 1e-3 * (heavier.found.objective - result.found.objective) / 0.01
    assert -price == pytest.approx(gained, rel=0.01)
    assert repr(result).startswith("<Optimization: tip stiffness ")


@pytest.mark.parametrize(
    "goal", [pytest.param("maximize: first_frequency", marks=pytest.mark.slow), "maximize: safety_factor"]
)
def test_no_combination_does_better_on_its_own(goal: str, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, goal + "\n" + CHOICE + LIMITS % "")
    best = optimise(problem)
    assert best.status == "converged"
    assert best.exhaustive
    alone: list[float] = []
    for pick in combinations(problem):
        sections = [
            SHAPES[str(shape)].start(0.3, *own.sizes) for shape, own in zip(pick.shapes, problem.ranges, strict=True)
        ]
        parts = zip(problem.arm.links, sections, pick.materials, strict=True)
        links = tuple(replace(link, section=section, material=material) for link, section, material in parts)
        own = replace(problem, arm=problem.arm.with_links(links), shapes=None, materials=None)
        alone.append(optimise(own).objective)
    assert best.objective == pytest.approx(max(alone), rel=1e-5)
    told = [candidate.objective for candidate in best.candidates if candidate.objective is not None]
    assert told == sorted(told, reverse=True)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("minimize: first_frequency\n", "write maximize: first_frequency"),
        ("maximize: mass\n", "write minimize: mass"),
        ("minimize: mass\nmaximize: tip_stiffness\n", "stands beside minimize"),
        ("maximize: buckling\n", "buckling"),
    ],
)
def test_a_goal_that_is_none_is_told(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        problem_of(tmp_path, ARM, text + LIMITS % "")


def test_what_no_design_keeps_is_told_whatever_the_goal(tmp_path: Path) -> None:
    """Only the limits are told to change, never the goal; and rounding, which compares sums, is refused."""
    problem = problem_of(tmp_path, ARM, "maximize: first_frequency\n" + LIMITS % ", max_error: '<= 0.01 mm'")
    with pytest.raises(NoAnswer, match=r"max_error <= 0\.01 mm would have to be") as caught:
        optimise(problem)
    assert "first_frequency" not in str(caught.value)
    with pytest.raises(InputError, match="goes without --round"):
        optimise_rounded(problem, Rounding(1e-3))
