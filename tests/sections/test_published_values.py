"""Published figures and first principles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwright.core.sections import (
    Angle,
    Circle,
    Ellipse,
    EllipticalTube,
    HexagonalTube,
    ISection,
    Octagon,
    Polygon,
    Rectangle,
    RectangularTube,
    Triangle,
    Tube,
    load_stock,
    slenderness_limits,
)


@pytest.mark.parametrize(
    ("ratio", "constant"),
    [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (5.0, 0.291), (10.0, 0.312)],
)
def test_torsion_constant_of_rectangles(ratio: float, constant: float) -> None:
    # Timoshenko and Goodier, Theory of Elasticity, 3rd ed., section 109, table 7: J = k1 b h^3.
    for section in (Rectangle(0.02 * ratio, 0.02), Rectangle(0.02, 0.02 * ratio)):
        result = section.properties(0.3).torsion_constant / (0.02**4 * ratio)
        assert result == pytest.approx(constant, abs=6e-4)


@pytest.mark.parametrize(("ratio", "k2"), [(1.0, 0.208), (1.5, 0.231), (2.0, 0.246), (4.0, 0.282), (10.0, 0.312)])
def test_torsion_stress_of_rectangles(ratio: float, k2: float) -> None:
    # The same table: greatest stress T / (k2 b h^2).
    result = Rectangle(0.02 * ratio, 0.02).properties(0.3).torsion_modulus / (0.02**3 * ratio)
    assert result == pytest.approx(k2, rel=0.006)


def test_torsion_of_an_equilateral_triangle() -> None:
    # Timoshenko and Goodier, section 104: J = sqrt(3) a^4 / 80, greatest stress 20 T / a^3.
    a = 0.07
    result = Triangle(a, a * math.sqrt(3) / 2).properties(0.3)
    assert result.torsion_constant == pytest.approx(math.sqrt(3) / 80 * a**4, rel=1e-4)
    assert result.torsion_modulus == pytest.approx(a**3 / 20, rel=0.01)
    corners = ((0.0, 0.0), (a, 0.0), (a / 2, a * math.sqrt(3) / 2))
    assert Polygon(corners).properties(0.3).torsion_constant == pytest.approx(math.sqrt(3) / 80 * a**4, rel=1e-5)


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
    result = Tube(0.1, 1e-6).properties(0.3)
    assert result.shear_area_z / result.area == pytest.approx(0.5, rel=1e-4)


def test_ellipse_torsion() -> None:
    # J = pi a^3 b^3 / (a^2 + b^2) with semi-axes a, b; greatest stress 2 T / (pi a b^2), b the smaller.
    result = Ellipse(0.06, 0.1).properties(0.3)
    a, b = 0.05, 0.03
    assert result.torsion_constant == pytest.approx(math.pi * a**3 * b**3 / (a**2 + b**2), rel=1e-12)
    assert result.torsion_modulus == pytest.approx(math.pi * a * b**2 / 2, rel=1e-12)


def test_bredt_for_a_thin_rectangular_tube() -> None:
    b, h, t = 0.12, 0.08, 0.0004
    result = RectangularTube(b, h, t).properties(0.3)
    middle_b, middle_h = b - t, h - t
    bredt = 4 * (middle_b * middle_h) ** 2 * t / (2 * (middle_b + middle_h))
    assert result.torsion_constant == pytest.approx(bredt, rel=0.012)
    assert result.torsion_modulus == pytest.approx(2 * middle_b * middle_h * t, rel=1e-9)


def test_ipe_80_without_fillets() -> None:
    # EN 10365: IPE 80 is 80 x 46 x 3.8 x 5.2 mm with r = 5; A = 7.64 cm^2 and I_y = 80.1 cm^4 include the
    # fillets,
    # whose area (4 - pi) r^2 and place are known.
    result = ISection(0.046, 0.080, 0.0052, 0.0038).properties(0.3)
    fillet_area = (4 - math.pi) * 0.005**2
    arm = 0.040 - 0.0052 - 0.223 * 0.005
    assert result.area + fillet_area == pytest.approx(7.64e-4, rel=1e-3)
    assert result.second_moment_y + fillet_area * arm**2 == pytest.approx(80.1e-8, rel=2e-3)


def test_unequal_flanges_by_hand() -> None:
    # Bottom 100 x 20, web 10 x 60, top 60 x 20 mm: A = 3800 mm^2.
    section = ISection(
        height=0.1,
        web_thickness=0.01,
        top_flange_width=0.06,
        bottom_flange_width=0.1,
        flange_thickness=0.02,
    )
    result = section.properties(0.3)
    centroid = (2000 * 10 + 600 * 50 + 1200 * 90) / 3800
    inertia = (100 * 20**3 + 10 * 60**3 + 60 * 20**3) / 12 + sum(
        a * (z - centroid) ** 2 for a, z in ((2000, 10), (600, 50), (1200, 90))
    )
    assert result.area == pytest.approx(3800e-6)
    assert result.centroid_z == pytest.approx(centroid * 1e-3)
    assert result.second_moment_y == pytest.approx(inertia * 1e-12)
    assert result.extreme_fibre_y == pytest.approx((100 - centroid) * 1e-3)
    assert result.section_modulus_y == pytest.approx(inertia / (100 - centroid) * 1e-9)


def test_ipe_80_with_fillets() -> None:
    # EN 10365 and the profile tables: A = 7.64 cm^2, I_y = 80.1, I_z = 8.49 cm^4, W_pl,y = 23.2, W_pl,z = 5.82 cm^3.
    result = ISection(0.046, 0.080, 0.0052, 0.0038, root_radius=0.005).properties(0.3)
    assert result.area == pytest.approx(7.64e-4, abs=0.005e-4)
    assert result.second_moment_y == pytest.approx(80.1e-8, abs=0.05e-8)
    assert result.second_moment_z == pytest.approx(8.49e-8, abs=0.005e-8)
    assert result.plastic_modulus_y == pytest.approx(23.2e-6, abs=0.05e-6)
    assert result.plastic_modulus_z == pytest.approx(5.82e-6, abs=0.005e-6)


def test_square_hollow_section_of_en_10219() -> None:
    # SHS 100x100x5: I_t = 441 cm^4, W_pl = 64.6 cm^3 beside A = 18.4 cm^2 and I = 271 cm^4.
    result = load_stock().find("SHS 100x5").section.properties(0.3)
    assert result.torsion_constant == pytest.approx(441e-8, rel=5e-3)
    assert result.plastic_modulus_y == pytest.approx(64.6e-6, abs=0.05e-6)


def test_octagon_from_first_principles() -> None:
    # Side a = width (sqrt(2) - 1), A = 2 (1 + sqrt(2)) a^2, I = (11 + 8 sqrt(2)) a^4 / 12 about any axis.
    width = 0.08
    side = width * (math.sqrt(2) - 1)
    result = Octagon(width).properties(0.3)
    assert result.area == pytest.approx(2 * (1 + math.sqrt(2)) * side**2, rel=1e-12)
    assert result.second_moment_y == pytest.approx((11 + 8 * math.sqrt(2)) / 12 * side**4, rel=1e-12)
    assert result.second_moment_z == result.second_moment_y


@pytest.mark.parametrize(
    ("name", "strong", "weak", "mass"),
    [("HFS5-2020", 0.742, 0.742, 0.50), ("HFS5-2040", 5.13, 1.358, 0.88), ("HFS8-4040", 10.4, 10.4, 1.73)],
)
def test_extrusions_have_the_makers_figures(name: str, strong: float, weak: float, mass: float) -> None:
    """Misumi's second moments (cm^4) and masses per metre (kg/m, density 2,700), within what its drawings' fillets
    do."""
    section = load_stock(user=False).find(name).section
    area, about_y, about_z = moments_within(section.outline())
    assert 1e8 * about_y == pytest.approx(strong, rel=0.003)
    assert 1e8 * about_z == pytest.approx(weak, rel=0.012)
    assert 2700.0 * area == pytest.approx(mass, rel=0.025)


def moments_within(loops: list[np.ndarray]) -> tuple[float, float, float]:
    """Area and second moments about the origin by Green's theorem, holes taken away."""
    totals = np.zeros(3)
    for number, loop in enumerate(loops):
        (y0, z0), (y1, z1) = loop[:-1].T, loop[1:].T
        twice = y0 * z1 - y1 * z0
        part = np.array(
            [
                twice.sum() / 2,
                (twice * (z0**2 + z0 * z1 + z1**2)).sum() / 12,
                (twice * (y0**2 + y0 * y1 + y1**2)).sum() / 12,
            ]
        )
        totals += np.abs(part) * (1 if number == 0 else -1)
    return tuple(totals)  # type: ignore[return-value]


