"""The contract of shapes: every registered one keeps it, wrong ones do not, and one may have nothing but an outline."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest

from linkwright.core.sections import (
    SHAPES,
    Dimension,
    HexagonalTube,
    Number,
    Outline,
    Polygon,
    Section,
    SectionError,
    SectionProperties,
    TSlot,
    Wall,
)
from linkwright.core.sections.contract import check_shape
from linkwright.core.sections.formulas.by_ratios import figures_by_ratios
from linkwright.core.sections.wall import WallKind
from linkwright.core.units.quantities import InputError

FIXED = {
    "polygon": Polygon(((0.0, 0.0), (0.06, 0.0), (0.06, 0.01), (0.01, 0.01), (0.01, 0.05), (0.0, 0.05))),
    "t_slot": TSlot(0.02, 0.02, 0.006, 0.012, 0.002, 0.008, 0.0015, 0.0042),
}
"""Sections of shapes whose dimensions cannot be drawn."""


@dataclass(frozen=True)
class Outlined(Section):
    """A hexagonal tube by its outline alone."""

    height: Number
    thickness: Number

    shape: ClassVar[str] = "outlined_hexagonal_tube"
    dimensions: ClassVar[tuple[Dimension, ...]] = HexagonalTube.dimensions

    def outline(self) -> Outline:
        return HexagonalTube(self.height, self.thickness).outline()


@dataclass(frozen=True)
class Bracket(Section):
    """Of three dimensions, by its outline alone."""

    width: Number
    height: Number
    thickness: Number

    shape: ClassVar[str] = "bracket"
    dimensions: ClassVar[tuple[Dimension, ...]] = SHAPES["angle"].dimensions

    def outline(self) -> Outline:
        return SHAPES["angle"](self.width, self.height, self.thickness).outline()


class Weak(HexagonalTube):
    """Its J is a fifth too small."""

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        right = super().properties(poisson_ratio)
        return dataclasses.replace(right, torsion_constant=0.8 * right.torsion_constant)


class Shifted(HexagonalTube):
    """Its outline is not about the centroid."""

    def outline(self) -> Outline:
        return [loop + 0.01 for loop in super().outline()]


class Cubed(HexagonalTube):
    """Its second moment grows with the cube of the size."""

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        right = super().properties(poisson_ratio)
        return dataclasses.replace(right, second_moment_y=right.second_moment_y * 0.1 / self.height)


class Beside(HexagonalTube):
    """A wall of it lies in the hollow."""

    def wall_parts(self, web: str) -> tuple[Wall, ...]:
        del web
        return (Wall("web", "the web", "internal", 0.05, 0.002, ((0.05, 0.02), (0.05, 0.03))),)


class Strong(HexagonalTube):
    """Its bending stress is half of what it is."""

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        right = super().properties(poisson_ratio)
        return dataclasses.replace(right, section_modulus_y=2.0 * right.section_modulus_y)


class Twisted(HexagonalTube):
    """Its stress of torsion is half of what it is."""

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        right = super().properties(poisson_ratio)
        return dataclasses.replace(right, torsion_modulus=2.0 * right.torsion_modulus)


class Stout(HexagonalTube):
    """Its walls are twice as thick as drawn."""

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        walls = super().wall_parts(web) or ()
        return tuple(dataclasses.replace(wall, thickness=2.0 * wall.thickness) for wall in walls)


class Narrow(HexagonalTube):
    """Its walls are half as wide as drawn."""

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        walls = super().wall_parts(web) or ()
        return tuple(dataclasses.replace(wall, width=0.5 * wall.width) for wall in walls)


class Roomy(HexagonalTube):
    """Its bore is its outer size."""

    @property
    def inner_diameter(self) -> Number:
        return self.height


class Stiff(HexagonalTube):
    """It knows numbers alone."""

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        right = super().properties(poisson_ratio)
        return right if isinstance(self.height, float) else dataclasses.replace(right, area=1.01 * right.area)


@pytest.mark.parametrize("name", list(SHAPES))
def test_every_shape_keeps_it(name: str) -> None:
    check_shape(SHAPES[name], *([FIXED[name]] if name in FIXED else []))


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (Weak, "torsion_constant of"),
        (Shifted, "outline is not about the centroid"),
        (Cubed, "second_moment_y does not grow with power 4"),
        (Beside, "the middle of its wall 'web' does not lie in the material"),
        (Strong, "section_modulus_y of"),
        (Twisted, "torsion_modulus of"),
        (Stout, "its wall 'wall' is .* mm thick where its outline has"),
        (Narrow, "its wall 'wall' is .* mm wide and its ends are"),
        (Roomy, "its inner diameter is .* mm where its outline has"),
        (Stiff, "area by symbols is not that by numbers"),
    ],
)
def test_a_wrong_shape_does_not(kind: type[Section], said: str) -> None:
    with pytest.raises(InputError, match=said):
        check_shape(kind)


def test_an_outline_is_enough() -> None:
    """Numbers, arrays and symbols, against the closed form of the same tube."""
    check_shape(Outlined)
    for thickness in (0.001, 0.004, 0.015):
        expected, result = HexagonalTube(0.06, thickness).properties(0.3), Outlined(0.06, thickness).properties(0.3)
        for field in dataclasses.fields(expected):
            if field.name not in ("torsion_modulus", "junction_modulus_y", "junction_shear_area_z"):
                value = getattr(expected, field.name)
                assert getattr(result, field.name) == pytest.approx(value, rel=2e-3, abs=1e-15), field.name


def test_slopes_of_what_is_fitted() -> None:
    """By which an optimiser goes: against those of the closed form, along the wall."""

    def slope(kind: type[Section]) -> float:
        wall = ca.SX.sym("t")
        constant = kind(0.06, wall).properties(0.3).torsion_constant
        return float(ca.Function("f", [wall], [ca.jacobian(constant, wall)])(0.003))

    assert slope(Outlined) == pytest.approx(slope(HexagonalTube), rel=0.01)


def test_several_ratios_are_plain_numbers() -> None:
    expected, result = SHAPES["angle"](0.05, 0.08, 0.006).properties(0.3), Bracket(0.05, 0.08, 0.006).properties(0.3)
    assert result.warping_constant == pytest.approx(expected.warping_constant, rel=0.05)
    assert result.shear_centre == pytest.approx(expected.shear_centre, abs=5e-4)
    assert Bracket.variables == ()
    assert "give their values, or take stock sizes" in str(Bracket.contradiction((0.02, 0.1), (0.002, 0.01)))
    with pytest.raises(SectionError, match="no formulas"):
        Bracket(ca.SX.sym("b"), 0.08, 0.006).properties(0.3)
    walls = Bracket(np.array([0.05, 0.1]), np.array([0.08, 0.16]), np.array([0.006, 0.012])).properties(0.3)
    assert walls.torsion_constant == pytest.approx(np.array([1.0, 16.0]) * result.torsion_constant)


def test_a_ratio_is_solved_once() -> None:
    calls: list[float] = []

    class Counted(Bracket):
        def outline(self) -> Outline:
            calls.append(self.width)
            return super().outline()

    for size in (0.05, 0.1, 0.05):
        assert Counted(size, 1.6 * size, 0.12 * size).properties(0.3).area > 0.0
    assert len(calls) == 1
    assert figures_by_ratios(Counted, "width", {"height": 1.6, "thickness": 0.12}, None) is not None
    assert len(calls) == 1
