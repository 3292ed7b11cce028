"""Arms that move: loads against MuJoCo, closed forms and an own integration of beams; designs against own formulas."""

from __future__ import annotations

import math
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.optimize import brentq

from linkwright.core.arm.actuators import load_actuators
from linkwright.core.arm.bodies.inertia import Moving
from linkwright.core.arm.chain.chain import Arm, EffectEntry, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.descriptions.formats import export_arm
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.figures.motion.cycle import least_use
from linkwright.core.arm.motion.cycle import cycles_of, errors_along
from linkwright.core.arm.motion.dynamics import drive_torques
from linkwright.core.optimize.choice.actuators import hopeless
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.arm.motion.test_rigid import by_mujoco, random_arm, random_states
from tests.costs import slow_but
from tests.optimize.builders import problem_of

E, RHO = 70e9, 2700.0
METAL = "{elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3, yield_strength: 200 MPa}"
STILL = "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\n"
PERIOD = 0.8


def bars(*lengths: float, joint: str = "", diameter: float = 30.0, rest: str = "payload: {mass: 1 kg}\n") -> str:
    """An arm file of rods on joints that turn."""
    link = f"section: {{shape: circle, diameter: {diameter:g} mm}}, material: {METAL}"
    rows = (
        f"  - joint: {{type: revolute{joint}}}\n    link: {{length: {length:g} mm, {link}}}\n" for length in lengths
    )
    return "chain:\n" + "".join(rows) + rest + "leave_out: [shear_deformation, axial]\n"


def swing(folder: Path, *swings: tuple[float, float, float], count: int = 80, more: str = "") -> None:
    """A cycle in which joint k swings by `amplitude` (deg) about `middle` (deg), with a phase (rad)."""
    names = ", ".join(f"q{number}_deg" for number in range(1, len(swings) + 1))
    lines = [f"time_s, {names}{', payload_kg' if more else ''}"]
    for k in range(count + 1):
        turn = 2.0 * math.pi * k / count
        cells = [f"{middle + amplitude * math.cos(turn + phase):.12g}" for middle, amplitude, phase in swings]
        lines.append(", ".join([f"{PERIOD * k / count:.12g}", *cells, *([more] if more else [])]))
    (folder / "cycle.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


@pytest.mark.parametrize("seed", slow_but(range(12), *range(4)))
def test_random_arms_in_motion_load_their_drives_as_in_mujoco(seed: int) -> None:
    arm = random_arm(seed)
    states = random_states(arm, seed)
    expected = by_mujoco(mujoco.MjModel.from_xml_string(export_arm(arm, "mjcf").text), *states)
    moving = Moving(*(tuple(rows.T) for rows in states))
    state = solve(arm, list(states[0].T), beams_of(arm), replace(arm.payload, moving=moving))
    result = np.stack([np.broadcast_to(-joint.drive_load, len(expected)) for joint in state.joints], axis=1)
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-9)


def test_a_bar_that_speeds_up_bends_as_under_a_load_that_grows_along_it(tmp_path: Path) -> None:
    """11/120 of q L^4 / E I for the rod, m a L^3 / 3 E I for the payload, and the turning of its ball of steel."""
    arm = problem_of(tmp_path, STILL + bars(500.0), "minimize: max_error\n").arm
    speeding = replace(arm.payload, moving=Moving((0.4,), (0.0,), (30.0,)))
    length, area, flexural = 0.5, math.pi * 0.015**2, E * math.pi * 0.03**4 / 64.0
    bent = (11.0 / 120.0 * RHO * area * length + 1.0 / 3.0) * 30.0 * length**4 / flexural
    bent += ball(1.0) * 30.0 * length**2 / (2.0 * flexural)
    evaluation = evaluate(arm, load_cases=(speeding,))
    assert evaluation.max_error == pytest.approx(bent, rel=1e-4)
    root = (RHO * area * length**3 / 3.0 + length**2 + ball(1.0)) * 30.0
    stress = root * 0.015 / (math.pi * 0.03**4 / 64.0)
    assert evaluation.strength.stress[0] == pytest.approx(stress, rel=2e-3)


