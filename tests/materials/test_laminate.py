"""Walls of plies: against published constants, against closed forms, and in an arm that bends and twists."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.materials.catalogue import Catalogue, load_catalogue, load_layer
from linkwright.core.materials.walls import Ply, wall_of
from linkwright.core.units.quantities import InputError

T300 = Ply(along=181e9, across=10.3e9, shear=7.17e9, poisson_ratio=0.28, expansion_along=2e-8, expansion_across=22.5e-6)
"""T300/5208: S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, Technomic, 1980."""
LINK = "link: {{length: 500 mm, section: {{shape: tube, diameter: 80 mm, thickness: 2 mm}}, material: {}}}"
PLY = "{elastic_modulus: 181 GPa, transverse_modulus: 10.3 GPa, shear_modulus: 7.17 GPa, poisson_ratio: 0.28, isotropic: false, density: 1600 kg/m^3}"  # noqa: E501 - as an arm file has it


def degrees(*angles: float) -> list[float]:
    return [math.radians(angle) for angle in angles]


def arm_of(folder: Path, material: str):
    path = folder / "arm.yaml"
    link = LINK.format(material)
    path.write_text(f"chain:\n  - joint: {{range: [-90 deg, 90 deg]}}\n    {link}\n", encoding="utf-8")
    return read_arm(path)


def test_quasi_isotropic_constants_as_published():
    """Tsai and Hahn: E 69.68 GPa, nu 0.296, G 26.88 GPa for T300/5208, the same in all directions."""
    for angles in ((0, 45, -45, 90), (0, 60, -60)):
        wall = wall_of(T300, degrees(*angles))
        assert wall.along == pytest.approx(69.68e9, rel=2e-4)
        assert wall.around == pytest.approx(wall.along, rel=1e-9)
        assert wall.shear == pytest.approx(26.88e9, rel=3e-4)
        assert wall.poisson_ratio == pytest.approx(0.296, abs=5e-4)


def test_plies_along_and_across_are_the_ply_itself():
    along, across = wall_of(T300, [0.0]), wall_of(T300, [0.5 * math.pi])
    assert (along.along, along.around, along.shear) == pytest.approx((181e9, 10.3e9, 7.17e9), rel=1e-9)
    assert (across.along, across.around, across.shear) == pytest.approx((10.3e9, 181e9, 7.17e9), rel=1e-9)
    assert across.poisson_ratio == pytest.approx(0.28 * 10.3 / 181.0, rel=1e-9)
    assert (along.expansion_along, across.expansion_along) == pytest.approx((2e-8, 22.5e-6), rel=1e-9)


@given(st.floats(1.0, 89.0))
def test_wound_tube_by_invariants(angle: float):
    """At plus and minus an angle: Q11, Q12, Q22 and Q66 by Tsai and Pagano's invariants, which turn no matrix."""
    q = T300.stiffness
    u1 = (3 * q[0, 0] + 3 * q[1, 1] + 2 * q[0, 1] + 4 * q[2, 2]) / 8
    u2, u3 = (q[0, 0] - q[1, 1]) / 2, (q[0, 0] + q[1, 1] - 2 * q[0, 1] - 4 * q[2, 2]) / 8
    u4, u5 = (q[0, 0] + q[1, 1] + 6 * q[0, 1] - 4 * q[2, 2]) / 8, (q[0, 0] + q[1, 1] - 2 * q[0, 1] + 4 * q[2, 2]) / 8
    twice, four = math.cos(math.radians(2 * angle)), math.cos(math.radians(4 * angle))
    a11, a22 = u1 + u2 * twice + u3 * four, u1 - u2 * twice + u3 * four
    a12, a66 = u4 - u3 * four, u5 - u3 * four
    wall = wall_of(T300, degrees(angle, -angle))
    assert wall.along == pytest.approx(a11 - a12**2 / a22, rel=1e-9)
    assert wall.around == pytest.approx(a22 - a12**2 / a11, rel=1e-9)
    assert wall.shear == pytest.approx(a66, rel=1e-9)
    assert wall.poisson_ratio == pytest.approx(a12 / a22, rel=1e-9)


def test_shipped_quasi_isotropic_laminates_are_those_of_their_plies():
    shipped = load_catalogue(user=False)
    for kind in ("cfrp", "gfrp"):
        made, kept = shipped.find(f"{kind}-unidirectional"), shipped.find(f"{kind}-quasi-isotropic")
        ply = Ply(
            *(made.need(name) for name in ("elastic_modulus", "transverse_modulus", "shear_modulus", "poisson_ratio")),
            made.need("thermal_expansion"),
            made.need("transverse_expansion"),
        )
        wall = wall_of(ply, degrees(0, 45, 90, -45))
        assert wall.along == pytest.approx(kept.need("elastic_modulus"), rel=1e-3)
        assert wall.expansion_along == pytest.approx(kept.need("thermal_expansion"), rel=1e-3)


