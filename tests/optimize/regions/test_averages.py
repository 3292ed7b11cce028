"""Poses with weights as a workspace, and the average error over them and over joint ranges."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import qmc

from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import AVERAGE_ERROR
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-60 90", "-90 90", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin"))
LISTED = "workspace: {poses: [[0 deg, 0 deg], [30 deg, 40 deg], [90 deg, -90 deg]]}\n"
LIMITS = "subject_to: {mass: '<= 5 kg', section_size: [20 mm, 90 mm]}\n"
TABLE = "q1_deg, q2_deg, weight\n0, 0, 1\n30, 40, 3\n90, -90, 12\n"


def weighted(folder: Path, text: str, table: str = TABLE) -> Problem:
    (folder / "poses.csv").write_text(table, encoding="utf-8")
    return problem_of(folder, ARM, "workspace: {poses: poses.csv}\n" + text)


def errors_at(problem: Problem, q: np.ndarray) -> np.ndarray:
    """Of each pose, by the search for the worst in joint ranges that hold nothing else."""
    model, p = error_model(problem.arm, problem.load_cases), beam_values(beams_of(problem.arm))
    one = (WorstSearch(model, replace(problem.workspace, poses=(tuple(row),), weights=())) for row in q.tolist())
    return np.array([search.worst(p).error for search in one])


def test_an_average_is_that_of_the_poses_listed(tmp_path: Path) -> None:
    problem = weighted(tmp_path, LIMITS)
    assert problem.workspace.weights == (1.0, 3.0, 12.0)
    own = errors_at(problem, np.radians([[0.0, 0.0], [30.0, 40.0], [90.0, -90.0]]))
    result = evaluate(problem.arm, problem.workspace, problem.load_cases)
    assert result.max_error == result.worst.upper_bound == pytest.approx(own.max(), rel=1e-12)
    assert result.worst.certified
    assert AVERAGE_ERROR.value(result) == pytest.approx(np.sqrt(own**2 @ [1.0, 3.0, 12.0] / 16.0), rel=1e-12)
    assert {pose.q for pose in result.worst.poses} <= set(problem.workspace.poses)
    alike = evaluate(problem.arm, problem_of(tmp_path, ARM, LISTED + LIMITS).workspace, problem.load_cases)
    assert AVERAGE_ERROR.value(alike) == pytest.approx(np.sqrt((own**2).mean()), rel=1e-12)


def test_an_average_over_joint_ranges_is_the_integral(tmp_path: Path) -> None:
    """Against 2^14 points of a Sobol sequence; 192 of another kind are within some per cent."""
    problem = problem_of(tmp_path, ARM, LIMITS)
    search = WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)
    q = qmc.scale(qmc.Sobol(2, seed=1).random(2**14), search.lower, search.upper)
    every = search.errors(q, beam_values(beams_of(problem.arm)), 0).error
    result = AVERAGE_ERROR.value(evaluate(problem.arm, problem.workspace, problem.load_cases))
    assert result == pytest.approx(float(np.sqrt((every**2).mean())), rel=0.02)


def elbow_down(places: np.ndarray) -> np.ndarray:
    """The coordinates (rad) at which the tip of links of 400 and 300 mm stands at places (m), its second joint turned
    to the left: the law of cosines."""
    x, y = places.T
    second = np.arccos((x**2 + y**2 - 0.4**2 - 0.3**2) / (2.0 * 0.4 * 0.3))
    first = np.arctan2(y, x) - np.arctan2(0.3 * np.sin(second), 0.4 + 0.3 * np.cos(second))
    return np.stack([first, second], axis=1)


@pytest.mark.parametrize("kind", ["points", "path"])
def test_places_count_alike_and_a_path_by_its_length(kind: str, tmp_path: Path) -> None:
    """However many searches come to a place, and however long the legs of the path are."""
    places = [[0.69, 0.05], [0.5, 0.2], [0.1, 0.45]]
    written = f"workspace: {{{kind}: {[[f'{1e3 * value:.0f} mm' for value in place] for place in places]}}}\n"
    one_elbow = jointed((400, 300), ranged("-90 120", "0 120", more=", mass: 2 kg, stiffness: 60 kN*m/rad"))
    problem = problem_of(tmp_path, one_elbow, written + LIMITS)
    corners = np.array(places)
    if kind == "path":
        share = (np.arange(400.0) + 0.5) / 400.0
        legs = [a + share[:, None] * (b - a) for a, b in itertools.pairwise(corners)]
        weights = np.repeat(np.linalg.norm(np.diff(corners, axis=0), axis=1), 400)
        corners = np.vstack(legs)
    else:
        weights = np.ones(3)
    search = WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)
    own = search.errors(elbow_down(corners), beam_values(beams_of(problem.arm)), 0).error
    expected = np.sqrt(own**2 @ weights / weights.sum())
    result = AVERAGE_ERROR.value(evaluate(problem.arm, problem.workspace, problem.load_cases))
    assert result == pytest.approx(expected, rel=1e-9 if kind == "points" else 1e-3)


def average_of(problem: Problem, first: float) -> float:
    """The average error (m) with a rod of that diameter (m) first, and what is left of 5 kg for the second."""
    material = problem.arm.links[0].material
    assert material is not None
    one, other = (0.25 * np.pi * length * material.need("density") for length in problem.arm.lengths)
    sizes = (first, float(np.sqrt((5.0 - one * first**2) / other)))
    both = zip(problem.arm.links, sizes, strict=True)
    arm = problem.arm.with_links(tuple(replace(link, section=SHAPES["circle"](diameter=size)) for link, size in both))
    result = AVERAGE_ERROR.value(evaluate(arm, problem.workspace, problem.load_cases))
    assert result is not None
    return result


@pytest.mark.parametrize("space", ["poses", "joints"])
def test_the_least_average_is_that_of_a_scan(space: str, tmp_path: Path) -> None:
    """Two rods that share a mass: one number to choose, looked for by a scalar minimiser of evaluations."""
    text = "minimize: average_error\nchoose: {section: [circle]}\n" + LIMITS
    problem = weighted(tmp_path, text) if space == "poses" else problem_of(tmp_path, ARM, text)
    result = optimise(problem)
    assert result.doubts == ()
    assert result.minimize == "average_error"
    best = minimize_scalar(
        lambda first: average_of(problem, first), bounds=(0.05, 0.073), method="bounded", options={"xatol": 1e-6}
    )
    assert result.objective == pytest.approx(float(best.fun), rel=1e-4)


def test_an_average_is_limited_and_the_limit_binds(tmp_path: Path) -> None:
    least = optimise(weighted(tmp_path, "minimize: average_error\n" + LIMITS)).objective
    text = f"minimize: mass\nsubject_to: {{average_error: '<= {1.5e3 * least:.6f} mm', section_size: [20 mm, 90 mm]}}\n"
    result = optimise(weighted(tmp_path, text))
    assert result.doubts == ()
    assert AVERAGE_ERROR.value(result.after) == pytest.approx(1.5 * least, rel=1e-4)
    assert [item.name for item in result.binding][:1] == ["average_error"]
    assert result.after.mass is not None
    assert result.after.mass < 5.0


def test_lengths_that_are_free_keep_the_poses_of_joints(tmp_path: Path) -> None:
    text = "minimize: average_error\nsubject_to: {mass: '<= 5 kg', link_length: [250 mm, 450 mm], reach: '== 700 mm'}\n"
    result = optimise(weighted(tmp_path, text))
    assert result.doubts == ()
    assert result.after.reach == pytest.approx(0.7, rel=1e-9)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("q1_deg, q2_deg\n", "holds no poses"),
        ("q1_deg, q3_deg\n1, 2\n", "q2_deg: is missing; the file has q1_deg, q3_deg"),
        ("q1_deg, q2_deg\n1, two\n", "q2_deg: is no coordinate of a joint in row 1"),
        ("q1_deg, q2_deg, weight\n1, 2, 0\n", "weight: is no number above zero in row 1"),
    ],
)
def test_one_line_tells_what_is_wrong_with_a_table(table: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        weighted(tmp_path, LIMITS, table)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("workspace: {poses: [[0 deg]]}\n", r"poses\[1\]: is a coordinate for each of the 2 joints"),
        ("workspace: {poses: [], joints: range}\n", "needs one of joints, poses, path, points and box"),
        (
            "workspace: {points: [[400 mm, 300 mm]]}\nminimize: average_error\n"
            "subject_to: {link_length: [200 mm, 500 mm]}\n",
            "average_error is over poses that stay.*list poses of the joints",
        ),
        (
            "workspace: {path: [[400 mm, 300 mm], [500 mm, 300 mm]], error: across}\nminimize: average_error\n",
            "minimize: average_error is of the whole error",
        ),
    ],
)
def test_one_line_tells_what_is_wrong(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        problem_of(tmp_path, ARM, text)
