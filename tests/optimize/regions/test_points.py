"""Points of a workspace with tolerances and weights of their own."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures.error import averaged_over
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-60 90", "-120 120", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin"))
NEAR, FAR = "[350 mm, 200 mm]", "[600 mm, 250 mm]"
REST = "choose: {section: [tube]%s}\nsubject_to: {section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]%s}\n"


def asked(folder: Path, points: str, *, choose: str = "", limits: str = "", aim: str = "mass") -> Problem:
    text = f"minimize: {aim}\nworkspace: {{points: [{points}]}}\n{REST % (choose, limits)}"
    return problem_of(folder, ARM, text)


def alone(problem: Problem, arm: Arm, point: int) -> float:
    """The worst error (m) of an arm at one point."""
    there = Workspace("path", (problem.workspace.points[point],), apart=True)
    return evaluate(arm, there, problem.load_cases).max_error


def test_one_limited_point_is_as_if_it_were_the_only_one(tmp_path: Path) -> None:
    problem = asked(tmp_path, f"{{at: {NEAR}, max_error: '<= 0.25 mm'}}, {FAR}")
    result = optimise(problem)
    only = optimise(asked(tmp_path, NEAR, limits=", max_error: '<= 0.25 mm'"))
    assert result.doubts == ()
    assert result.objective == pytest.approx(only.objective, rel=2e-4)
    assert alone(problem, result.arm, 0) == pytest.approx(2.5e-4, rel=2e-4)
    assert result.after.max_error > 2.5e-4
    (binding,) = (item for item in result.binding if item.name == "max_error at point 1")
    assert binding.value == pytest.approx(0.25, rel=2e-4)
    # One micrometre more, by the price and by another design.
    looser = replace(
        problem, limits=tuple(replace(x, value=2.51e-4) if "point" in x.name else x for x in problem.limits)
    )
    assert optimise(looser).objective - result.objective == pytest.approx(1e-3 * binding.price, rel=0.03)


def test_listed_sizes_keep_each_points_tolerance(tmp_path: Path) -> None:
    points = f"{{at: {NEAR}, max_error: '<= 0.4 mm'}}, {{at: {FAR}, max_error: '<= 0.7 mm'}}"
    sizes = ", sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}"
    problem = asked(tmp_path, points, choose=sizes)
    assert problem.sizes is not None
    masses: list[float] = []
    for pick in itertools.product(problem.sizes[0], repeat=2):
        pairs = zip(problem.arm.links, pick, strict=True)
        arm = problem.arm.with_links(tuple(replace(link, section=item.section) for link, item in pairs))
        if alone(problem, arm, 0) <= 4e-4 and alone(problem, arm, 1) <= 7e-4:
            whole = evaluate(arm, problem.workspace, problem.load_cases)
            assert whole.mass is not None
            masses.append(whole.mass)
    assert 0 < len(masses) < 9
    assert optimise(problem).objective == pytest.approx(min(masses), rel=1e-9)


def test_weights_of_points_count_in_the_average(tmp_path: Path) -> None:
    problem = asked(tmp_path, f"{{at: {NEAR}, weight: 3}}, {FAR}", limits=", max_error: '<= 3 mm'")
    assert problem.workspace.weights == (3.0, 1.0)
    search = worst_search(error_model(problem.arm, problem.load_cases), problem.workspace)
    p = beam_values(beams_of(problem.arm, problem.load_cases))
    poses, shares = averaged_over(search, p)
    near = np.linalg.norm(search.tip(poses, p) - problem.workspace.points[0], axis=1) < 1e-6
    assert shares[near].sum() == pytest.approx(0.75, rel=1e-12)
    squares = shares @ search.errors(poses, p, 0).error ** 2
    whole = evaluate(problem.arm, problem.workspace, problem.load_cases)
    assert problem.figures["average_error"].value(whole) == pytest.approx(math.sqrt(squares), rel=1e-9)


@pytest.mark.parametrize(
    ("points", "limits", "why"),
    [
        (f"{{at: {NEAR}, weight: 0}}", "", r"points\[1\].weight.*above zero"),
        (f"{NEAR}, {{at: {FAR}, max_error: '>= 1 mm'}}", "", r"points\[2\].max_error"),
        (f"{{at: {NEAR}, tolerance: 1 mm}}", "", r"points\[1\].*unknown key .tolerance"),
        ("{weight: 2}", "", r"points\[1\].at.*missing"),
        (f"{{at: {NEAR}, max_error: '<= 1 mm'}}", ", link_length: [200 mm, 500 mm]", "links whose length stays"),
    ],
)
def test_points_that_say_nonsense_are_refused(points: str, limits: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=why):
        asked(tmp_path, points, limits=limits)
