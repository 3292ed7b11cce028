"""Solid isosceles triangular bar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.formulas.closed_forms import (
    triangle_shear_factors,
    triangle_torsion_constant,
    triangle_torsion_modulus,
)
from linkwright.core.sections.formulas.open_walls import triangle_shear_centre
from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Dimension, Outline, Section, closed, common_properties


@dataclass(frozen=True)
class Triangle(Section):
    """A solid isosceles triangle, base down, symmetric about its height.

    Attributes:
        width: base along y, m.
        height: along z, m.
    """

    width: Number
    height: Number

    shape: ClassVar[str] = "triangle"
    solid: ClassVar[bool] = True
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "base, across the bending plane", "outer"),
        Dimension("height", "height, in the bending plane", "outer"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); J and shear areas are fits, good to 0.05 % for width / height from 0.1 to 10.

        The fits (`sections.formulas.closed_forms`) follow a boundary element solution that meets J = sqrt(3) a^4 /
        80 of
        the equilateral triangle (Timoshenko and Goodier, Theory of Elasticity, section 104) to 1e-8.
        """
        b, h = self.width, self.height
        return common_properties(
            shear=triangle_shear_factors(b, h, poisson_ratio),
            area=0.5 * b * h,
            second_moment_y=b * h**3 / 36.0,
            second_moment_z=h * b**3 / 48.0,
            torsion_constant=triangle_torsion_constant(b, h),
            plastic_modulus_y=(2.0 - math.sqrt(2.0)) / 6.0 * b * h**2,
            plastic_modulus_z=h * b**2 / 12.0,
            extreme_fibre_y=2.0 / 3.0 * h,
            torsion_modulus=triangle_torsion_modulus(b, h),
            shear_stress_area_y=0.5 * b * h,
            shear_stress_area_z=b * h / 3.0,
            width=b,
            height=h,
            centroid_z=h / 3.0,
            shear_centre_z=triangle_shear_centre(b, h),
        )

    def outline(self) -> Outline:
        """Three corners."""
        y, low, high = 0.5 * self.width, -self.height / 3.0, 2.0 * self.height / 3.0
        return [closed([(-y, low), (y, low), (0.0, high)])]
