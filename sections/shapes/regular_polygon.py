"""Regular polygons that lie on a side, solid or as a tube of constant wall: octagon and hexagon."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.numeric import Array, Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    Dimension,
    Outline,
    Section,
    common_properties,
    hollow_torsion_modulus,
    opening,
    poisson_square,
    stress_area,
)
from linkwright.core.sections.wall import Wall, WallKind


def half_side(sides: int) -> float:
    """Half a side over the distance of the side from the middle."""
    return math.tan(math.pi / sides)


class RegularPolygon(Section):
    """A regular polygon of an even number of sides that lies on one of them, by `across`, its size across flats (m)."""

    sides: ClassVar[int]
    fits: ClassVar[str]
    """J and shear areas by how large the hollow is."""
    spread: ClassVar[float]
    """Its width over its size across flats, which is its height."""
    plastic: ClassVar[tuple[float, float]]
    """Plastic moduli about y and z over the cube of the size across flats."""
    twisting: ClassVar[float]
    """The same of the torsion modulus of a solid one: by boundary elements."""
    faces: ClassVar[tuple[tuple[str, float], ...]]
    """The sides of which others are mirror images: the name, and how far (rad) each is turned from the top."""

    @property
    @abstractmethod
    def across(self) -> Number:
        """Size across flats, m."""

    @property
    def inner(self) -> Number:
        """The hollow's size over the outer one."""
        return 0.0

    def torsion_modulus(self, torsion_constant: Number) -> Number:
        """J over the greatest shear stress by torque, m^3."""
        del torsion_constant
        return self.twisting * self.across**3

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J and shear areas (fits, 0.01 % for walls from a hundredth of the size).

        With t = tan(pi / sides) and half the size a: A = sides a^2 t, I = A a^2 / 4 (1 + t^2 / 3) about any axis. The
        torsion modulus of a tube is that of the middle of a side (`hollow_torsion_modulus`).
        """
        across, tangent, square = self.across, half_side(self.sides), self.inner**2
        area = 0.25 * self.sides * tangent * across**2
        second_moment = area * across**2 / 16.0 * (1.0 + tangent**2 / 3.0) * (1.0 - square**2)
        torsion_constant = across**4 * (1.0 - square**2) * fitted(f"{self.fits}_torsion", (self.inner,))
        poisson = poisson_square(poisson_ratio) * (1.0 - square) ** 2
        shear = fitted(f"{self.fits}_shear", (self.inner,)) + poisson * fitted(f"{self.fits}_poisson", (self.inner,))
        about_y, about_z = (factor * across**3 * (1.0 - self.inner**3) for factor in self.plastic)
        width, wall = self.spread * across, 1.0 - self.inner
        return common_properties(
            shear=(shear, shear),
            area=area * (1.0 - square),
            second_moment_y=second_moment,
            second_moment_z=second_moment,
            torsion_constant=torsion_constant,
            plastic_modulus_y=about_y,
            plastic_modulus_z=about_z,
            torsion_modulus=self.torsion_modulus(torsion_constant),
            shear_stress_area_y=stress_area(second_moment, wall * across, 0.5 * about_z),
            shear_stress_area_z=stress_area(second_moment, wall * width, 0.5 * about_y),
            width=width,
            height=across,
        )

    @property
    def greatest_radius(self) -> Number:
        """Half of its size across corners, m."""
        return 0.5 * self.across / math.cos(math.pi / self.sides)

    def outline(self) -> Outline:
        """Its edges, closed by the very point with which they begin: meshers take one beside it for an edge."""
        angle = -0.5 * math.pi + math.pi / self.sides * (1.0 + 2.0 * np.arange(self.sides))
        radius = 0.5 * self.across / math.cos(math.pi / self.sides)
        corners = radius * np.column_stack((np.cos(angle), np.sin(angle)))
        outer: Array = np.vstack((corners, corners[:1]))
        return [outer, self.inner * outer[::-1]] if self.inner else [outer]


class RegularTube(RegularPolygon):
    """The same as a tube of constant wall."""

    thickness: Number

    @property
    def inner_diameter(self) -> Number:
        """Across the flats of the hollow, m."""
        return self.across - 2.0 * self.thickness

    @property
    def inner(self) -> Number:
        """The hollow's size over the outer one."""
        return 1.0 - 2.0 * self.thickness / self.across

    def torsion_modulus(self, torsion_constant: Number) -> Number:
        """Of the middle of a side."""
        enclosed = 0.25 * self.sides * half_side(self.sides) * (self.across - self.thickness) ** 2
        return hollow_torsion_modulus(enclosed, self.thickness, torsion_constant)

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must leave a hollow."""
        size = self.dimensions[0].name
        return (opening("hollow", "two walls", f"the {size}", 2.0 * self.thickness / self.across),)

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Sides at the top and beside it; the others are their mirror images."""
        del web
        t, tangent = self.thickness, half_side(self.sides)
        middle = 0.5 * self.across
        apothem, half = middle - 0.5 * t, (middle - t) * tangent
        enclosed = self.sides * tangent * apothem**2
        results: list[Wall] = []
        for name, turn in self.faces:
            y, z = math.sin(turn), math.cos(turn)
            ends = tuple(
                (self.spread * middle + apothem * y + s * half * z, middle + apothem * z - s * half * y)
                for s in (-1.0, 1.0)
            )
            results.append(Wall(name, "each side", "internal", 2.0 * half, t, (ends[0], ends[1]), encloses=enclosed))
        return tuple(results)


