"""Boxes and paths: poses follow the places where they stand when lengths change; arms that move in space."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate, link_masses
from linkwright.core.arm.worst.coverage import Unreached
from linkwright.core.optimize.choice.combinations import choose
from linkwright.core.optimize.exchange.design import arm_of
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.trust import doubts_of
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.results.design import bound_words
from tests.optimize.builders import ALUMINIUM, DRIVE, jointed, one_exchange, problem_of, ranged, scanned_error, worst_at

ARM = jointed((500, 500), ranged("-120 120", "20 150"))
PATH = "workspace: {path: [[800 mm, -300 mm], [600 mm, 200 mm]]}\n"
BOX = "workspace: {box: [[400 mm, -300 mm], [700 mm, 300 mm]]}\n"
MASS = "subject_to: {mass: '<= 6 kg', section_size: [5 mm, 200 mm]}\n"
FREE = "subject_to: {mass: '<= 6 kg', section_size: [5 mm, 200 mm], link_length: [200 mm, 900 mm]}\n"


def poses_in_region(result: OptimizationResult, problem: Problem) -> np.ndarray:
    """Poses (N, 2) of a two-joint arm with the tip in the box or on the path, by the law of cosines."""
    points = np.array(problem.workspace.points)[:, :2]
    if problem.workspace.kind == "path":
        places = points[0] + np.linspace(0.0, 1.0, 401)[:, None] * (points[1] - points[0])
    else:
        sides = [np.linspace(*points[:, axis], 81) for axis in (0, 1)]
        places = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    first, second = result.arm.lengths
    cosine = ((places**2).sum(axis=1) - first**2 - second**2) / (2.0 * first * second)
    reached = np.abs(cosine) <= 1.0
    elbow = np.arccos(np.clip(cosine, -1.0, 1.0))
    shoulder = np.arctan2(places[:, 1], places[:, 0]) - np.arctan2(
        second * np.sin(elbow), first + second * np.cos(elbow)
    )
    q = np.stack([shoulder, elbow], axis=1)
    ranges = np.array([joint.range for joint in problem.arm.joints])
    kept = reached & np.all((q >= ranges[:, 0]) & (q <= ranges[:, 1]), axis=1)
    assert np.abs(tip_position(result.arm, q[kept])[:, :2] - places[kept]).max() < 1e-9
    return q[kept]


@pytest.mark.parametrize(
    ("region", "limits"),
    [
        (PATH, MASS),
        pytest.param(PATH, FREE, marks=pytest.mark.slow),
        pytest.param(BOX, MASS, marks=pytest.mark.slow),
        pytest.param(BOX, FREE, marks=pytest.mark.slow),
    ],
    ids=["path", "path, free", "box", "box, free"],
)
def test_no_pose_of_the_region_is_worse_than_claimed(region: str, limits: str, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, region + limits)
    result = optimise(problem)
    assert result.status != "stopped"
    poses = poses_in_region(result, problem)
    assert len(poses) > 100
    worst = worst_at(result.arm, problem.load_cases, poses)
    assert worst <= result.objective * (1.0 + 1e-4)
    assert worst >= result.objective * 0.98
    assert result.objective < result.before.max_error
    assert result.objective <= result.lower_bound * (1.0 + 2e-4)


@pytest.mark.slow
def test_hole_in_a_path_is_told(tmp_path: Path) -> None:
    """An elbow that folds to 150 degrees keeps the tip out of a disc, and the path cuts 25 mm off its edge, between two
    of the points at which it is sampled."""
    inner = np.hypot(500.0 + 500.0 * np.cos(np.radians(150.0)), 500.0 * np.sin(np.radians(150.0)))
    path = "workspace: {path: [[-600 mm, 258.5 mm], [650 mm, 258.5 mm]]}\n"
    result = optimise(problem_of(tmp_path, ARM, path + MASS))
    hole = 2.0 * np.sqrt(inner**2 - 258.5**2) / 1250.0
    assert result.after.unreached is not None
    assert result.after.unreached.share == pytest.approx(hole, abs=1.0 / 240.0)
    assert hole > 0.01
    assert any("of the path cannot be reached" in warning for warning in result.after.warnings)
    assert "of the path that is reached" in bound_words(result.after)


def test_corners_of_a_box_beyond_the_arm_are_told(tmp_path: Path) -> None:
    """The share of the box outside the ring between the folded and the stretched arm, by counting."""
    box = problem_of(tmp_path, ARM, "workspace: {box: [[100 mm, -300 mm], [1100 mm, 300 mm]]}\n" + MASS)
    x, y = np.meshgrid(np.linspace(100, 1100, 1001), np.linspace(-300, 300, 601))
    radius = np.hypot(x, y)
    spans = [np.hypot(500 + 500 * np.cos(a), 500 * np.sin(a)) for a in np.radians((150.0, 20.0))]
    outside = ((radius < spans[0]) | (radius > spans[1])).mean()
    result = evaluate(box.arm, box.workspace).unreached
    assert result is not None
    assert result.share == pytest.approx(outside, abs=0.03)
    whole = problem_of(tmp_path, ARM, BOX + MASS)
    assert evaluate(whole.arm, whole.workspace).unreached is None


def test_design_that_reaches_less_than_the_arm_as_given_is_doubted(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, BOX + MASS)
    context = context_of(problem)
    choice = choose(context)
    assert choice is not None
    after = evaluate(arm_of(choice.space, choice.exchanged.x, choice.combination.materials), problem.workspace)
    before = evaluate(problem.arm, problem.workspace)
    lower = choice.exchanged.solution.error
    assert doubts_of(context, choice, before, after, lower) == ()
    less = replace(after, unreached=Unreached(0.1, (0.4, 0.3), 0.02))
    assert "10 % of the box unreached" in doubts_of(context, choice, before, less, lower)[0]


@pytest.mark.slow
def test_free_lengths_do_better_than_fixed_ones(tmp_path: Path) -> None:
    fixed, free = (optimise(problem_of(tmp_path, ARM, PATH + limits)).objective for limits in (MASS, FREE))
    assert free < 0.95 * fixed


@pytest.mark.slow
def test_lengths_do_not_shrink_below_what_the_path_needs(tmp_path: Path) -> None:
    """Nothing but the path keeps the arm long; a design too short for it has no errors there to be judged by."""
    text = "minimize: mass\n" + PATH + "subject_to: {max_error: '<= 2 mm', link_length: [200 mm, 900 mm]}\n"
    problem = problem_of(tmp_path, ARM, text)
    result = optimise(problem)
    assert len(poses_in_region(result, problem)) == 401
    assert result.after.max_error <= 2e-3 * (1.0 + 1e-4)


@pytest.mark.slow
def test_nearly_stretched_arm_keeps_its_elbow(tmp_path: Path) -> None:
    """A pose that may flip its elbow to the other side binds nothing: the exchange would stop short of an answer."""
    arm = jointed((400, 420, 420), ranged("-120 120", "-150 150", "-150 150"))
    text = (
        "workspace: {path: [[800 mm, -300 mm], [700 mm, 300 mm]]}\n"
        "subject_to: {mass: '<= 10 kg', section_size: [5 mm, 200 mm], link_length: [200 mm, 700 mm]}\n"
    )
    _, done = one_exchange(problem_of(tmp_path, arm, text))
    assert done.converged
    assert done.worst is not None
    assert done.worst.error < 1.21e-3  # 1.216 mm is where it stopped when elbows could flip


@pytest.mark.slow
def test_arm_in_space(tmp_path: Path) -> None:
    """Base about z, shoulder and elbow about y, a sideways force, play in every joint."""
    axes = (("z", -180, 180), ("y", -120, 60), ("y", 20, 140))
    play = DRIVE + ", backlash: 1 arcmin, clearance: 0.01 mm"
    joints = [f"{play}, axis: {axis}, range: [{low} deg, {high} deg]" for axis, low, high in axes]
    arm = "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\n" + jointed((150, 450, 400), joints, material=ALUMINIUM)
    text = (
        "choose: {section: ellipse}\n"
        "load_cases: [{payload: {mass: 2 kg}, force: [40 N, 30 N, 0 N]}]\n"
        "subject_to: {mass: '<= 8 kg', section_size: [20 mm, 200 mm]}\n"
    )
    problem = problem_of(tmp_path, arm, text)
    result, done = one_exchange(problem)
    assert done.converged
    assert done.worst is not None
    scan = scanned_error(result, problem.load_cases)
    assert scan <= done.worst.error * (1.0 + 1e-4)
    assert scan >= 0.97 * done.worst.error
    assert sum(float(mass) for mass in link_masses(beams_of(result))) <= 8.0 * (1.0 + 1e-6)


def test_what_cannot_take_the_best_ones_place_is_not_certified(tmp_path: Path) -> None:
    """Further starts that end at the same design: the first is certified, and the answer by it."""
    result = optimise(problem_of(tmp_path, ARM, PATH + MASS))
    certified = [iteration.objective for iteration in result.iterations if iteration.certified]
    assert len(result.iterations) > 3
    assert len(certified) == 1
    assert result.status == "certified"
    assert result.after.worst.certified
    assert certified[0] == pytest.approx(result.objective, rel=1e-4)


POINTS = [(0.7, -0.3), (0.55, 0.2), (0.3, 0.6)]


def poses_at(points: list[tuple[float, float]], lengths: tuple[float, ...], ranges: np.ndarray) -> np.ndarray:
    """Every pose (N, 2) of two links that has its tip at a point, by the law of cosines."""
    results: list[list[float]] = []
    for x, y in points:
        cosine = (x * x + y * y - lengths[0] ** 2 - lengths[1] ** 2) / (2.0 * lengths[0] * lengths[1])
        for elbow in (np.arccos(cosine), -np.arccos(cosine)):
            across, along = lengths[1] * np.sin(elbow), lengths[0] + lengths[1] * np.cos(elbow)
            shoulder = np.arctan2(y, x) - np.arctan2(across, along)
            results.append([float(np.remainder(shoulder + np.pi, 2.0 * np.pi) - np.pi), float(elbow)])
    q = np.array(results)
    return q[np.all((q >= ranges[:, 0] - 1e-9) & (q <= ranges[:, 1] + 1e-9), axis=1)]


def test_points_count_and_nothing_between_them(tmp_path: Path) -> None:
    """The worst of all poses at three points, by hand; a path through them has worse ones."""
    words = ", ".join(f"[{1e3 * x:g} mm, {1e3 * y:g} mm]" for x, y in POINTS)
    arm = jointed((500, 500), ranged("-120 120", "-150 150"))
    problem = problem_of(tmp_path, arm, f"workspace: {{points: [{words}]}}\n{MASS}")
    result = optimise(problem)
    ranges = np.array([joint.range for joint in problem.arm.joints])
    poses = poses_at(POINTS, result.arm.lengths, ranges)
    assert len(poses) > len(POINTS)
    worst = worst_at(result.arm, problem.load_cases, poses)
    assert result.objective == pytest.approx(worst, rel=1e-6)
    assert result.after.worst.upper_bound == pytest.approx(worst, rel=1e-4)
    path = problem_of(tmp_path, arm, f"workspace: {{path: [{words}]}}\n{MASS}")
    assert optimise(path).objective >= result.objective * (1.0 - 1e-6)
    with pytest.raises(InputError, match="needs a direction"):
        problem_of(tmp_path, arm, f"workspace: {{points: [{words}], error: across}}\n{MASS}")
    with pytest.raises(NoAnswer, match="cannot be reached"):
        optimise(problem_of(tmp_path, arm, f"workspace: {{points: [{words}, [1200 mm, 0 mm]]}}\n{MASS}"))
