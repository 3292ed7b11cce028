"""Boxes and paths: poses follow the places where they stand when lengths change; arms that move in space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from arm.evaluation import link_masses
from arm.kinematics import tip_position
from arm.model import beams_of
from optimize.problem import Problem
from optimize.result import OptimizationResult
from optimize.run import optimise
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
    [(PATH, MASS), (PATH, FREE), (BOX, MASS), (BOX, FREE)],
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


def test_free_lengths_do_better_than_fixed_ones(tmp_path: Path) -> None:
    fixed, free = (optimise(problem_of(tmp_path, ARM, PATH + limits)).objective for limits in (MASS, FREE))
    assert free < 0.95 * fixed


def test_lengths_do_not_shrink_below_what_the_path_needs(tmp_path: Path) -> None:
    """Nothing but the path keeps the arm long; a design too short for it has no errors there to be judged by."""
    text = "minimize: mass\n" + PATH + "subject_to: {max_error: '<= 2 mm', link_length: [200 mm, 900 mm]}\n"
    problem = problem_of(tmp_path, ARM, text)
    result = optimise(problem)
    assert len(poses_in_region(result, problem)) == 401
    assert result.after.max_error <= 2e-3 * (1.0 + 1e-4)


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
    found, done = one_exchange(problem)
    assert done.converged
    assert done.worst is not None
    scan = scanned_error(found, problem.load_cases)
    assert scan <= done.worst.error * (1.0 + 1e-4)
    assert scan >= 0.97 * done.worst.error
    assert sum(float(mass) for mass in link_masses(beams_of(found))) <= 8.0 * (1.0 + 1e-6)
