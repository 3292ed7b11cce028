"""Links of open sections twist about their shear centres: against beams with seven degrees of freedom a node."""

from __future__ import annotations

import importlib.util
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_bvp

from linkwright.core.arm.bodies.warping import FREE, Warping, held_torsion, warping_of
from linkwright.core.arm.chain.beam import elastic_beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.similar_taper import similar_beam
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.taper import tapered_beam
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.limits.modes import first_frequencies
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.material import MaterialValues
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import build
from linkwright.core.sections.taper import Tapered
from tests.arm.builders import arm_of, elastic_motion

_SPEC = importlib.util.spec_from_file_location("seven_freedoms", Path(__file__).with_name("seven_freedoms.py"))
assert _SPEC is not None
assert _SPEC.loader is not None
_MODULE = importlib.util.module_from_spec(_SPEC)
sys.modules[_SPEC.name] = _MODULE
_SPEC.loader.exec_module(_MODULE)

ALUMINIUM = "{elastic_modulus: 68.9 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 276 MPa}"
CHANNEL = "{shape: channel, width: 50 mm, height: 80 mm, flange_thickness: 6 mm, web_thickness: 4 mm}"
SHAPES = {
    "channel": CHANNEL,
    "t_section": "{shape: t_section, width: 60 mm, height: 50 mm, flange_thickness: 5 mm, web_thickness: 5 mm}",
    "i_section": "{shape: i_section, width: 60 mm, height: 80 mm, flange_thickness: 5 mm, web_thickness: 4 mm}",
    "tube": "{shape: tube, diameter: 50 mm, thickness: 3 mm}",
}
NO_SHEAR = "leave_out: [shear_deformation]\n"


def chain(*sections: str, length: float = 500.0, turned: bool = False, tail: str = "", head: str = "") -> str:
    """Links of these sections; with `turned` each joint's axis stands across the one before."""
    lines: list[str] = [head + "chain:\n"]
    for number, section in enumerate(sections):
        axis = "[0, 1, 0]" if turned and number % 2 else "[0, 0, 1]"
        lines.append(f"  - joint: {{range: [-60 deg, 60 deg], axis: {axis}}}\n")
        lines.append(f"    link: {{length: {length:g} mm, section: {section}, material: {ALUMINIUM}}}\n")
    return "".join(lines) + "payload: {mass: 5 kg}\n" + tail


def rods_of(arm: Arm, q: list[float]) -> list[Any]:
    """The same links for the seven freedoms: rigidities by formula, not by the arm's beams."""
    rods: list[Any] = []
    for index, (link, frame) in enumerate(zip(arm.links, place(arm, q).links, strict=True)):
        assert link.section is not None
        assert link.material is not None
        found, material = link.section.properties(0.33), link.material.at(arm.temperature)
        young, shear = material.need("elastic_modulus"), material.need("shear_modulus")
        rods.append(
            _MODULE.Rod(
                length=link.length,
                along=np.array(frame.along, dtype=float),
                height=np.array(frame.height, dtype=float),
                width=np.array(frame.width, dtype=float),
                axial=young * found.area,
                bending_height=young * found.second_moment_y,
                bending_width=young * found.second_moment_z,
                torsion=shear * found.torsion_constant,
                warping=young * found.warping_constant,
                shear_centre=(float(found.shear_centre_z), float(found.shear_centre_y)),
                mass=material.need("density") * float(found.area),
                held=(True, index < arm.size - 1),
            )
        )
    return rods


@pytest.mark.parametrize(
    ("sections", "q", "turned"),
    [
        (("channel",), [0.3], False),
        (("channel", "channel"), [0.3, -0.9], False),
        (("channel", "t_section"), [0.2, 0.8], True),
        (("t_section", "channel", "tube"), [0.4, 0.7, -0.5], True),
        (("i_section", "i_section"), [0.1, 0.9], True),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, tuple) else "",
)
def test_the_tip_moves_and_turns_as_that_of_beams_with_seven_freedoms(
    sections: tuple[str, ...], q: list[float], turned: bool, tmp_path: Path
) -> None:
    arm = arm_of(chain(*(SHAPES[name] for name in sections), turned=turned, tail=NO_SHEAR), tmp_path)
    moved, rotated = elastic_motion(arm, solve(arm, q, beams_of(arm)))
    expected = _MODULE.frame(rods_of(arm, q)).moved(arm.gravity, 5.0)
    size = np.linalg.norm(expected[:3]), np.linalg.norm(expected[3:])
    assert moved == pytest.approx(expected[:3], abs=2e-3 * size[0])
    assert rotated == pytest.approx(expected[3:], abs=2e-3 * size[1])


@pytest.mark.parametrize("sections", [("i_section", "i_section"), ("channel", "channel")], ids=lambda value: value[0])
def test_frequencies_are_those_of_beams_with_seven_freedoms(sections: tuple[str, ...], tmp_path: Path) -> None:
    arm = arm_of(chain(*(SHAPES[name] for name in sections), turned=True, tail=NO_SHEAR), tmp_path)
    q = [0.1, 1.0]
    found = float(first_frequencies(arm, beams_of(arm), 5.0, np.array([q]))[0])
    # The project's links have four segments, with all compliance of torsion spread along them evenly.
    assert found == pytest.approx(_MODULE.frame(rods_of(arm, q)).first_frequency(5.0), rel=0.01)
    free = [
        replace(beam, torsional_rigidity=rod.torsion) for beam, rod in zip(beams_of(arm), rods_of(arm, q), strict=True)
    ]
    assert found > 1.05 * float(first_frequencies(arm, free, 5.0, np.array([q]))[0])


