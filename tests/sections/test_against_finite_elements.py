"""J and shear areas against an independent finite element solution, over random dimensions in the valid
range."""

from __future__ import annotations

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.sections import (
    SHAPES,
    Angle,
    Channel,
    Circle,
    ISection,
    Octagon,
    Polygon,
    Rectangle,
    RectangularTube,
    Section,
    Triangle,
    TriangularTube,
    TSection,
    Tube,
)
from linkwright.core.sections.contract import drawn
from tests.costs import slow_but

_SPEC = importlib.util.spec_from_file_location("section_reference", Path(__file__).with_name("reference.py"))
assert _SPEC is not None
assert _SPEC.loader is not None
_MODULE = importlib.util.module_from_spec(_SPEC)
sys.modules[_SPEC.name] = _MODULE
_SPEC.loader.exec_module(_MODULE)
reference = _MODULE.reference

POISSON = (0.0, 0.3, 0.45)
EACH_BUILD = ("tube", "rectangular_tube", "channel", "t_section")
CURVED = 60
"""An outline of so many corners stands for a curve, inside which its chords lie."""


def cases() -> list[object]:
    """A shape and a Poisson's ratio, with sections of random dimensions; all are slow but the first ratio of a few
    hollow and flanged shapes."""
    marked: list[object] = []
    for name, kind in SHAPES.items():
        if not kind.variables:
            continue
        random = np.random.default_rng([2024, *name.encode()])
        for number, nu in enumerate(POISSON):
            marks = () if name in EACH_BUILD and not number else pytest.mark.slow
            section = drawn(kind, random, walls=(0.04, 0.5), spread=3.0)
            marked.append(pytest.param(section, nu, marks=marks, id=f"{name}-{nu}"))
    return marked


@pytest.mark.parametrize(("section", "nu"), cases())
def test_every_shape_of_the_list(section: Section, nu: float) -> None:
    expected, result = reference(section, nu), section.properties(nu)
    curved = max(len(loop) for loop in section.outline()) > CURVED
    assert result.area == pytest.approx(expected.area, rel=2e-3 if curved else 1e-6)
    assert result.second_moment_y == pytest.approx(expected.second_moment_y, rel=4e-3 if curved else 1e-6)
    assert result.second_moment_z == pytest.approx(expected.second_moment_z, rel=4e-3 if curved else 1e-6)
    assert result.torsion_constant == pytest.approx(expected.torsion_constant, rel=0.012)
    assert result.shear_area_y == pytest.approx(expected.shear_area_y, rel=0.012)
    assert result.shear_area_z == pytest.approx(expected.shear_area_z, rel=0.012)


@pytest.mark.parametrize(
    "section",
    [
        RectangularTube(0.05, 0.1, 0.004, corner_radius=0.008),
        pytest.param(RectangularTube(0.1, 0.1, 0.008, corner_radius=0.02), marks=pytest.mark.slow),
        pytest.param(ISection(0.046, 0.08, 0.0052, 0.0038, root_radius=0.005), marks=pytest.mark.slow),
        pytest.param(ISection(0.1, 0.096, 0.008, 0.005, root_radius=0.012), marks=pytest.mark.slow),
    ],
    ids=["RHS", "SHS", "IPE80", "HEA100"],
)
def test_rounded_corners_and_root_fillets(section: Section) -> None:
    # Chords stand for the arcs of the outline: eight of them leave up to 0.3 % of I.
    expected, result = reference(section, 0.3, 1500), section.properties(0.3)
    assert result.area == pytest.approx(expected.area, rel=4e-3)
    assert result.second_moment_y == pytest.approx(expected.second_moment_y, rel=4e-3)
    assert result.second_moment_z == pytest.approx(expected.second_moment_z, rel=4e-3)
    assert result.torsion_constant == pytest.approx(expected.torsion_constant, rel=0.014)
    assert result.shear_area_y == pytest.approx(expected.shear_area_y, rel=0.011)
    assert result.shear_area_z == pytest.approx(expected.shear_area_z, rel=0.011)


ANGLE = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.02), (0.015, 0.02), (0.015, 0.08), (0.0, 0.08))
CHANNEL = (
    (0, 0),
    (0.06, 0),
    (0.06, 0.008),
    (0.006, 0.008),
    (0.006, 0.092),
    (0.05, 0.092),
    (0.05, 0.1),
    (0, 0.1),
)
HEXAGON = tuple((0.05 * math.cos(k * math.pi / 3), 0.05 * math.sin(k * math.pi / 3)) for k in range(6))
HOLE = ((-0.02, -0.01), (0.01, -0.015), (0.0, 0.02))


