"""Properties that hold for every section."""

from __future__ import annotations

import dataclasses
import math
import warnings

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.sections import (
    SHAPES,
    Circle,
    Ellipse,
    FreeFlangeISection,
    ISection,
    Polygon,
    Rectangle,
    RectangularTube,
    Section,
    Tube,
)
from linkwright.core.sections.contract import drawn
from linkwright.core.sections.formulas.plastic import polygon_modulus
from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import POWERS

sizes = st.floats(0.02, 0.3)
ratios = st.floats(0.35, 2.8)
walls = st.floats(0.011, 0.24)
poisson = st.floats(0.0, 0.49)
CHOSEN = [kind for kind in SHAPES.values() if kind.variables] + [FreeFlangeISection]
WALLS = (0.022, 0.48)
"""Of what leaves nothing open."""


@st.composite
def sections(draw: st.DrawFn) -> Section:
    """A section of any shape, registered ones of later days among them."""
    kind = draw(st.sampled_from(CHOSEN))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    if kind is FreeFlangeISection:
        width, height, flange, web = drawn(ISection, random, walls=WALLS, spread=2.8).variable_values()
        return kind.from_variables((width, 0.9 * width, height, flange, 0.8 * flange, 0.9 * web))
    return drawn(kind, random, walls=WALLS, spread=2.8)


@given(sections(), st.floats(0.1, 10.0), poisson)
def test_scaling(section: Section, factor: float, nu: float) -> None:
    before, after = section.properties(nu), section.scaled(factor).properties(nu)
    for name, order in POWERS.items():
        assert getattr(after, name) == pytest.approx(getattr(before, name) * factor**order, rel=1e-9)


@settings(deadline=None, max_examples=60)
@given(sections(), poisson)
def test_symbols_and_arrays_agree_with_floats(section: Section, nu: float) -> None:
    values = section.variable_values()
    expected = section.properties(nu)
    arrays = type(section).from_variables([np.array([v, 1.1 * v]) for v in values]).properties(nu)
    with warnings.catch_warnings():
        # CasADi warns when a NumPy function meets a symbol.
        warnings.simplefilter("error", FutureWarning)
        for kind in (ca.SX, ca.MX):
            symbols = kind.sym("x", len(values))
            built = type(section).from_variables(ca.vertsplit(symbols))
            properties = built.properties(nu)
            outputs = [getattr(properties, name) for name in POWERS]
            result = ca.Function("f", [symbols], [ca.vertcat(*outputs)])(ca.DM(values)).full().ravel()
            for name, value in zip(POWERS, result, strict=True):
                assert value == pytest.approx(getattr(expected, name), rel=1e-8)
    for name in POWERS:
        assert np.broadcast_to(getattr(arrays, name), 2)[0] == pytest.approx(getattr(expected, name), rel=1e-8)


@given(sections(), poisson)
def test_bounds_of_physics(section: Section, nu: float) -> None:
    p = section.properties(nu)
    # Saint-Venant: no section is stiffer in torsion than the polar moment; shear areas are below A.
    assert 0.0 < p.torsion_constant <= (p.second_moment_y + p.second_moment_z) * (1 + 1e-6)
    assert 0.0 < p.shear_area_y < p.area
    assert 0.0 < p.shear_area_z < p.area
    assert p.shear_area_z <= section.properties(0.0).shear_area_z * (1 + 1e-12)


@given(sections())
def test_plastic_moduli_agree_with_the_outline_and_exceed_the_elastic_ones(section: Section) -> None:
    p = section.properties(0.3)
    loops = [loop[:-1] for loop in section.outline()]
    for axis, found, elastic in (
        (1, p.plastic_modulus_y, p.section_modulus_y),
        (0, p.plastic_modulus_z, p.section_modulus_z),
    ):
        assert found == pytest.approx(polygon_modulus(loops, axis), rel=3e-3)
        assert found > elastic


@given(sections())
def test_variables_come_back(section: Section) -> None:
    values = section.variable_values()
    again = type(section).from_variables(values)
    assert again.variable_values() == pytest.approx(values, rel=1e-9)
    assert again.properties(0.3).second_moment_y == pytest.approx(section.properties(0.3).second_moment_y, rel=1e-9)


