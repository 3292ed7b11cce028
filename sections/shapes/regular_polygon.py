"""Regular polygons that lie on a side, solid or as a tube of constant wall: the octagon."""

from __future__ import annotations

import math
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


@dataclass(frozen=True)
class Octagon(Section):
    """A solid regular octagon that lies on one of its sides.

    Attributes:
        width: across flats, m; the height is the same.
    """

    width: Number

    sides: ClassVar[int] = 8
    """A multiple of four, so that width and height are the same."""
    fits: ClassVar[str] = "octagon"
    """J and shear areas by how large the hollow is."""
    shape: ClassVar[str] = "octagon"
    solid: ClassVar[bool] = True
    dimensions: ClassVar[tuple[Dimension, ...]] = (Dimension("width", "across flats", "outer"),)

    @property
    def inner(self) -> Number:
        """The hollow's width over the outer one."""
        return 0.0

    def torsion_modulus(self, torsion_constant: Number) -> Number:
        """J over the greatest shear stress by torque, m^3: by boundary elements."""
        del torsion_constant
        return 0.1840 * self.width**3

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J and shear areas (fits, 0.01 % for walls of 0.0075 widths to solid).

        With t = tan(pi / sides) and half the width a: A = sides a^2 t, I = A a^2 / 4 (1 + t^2 / 3) about any axis, and
        the plastic modulus is 2 a^3 / 3 (2 + t^2), by the first moments of the triangles on the sides. The torsion
        modulus of a tube is that of the middle of a side (`hollow_torsion_modulus`).
        """
        width, tangent, square = self.width, half_side(self.sides), self.inner**2
        area = 0.25 * self.sides * tangent * width**2
        second_moment = area * width**2 / 16.0 * (1.0 + tangent**2 / 3.0) * (1.0 - square**2)
        torsion_constant = width**4 * (1.0 - square**2) * fitted(f"{self.fits}_torsion", (self.inner,))
        poisson = poisson_square(poisson_ratio) * (1.0 - square) ** 2
        shear = fitted(f"{self.fits}_shear", (self.inner,)) + poisson * fitted(f"{self.fits}_poisson", (self.inner,))
        plastic = (2.0 + tangent**2) / 12.0 * width**3 * (1.0 - self.inner**3)
        return common_properties(
            shear=(shear, shear),
            area=area * (1.0 - square),
            second_moment_y=second_moment,
            second_moment_z=second_moment,
            torsion_constant=torsion_constant,
            plastic_modulus_y=plastic,
            plastic_modulus_z=plastic,
            torsion_modulus=self.torsion_modulus(torsion_constant),
            shear_stress_area_y=stress_area(second_moment, (1.0 - self.inner) * width, 0.5 * plastic),
            shear_stress_area_z=stress_area(second_moment, (1.0 - self.inner) * width, 0.5 * plastic),
            width=width,
            height=width,
        )

    def outline(self) -> Outline:
        """Its edges, closed by the very point with which they begin: meshers take one beside it for an edge."""
        angle = math.pi / self.sides * (1.0 + 2.0 * np.arange(self.sides))
        radius = 0.5 * self.width / math.cos(math.pi / self.sides)
        corners = radius * np.column_stack((np.cos(angle), np.sin(angle)))
        outer: Array = np.vstack((corners, corners[:1]))
        return [outer, self.inner * outer[::-1]] if self.inner else [outer]


@dataclass(frozen=True)
class OctagonalTube(Octagon):
    """A tube whose outer edge is a regular octagon, lying on a side, with a constant wall.

    Attributes:
        width: outer, across flats, m; the height is the same.
        thickness: of the wall, square to it, m.
    """

    thickness: Number

    shape: ClassVar[str] = "octagonal_tube"
    solid: ClassVar[bool] = False
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer width across flats", "outer"),
        Dimension("thickness", "wall thickness", "wall"),
    )

    @property
    def inner_diameter(self) -> Number:
        """Across the flats of the hollow, m."""
        return self.width - 2.0 * self.thickness

    @property
    def inner(self) -> Number:
        """The hollow's width over the outer one."""
        return 1.0 - 2.0 * self.thickness / self.width

    def torsion_modulus(self, torsion_constant: Number) -> Number:
        """Of the middle of a side."""
        enclosed = 0.25 * self.sides * half_side(self.sides) * (self.width - self.thickness) ** 2
        return hollow_torsion_modulus(enclosed, self.thickness, torsion_constant)

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must leave a hollow."""
        return (opening("hollow", "two walls", "the width", 2.0 * self.thickness / self.width),)

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Sides at the top, at the right and between them; the others are their mirror images."""
        del web
        t, tangent = self.thickness, half_side(self.sides)
        middle = 0.5 * self.width
        apothem, half = middle - 0.5 * t, (middle - t) * tangent
        enclosed = self.sides * tangent * apothem**2
        results: list[Wall] = []
        for name, turn in (("wall", 0.0), ("sloping", 0.25 * math.pi), ("web", 0.5 * math.pi)):
            y, z = math.sin(turn), math.cos(turn)
            ends = tuple(
                (middle + apothem * y + s * half * z, middle + apothem * z - s * half * y) for s in (-1.0, 1.0)
            )
            results.append(Wall(name, "each side", "internal", 2.0 * half, t, (ends[0], ends[1]), encloses=enclosed))
        return tuple(results)