@pytest.mark.parametrize("nu", slow_but([0.0, 0.45], 0.45))
@pytest.mark.parametrize(
    "section",
    [
        *(pytest.param(Polygon(outline), marks=pytest.mark.slow) for outline in (ANGLE, CHANNEL, HEXAGON)),
        Polygon(HEXAGON, (HOLE,)),
    ],
    ids=["L", "C", "6", "6o"],
)
def test_polygons(section: Polygon, nu: float) -> None:
    expected, result = reference(section, nu, 2500), section.properties(nu)
    assert result.area == pytest.approx(expected.area, rel=1e-9)
    assert result.second_moment_y == pytest.approx(expected.second_moment_y, rel=1e-9)
    assert result.product_moment_yz == pytest.approx(
        expected.product_moment_yz, rel=1e-9, abs=1e-9 * expected.second_moment_y
    )
    # Finite elements are too stiff near re-entrant corners: what differs here is mostly theirs.
    assert result.torsion_constant == pytest.approx(expected.torsion_constant, rel=5e-3)
    assert result.shear_area_y == pytest.approx(expected.shear_area_y, rel=5e-3)
    assert result.shear_area_z == pytest.approx(expected.shear_area_z, rel=5e-3)


OPEN = [
    Channel(0.05, 0.08, 0.006, 0.004),
    Channel(0.03, 0.1, 0.012, 0.004),
    TSection(0.06, 0.08, 0.006, 0.005),
    Angle(0.06, 0.09, 0.006),
    ISection(0.06, 0.08, 0.006, 0.005),
    ISection(
        height=0.08,
        web_thickness=0.004,
        top_flange_width=0.06,
        bottom_flange_width=0.04,
        top_flange_thickness=0.006,
        bottom_flange_thickness=0.005,
    ),
    Triangle(0.04, 0.09),
    TriangularTube(0.06, 0.08, 0.004),
    Polygon(CHANNEL),
    Polygon(ANGLE),
]


@pytest.mark.parametrize("section", slow_but(OPEN, OPEN[0], OPEN[8]), ids=lambda section: section.shape)
def test_shear_centres_and_warping_constants(section: Section) -> None:
    expected, result = reference(section, 0.3, 2500), section.properties(0.3)
    centre = tuple(float(value) for value in result.shear_centre)
    assert centre == pytest.approx(expected.shear_centre, abs=0.005 * float(result.height))
    if section.shape in ("triangle", "triangular_tube"):
        assert result.warping_constant == 0.0
        return
    # A T-section's walls warp across their thickness alone, as its closed form has it within 20 %.
    tolerance = 0.2 if section.shape == "t_section" else 0.015
    assert result.warping_constant == pytest.approx(expected.warping_constant, rel=tolerance)
    if section.shape == "t_section":
        assert result.warping_constant < 0.05 * float(
            Channel(0.06, 0.08, 0.006, 0.005).properties(0.3).warping_constant
        )


@pytest.mark.parametrize(
    "section", [Circle(0.1), Tube(0.1, 0.004), Rectangle(0.02, 0.05), RectangularTube(0.05, 0.1, 0.004), Octagon(0.1)]
)
def test_closed_and_solid_shapes_neither_twist_under_a_load_at_the_centroid_nor_warp(section: Section) -> None:
    result = section.properties(0.3)
    assert (*result.shear_centre, result.warping_constant) == (0.0, 0.0, 0.0)


def test_channel_by_the_textbook() -> None:
    """Thin walls: e = 3 b^2 t_f / (6 b t_f + h t_w) beyond the web's middle (Timoshenko, Strength of Materials II)."""
    b, h, t = 0.1, 0.2, 0.0005
    result = Channel(b + 0.5 * t, h + t, t, t).properties(0.3)
    beyond = -float(result.shear_centre_y) - float(result.centroid_y) + 0.5 * t
    assert beyond == pytest.approx(3.0 * b**2 / (6.0 * b + h), rel=5e-3)
    constant = b**3 * h**2 * t / 12.0 * (3.0 * b + 2.0 * h) / (6.0 * b + h)
    assert result.warping_constant == pytest.approx(constant, rel=0.02)