@given(sections())
def test_outline_has_the_area_and_the_centroid(section: Section) -> None:
    loops = section.outline()
    assert all(np.array_equal(loop[0], loop[-1]) for loop in loops)
    area = first_y = first_z = 0.0
    for loop in loops:
        (y0, z0), (y1, z1) = loop[:-1].T, loop[1:].T
        cross = y0 * z1 - y1 * z0
        area += cross.sum() / 2
        first_y += ((y0 + y1) * cross).sum() / 6
        first_z += ((z0 + z1) * cross).sum() / 6
    p = section.properties(0.3)
    assert area == pytest.approx(p.area, rel=2e-3)
    assert (first_y / area, first_z / area) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert np.ptp(loops[0][:, 0]) == pytest.approx(p.width, rel=2e-3)
    assert np.ptp(loops[0][:, 1]) == pytest.approx(p.height, rel=2e-3)
    assert -loops[0][:, 1].min() == pytest.approx(p.centroid_z, rel=2e-3)


@given(sizes, walls, poisson)
def test_round_tube_is_outer_minus_inner_and_tends_to_solid(diameter: float, wall: float, nu: float) -> None:
    thickness = wall * diameter
    tube = Tube(diameter, thickness).properties(nu)
    outer, inner = Circle(diameter).properties(nu), Circle(diameter - 2 * thickness).properties(nu)
    for name in ("area", "second_moment_y", "torsion_constant"):
        assert getattr(tube, name) == pytest.approx(getattr(outer, name) - getattr(inner, name), rel=1e-9)
    solid = Tube(diameter, diameter * (0.5 - 1e-6)).properties(nu)
    for name in ("area", "second_moment_y", "torsion_constant", "shear_area_y"):
        assert getattr(solid, name) == pytest.approx(getattr(outer, name), rel=1e-6)


@given(sizes, ratios, walls, walls)
def test_rectangular_tube_is_outer_minus_inner(height: float, ratio: float, u: float, v: float) -> None:
    width = ratio * height
    flange, web = v * height, u * width
    tube = RectangularTube(width, height, flange_thickness=flange, web_thickness=web).properties(0.3)
    outer = Rectangle(width, height).properties(0.3)
    inner = Rectangle(width - 2 * web, height - 2 * flange).properties(0.3)
    for name in ("area", "second_moment_y", "second_moment_z"):
        assert getattr(tube, name) == pytest.approx(getattr(outer, name) - getattr(inner, name), rel=1e-9)
    assert tube.torsion_constant < outer.torsion_constant


@given(sizes, ratios, poisson)
def test_width_and_height_change_places(height: float, ratio: float, nu: float) -> None:
    for kind in (Rectangle, Ellipse):
        one, other = kind(ratio * height, height).properties(nu), kind(height, ratio * height).properties(nu)
        assert one.second_moment_y == pytest.approx(other.second_moment_z)
        assert one.torsion_constant == pytest.approx(other.torsion_constant)
        assert one.shear_area_y == pytest.approx(other.shear_area_z)


@settings(deadline=None, max_examples=8)
@given(st.floats(0.0, 2 * math.pi), poisson)
def test_rotation_of_a_polygon(angle: float, nu: float) -> None:
    points = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.02), (0.02, 0.02), (0.02, 0.07), (0.0, 0.07))
    still, turned = Polygon(points), Polygon(points).rotated(angle)
    a, b = still.properties(nu), turned.properties(nu)
    assert b.area == pytest.approx(a.area, rel=1e-9)
    assert b.torsion_constant == pytest.approx(a.torsion_constant, rel=1e-6)
    # The tensor of second moments turns: trace and determinant stay.
    assert b.second_moment_y + b.second_moment_z == pytest.approx(a.second_moment_y + a.second_moment_z, rel=1e-9)
    det = [p.second_moment_y * p.second_moment_z - p.product_moment_yz**2 for p in (a, b)]
    assert det[1] == pytest.approx(det[0], rel=1e-9)
    # So does the flexibility in shear, whose trace is 1 / A_sy + 1 / A_sz.
    trace = [1 / p.shear_area_y + 1 / p.shear_area_z for p in (a, b)]
    assert trace[1] == pytest.approx(trace[0], rel=1e-5)


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_polygon_of_a_known_shape_agrees_with_it(nu: float) -> None:
    tube = RectangularTube(0.08, 0.1, 0.008)
    outer, inner = ([tuple(point) for point in loop[:-1]] for loop in tube.outline())
    expected, result = tube.properties(nu), Polygon(tuple(outer), (tuple(inner),)).properties(nu)
    for field in dataclasses.fields(expected):
        # A polygon does not say where web and flange meet.
        if field.name not in ("torsion_modulus", "junction_modulus_y", "junction_shear_area_z"):
            value: Number = getattr(expected, field.name)
            room = 1e-12 if field.name.startswith("shear_centre") else 1e-15
            assert getattr(result, field.name) == pytest.approx(value, rel=0.011, abs=room)
