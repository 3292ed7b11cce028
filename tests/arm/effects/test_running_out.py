"""Booms that run out of a sleeve, against cantilevers worked out here: F h^3/3EI + w h^4/8EI at every coordinate h."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.errors.exact import deformed
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml

E, RHO, YIELD, G = 200e9, 7800.0, 300e6, 9.81
LENGTH, LEAST, LOAD = 1.5, 0.3, 12.0
STEEL = "{elastic_modulus: 200 GPa, poisson_ratio: 0.3, density: 7800 kg/m^3, yield_strength: 300 MPa}"


def _file(folder: Path, section: str = "{shape: tube, diameter: 60 mm, thickness: 4 mm}", more: str = "") -> Path:
    file = folder / "arm.yaml"
    file.write_text(
        "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\nleave_out: [shear_deformation]\n"
        f"chain:\n  - joint: {{type: prismatic, range: [300 mm, 1500 mm]{more}}}\n"
        f"    link: {{length: 1500 mm, section: {section}, material: {STEEL}, bends_over: q1}}\n"
        f"payload: {{mass: {LOAD} kg}}\n"
    )
    return file


def _tube(diameter: float, wall: float) -> tuple[float, float]:
    """Area (m^2) and second moment (m^4)."""
    inner = diameter - 2.0 * wall
    return math.pi / 4.0 * (diameter**2 - inner**2), math.pi / 64.0 * (diameter**4 - inner**4)


def _sag(h: float, area: float, second: float) -> float:
    weight = RHO * area * G
    return (LOAD * G * h**3 / 3.0 + weight * h**4 / 8.0) / (E * second)


@pytest.mark.parametrize("h", [0.3, 0.8, 1.5])
def test_it_bends_as_far_as_it_has_run_out(tmp_path: Path, h: float) -> None:
    arm, (area, second) = read_arm(_file(tmp_path)), _tube(0.06, 0.004)
    state = solve(arm, [np.array([h])], beams_of(arm))
    shape = deformed(state, active_effects(arm), 1)
    assert -shape.tip[0, 2] == pytest.approx(_sag(h, area, second), rel=1e-3)
    assert float(np.ravel(state.tip()[0])[0]) == pytest.approx(h)
    # What is still in the sleeve weighs there: the whole boom on the base, and only what is out bends it.
    assert -float(np.ravel(state.joints[0].force[2])[0]) == pytest.approx((LOAD + RHO * area * LENGTH) * G)
    moment = float(np.linalg.norm([float(np.ravel(part)[0]) for part in state.joints[0].moment]))
    assert moment == pytest.approx(LOAD * G * h + 0.5 * RHO * area * G * h * h)


def test_what_it_weighs_is_the_same_at_every_pose(tmp_path: Path) -> None:
    """What a diagnosis holds less payload to: no less than nothing, with what the boom weighs."""
    arm, (area, _) = read_arm(_file(tmp_path)), _tube(0.06, 0.004)
    state = solve(arm, [np.array([0.3, 0.9, 1.5])], beams_of(arm))
    beams = [link.beam for link in state.links]
    for name, carried in (("payload", LOAD), ("link_mass", 0.0)):
        declared = EFFECTS[name].link.declared
        assert declared is not None
        assert declared(arm, beams, 0) == pytest.approx(carried + RHO * area * LENGTH, rel=1e-12)


def test_what_is_evaluated_goes_by_the_length_at_each_pose(tmp_path: Path) -> None:
    result, (area, second) = lw.evaluate(_file(tmp_path)).found, _tube(0.06, 0.004)
    assert result.worst.error == pytest.approx(_sag(LENGTH, area, second), rel=1e-6)
    assert result.mass == pytest.approx(RHO * area * LENGTH, rel=1e-9)
    moment = LOAD * G * LENGTH + 0.5 * RHO * area * G * LENGTH**2
    assert result.strength.least_safety_factor == pytest.approx(YIELD / (moment * 0.03 / second), rel=1e-6)
    # A cantilever with its own mass and one at its end: 33/140 of the beam's counts with it (Rayleigh), to 1 or 2 %.
    tip = LOAD + 33.0 / 140.0 * RHO * area * LENGTH
    assert result.frequency is not None
    assert result.frequency.value == pytest.approx(
        math.sqrt(3.0 * E * second / LENGTH**3 / tip) / 2.0 / math.pi, rel=5e-3
    )


def test_its_best_section_is_that_of_a_grid_of_sizes(tmp_path: Path) -> None:
    _file(tmp_path)
    problem = tmp_path / "problem.yaml"
    limits = "mass: '<= 12 kg', section_size: [30 mm, 100 mm], thickness: [2 mm, 6 mm], wall_slenderness: off"
    problem.write_text(f"arm: arm.yaml\nsubject_to: {{{limits}}}\nchoose: {{section: [tube]}}\n")
    result = lw.optimize(problem)
    best = math.inf
    for diameter, wall in itertools.product(np.linspace(0.03, 0.1, 141), np.linspace(0.002, 0.006, 161)):
        area, second = _tube(float(diameter), float(wall))
        if RHO * area * LENGTH <= 12.0:
            best = min(best, max(_sag(h, area, second) for h in (LEAST, LENGTH)))
    assert result.after.max_error_mm <= 1e3 * best * (1.0 + 1e-6)
    assert result.after.max_error_mm >= 1e3 * best * 0.99, "between the grid's points there is little to gain"


def test_a_file_is_read_back_and_what_cannot_run_out_is_refused(tmp_path: Path) -> None:
    file = _file(tmp_path)
    arm = read_arm(file)
    (tmp_path / "back.yaml").write_text(arm_to_yaml(arm))
    assert read_arm(tmp_path / "back.yaml") == arm
    text = file.read_text()
    for old, new, said in (
        ("type: prismatic, range: [300 mm, 1500 mm]", "range: [0 deg, 9 deg]", "needs a slide, and joint 1 turns"),
        ("over: q1", "over: q2", "names the slide that carries the link, here q1"),
        ("1500 mm]", "1600 mm]", "slide 1 runs out from 300 mm to 1600 mm, but its boom is 1500 mm"),
        ("{length", "{direction: [0, 1, 0], length", "slides along itself"),
    ):
        file.write_text(text.replace(old, new))
        with pytest.raises(lw.InputError, match=said):
            read_arm(file)
    file.write_text(text)
    for limit in ("link_length: [200 mm, 700 mm]", "taper: [0.4, 1]"):
        (tmp_path / "p.yaml").write_text(f"arm: arm.yaml\nsubject_to: {{{limit}}}\n")
        with pytest.raises(lw.InputError, match="bends_over"):
            lw.read_problem(tmp_path / "p.yaml")
    with pytest.raises(lw.InputError, match="runs out of a sleeve"):
        lw.export_arm(file, to="urdf")
