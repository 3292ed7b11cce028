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
