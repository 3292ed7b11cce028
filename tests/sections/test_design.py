"""Design variables, bounds, starting points, and errors for people."""

from __future__ import annotations

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.sections import SHAPES, FreeFlangeISection, ISection, RectangularTube, SectionError, Tube, build

CHOSEN = [kind for kind in SHAPES.values() if kind.variables] + [FreeFlangeISection]
OUTER, WALL = (0.02, 0.14), (0.002, 0.01)


@given(st.sampled_from(CHOSEN), st.floats(1e-5, 3e-2))
def test_start_is_feasible_and_near_the_wanted_area(kind: type, area: float) -> None:
    section = kind.start(area, OUTER, WALL)
    assert section.check() == ()
    for value, (low, high) in zip(section.variable_values(), kind.variable_bounds(OUTER, WALL), strict=True):
        assert low * (1 - 1e-9) <= value <= high * (1 + 1e-9)
    for constraint in section.bound_constraints(OUTER, WALL):
        assert constraint.value <= 1e-9
    least = kind.start(1e-9, OUTER, WALL).properties(0.3).area
    most = kind.start(1.0, OUTER, WALL).properties(0.3).area
    assert section.properties(0.3).area == pytest.approx(min(max(area, least), most), rel=1e-6)


@given(st.floats(0.02, 0.14), st.floats(0.0005, 0.0095))
def test_bounds_on_the_wall_of_a_tube(diameter: float, thickness: float) -> None:
    constraints = {c.name: c.value for c in Tube(diameter, thickness).bound_constraints(OUTER, WALL)}
    assert (constraints["thickness_min"] <= 1e-12) == (thickness >= WALL[0] * (1 - 1e-9))
    assert constraints["thickness_max"] <= 1e-12


def test_tube_mass_is_linear_and_its_flexibility_convex_in_the_design_variables() -> None:
    x = ca.SX.sym("x", 2)
    p = Tube.from_variables(ca.vertsplit(x)).properties(0.3)
    hessian = ca.Function("h", [x], [ca.hessian(1 / p.second_moment_y, x)[0], ca.hessian(p.area, x)[0]])
    for point in ([0.1, 0.001], [0.05, 0.0015], [0.14, 0.006]):
        flexibility, mass = hessian(point)
        assert float(ca.norm_fro(mass)) == pytest.approx(0.0, abs=1e-12)
        assert float(flexibility[0, 0]) > 0.0
        assert float(ca.det(flexibility)) >= 0.0


def test_contradictory_bounds_are_named() -> None:
    for kind in (Tube, RectangularTube, ISection):
        reason = kind.contradiction((0.01, 0.015), (0.01, 0.02))
        assert reason is not None
        assert "10 mm" in reason
        assert "15 mm" in reason
        with pytest.raises(SectionError):
            kind.start(1e-3, (0.01, 0.015), (0.01, 0.02))
        assert kind.contradiction(OUTER, WALL) is None
    assert SHAPES["circle"].contradiction((0.01, 0.015), (0.01, 0.02)) is None
    assert SHAPES["circle"].contradiction((0.02, 0.01), WALL) is not None
    assert SHAPES["polygon"].contradiction(OUTER, WALL) is not None


def test_constraints_on_symbols_are_not_judged_but_given() -> None:
    d, t = ca.SX.sym("d"), ca.SX.sym("t")
    section = RectangularTube(d, 2 * d, t)
    assert section.check() == ()
    value = ca.Function("c", [d, t], [section.constraints()[0].value])
    assert float(value(0.1, 0.06)) > 0.0
    assert float(value(0.1, 0.01)) < 0.0


@pytest.mark.parametrize(
    ("shape", "dimensions", "key", "words"),
    [
        ("rectangel", {}, "shape", "rectangle"),
        ("circle", {"diametre": 0.1}, "diametre", "diameter"),
        ("circle", {}, "diameter", "needs"),
        ("circle", {"diameter": 0.0}, "diameter", "positive"),
        ("circle", {"diameter": "10"}, "diameter", "length"),
        ("tube", {"diameter": 0.1, "thickness": 0.0495}, "thickness", "bore"),
        ("tube", {"diameter": 0.1, "thickness": 0.07}, "thickness", "wall"),
        ("rectangular_tube", {"width": 0.1, "height": 0.1, "thickness": 0.06}, "thickness", "width"),
        (
            "rectangular_tube",
            {"width": 0.1, "height": 0.1, "web_thickness": 0.01},
            "thickness",
            "flange_thickness",
        ),
        (
            "i_section",
            {"width": 0.1, "height": 0.1, "flange_thickness": 0.06, "web_thickness": 0.01},
            "flange_thickness",
            "height",
        ),
        ("i_section", {"width": 0.1, "height": 0.1, "flange_thickness": 0.01}, "web_thickness", "needs"),
        ("polygon", {"points": [[0, 0], [1, 1], [1, 0], [0, 1]]}, "points", "cross"),
        ("polygon", {"points": [[0, 0], [1, 0]]}, "points", "three"),
        (
            "polygon",
            {"points": [[0, 0], [1, 0], [0, 1]], "holes": [[[2, 2], [3, 2], [2, 3]]]},
            "holes",
            "inside",
        ),
        ("polygon", {"points": [[0, 0], [1, 0], [2, 0]]}, "points", ""),
    ],
)
def test_errors_name_the_key_and_say_what_is_wrong(shape: str, dimensions: dict, key: str, words: str) -> None:
    with pytest.raises(SectionError) as caught:
        build(shape, dimensions)
    assert caught.value.key == key
    assert words in caught.value.message
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_short_forms() -> None:
    whole = build("rectangular_tube", {"width": 0.1, "height": 0.08, "thickness": 0.004})
    pairs = build("rectangular_tube", {"width": 0.1, "height": 0.08, "flange_thickness": 0.004, "web_thickness": 0.004})
    assert whole.properties(0.3) == pairs.properties(0.3)
    equal = ISection(0.05, 0.1, 0.006, 0.004)
    spelt = FreeFlangeISection.from_variables((0.05, 0.05, 0.1, 0.006, 0.006, 0.004))
    for name in ("area", "second_moment_y", "torsion_constant", "shear_area_y", "shear_area_z"):
        assert getattr(equal.properties(0.3), name) == pytest.approx(getattr(spelt.properties(0.3), name), rel=1e-9)
    assert equal.given() == {"width": 0.05, "height": 0.1, "flange_thickness": 0.006, "web_thickness": 0.004}


def test_the_registry_cannot_be_changed() -> None:
    with pytest.raises(TypeError):
        SHAPES["circle"] = Tube  # type: ignore[index]