class EightSides(RegularPolygon):
    """What octagons have in common. Plastic modulus: 2 a^3 / 3 (2 + t^2), by the triangles on the sides."""

    width: Number
    sides = 8
    fits = "octagon"
    spread = 1.0
    plastic = ((2.0 + half_side(8) ** 2) / 12.0, (2.0 + half_side(8) ** 2) / 12.0)
    twisting = 0.1840
    faces = (("wall", 0.0), ("sloping", 0.25 * math.pi), ("web", 0.5 * math.pi))

    @property
    def across(self) -> Number:
        """Its width."""
        return self.width


@dataclass(frozen=True)
class Octagon(EightSides):
    """A solid regular octagon that lies on one of its sides.

    Attributes:
        width: across flats, m; the height is the same.
    """

    width: Number

    shape: ClassVar[str] = "octagon"
    solid: ClassVar[bool] = True
    dimensions: ClassVar[tuple[Dimension, ...]] = (Dimension("width", "across flats", "outer"),)


@dataclass(frozen=True)
class OctagonalTube(RegularTube, EightSides):
    """A tube whose outer edge is a regular octagon, lying on a side, with a constant wall.

    Attributes:
        width: outer, across flats, m; the height is the same.
        thickness: of the wall, square to it, m.
    """

    width: Number
    thickness: Number

    shape: ClassVar[str] = "octagonal_tube"
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer width across flats", "outer"),
        Dimension("thickness", "wall thickness", "wall"),
    )


@dataclass(frozen=True)
class HexagonalTube(RegularTube):
    """A tube whose outer edge is a regular hexagon, lying on a side, with a constant wall.

    Attributes:
        height: outer, across flats, m; the width, across corners, is 2 / sqrt(3) times that.
        thickness: of the wall, square to it, m.
    """

    height: Number
    thickness: Number

    sides: ClassVar[int] = 6
    fits: ClassVar[str] = "hexagon"
    spread: ClassVar[float] = 2.0 / math.sqrt(3.0)
    # By the halves above the middle and beside it: 8 a^3 / (3 sqrt(3)) and 14 a^3 / 9.
    plastic: ClassVar[tuple[float, float]] = (1.0 / (3.0 * math.sqrt(3.0)), 7.0 / 36.0)
    faces: ClassVar[tuple[tuple[str, float], ...]] = (("wall", 0.0), ("sloping", math.pi / 3.0))
    shape: ClassVar[str] = "hexagonal_tube"
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("height", "outer height across flats", "outer"),
        Dimension("thickness", "wall thickness", "wall"),
    )

    @property
    def across(self) -> Number:
        """Its height."""
        return self.height