def test_what_a_swinging_rod_asks_of_its_drive(tmp_path: Path) -> None:
    """A cos(w t) without weight: torque J A w^2, speed A w, and half J (A w)^2 put in and braked off twice a period.
    The worst instants of a cycle have no average error."""
    swing(tmp_path, (0.0, 40.0, 0.0))
    problem = problem_of(tmp_path, STILL + bars(500.0), "minimize: max_error\nload_cases: [{motion: cycle.csv}]\n")
    (drive,) = evaluate(problem.arm, problem.workspace, problem.load_cases).in_motion or ()
    inertia = RHO * math.pi * 0.015**2 * 0.5**3 / 3.0 + 0.5**2 + ball(1.0)
    amplitude, frequency = math.radians(40.0), 2.0 * math.pi / PERIOD
    peak, kinetic = inertia * amplitude * frequency**2, 0.5 * inertia * (amplitude * frequency) ** 2
    expected = [peak, peak / math.sqrt(2.0), amplitude * frequency, 0.5 * peak * amplitude * frequency]
    assert astuple(drive) == pytest.approx([*expected, 2.0 * kinetic, 2.0 * kinetic], rel=2e-3)
    assert FIGURES["average_error"].value(evaluate(problem.arm, problem.workspace, problem.load_cases)) is None
    with pytest.raises(InputError, match="worst instants count; limit max_error"):
        problem_of(tmp_path, STILL + bars(500.0), "minimize: average_error\nload_cases: [{motion: cycle.csv}]\n")


def ball(mass: float) -> float:
    """The inertia of a ball of steel, kg*m^2."""
    return 0.4 * mass * (3.0 * mass / (4.0 * math.pi * 7850.0)) ** (2.0 / 3.0)


def integrated_error(arm: Arm, q: Any, velocity: Any, acceleration: Any, payload: float) -> float:
    """The tip's displacement of a planar arm of two rods (m): Euler and Bernoulli along each, loads in 400 steps."""
    lengths, area, flexural = arm.lengths, math.pi * 0.015**2, E * math.pi * 0.03**4 / 64.0
    angles, rates, changes = np.cumsum(q), np.cumsum(velocity), np.cumsum(acceleration)
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    across = np.stack([-np.sin(angles), np.cos(angles)], axis=1)
    gravity = np.array(arm.gravity[:2])
    starts, rising = [np.zeros(2)], [np.zeros(2)]
    for k, length in enumerate(lengths):
        starts.append(starts[k] + length * along[k])
        rising.append(rising[k] + length * (changes[k] * across[k] - rates[k] ** 2 * along[k]))
    tip = starts[-1]
    steps = 400
    share = (np.arange(steps) + 0.5) / steps
    points, loads = [], []
    for k, length in enumerate(lengths):
        at = share[:, None] * length
        points.append(starts[k] + at * along[k])
        felt = gravity - rising[k] - at * (changes[k] * across[k] - rates[k] ** 2 * along[k])
        loads.append(RHO * area * length / steps * felt)
    points.append(tip[None])
    loads.append(payload * (gravity - rising[-1])[None])
    point, load = np.vstack(points), np.vstack(loads)
    moved = np.zeros(2)
    for k, length in enumerate(lengths):
        for s in share * length:  # each cut turns all beyond by M ds / E I
            here = starts[k] + s * along[k]
            beyond = np.concatenate(
                [((share * length > s) if j == k else np.full(steps, j > k)) for j in range(len(lengths))] + [[True]]
            )
            arms = point[beyond] - here
            moment = float(np.sum(arms[:, 0] * load[beyond][:, 1] - arms[:, 1] * load[beyond][:, 0]))
            moved += moment * length / steps / flexural * across_of(tip - here)
    return float(np.linalg.norm(moved))


def across_of(vector: Any) -> Any:
    """A quarter turn."""
    return np.array([-vector[1], vector[0]])


