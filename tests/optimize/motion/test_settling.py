"""Settling time: against MuJoCo with springs and dampers in its joints, a closed form, and designs tried one by one."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.figures.motion.settling import Swinging, settled, settling_time, swung
from linkwright.core.arm.motion.cycle import Cycle, cycles_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.shapes.circle import Circle
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import problem_of
from tests.optimize.motion.test_cycles import STILL, swing

STIFF, DELAY, ELBOW, TIP = (20e3, 8e3), 6e-3, 2.0, 3.0
RIGID = (
    "chain:\n  - joint: {type: revolute, stiffness: 20 kN*m/rad}\n    link: {length: 400 mm, mass: 0 kg}\n"
    "  - joint: {type: revolute, stiffness: 8 kN*m/rad, mass: 2 kg}\n    link: {length: 300 mm, %s}\n"
    "payload: {mass: 3 kg}\n"
    + STILL
    + "effects: [{effect: joint_compliance, compliance: 0 rad/(N*m), retardation: 6 ms}]\n"
)
BAR = "section: {shape: circle, diameter: 40 mm}, material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, "
BAR += "poisson_ratio: 0.3, damping: 0.002}"
ASKED = "minimize: %s\nload_cases: [{motion: cycle.csv}]\nsubject_to: {settling_time: '<= %s to 0.02 mm'%s}\n"
ROWS = "section_size: [15 mm, 90 mm]"


def asked(folder: Path, arm: str, aim: str = "mass", limit: str = "100 ms", more: str = f", {ROWS}") -> Problem:
    swing(folder, (20.0, 30.0, 0.0), (-40.0, 25.0, 1.0), count=24)
    return problem_of(folder, arm, ASKED % (aim, limit, more))


def cycle_of(problem: Problem) -> Cycle:
    (cycle,) = cycles_of(problem.load_cases)
    return cycle


def mass_matrix(q: Array) -> Array:
    """Of point masses at the elbow and the tip."""
    first, second = 0.4, 0.3
    across = first * second * math.cos(q[1])
    tip = np.array([[first**2 + second**2 + 2.0 * across, second**2 + across], [second**2 + across, second**2]])
    return TIP * tip + ELBOW * np.array([[first**2, 0.0], [0.0, 0.0]])


def swings_in_mujoco(q: Array, bent: Array) -> tuple[Array, Array]:
    """Times (s), and how far (m) the tip is from where it stops, let go from bent springs."""
    damp = [DELAY * k for k in STIFF]
    joint = '<joint name="{}" type="hinge" axis="0 0 1" stiffness="{}" damping="{}" springref="{}"/>'
    one, two = (joint.format(f"j{k}", STIFF[k], damp[k], math.degrees(q[k])) for k in range(2))
    point = '<geom type="sphere" size="0.001" pos="{} 0 0" mass="{}"/>'
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option gravity="0 0 0" timestep="5e-5" integrator="implicitfast"/><worldbody><body>'
        f'{one}{point.format(0.4, ELBOW)}<body pos="0.4 0 0">{two}{point.format(0.3, TIP)}'
        '<site name="tip" pos="0.3 0 0"/></body></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.qpos = q
    mujoco.mj_forward(model, data)
    still = data.site("tip").xpos.copy()
    data.qpos = q + bent
    away: list[float] = []
    for _ in range(24_000):
        mujoco.mj_step(model, data)
        away.append(float(np.linalg.norm(data.site("tip").xpos - still)))
    return 5e-5 * np.arange(1, len(away) + 1), np.array(away)


def test_two_elastic_joints_settle_as_in_mujoco(tmp_path: Path) -> None:
    """Never later than the envelope says, and once the slower mode is left no more than half its period earlier."""
    problem = asked(tmp_path, RIGID % BAR)
    arm = replace(
        problem.arm, links=tuple(replace(link, section=None, material=None, mass=0.0) for link in problem.arm.links)
    )
    cycle = cycle_of(problem)
    q, acceleration = cycle.q, cycle.acceleration
    swinging = swung(arm, beams_of(arm, problem.load_cases), TIP, q, acceleration)
    for k in (0, 7, 15):
        matrix = mass_matrix(q[k])
        bent = -np.linalg.solve(np.diag(STIFF), matrix @ acceleration[k])
        time, away = swings_in_mujoco(q[k], bent)
        omega = np.sqrt(np.linalg.eigvals(np.linalg.solve(matrix, np.diag(STIFF))).real)
        for share in (0.3, 0.03):
            distance = share * away.max()
            last = float(time[np.flatnonzero(away > distance)[-1]])
            one = Swinging(*(rows[k : k + 1] for rows in vars(swinging).values()))
            value = float(settled(one, distance)[0])
            assert last <= value * (1.0 + 2e-3)
            assert value <= last + 1.2 * math.pi / omega.min()


def test_one_mode_settles_in_closed_form(tmp_path: Path) -> None:
    """ln (A / x) over zeta omega, with A = a r / omega^2 / (1 - zeta^2)^0.5 and zeta = omega D / 2 K."""
    lines = [line for k, line in enumerate((RIGID % BAR).splitlines()) if k not in (3, 4)]
    problem = asked_of_one(tmp_path, "\n".join(lines).replace("mass: 0 kg", BAR) + "\n")
    (link,) = problem.arm.links
    arm = replace(problem.arm, links=(replace(link, section=None, material=None, mass=0.0),))
    cycle = cycle_of(problem)
    omega = math.sqrt(STIFF[0] / (TIP * 0.4**2))
    size = np.abs(cycle.acceleration[:, 0]) * 0.4 / omega**2 / math.sqrt(1.0 - (0.5 * omega * DELAY) ** 2)
    expected = np.log(np.maximum(size / 2e-5, 1.0)) / (0.5 * omega**2 * DELAY)
    swinging = swung(arm, beams_of(arm, problem.load_cases), TIP, cycle.q, cycle.acceleration)
    assert settled(swinging, 2e-5) == pytest.approx(np.maximum(expected, 1e-6), rel=1e-5)


def asked_of_one(folder: Path, arm: str) -> Problem:
    swing(folder, (20.0, 30.0, 0.0), count=24)
    return problem_of(folder, arm, ASKED % ("mass", "100 ms", f", {ROWS}"))


def test_material_damps_as_its_loss_factor_says(tmp_path: Path) -> None:
    """A bar alone, its joint stiff: zeta = loss factor / 2, and the first frequency that the evaluation has."""
    text = (
        f"chain:\n  - joint: {{type: revolute}}\n    link: {{length: 500 mm, {BAR}}}\npayload: {{mass: 3 kg}}\n{STILL}"
    )
    problem = asked_of_one(tmp_path, text)
    frequency = FIGURES["first_frequency"].value(evaluate(problem.arm, problem.workspace, problem.load_cases))
    assert frequency is not None
    cycle = cycle_of(problem)
    swinging = swung(problem.arm, beams_of(problem.arm, problem.load_cases), 3.0, cycle.q, cycle.acceleration)
    assert swinging.decay[:, 0] == pytest.approx(0.001 * 2.0 * math.pi * frequency, rel=1e-6)


def with_bars(arm: Arm, diameters: tuple[float, ...]) -> Arm:
    sections = [Circle(diameter=diameter) for diameter in diameters]
    return arm.with_links(tuple(replace(link, section=s) for link, s in zip(arm.links, sections, strict=True)))


def test_nothing_lighter_of_a_grid_settles_in_time(tmp_path: Path) -> None:
    problem = asked(
        tmp_path, (RIGID % BAR).replace("length: 400 mm, mass: 0 kg", f"length: 400 mm, {BAR}"), limit="450 ms"
    )
    result = optimise(problem)
    figure = settling_time(2e-5)
    assert figure.value(result.after) == pytest.approx(0.45, rel=1e-3)
    best = math.inf
    cycle = cycle_of(problem)
    for pair in itertools.product(np.linspace(0.02, 0.09, 29), repeat=2):
        arm = with_bars(problem.arm, pair)
        beams = beams_of(arm, problem.load_cases)
        times = settled(swung(arm, beams, 3.0, cycle.q, cycle.acceleration), 2e-5)
        if times.max() <= 0.45:
            best = min(best, sum(float(beam.mass) for beam in beams))
    assert math.isfinite(best)
    assert result.objective <= best * (1.0 + 1e-3)
    price = next(item.price for item in result.binding if item.name == figure.name)
    assert price < 0.0


def test_what_is_asked_and_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked(tmp_path, RIGID % BAR)
    target = tmp_path / "result.json"
    arguments = ["evaluate", str(tmp_path / "arm.yaml"), "--problem", str(tmp_path / "problem.yaml")]
    assert outcome([*arguments, "--json", str(target)]) == 0
    assert "settling time to 0.02 mm" in capsys.readouterr().out
    assert json.loads(target.read_text(encoding="utf-8"))["settling_time_to_0.02_mm_s"] > 0.0
    for text, message in (
        ("'<= 0.2 s'", "needs a time and a distance"),
        ("'<= 0.2 s to -1 mm'", "needs a distance above zero"),
        ("'>= 0.2 s to 1 mm'", "can only be limited by <="),
    ):
        with pytest.raises(InputError, match=message):
            problem_of(
                tmp_path, RIGID % BAR, f"load_cases: [{{motion: cycle.csv}}]\nsubject_to: {{settling_time: {text}}}\n"
            )
    still = problem_of(tmp_path, RIGID % BAR, "subject_to: {settling_time: '<= 0.2 s to 1 mm'}\n")
    with pytest.raises(InputError, match="needs a motion"):
        optimise(still)
    undamped = (RIGID % BAR).replace(", damping: 0.002", "").split("effects")[0]
    with pytest.raises(InputError, match="says nothing of damping"):
        optimise(asked(tmp_path, undamped))
