"""Figures along a direction, of a rotation, and of play alone: against every pose of a scan and finite loads."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import DIRECTED, FIGURES
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from tests.arm.builders import arm_of
from tests.costs import slow_but
from tests.optimize.builders import problem_of

IN_SPACE = """\
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {type: revolute, range: [-60 deg, 60 deg], clearance: 0.02 mm, backlash: 1 arcmin, stiffness: 50 kN*m/rad}
    link: {length: 300 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
  - joint: {type: revolute, axis: [0, 1, 0], range: [-80 deg, 80 deg], clearance: 0.03 mm, backlash: 2 arcmin}
    link: {length: 400 mm, section: {shape: circle, diameter: 50 mm}, material: steel-s355}
payload: {mass: 5 kg}
"""
PLANAR = """\
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg], clearance: 0.02 mm, backlash: 1 arcmin, stiffness: 50 kN*m/rad}
    link: {length: 400 mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, range: [-120 deg, 120 deg], clearance: 0.03 mm, backlash: 2 arcmin}
    link: {length: 300 mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}
payload: {mass: 3 kg}
"""
UP, SLANT = (0.0, 0.0, 1.0), (0.6, 0.48, 0.64)


def poses_of(arm: Arm, each: int = 41) -> Array:
    """A full grid of the joint ranges."""
    axes = [np.linspace(*joint.range, each) for joint in arm.joints]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, arm.size)


def scanned(arm: Arm, direction: tuple[float, ...] | None, counted: str) -> float:
    """The worst over the grid, straight from the effects: the support of the set that play makes, along a direction, or
    over many of them."""
    q = poses_of(arm)
    state = solve(arm, [q[:, k] for k in range(arm.size)], beams_of(arm), arm.payload)
    error = tip_error(state, active_effects(arm), "orientation" if counted == "orientation" else "position")
    rows = len(q)
    vector = np.zeros((rows, 3)) if counted == "lost_motion" else columns(error.vector, rows)
    fan = np.random.default_rng(4).normal(size=(1500, 3)) if direction is None else np.array([direction])
    fan = np.vstack([fan, *([np.eye(3)] if direction is None else [])])
    worst = 0.0
    for d in fan / np.linalg.norm(fan, axis=1)[:, None]:
        reach = np.abs(vector @ d) + sum(np.abs(columns(interval.vector, rows) @ d) for interval in error.intervals)
        for disc in error.discs:
            reach = reach + disc.radius * np.sqrt(np.maximum(0.0, 1.0 - (columns(disc.normal, rows) @ d) ** 2))
        worst = max(worst, float(reach.max()))
    return worst


@pytest.mark.parametrize("text", [IN_SPACE, PLANAR], ids=["space", "plane"])
@pytest.mark.parametrize("direction", [UP, SLANT, (1.0, 0.0, 0.0)], ids=["up", "slant", "x"])
def test_the_error_along_a_direction_is_that_of_a_scan(tmp_path: Path, text: str, direction: tuple[float, ...]) -> None:
    arm = arm_of(text, tmp_path)
    value = DIRECTED["error_along"].figure(direction).value(evaluate(arm))  # type: ignore[arg-type]
    expected = scanned(arm, direction, "position")
    assert value is not None
    assert expected * (1.0 - 1e-9) - 1e-15 <= value <= expected * 1.01 + 1e-15


@pytest.mark.parametrize("text", [IN_SPACE, PLANAR], ids=["space", "plane"])
@pytest.mark.parametrize("name", ["orientation_error", "repeatability"])
def test_rotation_and_repeatability_are_those_of_a_scan(tmp_path: Path, text: str, name: str) -> None:
    """The directions of the scan are a fan, so that it may fall short by a per cent."""
    arm = arm_of(text, tmp_path)
    value = FIGURES[name].value(evaluate(arm))
    expected = scanned(arm, None, "orientation" if name == "orientation_error" else "lost_motion")
    assert value is not None
    assert expected * (1.0 - 1e-9) <= value <= expected * 1.02


def test_rotation_of_a_cantilever_is_that_of_any_textbook(tmp_path: Path) -> None:
    """F L^2 / 2 E I about the axis across the plane and none about others; stiffness 3 E I / L^3 across the beam."""
    text = (
        "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\nleave_out: [shear_deformation]\nchain:\n"
        "  - joint: {type: revolute, range: [0 deg, 1e-6 deg]}\n"
        "    link: {length: 1 m, section: {shape: rectangle, width: 20 mm, height: 30 mm},\n"
        "           material: {elastic_modulus: 200 GPa, poisson_ratio: 0.3, density: 1 kg/m^3}}\n"
        "payload: {mass: 0 kg, force: [0 N, -50 N, 0 N]}\n"
    )
    evaluation = evaluate(arm_of(text, tmp_path))
    rigidity, axial = 200e9 * 0.02 * 0.03**3 / 12.0, 200e9 * 0.02 * 0.03
    about = DIRECTED["orientation_error"].figure
    assert FIGURES["orientation_error"].value(evaluation) == pytest.approx(50.0 / (2.0 * rigidity), rel=1e-6)
    assert about(UP).value(evaluation) == pytest.approx(50.0 / (2.0 * rigidity), rel=1e-6)
    assert about((1.0, 0.0, 0.0)).value(evaluation) == pytest.approx(0.0, abs=1e-12)
    along = DIRECTED["tip_stiffness_along"].figure
    assert along((0.0, 1.0, 0.0)).value(evaluation) == pytest.approx(3.0 * rigidity, rel=1e-6)
    assert along((1.0, 0.0, 0.0)).value(evaluation) == pytest.approx(axial, rel=1e-6)
    both = 1.0 / (0.5 / (3.0 * rigidity) + 0.5 / axial)
    root = math.sqrt(0.5)
    assert along((root, root, 0.0)).value(evaluation) == pytest.approx(both, rel=1e-6)


def test_stiffness_along_a_direction_is_that_of_a_finite_load(tmp_path: Path) -> None:
    """A newton along the direction, at the softest pose that is found and at every other of a scan."""
    arm = arm_of(IN_SPACE, tmp_path)
    figure = DIRECTED["tip_stiffness_along"].figure(SLANT)
    evaluation = evaluate(arm)
    value = figure.value(evaluation)
    assert value is not None
    q = poses_of(arm)
    moved: list[Array] = []
    for force in (SLANT, (0.0, 0.0, 0.0)):
        state = solve(arm, [q[:, k] for k in range(arm.size)], beams_of(arm), LoadCase(mass=5.0, force=force))
        moved.append(columns(tip_error(state, active_effects(arm)).vector, len(q)))
    least = 1.0 / float(((moved[0] - moved[1]) @ np.array(SLANT)).max())
    assert least * 0.99 <= value <= least * (1.0 + 1e-9)
    assert figure.at_poses is not None
    assert figure.at_poses(evaluation, [tuple(q[0].tolist())]) == pytest.approx(
        1.0 / float((moved[0] - moved[1])[0] @ np.array(SLANT)), rel=1e-9
    )


LIMITS = [
    "error_along: {direction: [0, 1], value: '<= 0.5 mm'}",
    "orientation_error: '<= 0.7 mrad'",
    "orientation_error: {axis: [0, 0, 1], value: '<= 0.7 mrad'}",
    "tip_stiffness_along: {direction: [1, 0, 0], value: '>= 150 N/mm'}",
]


def with_diameter(arm: str, diameter: float) -> str:
    return arm.replace("diameter: 60 mm", f"diameter: {1e3 * diameter:.9f} mm")


@pytest.mark.parametrize("limit", slow_but(LIMITS, LIMITS[0]))
def test_the_lightest_design_is_that_of_bisection(tmp_path: Path, limit: str) -> None:
    """Of circles that are all alike there is one number to choose: bisect it by evaluations alone."""
    text = f"minimize: mass\nsubject_to: {{{limit}, section_size: [10 mm, 200 mm]}}\n"
    arm = PLANAR.replace(", stiffness: 50 kN*m/rad", "")
    problem = problem_of(tmp_path, arm, text + "choose: {section: [circle], same: [size]}\n")
    result = optimise(problem)
    (asked,) = (item for item in problem.limits if not item.assumed)
    assert asked.of(result.after) == pytest.approx(asked.value, rel=1e-4)
    low, high = 0.01, 0.2
    for _ in range(11):
        middle = 0.5 * (low + high)
        value = asked.of(evaluate(arm_of(with_diameter(arm, middle), tmp_path)))
        keeps = value <= asked.value if asked.relation == "<=" else value >= asked.value
        low, high = (low, middle) if keeps else (middle, high)
    area = math.pi * high**2 / 4.0
    assert result.objective == pytest.approx(2700.0 * 0.7 * area, rel=5e-3)
    (binding,) = (item for item in result.binding if item.name == asked.name)
    assert binding.price is not None


def test_a_direction_is_minimised_and_traded(tmp_path: Path) -> None:
    text = "subject_to: {mass: '<= 8 kg', section_size: [10 mm, 200 mm]}\nchoose: {section: [circle], same: [size]}\n"
    problem = problem_of(tmp_path, PLANAR, "minimize: {error_along: [0, 1]}\n" + text)
    assert problem.minimize == "error_along (0, 1, 0)"
    assert question(problem, "mass", "error_along").y.name == problem.minimize
    result = optimise(problem)
    assert result.objective == pytest.approx(problem.objective.value(result.after), rel=1e-6)
    texts = [with_diameter(PLANAR, diameter) for diameter in np.linspace(0.04, 0.073, 12).tolist()]  # up to 8 kg
    values = [problem.objective.value(evaluate(arm_of(text, tmp_path))) for text in texts]
    least = min(value for value in values if value is not None)
    assert least * (1.0 - 3e-3) <= result.objective <= least * (1.0 + 1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("subject_to: {error_along: '<= 1 mm'}", "error_along: needs its direction"),
        ("subject_to: {error_along: {direction: [0, 0, 0], value: '<= 1 mm'}}", "direction: is a direction"),
        ("subject_to: {error_along: {direction: up, value: '<= 1 mm'}}", "direction: is a direction"),
        ("subject_to: {error_along: {direction: [0, 0, 1], value: '>= 1 mm'}}", "value"),
        ("subject_to: {error_along: {direction: [0, 0, 1]}}", "value"),
        ("subject_to: {error_along: {direction: [0, 0, 1], value: '<= 1 mm', at: 3}}", "at"),
        ("subject_to: {orientation_error: {direction: [0, 0, 1], value: '<= 1 mrad'}}", "orientation_error"),
        ("subject_to: {orientation_error: '<= 1 mm'}", "orientation_error"),
        ("minimize: error_along", "minimize: needs a direction"),
        ("minimize: {tip_stiffness_along: [0, 0, 1]}", "maximize"),
        ("minimize: {mass: [0, 0, 1]}", "error_along"),
    ],
)
def test_what_cannot_be_is_told_in_a_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError) as error:
        problem_of(tmp_path, PLANAR, text + "\n")
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_repeatability_needs_play(tmp_path: Path) -> None:
    bare = PLANAR.replace(", clearance: 0.02 mm, backlash: 1 arcmin", "").replace(
        ", clearance: 0.03 mm, backlash: 2 arcmin", ""
    )
    assert FIGURES["repeatability"].value(evaluate(arm_of(bare, tmp_path))) is None
    with pytest.raises(InputError, match=r"repeatability: needs an arm with play"):
        optimise(
            problem_of(
                tmp_path, bare, "minimize: mass\nsubject_to: {repeatability: '<= 0.1 mm', max_error: '<= 1 mm'}\n"
            )
        )