def test_every_instant_of_a_cycle_errs_as_own_beams_do_and_the_worst_counts(tmp_path: Path) -> None:
    swing(tmp_path, (20.0, 40.0, 0.0), (-40.0, 50.0, 0.7), count=40)
    arm_text = bars(400.0, 300.0)
    problem = problem_of(tmp_path, arm_text, "minimize: max_error\nload_cases: [{motion: cycle.csv}]\n")
    (cycle,) = cycles_of(problem.load_cases)
    errors = errors_along(problem.arm, cycle)
    for k in range(0, 40, 7):
        expected = integrated_error(problem.arm, cycle.q[k], cycle.velocity[k], cycle.acceleration[k], 1.0)
        assert errors[k] == pytest.approx(expected, rel=3e-3)
    evaluation = evaluate(problem.arm, problem.workspace, problem.load_cases)
    one_by_one = [
        evaluate(problem.arm, problem.workspace, (cycle.sample(k),)).max_error for k in (0, int(np.argmax(errors)), 25)
    ]
    assert evaluation.max_error == pytest.approx(errors.max(), rel=1e-9) == max(one_by_one)
    assert evaluation.worst.poses[0].q == pytest.approx(tuple(cycle.q[int(np.argmax(errors))]))


def pendulum(diameter: float, payload: float, count: int = 2000) -> tuple[float, float]:
    """Root mean square and peak torque of a level rod of 500 mm that swings by 40 degrees, with a rod's inertia and a
    ball of steel at its end."""
    time = np.linspace(0.0, PERIOD, count + 1)
    rate = 2.0 * math.pi / PERIOD
    angle, speeding = (math.radians(40.0) * f * np.cos(rate * time) for f in (1.0, -(rate**2)))
    mass = RHO * math.pi * diameter**2 / 4.0 * 0.5
    inertia = mass * (0.5**2 / 3.0 + diameter**2 / 16.0) + payload * 0.5**2 + ball(payload)
    torque = inertia * speeding + 9.81 * 0.5 * (0.5 * mass + payload) * np.cos(angle)
    return math.sqrt(np.trapezoid(torque**2, time) / PERIOD), float(np.abs(torque).max())


@pytest.mark.parametrize(("figure", "which", "most"), [("rms_torque", 0, 12.0), ("peak_torque", 1, 20.0)])
def test_the_thickest_rod_takes_the_torque_that_it_may(figure: str, which: int, most: float, tmp_path: Path) -> None:
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    text = (
        "minimize: max_error\nload_cases: [{motion: cycle.csv}]\n"
        f"subject_to: {{{figure}: '<= {most} N*m', section_size: [10 mm, 80 mm], local_buckling: off}}\n"
    )
    result = optimise(problem_of(tmp_path, bars(500.0), text))
    diameter = brentq(lambda d: pendulum(d, 1.0)[which] - most, 0.01, 0.08)
    section = result.arm.links[0].section
    assert section is not None
    assert float(section.properties(0.3).height) == pytest.approx(diameter, rel=1e-3)
    assert [item.name for item in result.binding] == [figure]


def test_the_lightest_drive_that_a_cycle_leaves_is_chosen(tmp_path: Path) -> None:
    """Root mean square against rated, peak against peak torque, each with its rotor behind its gear."""
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    names = ("CSG-14-100-2UH", "CSG-17-100-2UH", "CSG-20-100-2UH", "CSG-25-100-2UH")
    text = (
        "minimize: total_mass\nload_cases: [{motion: cycle.csv}]\n"
        f"subject_to: {{max_error: '<= 40 mm', section_size: [25 mm, 80 mm]}}\n"
        f"choose: {{actuator: [{', '.join(names)}]}}\n"
    )
    result = optimise(problem_of(tmp_path, bars(500.0, rest="payload: {mass: 2 kg}\n"), text))
    known = load_actuators()
    rms, peak = pendulum(0.025, 2.0)
    able = [
        item
        for item in map(known.find, names)
        if rms <= (item.rated_torque or 0.0) and peak <= (item.peak_torque or math.inf)
    ]
    chosen = result.arm.joints[0].actuator
    assert chosen is not None
    assert len(able) < len(names)
    assert chosen.name == min(able, key=lambda item: item.mass or 0.0).name


