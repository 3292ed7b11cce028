"""Bases that speed up (a lift, a vehicle): whatever has a mass weighs as if gravity were less their acceleration."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from linkwright.command_line import outcome
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from linkwright.results.figures_in_words import load_case_words
from tests.optimize.builders import problem_of
from tests.optimize.motion.test_cycles import PERIOD, RHO, E, ball, bars, swing

SPACE = """\
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {range: [-60 deg, 60 deg], stiffness: 50 kN*m/rad}
    link: {length: 300 mm, section: {shape: tube, diameter: 60 mm, thickness: 3 mm}, material: steel-s355}
  - joint: {axis: y, range: [-80 deg, 80 deg], stiffness: 30 kN*m/rad, mass: 2 kg}
    link: {length: 400 mm, section: {shape: tube, diameter: 50 mm, thickness: 3 mm}, material: steel-s355}
payload: {mass: 5 kg, force: [20 N, 0 N, 10 N]}
"""


def sag(diameter: float, felt: float) -> float:
    """Of a level rod of 500 mm with 1 kg at its end, where everything falls at `felt` (m/s^2)."""
    flexural, weight = E * math.pi * diameter**4 / 64.0, RHO * math.pi * diameter**2 / 4.0 * felt
    return felt * 0.5**3 / (3.0 * flexural) + weight * 0.5**4 / (8.0 * flexural)


def test_a_lift_that_rises_makes_all_of_a_rod_heavier_and_aside_it_bends_out_of_its_plane(tmp_path: Path) -> None:
    limits = "subject_to: {max_error: '<= 1.5 mm', section_size: [10 mm, 80 mm]}\n"
    level = bars(500.0, joint=", range: [-1e-6 deg, 1e-6 deg]")
    text = "minimize: mass\nload_cases: [{payload: {mass: 1 kg}%s}]\n" + limits
    problem = problem_of(tmp_path, level, text % ", acceleration: [0 m/s^2, 3 m/s^2]")
    evaluation = evaluate(problem.arm, problem.workspace, problem.load_cases)
    assert evaluation.max_error == pytest.approx(sag(0.03, 12.81), rel=1e-6)
    diameter = brentq(lambda d: sag(d, 12.81) - 1.5e-3, 0.01, 0.08)
    assert optimise(problem).objective == pytest.approx(RHO * math.pi * diameter**2 / 4.0 * 0.5, rel=1e-4)
    aside = problem_of(tmp_path, level, text % ", acceleration: [0 m/s^2, 0 m/s^2, 6 m/s^2]")
    both = evaluate(aside.arm, aside.workspace, aside.load_cases).max_error
    assert both == pytest.approx(math.hypot(sag(0.03, 9.81), sag(0.03, 6.0)), rel=1e-6)


def test_every_figure_is_that_of_the_arm_under_other_gravity(tmp_path: Path) -> None:
    """Error, stress, torque and load of joints in space, the force at the tip among them."""
    text = "load_cases: [{payload: {mass: 5 kg}, force: [20 N, 0 N, 10 N]%s}]\nsubject_to: {mass: '<= 9 kg'}\n"
    problem = problem_of(tmp_path, SPACE, text % ", acceleration: [2 m/s^2, -1 m/s^2, 4 m/s^2]")
    moved = evaluate(problem.arm, problem.workspace, problem.load_cases)
    heavy = replace(problem.arm, gravity=(-2.0, 1.0, -13.81))
    other = evaluate(heavy, problem.workspace, (replace(problem.load_cases[0], acceleration=(0.0, 0.0, 0.0)),))
    for name in ("max_error", "orientation_error", "safety_factor", "buckling", "mass", "first_frequency"):
        assert FIGURES[name].value(moved) == pytest.approx(FIGURES[name].value(other), rel=1e-9)
    assert moved.joint_loads is not None
    assert other.joint_loads is not None
    for one, two in zip(moved.joint_loads, other.joint_loads, strict=True):
        np.testing.assert_allclose((one.force, one.moment), (two.force, two.moment), rtol=1e-9, atol=1e-9)
    still = problem_of(tmp_path, SPACE, text % "")
    assert moved.max_error > 1.1 * evaluate(still.arm, still.workspace, still.load_cases).max_error


def test_a_rod_that_swings_in_a_lift_asks_more_of_its_drive(tmp_path: Path) -> None:
    """J q'' + (g + a) (m / 2 + M) L cos q, about the level."""
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    text = "minimize: max_error\nload_cases: [{motion: cycle.csv, acceleration: [0 m/s^2, 3 m/s^2]}]\n"
    problem = problem_of(tmp_path, bars(500.0), text)
    (drive,) = evaluate(problem.arm, problem.workspace, problem.load_cases).in_motion or ()
    time, rate = np.linspace(0.0, PERIOD, 2001), 2.0 * math.pi / PERIOD
    mass = RHO * math.pi * 0.03**2 / 4.0 * 0.5
    inertia = mass * (0.5**2 / 3.0 + 0.03**2 / 16.0) + 0.5**2 + ball(1.0)
    angle, speeding = (math.radians(40.0) * factor * np.cos(rate * time) for factor in (1.0, -(rate**2)))
    torque = inertia * speeding + 12.81 * 0.5 * (0.5 * mass + 1.0) * np.cos(angle)
    assert drive.torque == pytest.approx(float(np.abs(torque).max()), rel=2e-3)
    assert drive.rms_torque == pytest.approx(math.sqrt(np.trapezoid(torque**2, time) / PERIOD), rel=2e-3)


@pytest.mark.parametrize("since", ["payload: {mass: 1 kg}", "temperature: 20 degC"])
def test_what_is_calibrated_stood_still(since: str, tmp_path: Path) -> None:
    """Relative to the load case's own payload at rest, named or not, the acceleration alone counts."""
    text = "load_cases: [{payload: {mass: 1 kg}, acceleration: [0 m/s^2, 3 m/s^2]}]\n"
    text += f"relative_to: {{{since}}}\n"
    problem = problem_of(tmp_path, bars(500.0, joint=", range: [-1e-6 deg, 1e-6 deg]"), "minimize: max_error\n" + text)
    evaluation = evaluate(problem.arm, problem.workspace, problem.load_cases)
    assert evaluation.max_error == pytest.approx(sag(0.03, 3.0), rel=1e-6)


def test_it_is_printed_and_written_and_nonsense_is_one_line(tmp_path: Path) -> None:
    text = "minimize: max_error\nload_cases: [{payload: {mass: 1 kg}, acceleration: %s}]\n"
    problem = problem_of(tmp_path, bars(500.0), text % "[0 m/s^2, 3 m/s^2]")
    file, target = tmp_path / "problem.yaml", tmp_path / "result.json"
    assert outcome(["evaluate", str(tmp_path / "arm.yaml"), "--problem", str(file), "--json", str(target)]) == 0
    assert load_case_words(problem.load_cases[0]) == "payload 1 kg, base accelerated by (0, 3, 0) m/s²"
    (case,) = json.loads(target.read_text(encoding="utf-8"))["load_cases"]
    assert case["base_acceleration_m_per_s2"] == [0.0, 3.0, 0.0]
    for wrong in ("3 m/s^2", "[3 mm, 0 mm]", "[3 m/s^2]"):
        with pytest.raises(InputError, match="acceleration"):
            problem_of(tmp_path, bars(500.0), text % wrong)
