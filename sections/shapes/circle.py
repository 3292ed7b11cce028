"""Solid round bar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Dimension,
    Outline,
    Section,
    common_properties,
    ellipse_points,
    poisson_square,
)


@dataclass(frozen=True)
class Circle(Section):
    """A solid circle.

    Attributes:
        diameter: m.
    """

    diameter: Number

    shape: ClassVar[str] = "circle"
    solid: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("round", "round_bar", "rod", "solid_round", "cylinder", "disc")
    dimensions: ClassVar[tuple[Dimension, ...]] = (Dimension("diameter", "outer diameter", "outer"),)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Exact properties (SI).

        A / A_s = 7/6 + (nu / (1 + nu))^2 / 6: J. D. Renton, Generalized beam theory applied to shear
        stiffness,
        Int. J. Solids Structures 27 (1991) 1955-1967.
        """
        d = self.diameter
        area = 0.25 * math.pi * d**2
        second_moment = math.pi / 64.0 * d**4
        shear = 7.0 / 6.0 + poisson_square(poisson_ratio) / 6.0
        return common_properties(
            shear=(shear, shear),
            area=area,
            second_moment_y=second_moment,
            second_moment_z=second_moment,
            torsion_constant=2.0 * second_moment,
            plastic_modulus_y=d**3 / 6.0,
            plastic_modulus_z=d**3 / 6.0,
            torsion_modulus=math.pi / 16.0 * d**3,
            shear_stress_area_y=0.75 * area,
            shear_stress_area_z=0.75 * area,
            width=d,
            height=d,
        )

    @property
    def greatest_radius(self) -> Number:
        """Half of its diameter, m."""
        return 0.5 * self.diameter

    def outline(self) -> Outline:
        """One circle."""
        return [ellipse_points(self.diameter, self.diameter)]