def test_a_channel_that_carries_its_load_at_its_centroid(tmp_path: Path) -> None:
    """Of a channel of 500 mm with its shear centre 36.0 mm off, the load alone twists 0.072 mm with warping held at the
    joint (0.110 mm in all), 0.146 mm with warping free (0.184 mm)."""
    arm = arm_of(chain(CHANNEL).replace(ALUMINIUM, "aluminium-6061-t6"), tmp_path)
    assert arm.links[0].section is not None
    assert arm.links[0].section.properties(0.33).shear_centre_y == pytest.approx(-36.0e-3, rel=2e-3)
    bent = evaluate(replace(arm, leave_out=frozenset({"torsion"})), Workspace()).worst.error
    assert bent == pytest.approx(0.0383e-3, rel=5e-3)

    def by_load_alone(beam: Any) -> float:
        state = solve(arm, [0.0], [replace(beam, torsion_by_weight=0.0)])
        return float(np.linalg.norm(elastic_motion(arm, state)[0]))

    (beam,) = beams_of(arm)
    assert by_load_alone(beam) == pytest.approx(0.110e-3, rel=0.015)
    (rod,) = rods_of(arm, [0.0])
    assert by_load_alone(replace(beam, torsional_rigidity=rod.torsion)) == pytest.approx(0.184e-3, rel=0.015)
    # Its own weight acts at its centroid too.
    whole = evaluate(arm, Workspace())
    assert whole.worst.error == pytest.approx(0.1155e-3, rel=5e-3)
    assert whole.worst.upper_bound is not None
    assert any("warping" in note for note in whole.notes)


@settings(deadline=None, max_examples=25)
@given(st.floats(0.25, 30.0), st.booleans(), st.floats(-2.0, 2.0))
def test_held_torsion_solves_the_equation_of_vlasov(a: float, far: bool, even: float) -> None:
    """G J v' - E C_w v''' = T + t (L - x), by a solver of boundary value problems: G J = L = 1, so C_w = 1 / a^2."""
    warping = Warping(at_joint=True, at_far_end=far)
    rigidity, by_weight = held_torsion(1.0, 1.0, 1.0 / a**2, warping)

    def slopes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.vstack([y[1], y[2], a**2 * (y[1] - 1.0 - even * (1.0 - x))])

    def ends(near: np.ndarray, there: np.ndarray) -> np.ndarray:
        return np.array([near[0], near[1], there[1] if far else there[2]])

    x = np.linspace(0.0, 1.0, 201)
    solved = solve_bvp(slopes, ends, x, np.zeros((3, len(x))), tol=1e-8, max_nodes=100_000)
    assert solved.success
    scale = (1.0 + abs(even)) / rigidity
    assert (1.0 + 0.5 * by_weight * even) / rigidity == pytest.approx(solved.y[0, -1], abs=3e-5 * scale)


def test_nothing_is_held_where_nothing_warps_or_ends_are_free() -> None:
    assert held_torsion(1.0, 5.0, 0.0, Warping(at_joint=True)) == (5.0, 1.0)
    assert held_torsion(1.0, 5.0, 2.0, FREE) == (5.0, 1.0)
    stiffer, by_weight = held_torsion(np.array([1.0, 1.0]), 5.0, np.array([2.0, 1e-9]), Warping(at_joint=True))
    assert stiffer[0] > 10.0
    assert stiffer[1] == pytest.approx(5.0, rel=1e-4)
    assert by_weight == pytest.approx([0.75, 1.0], abs=0.02)


def test_a_joint_holds_warping_and_a_tip_does_not(tmp_path: Path) -> None:
    arm = arm_of(chain(CHANNEL, CHANNEL), tmp_path)
    assert [warping_of(arm, link) for link in range(2)] == [Warping(True, True), Warping(True, False)]


def test_the_exact_motion_agrees_with_the_first_order(tmp_path: Path) -> None:
    """Links in pieces twist as whole ones: what is left is what first order leaves out."""
    whole = evaluate(arm_of(chain(CHANNEL), tmp_path), Workspace())
    assert whole.beyond.largest is not None
    assert whole.beyond.largest < 1e-3 * whole.worst.error


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.6])
def test_tapers_in_symbols_are_those_by_quadrature(ratio: float) -> None:
    values = {"width": 0.05, "height": 0.08, "flange_thickness": 0.006, "web_thickness": 0.004}
    near = build("channel", values)
    material = MaterialValues("", 0.0, elastic_modulus=7e10, shear_modulus=2.6e10, density=2700.0, poisson_ratio=0.33)
    by_quadrature = tapered_beam(0.5, Tapered(near, near.scaled(ratio)), material)
    in_symbols = similar_beam(elastic_beam(0.5, near.properties(0.33), material), math.log(ratio))
    for name in ("shear_centre_width", "torsional_rigidity", "torsion_by_weight"):
        assert float(getattr(in_symbols, name)) == pytest.approx(getattr(by_quadrature, name), rel=1e-8)
    assert float(in_symbols.taper.offset_square) == pytest.approx(by_quadrature.taper.offset_square, rel=1e-8)


def test_the_optimiser_counts_it_and_may_choose_an_angle(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(chain(CHANNEL))
    (tmp_path / "problem.yaml").write_text(
        "arm: arm.yaml\nminimize: max_error\nsubject_to: {mass: '<= 1 kg', section_size: [20 mm, 100 mm], "
        "thickness: [2 mm, 10 mm]}\nchoose: {section: [channel, angle, t_section]}\n"
    )
    result = optimise(read_problem(tmp_path / "problem.yaml"))
    shown = {candidate.shapes[0]: candidate for candidate in result.candidates}
    assert set(shown) == {"channel", "angle", "t_section"}
    # Loads in the plane of its web pass through a T-section's shear centre.
    assert result.after.arm.links[0].section.shape == "t_section"
    assert result.after.worst.error == pytest.approx(result.objective, rel=1e-4)
