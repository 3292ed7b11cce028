"""Where the base stands: against a grid of bases with poses and sizes tried one by one, and a beam on a slide."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-90 90", "-150 150", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin"))
POINTS = ((350.0, 200.0), (600.0, 250.0), (500.0, -150.0))
TEXT = (
    "minimize: max_error\nworkspace: {points: [[350 mm, 200 mm], {at: [600 mm, 250 mm]}, [500 mm, -150 mm]]}\n"
    "subject_to: {mass: '<= 3 kg'}\n"
    "choose: {base: %s, section: [tube], sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}}\n"
)
EITHER, ALONG_Y = "{x: [-100 mm, 200 mm], y: [-200 mm, 200 mm]}", "{y: [-200 mm, 200 mm]}"


def poses_to(point: tuple[float, float], base: Sequence[float]) -> list[tuple[float, float]]:
    """Both poses of the two links (400 and 300 mm) that reach a point, within their ranges."""
    x, y = 1e-3 * point[0] - base[0], 1e-3 * point[1] - base[1]
    cosine = (x * x + y * y - 0.25) / 0.24
    if abs(cosine) > 1.0:
        return []
    poses: list[tuple[float, float]] = []
    for elbow in (math.acos(cosine), -math.acos(cosine)):
        shoulder = math.atan2(y, x) - math.atan2(0.3 * math.sin(elbow), 0.4 + 0.3 * math.cos(elbow))
        shoulder = math.remainder(shoulder, 2.0 * math.pi)
        if abs(shoulder) <= math.pi / 2.0 and abs(elbow) <= math.radians(150.0) + 1e-6:
            poses.append((shoulder, elbow))
    return poses


def errors(arm: Arm, cases: Sequence[LoadCase], q: Array) -> Array:
    """The error (m) of an arm at poses (N, 2)."""
    (case,), p = error_model(arm, cases).cases, beam_values(beams_of(arm, cases))
    return played(case.arrays(q, p), case.radii, arm.play, planar=True).error


def designs(problem: Problem) -> list[Arm]:
    """Every arm of the sizes listed that keeps the mass."""
    assert problem.sizes is not None
    arms: list[Arm] = []
    for picks in itertools.product(*problem.sizes):
        links = [replace(link, section=item.section) for link, item in zip(problem.arm.links, picks, strict=True)]
        arm = problem.arm.with_links(tuple(links))
        if sum(float(beam.mass) for beam in beams_of(arm, problem.load_cases)) <= 3.0:
            arms.append(arm)
    return arms


@pytest.mark.parametrize(
    ("ranges", "xs"),
    [pytest.param(ALONG_Y, 1, marks=pytest.mark.slow), pytest.param(EITHER, 61, marks=pytest.mark.slow)],
)
def test_no_base_of_a_grid_with_any_sizes_does_better(tmp_path: Path, ranges: str, xs: int) -> None:
    problem = problem_of(tmp_path, ARM, TEXT % ranges)
    result = optimise(problem)
    assert result.base is not None
    assert result.objective <= optimise(replace(problem, base=None)).objective * (1.0 + 1e-9)
    bases = list(itertools.product(np.linspace(-0.1, 0.2, xs) if xs > 1 else [0.0], np.linspace(-0.2, 0.2, 81)))
    reached = [[poses_to(point, base) for point in POINTS] for base in bases]
    rows = [(k, pose) for k, poses in enumerate(reached) if all(poses) for pose in itertools.chain(*poses)]
    number, q = np.array([k for k, _ in rows]), np.array([pose for _, pose in rows])
    best = np.full(len(bases), np.inf)
    for arm in designs(problem):
        worst = np.where([all(poses) for poses in reached], 0.0, np.inf)
        np.maximum.at(worst, number, errors(arm, problem.load_cases, q))
        best = np.minimum(best, worst)
    assert result.objective <= best.min() * (1.0 + 1e-3)
    there = [pose for point in POINTS for pose in poses_to(point, result.base[:2])]
    assert result.objective == pytest.approx(errors(result.arm, problem.load_cases, np.array(there)).max(), rel=1e-4)
    # What is written stands there: evaluated with points where they were, it errs as promised.
    again = evaluate(result.arm, problem.workspace, problem.load_cases)
    assert again.max_error == pytest.approx(result.objective, rel=1e-4)
    assert result.arm.joints[0].origin_translation == pytest.approx(result.base, abs=1e-9)


SLIDE = (
    "gravity: [0 m/s^2, -9.81 m/s^2]\nchain:\n"
    "  - joint: {type: prismatic, axis: [0, 1, 0], range: [0 mm, 450 mm]}\n"
    "    link: {length: 400 mm, section: {shape: circle, diameter: 30 mm},\n"
    "      material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3}}\n"
    "payload: {mass: 1 kg}\nleave_out: [shear_deformation]\n"
)
HEIGHTS = (
    "minimize: max_error\nworkspace: {points: [[400 mm, 100 mm], [400 mm, 500 mm]]}\n"
    "choose: {base: {y: [%s]}}\nsubject_to: {section_size: [10 mm, 40 mm]}\n"
)


def test_a_base_along_gravity_changes_nothing_but_reach(tmp_path: Path) -> None:
    """A beam on an upright slide of 450 mm bends alike at all heights: P L^3 / 3 E I + w L^4 / 8 E I. The slide is at
    both heights, 400 mm apart, where the base is 50 to 100 mm up."""
    result = optimise(problem_of(tmp_path, SLIDE, HEIGHTS % "0 mm, 400 mm"))
    inertia, area, load, length = math.pi * 0.04**4 / 64.0, math.pi * 0.02**2, 9.81, 0.4
    bent = load * length**3 / 3.0 + 2700.0 * area * load * length**4 / 8.0
    assert result.objective == pytest.approx(bent / (70e9 * inertia), rel=1e-6)
    assert result.base is not None
    assert 0.05 - 1e-7 <= result.base[1] <= 0.1 + 1e-7
    assert result.start is not None  # where the arm as given stands, it does not reach the upper one
    assert not any(item.name == "base" and item.price for item in result.binding)
    with pytest.raises(NoAnswer, match="cannot be reached"):
        optimise(problem_of(tmp_path, SLIDE, HEIGHTS % "110 mm, 400 mm"))


@pytest.mark.parametrize(
    ("base", "message"),
    [
        ("{}", "needs a range of x, y or z"),
        ("{x: [5 mm, 5 mm]}", "has one value"),
        ("{x: [0 mm, 5 mm], z: [0 mm, 5 mm]}", "leaves the plane"),
        ("{x: [0 mm, 5 mm], w: [0 mm, 5 mm]}", "unknown key 'w'"),
    ],
)
def test_bases_that_are_none(tmp_path: Path, base: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        problem_of(tmp_path, ARM, TEXT % base)
    poses = "workspace: {joints: range}\nchoose: {section: [tube], base: {x: [0 mm, 5 mm]}}\n"
    with pytest.raises(InputError, match="changes nothing for poses"):
        problem_of(tmp_path, ARM, poses)


def test_what_is_printed_and_written_says_where_it_stands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem_of(tmp_path, SLIDE, HEIGHTS % "0 mm, 90 mm")
    file = str(tmp_path / "problem.yaml")
    target, other = tmp_path / "result.json", tmp_path / "again.json"
    assert outcome(["optimize", file, "--json", str(target), "--out", str(tmp_path / "out")]) == 0
    content = json.loads(target.read_text(encoding="utf-8"))
    assert 50.0 - 1e-4 <= content["base_mm"][1] <= 90.0
    assert "stands at" in capsys.readouterr().out
    assert outcome(["evaluate", str(tmp_path / "out" / "arm.yaml"), "--problem", file, "--json", str(other)]) == 0
    again = json.loads(other.read_text(encoding="utf-8"))
    assert again["max_error_mm"] == pytest.approx(content["max_error_mm"], rel=1e-6)
    assert outcome(["tradeoff", file, "--x", "mass", "--y", "max_error"]) == 2
    assert "choose.base: is settled by `optimize` alone" in capsys.readouterr().err