def test_a_slotted_bar_twists_like_its_thin_parts() -> None:
    """J is above that of the bored core alone, and near that of the core with ribs (b t^3 / 3 each) and corners."""
    section = load_stock(user=False).find("HFS5-2020").section
    constant = 1e12 * section.properties(0.33).torsion_constant
    core = 0.1406 * 8.0**4 - math.pi / 32.0 * 4.2**4
    ribs, corners = 4 * 4.5 * 1.5**3 / 3.0, 4 * 0.1406 * 4.0**4
    assert core < constant < 1.25 * (core + ribs + corners)


def test_hexagonal_tube_from_first_principles() -> None:
    # Side a, A = 3 sqrt(3) / 2 a^2, I = 5 sqrt(3) / 16 a^4 about any axis, outside less inside; J by Bredt's formula
    # (4 A_m^2 t / U; R. Bredt, Z. VDI 40 (1896) 785-790) and the walls' own U t^3 / 3. The shear flow cuts its corners,
    # which is worth some tenths of a thickness each.
    height, wall = 0.08, 0.001
    outer, inner, middle = (size / math.sqrt(3.0) for size in (height, height - 2.0 * wall, height - wall))
    result = HexagonalTube(height, wall).properties(0.3)
    assert result.area == pytest.approx(1.5 * math.sqrt(3.0) * (outer**2 - inner**2), rel=1e-12)
    assert result.second_moment_y == pytest.approx(5.0 / 16.0 * math.sqrt(3.0) * (outer**4 - inner**4), rel=1e-12)
    assert result.second_moment_z == pytest.approx(result.second_moment_y, rel=1e-12)
    enclosed, around = 1.5 * math.sqrt(3.0) * middle**2, 6.0 * middle
    bredt = 4.0 * enclosed**2 * wall / around + around * wall**3 / 3.0
    assert result.torsion_constant == pytest.approx(bredt, rel=6.0 * 0.3 * wall / around)
    assert (result.width, result.height) == pytest.approx((2.0 * outer, height))


