"""Stress, buckling and the limits of linear theory against textbook beams."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures.strength import STRENGTHS, StrengthResult, strength_over
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import MissingProperty
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import build
from tests.arm.builders import arm_of, rod_lines

STEEL = load_catalogue(user=False).find("steel-s355")
DIAMETER, LENGTH = 0.05, 0.8
ROD = build("circle", {"diameter": DIAMETER})
AREA, MODULUS = math.pi / 4 * DIAMETER**2, math.pi / 32 * DIAMETER**3
INERTIA = math.pi / 64 * DIAMETER**4
WEIGHTLESS = (0.0, 0.0, 0.0)


def rod(gravity: tuple[float, float, float] = WEIGHTLESS, links: int = 1) -> Arm:
    return Arm("rod", (Joint(),) * links, (Link(LENGTH, section=ROD, material=STEEL),) * links, gravity=gravity)


def strength(arm: Arm, load: LoadCase, q: tuple[float, ...] = (0.0,)) -> StrengthResult:
    return strength_over(arm, (load,), np.array([q]), beam_values(beams_of(arm, (load,))))


def test_bending_stress_is_the_moment_over_the_section_modulus_at_the_root() -> None:
    result = strength(rod(), LoadCase(force=(0.0, -900.0, 0.0)))
    assert result.stress[0] == pytest.approx(900 * LENGTH / MODULUS, rel=1e-6)


def test_own_weight_bends_the_root() -> None:
    density = STEEL.need("density")
    moment = density * AREA * 9.81 * LENGTH**2 / 2
    assert strength(rod((0.0, -9.81, 0.0)), LoadCase()).stress[0] == pytest.approx(moment / MODULUS, rel=1e-5)


def test_torsion_counts_by_von_mises() -> None:
    """tau = T / W_t with W_t = pi d^3/16; sqrt(3) tau."""
    result = strength(rod(), LoadCase(moment=(500.0, 0.0, 0.0))).stress[0]
    assert result == pytest.approx(math.sqrt(3) * 500 / (math.pi / 16 * DIAMETER**3), rel=1e-6)


@pytest.mark.parametrize("force", [7e4, -7e4])
def test_axial_stress(force: float) -> None:
    assert strength(rod(), LoadCase(force=(force, 0.0, 0.0))).stress[0] == pytest.approx(7e4 / AREA, rel=1e-6)


def test_bending_compression_and_torsion_add_up() -> None:
    """sqrt((N/A + M/W)^2 + 3 (T/W_t)^2)."""
    result = strength(rod(), LoadCase(force=(-5e4, 300.0, 0.0), moment=(200.0, 0.0, 0.0))).stress[0]
    normal, shear = 5e4 / AREA + 300 * LENGTH / MODULUS, 200 / (2 * MODULUS)
    assert result == pytest.approx(math.hypot(normal, math.sqrt(3) * shear), rel=1e-6)


def test_bending_in_the_width_uses_the_widths_modulus() -> None:
    bar = build("rectangle", {"width": 0.02, "height": 0.06})
    arm = Arm("bar", (Joint(),), (Link(LENGTH, section=bar, material=STEEL),), gravity=WEIGHTLESS)
    height = strength(arm, LoadCase(force=(0.0, 100.0, 0.0))).stress[0]
    width = strength(arm, LoadCase(force=(0.0, 0.0, 100.0))).stress[0]
    assert height == pytest.approx(100 * LENGTH / (0.02 * 0.06**2 / 6), rel=1e-6)
    assert width == pytest.approx(100 * LENGTH / (0.06 * 0.02**2 / 6), rel=1e-6)


def test_safety_factor_is_yield_over_stress_of_the_worst_pose_and_case() -> None:
    arm = rod()
    cases = (LoadCase(force=(0.0, -900.0, 0.0)), LoadCase(force=(0.0, -300.0, 0.0)))
    q = np.linspace(-1.5, 1.5, 31)[:, None]
    result = strength_over(arm, cases, q, beam_values(beams_of(arm)))
    expected = STEEL.need("yield_strength") / (900 * LENGTH / MODULUS)
    assert result.least_safety_factor == pytest.approx(expected, rel=1e-6)
    assert result.poses[0][1] == 0
    assert result.poses[0][0][0] == pytest.approx(0.0, abs=1e-9)


def test_a_material_without_a_yield_strength_has_no_safety_factor(tmp_path: Path) -> None:
    result = evaluate(arm_of(rod_lines([400]), tmp_path))
    assert result.strength.least_safety_factor is None
    assert "safety_factor" in result.unknown


def test_buckling_is_eulers_load_of_a_column_fixed_at_its_foot() -> None:
    """P = pi^2 E I / (2 L)^2 (Gere & Goodno, columns fixed at the base and free at the top)."""
    euler = math.pi**2 * STEEL.need("elastic_modulus") * INERTIA / (4 * LENGTH**2)
    pressed = strength(rod(), LoadCase(force=(-2e4, 0.0, 0.0)))
    assert pressed.buckling[0] == pytest.approx(euler / 2e4, rel=1e-9)
    assert strength(rod(), LoadCase(force=(2e4, 0.0, 0.0))).least_buckling is None


def test_own_weight_along_a_column_buckles_it_later_than_the_same_at_its_end() -> None:
    """(q L)_cr = 7.837 E I / L^2 (A. G. Greenhill 1881); with a load at the end the straight line between both."""
    weight = STEEL.need("density") * AREA * 9.81 * LENGTH
    alone = 7.837 * STEEL.need("elastic_modulus") * INERTIA / LENGTH**2
    euler = math.pi**2 * STEEL.need("elastic_modulus") * INERTIA / (4 * LENGTH**2)
    standing = rod((-9.81, 0.0, 0.0))
    assert strength(standing, LoadCase()).buckling[0] == pytest.approx(alone / weight, rel=1e-6)
    both = strength(standing, LoadCase(force=(-2e4, 0.0, 0.0))).buckling[0]
    assert both == pytest.approx(1.0 / (2e4 / euler + weight / alone), rel=1e-6)


def stubby(section: dict[str, float], shape: str, force: tuple[float, float, float]) -> float:
    """The stress of a link of 1 mm, so short that nothing bends."""
    link = Link(1e-3, section=build(shape, section), material=STEEL)
    return strength(Arm("stub", (Joint(),), (link,), gravity=WEIGHTLESS), LoadCase(force=force)).stress[0]


@pytest.mark.parametrize(
    ("shape", "section", "greatest"),
    [
        # Over V / A: 4/3 of a circle, 2 of a thin tube, 3/2 of a rectangle, 3/2 of a triangle (Gere & Goodno).
        ("circle", {"diameter": 0.05}, 4.0 / 3.0),
        ("ellipse", {"width": 0.03, "height": 0.05}, 4.0 / 3.0),
        ("tube", {"diameter": 0.08, "thickness": 0.0002}, 2.0),
        ("rectangle", {"width": 0.03, "height": 0.05}, 1.5),
        ("triangle", {"width": 0.03, "height": 0.05}, 1.5),
    ],
)
def test_shear_on_the_neutral_axis(shape: str, section: dict[str, float], greatest: float) -> None:
    area = float(build(shape, section).properties(0.3).area)
    stress = stubby(section, shape, (0.0, -1e4, 0.0))
    # What bends over a millimetre adds to a thousandth.
    assert stress == pytest.approx(math.sqrt(3.0) * greatest * 1e4 / area, rel=5e-3)


def test_bending_and_shear_meet_between_web_and_flange() -> None:
    """sqrt(sigma^2 + 3 tau^2) at the junction of an I-section, sigma = M z / I, tau = V Q / (I t_w), by hand."""
    b, h, t, w = 0.06, 0.12, 0.012, 0.004
    second = (b * h**3 - (b - w) * (h - 2 * t) ** 3) / 12
    force, length = 5e4, 0.05
    sigma = force * length * (h / 2 - t) / second
    tau = force * b * t * (h - t) / 2 / (second * w)
    section = build("i_section", {"width": b, "height": h, "flange_thickness": t, "web_thickness": w})
    link = Link(length, section=section, material=STEEL)
    result = strength(Arm("stub", (Joint(),), (link,), gravity=WEIGHTLESS), LoadCase(force=(0.0, -force, 0.0)))
    in_web = force * (b * t * (h - t) / 2 + w * (h / 2 - t) ** 2 / 2) / (second * w)
    assert result.stress[0] == pytest.approx(max(math.sqrt(sigma**2 + 3 * tau**2), math.sqrt(3.0) * in_web), rel=1e-6)


def test_a_tube_that_is_short_is_sized_for_shear(tmp_path: Path) -> None:
    """60 mm and 2 t with a factor of 2: bending alone leaves a thin tube of 1.36 in shear."""
    material = "{elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3, yield_strength: 240 MPa}"
    section = "{shape: tube, diameter: 80 mm, thickness: 3 mm}"
    link = f"{{length: 60 mm, section: {section}, material: {material}}}"
    (tmp_path / "arm.yaml").write_text(
        f"chain:\n  - joint: {{range: [0 deg, 0 deg]}}\n    link: {link}\npayload: {{mass: 2000 kg}}\n"
    )
    (tmp_path / "problem.yaml").write_text(
        "arm: arm.yaml\nminimize: mass\nsubject_to: {safety_factor: '>= 2', section_size: [20 mm, 120 mm], "
        "thickness: [1 mm, 10 mm]}\n"
    )
    after = optimise(read_problem(tmp_path / "problem.yaml")).after
    (tube,) = (link.section for link in after.arm.links)
    assert tube is not None
    radius, wall = 0.5 * float(tube.diameter), float(tube.thickness)
    outer, inner = radius, radius - wall
    shear = 2000 * 9.81 * 4 / 3 * (outer**2 + outer * inner + inner**2) / (outer**2 + inner**2)
    shear /= math.pi * (outer**2 - inner**2)
    assert 240e6 / (math.sqrt(3.0) * shear) >= 2.0 * (1.0 - 1e-3)
    assert after.strength.least_safety_factor == pytest.approx(2.0, rel=1e-3)


def test_the_weaker_way_buckles() -> None:
    bar = build("rectangle", {"width": 0.02, "height": 0.06})
    arm = Arm("bar", (Joint(),), (Link(LENGTH, section=bar, material=STEEL),), gravity=WEIGHTLESS)
    euler = math.pi**2 * STEEL.need("elastic_modulus") * 0.06 * 0.02**3 / 12 / (4 * LENGTH**2)
    assert strength(arm, LoadCase(force=(-2e3, 0.0, 0.0))).buckling[0] == pytest.approx(euler / 2e3, rel=1e-9)


def test_warnings_name_the_link_that_yields_or_buckles() -> None:
    lines = STRENGTHS.warnings(rod(), strength(rod(), LoadCase(force=(-2e6, 0.0, 0.0))))
    assert any("link 1 yields" in line for line in lines)
    assert any("link 1 buckles" in line for line in lines)
    assert STRENGTHS.warnings(rod(), strength(rod(), LoadCase(force=(0.0, -10.0, 0.0)))) == []


def test_the_papers_rubber_arm_is_said_to_bend_beyond_a_tenth(tmp_path: Path) -> None:
    """E = 8 MPa and 1300 kg/m^3 (the paper's Table II); the first link's own cantilever deflection by hand: 11 %."""
    rubber = "{elastic_modulus: 8 MPa, poisson_ratio: 0.49, density: 1300 kg/m^3}"
    weight = 1300 * 9.81 * math.pi / 4 * 0.1**2  # N/m
    beyond = 0.84
    bending = weight * (beyond * 0.4**3 / 3 + beyond**2 / 2 * 0.4**2 / 2 + 0.4**4 / 8) / (8e6 * math.pi / 64 * 0.1**4)
    result = evaluate(arm_of(rod_lines([400, 420, 420], material=rubber), tmp_path))
    assert result.strength.deflection[0] == pytest.approx(bending / 0.4, rel=1e-3)
    assert bending / 0.4 > 0.1
    assert any("link 1 bends" in line and "tenth" in line for line in result.warnings)
    stiff = evaluate(arm_of(rod_lines([400, 420, 420]), tmp_path))
    assert stiff.warnings == ()


def test_a_links_share_of_deflection_is_its_own_bending() -> None:
    """F L^3/(3 E I) over L."""
    share = 900 * LENGTH**2 / (3 * STEEL.need("elastic_modulus") * INERTIA)
    assert strength(rod(), LoadCase(force=(0.0, -900.0, 0.0))).deflection[0] == pytest.approx(share, rel=1e-6)


def test_a_link_without_length_neither_bends_nor_breaks_the_others() -> None:
    """A wrist's link in Denavit-Hartenberg form may have a = d = 0."""
    links = tuple(Link(length, section=ROD, material=STEEL) for length in (0.4, 0.0, 0.3))
    result = evaluate(Arm("wrist", (Joint(),) * 3, links))
    assert all(math.isfinite(share) for share in result.strength.deflection)
    assert result.warnings == ()


def test_a_side_force_on_a_planar_arm_asks_for_the_shear_modulus(tmp_path: Path) -> None:
    """Without one the link's torsion cannot be known; an infinite error is no answer."""
    text = rod_lines([400, 300], material="{elastic_modulus: 71 GPa, density: 2700 kg/m^3}")
    arm = arm_of(text + "leave_out: [shear_deformation]\n", tmp_path)
    assert math.isfinite(evaluate(arm).max_error)
    with pytest.raises(MissingProperty, match="shear_modulus"):
        evaluate(arm, load_cases=[LoadCase(force=(0.0, 0.0, 50.0))])
