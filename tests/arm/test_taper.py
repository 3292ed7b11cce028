"""Tapered links: against closed forms, against quadrature, and against the frame solver with many short members."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.taper import tapered_beam
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate, link_masses
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.limits.modes import first_modes
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.problem import read_problem
from linkwright.core.sections import SectionError, build
from linkwright.core.sections.taper import Tapered, build_tapered
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, load_yaml
from linkwright.results.figures_in_words import section_words
from tests import frame_solver
from tests.arm.builders import arm_of, elastic_motion

E, NU, RHO = 71e9, 0.33, 2700.0
G = E / (2.0 * (1.0 + NU))
MATERIAL = (
    "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 250 MPa, cost: 4 EUR/kg}"
)
CONE = "{shape: circle, diameter: [100 mm, 40 mm]}"
TUBE = "{shape: tube, diameter: [100 mm, 60 mm], thickness: 4 mm}"
BOX = "{shape: rectangular_tube, width: [60 mm, 80 mm], height: [90 mm, 50 mm], thickness: [5 mm, 3 mm]}"
STILL = "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\n"


def link(section: str, length: float = 0.8, range_: str = "[0 deg, 0 deg]") -> str:
    joint = f"{{type: revolute, range: {range_}}}"
    body = f"{{length: {1e3 * length:g} mm, section: {section}, material: {MATERIAL}}}"
    return f"  - joint: {joint}\n    link: {body}\n"


def arm(folder: Path, *sections: str, head: str = STILL, tail: str = ""):
    return arm_of(head + "chain:\n" + "".join(link(section) for section in sections) + tail, folder)


def motion(of, q=(0.0,)):
    return elastic_motion(of, solve(of, q, beams_of(of)))


def test_cone_under_a_force_at_its_end(tmp_path: Path) -> None:
    """F L^3/(3 E I_b) d_b/d_a: int s^2/d^4 = 1/(3 d_a d_b^3) for a diameter linear from d_b (held) to d_a (free)."""
    loaded = "payload: {force: [0 N, 100 N, 0 N]}\nleave_out: [shear_deformation]\n"
    result, turned = motion(arm(tmp_path, CONE, tail=loaded))
    inertia = math.pi * 0.1**4 / 64.0
    assert result[1] == pytest.approx(100.0 * 0.8**3 / (3.0 * E * inertia) * 0.1 / 0.04, rel=1e-9)
    # The slope by quadrature of M/EI, M = F s.
    slope, _ = quad(lambda s: 100.0 * s * 0.8**2 / (E * math.pi * (0.04 + 0.06 * s) ** 4 / 64.0), 0.0, 1.0)
    assert turned[2] == pytest.approx(slope, rel=1e-9)


def tube_at(x: float) -> tuple[float, float]:
    """Area and second moment of `TUBE` at a share of its length, from first principles."""
    outer = 0.1 - 0.04 * x
    inner = outer - 0.008
    return math.pi * (outer**2 - inner**2) / 4.0, math.pi * (outer**4 - inner**4) / 64.0


def test_tube_under_its_own_weight_and_a_moment(tmp_path: Path) -> None:
    """Every beam integral by scipy's quadrature, of the tube's own formulas."""
    tail = "payload: {moment: [0 N*m, 0 N*m, 12 N*m]}\nleave_out: [shear_deformation]\n"
    result, turned = motion(arm(tmp_path, TUBE, head="", tail=tail))
    length = 0.8

    def bending(x: float) -> float:
        own = quad(lambda xi: tube_at(xi)[0] * (xi - x), x, 1.0)[0] * RHO * 9.81 * length**2
        return (12.0 - own) / (E * tube_at(x)[1])

    slope = quad(bending, 0.0, 1.0)[0] * length
    deflection = quad(lambda x: bending(x) * (1.0 - x), 0.0, 1.0)[0] * length**2
    assert turned[2] == pytest.approx(slope, rel=1e-8)
    assert result[1] == pytest.approx(deflection, rel=1e-8)


def test_mass_centre_and_cost_are_those_of_the_frustum(tmp_path: Path) -> None:
    """V = pi L (d_b^2 + d_b d_a + d_a^2)/12; the base moment says where its centre is."""
    cone = arm(tmp_path, CONE, head="")
    volume = math.pi * 0.8 / 12.0 * (0.1**2 + 0.1 * 0.04 + 0.04**2)
    assert link_masses(beams_of(cone)) == (pytest.approx(volume * RHO, rel=1e-12),)
    centre = 0.8 / 4.0 * (0.1**2 + 2 * 0.1 * 0.04 + 3 * 0.04**2) / (0.1**2 + 0.1 * 0.04 + 0.04**2)
    state = solve(cone, (0.0,), beams_of(cone))
    assert state.links[0].base_moment[2] == pytest.approx(-volume * RHO * 9.81 * centre, rel=1e-12)
    assert evaluate(cone, Workspace()).cost == pytest.approx(4.0 * volume * RHO, rel=1e-12)


PIECES = 160


def framed(shear: bool = True, rho: float = RHO) -> tuple[frame_solver.Frame, int]:
    """Two tapered links at 20 and 75 degrees as short uniform members, each with the section at its middle."""
    ends = [np.zeros(3)]
    for angle in (math.radians(20.0), math.radians(75.0)):
        ends.append(ends[-1] + 0.8 * np.array([math.cos(angle), math.sin(angle), 0.0]))
    nodes, members = [ends[0]], []
    for number in range(2):  # TUBE and BOX
        along = (ends[number + 1] - ends[number]) / 0.8
        for piece in range(PIECES):
            middle = (piece + 0.5) / PIECES
            nodes.append(ends[number] + (ends[number + 1] - ends[number]) * (piece + 1) / PIECES)
            if number == 0:
                cut = build("tube", {"diameter": 0.1 - 0.04 * middle, "thickness": 0.004})
            else:
                sizes = {"width": 0.06 + 0.02 * middle, "height": 0.09 - 0.04 * middle}
                cut = build("rectangular_tube", {**sizes, "thickness": 0.005 - 0.002 * middle})
            result = cut.properties(NU)
            figures = (result.area, result.second_moment_y, result.second_moment_z, result.torsion_constant)
            shears = (result.shear_area_z, result.shear_area_y) if shear else (math.inf, math.inf)
            height = np.array([-along[1], along[0], 0.0])
            members.append(
                frame_solver.Member(len(nodes) - 2, len(nodes) - 1, height, E, G, *map(float, (*figures, *shears)), rho)
            )
    tip = len(nodes) - 1
    return (
        frame_solver.Frame(
            nodes=nodes,
            members=members,
            supports=[frame_solver.Support(0)],
            loads=[frame_solver.PointLoad(tip, (40.0, -60.0, 25.0), (3.0, -8.0, 5.0))],
            masses=[frame_solver.PointMass(tip, 2.0)],
            gravity=(2.0, -7.0, -6.0),
        ),
        tip,
    )


def test_two_links_in_space_as_the_frame_solver_says(tmp_path: Path) -> None:
    """Bending both ways, torsion, shear and axial strain under weight, payload, force and moment together."""
    head = "gravity: [2 m/s^2, -7 m/s^2, -6 m/s^2]\n"
    tail = "payload: {mass: 2 kg, force: [40 N, -60 N, 25 N], moment: [3 N*m, -8 N*m, 5 N*m]}\n"
    result, turned = motion(arm(tmp_path, TUBE, BOX, head=head, tail=tail), (math.radians(20.0), math.radians(55.0)))
    frame, tip = framed()
    expected = frame_solver.solve(frame)[tip]
    # Members of uniform section converge with the square of their length: (1/160)^2 is 4e-5.
    assert np.linalg.norm(result - expected[:3]) < 5e-5 * np.linalg.norm(expected[:3])
    assert np.linalg.norm(turned - expected[3:]) < 5e-5 * np.linalg.norm(expected[3:])


def test_the_compiled_model_says_the_same(tmp_path: Path) -> None:
    tail = "payload: {mass: 2 kg}\nleave_out: [joint_compliance]\n"
    whole = arm(tmp_path, TUBE, BOX, head="", tail=tail)
    q = np.array([[0.3, 0.9], [-1.0, 0.4]])
    vectors = error_model(whole).cases[0].arrays(q, beam_values(beams_of(whole))).vector
    for row, vector in zip(q, vectors, strict=True):
        assert vector == pytest.approx(motion(whole, tuple(row))[0], rel=1e-9, abs=1e-15)


def test_first_frequency_as_the_frame_solver_says(tmp_path: Path) -> None:
    tail = "payload: {mass: 2 kg}\n"
    whole = arm(tmp_path, TUBE, BOX, head="", tail=tail)
    q = np.array([[math.radians(20.0), math.radians(55.0)]])
    frequency = first_modes(whole, beams_of(whole), 2.0, q).frequency[0]
    frame, _ = framed()
    expected = frame_solver.frequencies(frame, rotary_inertia=False)
    # Four segments a link, with their masses by Simpson's rule; the solver also has modes out of the plane.
    assert min(abs(frequency / expected[:2] - 1.0)) < 3e-3


def test_a_long_cone_yields_where_it_is_half_as_thick_again_as_at_its_end(tmp_path: Path) -> None:
    """32 F x/(pi d^3) is greatest where d = 3/2 d_a: in the middle of the link, not at its joint."""
    thin = "{shape: circle, diameter: [100 mm, 20 mm]}"
    cone = arm(tmp_path, thin, tail="payload: {force: [0 N, 100 N, 0 N]}\n")
    at = 0.8 * (0.5 * 0.02) / 0.08
    greatest = 32.0 * 100.0 * at / (math.pi * 0.03**3)
    result = evaluate(cone, Workspace()).strength
    assert result.stress[0] == pytest.approx(greatest, rel=5e-3)
    assert result.stress[0] <= greatest * (1 + 1e-9)
    assert result.stress[0] > 1.5 * 32.0 * 100.0 * 0.8 / (math.pi * 0.1**3)


def test_stress_at_the_joint_is_that_of_the_loads_beyond(tmp_path: Path) -> None:
    """Own weight and force, at the root of a slightly tapered rod, where both are greatest."""
    rod = arm(tmp_path, "{shape: circle, diameter: [100 mm, 95 mm]}", head="", tail="payload: {mass: 3 kg}\n")
    state = solve(rod, (0.0,), beams_of(rod))
    moment = abs(state.links[0].base_moment[2])
    result = evaluate(rod, Workspace()).strength
    assert result.stress[0] == pytest.approx(32.0 * moment / (math.pi * 0.1**3), rel=1e-6)


def test_tapered_column_buckles_as_its_differential_equation_says(tmp_path: Path) -> None:
    """M'' = -P M/EI with M = 0 at the free end and M' = 0 at the joint, integrated numerically."""
    length = 0.8

    def miss(load: float) -> float:
        def slope(x: float, m: np.ndarray) -> list[float]:
            diameter = 0.04 + 0.06 * x / length
            return [m[1], -load * m[0] / (E * math.pi * diameter**4 / 64.0)]

        return float(solve_ivp(slope, (0.0, length), [0.0, 1.0], rtol=1e-10, atol=1e-12).y[1, -1])

    uniform = math.pi**2 * E * math.pi * 0.04**4 / 64.0 / (4.0 * length**2)
    critical = float(brentq(miss, uniform, 12.0 * uniform))
    pressed = arm(tmp_path, CONE, tail="payload: {force: [-1000 N, 0 N, 0 N]}\n")
    assert evaluate(pressed, Workspace()).strength.buckling[0] == pytest.approx(critical / 1000.0, rel=1e-6)


