"""What first frequency the drives alone allow: an oscillator's own, and the end of a question that no links answer."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.choice.actuators import frequency_allowed
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import NoAnswer
from linkwright.json.design import evaluation_json
from tests.optimize.builders import problem_of

ARM = """
chain:
  - joint: {{range: [-90 deg, 90 deg], {one}}}
    link: {{length: 500 mm, section: {{shape: tube, diameter: 60 mm, thickness: 3 mm}}, material: steel-s355}}
  - joint: {{range: [-90 deg, 90 deg], {two}, mass: 2 kg}}
    link: {{length: 400 mm, section: {{shape: tube, diameter: 60 mm, thickness: 3 mm}}, material: steel-s355}}
payload: {{mass: 6 kg}}
"""
SOFT = ARM.format(one="stiffness: 40 kN*m/rad", two="stiffness: 10 kN*m/rad")
ROOM = "section_size: [20 mm, 150 mm]"


def oscillator(one: float, two: float) -> float:
    """The lower frequency (Hz) of a stretched arm of two drives: 2 kg at 0.5 m, 6 kg at 0.9 m; no weight else."""
    arms = np.array([[0.5, 0.0], [0.9, 0.4]])  # what each mass moves by as each drive turns
    inertia = arms.T @ np.diag([2.0, 6.0]) @ arms
    values = np.linalg.eigvals(np.linalg.solve(inertia, np.diag([one, two])))
    return math.sqrt(float(values.real.min())) / (2.0 * math.pi)


def test_drives_alone_are_an_oscillator_of_point_masses(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, SOFT, f"subject_to: {{mass: '<= 12 kg', {ROOM}}}\n")
    allowed = frequency_allowed(problem)
    assert allowed == pytest.approx(oscillator(4e4, 1e4), rel=1e-6)
    result = evaluate(problem.arm, problem.workspace, problem.load_cases)
    assert result.frequency is not None
    assert result.frequency_of_drives is not None
    assert result.frequency.value < result.frequency_of_drives.value < allowed
    assert evaluation_json(result)["first_frequency_of_drives_Hz"] == result.frequency_of_drives.value


def test_a_frequency_beyond_that_of_the_drives_is_refused_at_once(tmp_path: Path) -> None:
    texts: list[str] = []
    rounds: list[object] = []
    problem = problem_of(tmp_path, SOFT, f"subject_to: {{first_frequency: '>= 20 Hz', {ROOM}}}\n")
    with pytest.raises(NoAnswer, match="first_frequency"):
        optimise(problem, log=rounds.append, notify=texts.append)
    assert rounds == []
    assert len(texts) == 1
    assert f"{oscillator(4e4, 1e4):.4g}" in texts[0]


def test_drives_too_soft_are_left_out_of_the_choice(tmp_path: Path) -> None:
    arm = ARM.format(one="actuator: RV-20E, mass: 4 kg", two="actuator: RV-6E")
    choose = "choose: {actuator: [[RV-20E, RV-40E], [CSG-14-100-2UH, RV-20E]]}\n"
    limits = f"first_frequency: '>= 12 Hz', {ROOM}, torque_use: off"
    result = optimise(problem_of(tmp_path, arm, f"minimize: mass\nsubject_to: {{{limits}}}\n{choose}"))
    outcomes = {drive.actuators: drive.outcome for drive in result.drives}
    assert {outcomes[one, "CSG-14-100-2UH"] for one in ("RV-20E", "RV-40E")} == {"infeasible"}
    assert result.after.frequency is not None
    assert result.after.frequency.value >= 12.0 * (1.0 - 1e-3)