def test_angle_by_hand() -> None:
    # 100 x 60 x 10 mm without fillets: the centroid by moments, the product moment of each leg about it.
    result = Angle(0.06, 0.1, 0.01).properties(0.3)
    y, z = (600 * 30 + 900 * 5) / 1500, (600 * 5 + 900 * 55) / 1500
    product = 600 * (30 - y) * (5 - z) + 900 * (5 - y) * (55 - z)
    assert (result.centroid_y, result.centroid_z) == pytest.approx((y * 1e-3, z * 1e-3))
    assert result.product_moment_yz == pytest.approx(product * 1e-12)
    greatest, least = result.principal_moments
    assert greatest + least == pytest.approx(result.second_moment_y + result.second_moment_z)
    turn = result.principal_angle
    c, s = math.cos(turn), math.sin(turn)
    about = c**2 * result.second_moment_y + s**2 * result.second_moment_z - 2 * s * c * result.product_moment_yz
    assert about == pytest.approx(greatest)


def test_an_elliptical_tube_of_equal_axes_is_a_round_one() -> None:
    for wall in (0.002, 0.01, 0.02):
        result, expected = EllipticalTube(0.1, 0.1, wall).properties(0.3), Tube(0.1, wall).properties(0.3)
        assert result.area == pytest.approx(expected.area, rel=1e-9)
        assert result.second_moment_y == pytest.approx(expected.second_moment_y, rel=1e-9)
        assert result.plastic_modulus_z == pytest.approx(expected.plastic_modulus_z, rel=1e-6)
        assert result.torsion_constant == pytest.approx(expected.torsion_constant, rel=1e-3)
        assert result.shear_area_y == pytest.approx(expected.shear_area_y, rel=5e-3)


def test_area_of_a_wall_along_an_ellipse_is_its_middle_line_times_its_thickness() -> None:
    # Steiner: A = L t - pi t^2; perimeter of the ellipse with semi-axes 2 and 1 is 9.688448220547676.
    result = EllipticalTube(0.04, 0.02, 0.002).properties(0.3)
    assert result.area == pytest.approx(0.09688448220547676 * 0.002 - math.pi * 0.002**2, rel=1e-7)


@pytest.mark.parametrize(
    ("section", "modulus"),
    [
        # First principles: twice the first moment of half the area.
        (Rectangle(0.03, 0.05), 0.03 * 0.05**2 / 4),
        (Circle(0.05), 0.05**3 / 6),
        (Ellipse(0.03, 0.05), 0.03 * 0.05**2 / 6),
        (Triangle(0.03, 0.05), (2 - math.sqrt(2)) / 6 * 0.03 * 0.05**2),
        (Tube(0.05, 0.005), (0.05**3 - 0.04**3) / 6),
        (RectangularTube(0.03, 0.05, 0.004), (0.03 * 0.05**2 - 0.022 * 0.042**2) / 4),
    ],
)
def test_plastic_moduli(section: Circle, modulus: float) -> None:
    assert section.properties(0.3).plastic_modulus_y == pytest.approx(modulus, rel=1e-9)


def test_wall_limits_of_class_3() -> None:
    # EN 1993-1-1:2005, table 5.2: at f_y = 235 MPa epsilon is 1; at 355 MPa it is 0.814 (0.81 as printed there).
    (round_wall,) = slenderness_limits(Tube(0.0905, 0.001), 235e6, 210e9)
    assert round_wall.greatest == pytest.approx(90.0)
    assert round_wall.utilisation > 1.0
    assert round_wall.constraint.value > 0.0
    flange, web = slenderness_limits(load_stock().find("IPE 300").section, 355e6, 210e9, bending_only=True)
    assert flange.wall.slenderness == pytest.approx((75 - 3.55 - 15) / 10.7)
    assert flange.greatest == pytest.approx(14 * 0.81, rel=5e-3)
    assert web.wall.slenderness == pytest.approx(248.6 / 7.1)
    assert web.greatest == pytest.approx(124 * 0.81, rel=5e-3)
    assert slenderness_limits(load_stock().find("IPE 300").section, 355e6, 210e9)[1].greatest == pytest.approx(
        42 * 0.81, rel=5e-3
    )
    assert slenderness_limits(Rectangle(0.1, 0.1), 235e6, 210e9) == ()