ALUMINIUM = load_catalogue(user=False).find("aluminium-6061-t6").at(293.15)


@settings(deadline=None, max_examples=25)
@given(st.floats(0.02, 0.2), st.floats(0.3, 2.0), st.floats(0.1, 3.0))
def test_hardly_tapered_is_uniform(diameter: float, ratio: float, length: float) -> None:
    """Every factor tends to one, and the two ends may be exchanged in what does not know them apart."""
    section = build_tapered("circle", {"diameter": (diameter, diameter * (1.0 + 1e-9))})
    assert isinstance(section, Tapered)
    taper = tapered_beam(length, section, ALUMINIUM).taper
    factors = [getattr(taper.height, name) for name in taper.height.__dataclass_fields__]
    factors += [2.0 * taper.balance, taper.axial_weight, taper.shear_height_weight, taper.column_height, *taper.density]
    assert factors == pytest.approx([1.0] * len(factors), rel=1e-7)
    one, other = (
        tapered_beam(length, build_tapered("circle", {"diameter": ends}), ALUMINIUM)  # type: ignore[arg-type]
        for ends in ((diameter, ratio * diameter * 1.01), (ratio * diameter * 1.01, diameter))
    )
    for name in ("mass_per_length", "axial_rigidity", "torsional_rigidity", "shear_rigidity_height"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-8)
    assert one.taper.balance + other.taper.balance == pytest.approx(1.0, rel=1e-9)