def test_a_tube_bends_and_twists_each_by_its_own_modulus(tmp_path: Path):
    """A wound tube at 45 degrees twists little and bends much; one of plies along it the other way round. Rigidities
    by hand of a circular tube: I of its second moment, twice that in torsion."""
    second = math.pi / 64 * (0.08**4 - 0.076**4)
    for angles in ((45, -45), (0, 0), (0, 45, -45, 0)):
        words = ", ".join(f"{angle} deg" for angle in angles)
        arm = arm_of(tmp_path, f"{{laminate: {{ply: {PLY}, angles: [{words}]}}}}")
        wall, (beam,) = wall_of(T300, degrees(*angles)), beams_of(arm)
        assert beam.flexural_rigidity_height == pytest.approx(wall.along * second, rel=1e-6)
        assert beam.torsional_rigidity == pytest.approx(wall.shear * 2 * second, rel=1e-6)
        (tmp_path / "again.yaml").write_text(arm_to_yaml(arm), encoding="utf-8")
        assert beams_of(read_arm(tmp_path / "again.yaml"))[0] == beam
    along, wound = (wall_of(T300, degrees(*angles)) for angles in ((0,), (45, -45)))
    assert along.along > 6 * wound.along
    assert wound.shear > 6 * along.shear


def test_thicknesses_weigh_plies(tmp_path: Path):
    thick = f"{{laminate: {{ply: {PLY}, angles: [0 deg, 90 deg], thicknesses: [0.9 mm, 0.3 mm]}}}}"
    four = wall_of(T300, degrees(0, 0, 0, 90))
    material = arm_of(tmp_path, thick).links[0].material
    assert material is not None
    assert material.need("elastic_modulus") == pytest.approx(four.along, rel=1e-9)
    assert material.need("transverse_modulus") == pytest.approx(four.around, rel=1e-9)


def test_thin_walls_buckle_by_both_moduli(tmp_path: Path):
    """Jones' plate: for an isotropic one (nu 0.3) the modulus itself; for plies along a link far less than theirs."""
    same = "{elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3, yield_strength: 200 MPa"
    plain = FIGURES["wall_slenderness"].of_links(arm_of(tmp_path, same + "}"))
    both = f"{same}, isotropic: false, transverse_modulus: 70 GPa, shear_modulus: {70 / 2.6!r} GPa}}"
    assert FIGURES["wall_slenderness"].of_links(arm_of(tmp_path, both)) == pytest.approx(plain, rel=1e-9)
    values = load_catalogue(user=False).find("cfrp-unidirectional").at()
    nu = 0.3 * 0.3 * 10 / 135
    plate = (math.sqrt(135 * 10) + 0.3 * 10) / (1 - nu) + 2 * 5
    assert values.wall_modulus == pytest.approx(0.455 * plate * 1e9, rel=1e-9)
    assert values.wall_modulus < 0.2 * 135e9


@pytest.mark.parametrize(
    ("laminate", "message"),
    [
        (f"{{ply: {PLY}, angles: [30 deg]}}", "laminate.angles: are not balanced"),
        (f"{{ply: {PLY}, angles: []}}", "laminate.angles: must be one for each ply"),
        (f"{{ply: {PLY}, angles: [0 deg], thicknesses: [-1 mm]}}", "laminate.thicknesses"),
        (f"{{ply: {PLY}, angles: [30]}}", "laminate.angles.*needs a unit"),
        ("{ply: steel-s355, angles: [0 deg]}", "steel-s355 has no transverse_modulus"),
        ("{ply: no-such, angles: [0 deg]}", "there is no material 'no-such'"),
        ("{ply: cfrp-unidirectional, angle: [0 deg]}", "did you mean"),
    ],
)
def test_laminates_that_are_none(tmp_path: Path, laminate: str, message: str):
    with pytest.raises(InputError, match=message) as caught:
        arm_of(tmp_path, f"{{laminate: {laminate}}}")
    assert "\n" not in str(caught.value)


def test_what_follows_is_not_given_as_well(tmp_path: Path):
    with pytest.raises(InputError, match="shear_modulus: follows from the laminate"):
        arm_of(tmp_path, f"{{laminate: {{ply: {PLY}, angles: [0 deg]}}, shear_modulus: 5 GPa}}")
    with pytest.raises(InputError, match="write isotropic: false"):
        arm_of(tmp_path, "{elastic_modulus: 70 GPa, transverse_modulus: 7 GPa}")


def test_a_laminate_of_ones_own_catalogue(tmp_path: Path):
    path = tmp_path / "own.yaml"
    path.write_text(
        "format_version: 1\nreferences: {own: winding plan 3}\nmaterials:\n"
        "  wound: {source: own, laminate: {ply: cfrp-unidirectional, angles: [30 deg, -30 deg]}}\n",
        encoding="utf-8",
    )
    wound = Catalogue((load_layer(path),)).find("wound")
    assert wound.properties["elastic_modulus"].source == "own"
    assert wound.need("density") == 1600.0
    assert not wound.has("yield_strength")
    assert wound.need("shear_modulus") > 4 * 5e9
    assert np.isfinite(wound.need("cost"))
