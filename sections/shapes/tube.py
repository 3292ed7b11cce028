"""Round tube."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np

from linkwright.core.sections.numeric import Number, is_symbol, maximum, sqrt
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    LEAST_OPENING,
    Bounds,
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    common_properties,
    ellipse_points,
    poisson_square,
    stress_area,
)
from linkwright.core.sections.wall import Arc, Wall, WallKind


@dataclass(frozen=True)
class Tube(Section):
    """A round tube with a concentric bore.

    For an optimiser the variables are the outer diameter and the area: mass is linear and 1 / I convex in
    them,
    which they are not in diameter and wall; a bound on the wall is linear in them too.

    Attributes:
        diameter: outer, m.
        thickness: of the wall, m.
        bore_squared: square of the inner diameter, m^2; filled in from the two others. Kept beside the wall
        so that
            formulas in (diameter, area) stay polynomials.
    """

    diameter: Number
    thickness: Number
    bore_squared: Number = field(default=None, repr=False, compare=False, kw_only=True)

    shape: ClassVar[str] = "tube"
    synonyms: ClassVar[tuple[str, ...]] = ("pipe", "round_tube", "circular_tube", "hollow_circle", "ring", "chs")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("diameter", "outer diameter", "outer"),
        Dimension("thickness", "wall thickness", "wall"),
    )
    variables: ClassVar[tuple[DesignVariable, ...]] = (
        DesignVariable("diameter", "outer diameter", "outer", logarithmic=False),
        DesignVariable("area", "area of the wall", "area", logarithmic=False),
    )

    def __post_init__(self) -> None:
        if self.bore_squared is None:
            object.__setattr__(self, "bore_squared", (self.diameter - 2.0 * self.thickness) ** 2)

    @property
    def inner_diameter(self) -> Number:
        """Of the bore, m."""
        return sqrt(self.bore_squared)

    def scaled(self, factor: Number) -> Self:
        """The same tube with both dimensions multiplied by a factor."""
        return type(self)(self.diameter * factor, self.thickness * factor, bore_squared=self.bore_squared * factor**2)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Exact properties (SI) for any wall.

        With m = inner / outer diameter, A / A_s = [(7 + 34 m^2 + 7 m^4) + (1 - m^2)^2 (nu / (1 + nu))^2]
        / (6 (1 + m^2)^2); the flexure functions of a ring
        are r, r^3, 1/r times cosines. Convention: Gruttmann and Wagner, doi:10.1007/s004660100239.
        """
        outer, inner = self.diameter**2, self.bore_squared
        area = 0.25 * math.pi * (outer - inner)
        second_moment = area * (outer + inner) / 16.0
        shear = (
            7.0 * outer**2
            + 34.0 * outer * inner
            + 7.0 * inner**2
            + (outer - inner) ** 2 * poisson_square(poisson_ratio)
        ) / (6.0 * (outer + inner) ** 2)
        radius = 0.5 * self.diameter
        # D^3 - d^3 = (D^2 - d^2)(D^2 + D d + d^2) / (D + d): no cancellation in thin walls.
        bore = self.diameter - 2.0 * self.thickness
        both = outer + inner + self.diameter * bore
        plastic = (outer - inner) * both / (6.0 * (self.diameter + bore))
        return common_properties(
            shear=(shear, shear),
            area=area,
            second_moment_y=second_moment,
            second_moment_z=second_moment,
            torsion_constant=2.0 * second_moment,
            plastic_modulus_y=plastic,
            plastic_modulus_z=plastic,
            torsion_modulus=2.0 * second_moment / radius,
            shear_stress_area_y=stress_area(second_moment, 2.0 * self.thickness, 0.5 * plastic),
            shear_stress_area_z=stress_area(second_moment, 2.0 * self.thickness, 0.5 * plastic),
            width=self.diameter,
            height=self.diameter,
        )

    @property
    def greatest_radius(self) -> Number:
        """Half of its diameter, m."""
        return 0.5 * self.diameter

    def outline(self) -> Outline:
        """The outer circle and the bore."""
        bore = self.diameter - 2.0 * self.thickness
        return [ellipse_points(self.diameter, self.diameter), ellipse_points(bore, bore, clockwise=True)]

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must leave a bore."""
        return (
            Constraint(
                "bore",
                f"the bore must be at least {LEAST_OPENING:.0%} of the diameter",
                LEAST_OPENING**2 - self.bore_squared / self.diameter**2,
            ),
        )

    def check(self) -> tuple[str, ...]:
        """The conditions that the tube violates, as text; conditions on symbols are not judged."""
        if is_symbol(self.diameter) or is_symbol(self.thickness) or np.all(2.0 * self.thickness < self.diameter):
            return super().check()
        return ("two walls must stay below the diameter",)

    @classmethod
    def from_variables(cls, values: Sequence[Number]) -> Self:
        """The tube of this outer diameter (m) and area (m^2)."""
        diameter, area = values
        bore_squared = diameter**2 - 4.0 / math.pi * area
        return cls(diameter, 0.5 * (diameter - sqrt(bore_squared)), bore_squared=bore_squared)

    def variable_values(self) -> tuple[Number, ...]:
        """Outer diameter (m) and area (m^2)."""
        return (self.diameter, 0.25 * math.pi * (self.diameter**2 - self.bore_squared))

    @classmethod
    def variable_bounds(cls, outer: Bounds, wall: Bounds) -> tuple[Bounds, ...]:
        """Bounds of the diameter (m) and the widest bounds of the area (m^2) that the wall's bounds imply."""

        def area(diameter: float, thickness: float) -> float:
            thickness = min(thickness, 0.5 * diameter)
            return math.pi * thickness * (diameter - thickness)

        return (outer, (area(outer[0], wall[0]), area(outer[1], wall[1])))

    def bound_constraints(self, outer: Bounds, wall: Bounds) -> tuple[Constraint, ...]:
        """Bounds on the wall; linear in (diameter, area), the upper one as far as two such walls fit inside.

        A tube too slender for two of the thickest walls is not bounded by them at all.
        """
        low, high = wall
        _, area = self.variable_values()
        scale = math.pi * low * outer[1]
        lower = Constraint(
            "thickness_min",
            f"thickness >= {low * 1e3:g} mm",
            (math.pi * low * (self.diameter - low) - area) / scale,
        )
        least_bore = maximum(self.diameter - 2.0 * high, 0.0)
        upper = Constraint(
            "thickness_max",
            f"thickness <= {high * 1e3:g} mm",
            (least_bore**2 - self.bore_squared) / (4.0 * high * outer[1]),
        )
        return (lower, upper)

    @classmethod
    def uniform(cls, size: float, thickness: float) -> Self:
        """The tube of this diameter and wall (m)."""
        return cls(size, thickness)

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Where they are and how they are held."""
        del web
        radius = 0.5 * (self.diameter - self.thickness)
        enclosed = math.pi * radius**2
        return (
            Wall(
                "wall",
                "the wall",
                "round",
                self.diameter,
                self.thickness,
                arcs=(Arc(radius),),
                encloses=enclosed,
            ),
        )