def test_the_pair_is_written_back(tmp_path: Path) -> None:
    tapered = arm(tmp_path, TUBE, BOX)
    text = arm_to_yaml(tapered)
    assert "{shape: tube, diameter: [100 mm, 60 mm], thickness: 4 mm}" in text
    assert arm_of(text, tmp_path).links == tapered.links
    assert section_words(tapered.links[0]) == "tube: diameter 100 to 60, thickness 4 mm"


def test_equal_ends_are_a_uniform_link(tmp_path: Path) -> None:
    same = arm(tmp_path, "{shape: circle, diameter: [80 mm, 80 mm]}")
    assert same.links[0].section == build("circle", {"diameter": 0.08})


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("{shape: tube, diameter: [100 mm, 60 mm, 40 mm], thickness: 4 mm}", "section.diameter: is one length, or two"),
        ("{shape: tube, diameter: [100 mm], thickness: 4 mm}", "section.diameter: is one length, or two"),
        ("{shape: tube, diameter: [100 mm, 6 mm], thickness: 4 mm}", "section.thickness"),
        ("{shape: tube, diameter: [100 mm, 60], thickness: 4 mm}", "section.diameter[2]: needs a unit"),
        ("{shape: angle, width: [100 mm, 60 mm], height: 50 mm, thickness: 4 mm}", "'angle' cannot be tapered"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path: Path, section: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        arm(tmp_path, section)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_shape_that_there_is_not() -> None:
    with pytest.raises(SectionError, match="did you mean 'tube'"):
        build_tapered("tub", {"diameter": (0.1, 0.05)})


def test_the_optimiser_says_that_no_taper_is_to_be_chosen(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text("chain:\n" + link(TUBE) + "payload: {mass: 2 kg}\n", encoding="utf-8")
    problem = tmp_path / "problem.yaml"
    text = "arm: arm.yaml\nminimize: max_error\nsubject_to: {mass: '<= 3 kg'}\n"
    problem.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="link 1 is tapered, and no taper is to be chosen"):
        read_problem(problem)
    problem.write_text(text + "choose: {section: [tube]}\n", encoding="utf-8")
    assert read_problem(problem).shapes == ("tube",)
    assert isinstance(load_yaml(problem), Mapping)