def test_no_rod_leaves_a_drive_less_than_its_payload_does(tmp_path: Path) -> None:
    """A pendulum without a rod; a rod can only add to it, as its torque and the payload's are in step."""
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    drive = ", rated_torque: 10 N*m, peak_torque: 15 N*m"
    problem = problem_of(tmp_path, bars(500.0, joint=drive), "minimize: max_error\nload_cases: [{motion: cycle.csv}]\n")
    (cycle,) = cycles_of(problem.load_cases)
    rms, peak = pendulum(1e-6, 1.0)
    assert least_use(problem.arm, cycle) == pytest.approx(max(rms / 10.0, peak / 15.0), rel=1e-4)


def test_a_drive_is_too_weak_for_a_cycle_only_where_its_torque_goes_by_the_mass_of_links(tmp_path: Path) -> None:
    """A spring of the joint holds the payload up, so that no drive is excluded before it is looked at."""
    swing(tmp_path, (0.0, 40.0, 0.0))
    drive = ", rated_torque: 1 N*m, peak_torque: 1 N*m"
    text = "minimize: max_error\nload_cases: [{motion: cycle.csv}]\nsubject_to: {motion_use: '<= 1'}\n"
    problem = problem_of(tmp_path, bars(500.0, joint=drive), text)
    assert hopeless(problem)
    spring = EffectEntry("spring", (1,), {"stiffness": 10.0, "rest": 0.0})
    assert not hopeless(replace(problem, arm=replace(problem.arm, effects=(spring,))))


def test_a_rotor_of_the_catalogue_counts_with_the_square_of_its_gear(tmp_path: Path) -> None:
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    problem = problem_of(tmp_path, bars(500.0), "minimize: max_error\nload_cases: [{motion: cycle.csv}]\n")
    (cycle,) = cycles_of(problem.load_cases)
    actuator = replace(load_actuators().find("CSG-20-100-2UH"), rotor_inertia=2e-5)
    joints = (replace(problem.arm.joints[0], actuator=actuator),)
    more = drive_torques(cycle.motion(replace(problem.arm, joints=joints))) - drive_torques(cycle.motion(problem.arm))
    np.testing.assert_allclose(more, 2e-5 * 100.0**2 * cycle.acceleration, rtol=1e-9)


def test_static_loads_and_cycles_stand_side_by_side(tmp_path: Path) -> None:
    """A pose at rest is bounded as ever; the cycle, at 20 times the acceleration of gravity, is worse."""
    swing(tmp_path, (0.0, 40.0, 0.0), count=400)
    text = "minimize: max_error\nload_cases: [{motion: cycle.csv}, {payload: {mass: 1 kg}}]\n"
    problem = problem_of(tmp_path, bars(500.0, joint=", range: [-60 deg, 60 deg]"), text)
    both = evaluate(problem.arm, problem.workspace, problem.load_cases)
    still = evaluate(problem.arm, problem.workspace, (LoadCase(1.0),))
    (cycle,) = cycles_of(problem.load_cases)
    assert both.max_error == pytest.approx(max(still.max_error, errors_along(problem.arm, cycle).max()), rel=1e-9)
    assert both.upper_bound is not None
    assert FIGURES["rms_torque"].value(both) == pytest.approx(pendulum(0.03, 1.0)[0], rel=1e-4)
    assert FIGURES["rms_torque"].value(still) is None


@pytest.mark.parametrize(
    ("cycle", "text", "words"),
    [
        ("q1_deg\n0\n1\n2\n3\n", "", "a motion has a clock"),
        ("time_s,q1_deg\n0,0\n1,1\n1,2\n3,1\n", "", "does not ascend"),
        ("time_s,q1_deg\n0,0\n1,1\n2,2\n3,1\n", "subject_to: {link_length: [200 mm, 500 mm]}\n", "given lengths"),
        ("time_s,q1_deg\n0,0\n1,1\n2,2\n3,1\n", "relative_to: {payload: {mass: 0 kg}}\n", "loads at rest"),
    ],
)
def test_what_no_cycle_is_or_goes_with_is_one_line(cycle: str, text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "cycle.csv").write_text(cycle, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        problem_of(tmp_path, bars(500.0), f"minimize: mass\nload_cases: [{{motion: cycle.csv}}]\n{text}")
