"""Published figures and first principles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sections import Circle, Ellipse, ISection, Polygon, Rectangle, RectangularTube, Triangle, Tube


@pytest.mark.parametrize(
    ("ratio", "constant"),
    [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (5.0, 0.291), (10.0, 0.312)],
)
def test_torsion_constant_of_rectangles(ratio: float, constant: float) -> None:
    # Timoshenko and Goodier, Theory of Elasticity, 3rd ed., section 109, table 7: J = k1 b h^3.
    for section in (Rectangle(0.02 * ratio, 0.02), Rectangle(0.02, 0.02 * ratio)):
        found = section.properties(0.3).torsion_constant / (0.02**4 * ratio)
        assert found == pytest.approx(constant, abs=6e-4)


@pytest.mark.parametrize(
    ("ratio", "k2"), [(1.0, 0.208), (1.5, 0.231), (2.0, 0.246), (4.0, 0.282), (10.0, 0.312)]
)
def test_torsion_stress_of_rectangles(ratio: float, k2: float) -> None:
    # The same table: greatest stress T / (k2 b h^2).
    found = Rectangle(0.02 * ratio, 0.02).properties(0.3).torsion_modulus / (0.02**3 * ratio)
    assert found == pytest.approx(k2, rel=0.006)


def test_torsion_of_an_equilateral_triangle() -> None:
    # Timoshenko and Goodier, section 104: J = sqrt(3) a^4 / 80, greatest stress 20 T / a^3.
    a = 0.07
    found = Triangle(a, a * math.sqrt(3) / 2).properties(0.3)
    assert found.torsion_constant == pytest.approx(math.sqrt(3) / 80 * a**4, rel=1e-4)
    assert found.torsion_modulus == pytest.approx(a**3 / 20, rel=0.01)
    corners = ((0.0, 0.0), (a, 0.0), (a / 2, a * math.sqrt(3) / 2))
    assert Polygon(corners).properties(0.3).torsion_constant == pytest.approx(
        math.sqrt(3) / 80 * a**4, rel=1e-5
    )


def test_shear_area_of_a_square_by_gruttmann_and_wagner() -> None:
    # doi:10.1007/s004660100239, rectangle: kappa = 5/6 at nu = 0; Renton gives A / A_s = 1.2 + 0.1392 s^2
    # for a square.
    square = Rectangle(0.1, 0.1)
    assert square.properties(0.0).shear_area_z == pytest.approx(0.01 * 5 / 6, rel=1e-9)
    n = np.arange(1, 2000)
    series = 144 * (1 / 720 - np.sum(np.tanh(n * np.pi) / n**5) / (8 * np.pi**5))
    expected = 0.01 / (1.2 + series * (0.5 / 1.5) ** 2)
    assert square.properties(0.5).shear_area_z == pytest.approx(expected, rel=1e-5)


def test_circle_shear_coefficient() -> None:
    # Renton (1991): 7/6 + s^2 / 6; at nu = 0 kappa = 6/7.
    area = math.pi * 0.01 / 4
    assert Circle(0.1).properties(0.0).shear_area_y == pytest.approx(area * 6 / 7, rel=1e-12)
    assert Circle(0.1).properties(0.25).shear_area_y == pytest.approx(area / (7 / 6 + 0.04 / 6), rel=1e-12)


def test_thin_round_tube_carries_half_its_area_in_shear() -> None:
    found = Tube(0.1, 1e-6).properties(0.3)
    assert found.shear_area_z / found.area == pytest.approx(0.5, rel=1e-4)


def test_ellipse_torsion() -> None:
    # J = pi a^3 b^3 / (a^2 + b^2) with semi-axes a, b; greatest stress 2 T / (pi a b^2), b the smaller.
    found = Ellipse(0.06, 0.1).properties(0.3)
    a, b = 0.05, 0.03
    assert found.torsion_constant == pytest.approx(math.pi * a**3 * b**3 / (a**2 + b**2), rel=1e-12)
    assert found.torsion_modulus == pytest.approx(math.pi * a * b**2 / 2, rel=1e-12)


def test_bredt_for_a_thin_rectangular_tube() -> None:
    b, h, t = 0.12, 0.08, 0.0004
    found = RectangularTube(b, h, t).properties(0.3)
    middle_b, middle_h = b - t, h - t
    bredt = 4 * (middle_b * middle_h) ** 2 * t / (2 * (middle_b + middle_h))
    assert found.torsion_constant == pytest.approx(bredt, rel=0.012)
    assert found.torsion_modulus == pytest.approx(2 * middle_b * middle_h * t, rel=1e-9)


def test_ipe_80_without_fillets() -> None:
    # EN 10365: IPE 80 is 80 x 46 x 3.8 x 5.2 mm with r = 5; A = 7.64 cm^2 and I_y = 80.1 cm^4 include the
    # fillets,
    # whose area (4 - pi) r^2 and place are known.
    found = ISection(0.046, 0.080, 0.0052, 0.0038).properties(0.3)
    fillet_area = (4 - math.pi) * 0.005**2
    arm = 0.040 - 0.0052 - 0.223 * 0.005
    assert found.area + fillet_area == pytest.approx(7.64e-4, rel=1e-3)
    assert found.second_moment_y + fillet_area * arm**2 == pytest.approx(80.1e-8, rel=2e-3)


def test_unequal_flanges_by_hand() -> None:
    # Bottom 100 x 20, web 10 x 60, top 60 x 20 mm: A = 3800 mm^2.
    section = ISection(
        height=0.1,
        web_thickness=0.01,
        top_flange_width=0.06,
        bottom_flange_width=0.1,
        flange_thickness=0.02,
    )
    found = section.properties(0.3)
    centroid = (2000 * 10 + 600 * 50 + 1200 * 90) / 3800
    inertia = (100 * 20**3 + 10 * 60**3 + 60 * 20**3) / 12 + sum(
        a * (z - centroid) ** 2 for a, z in ((2000, 10), (600, 50), (1200, 90))
    )
    assert found.area == pytest.approx(3800e-6)
    assert found.centroid_z == pytest.approx(centroid * 1e-3)
    assert found.second_moment_y == pytest.approx(inertia * 1e-12)
    assert found.extreme_fibre_y == pytest.approx((100 - centroid) * 1e-3)
    assert found.section_modulus_y == pytest.approx(inertia / (100 - centroid) * 1e-9)
