"""Solid rectangular bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.formulas.closed_forms import (
    rectangle_shear_factor,
    rectangle_torsion_constant,
    rectangle_torsion_modulus,
)
from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Dimension, Outline, Section, closed, common_properties


@dataclass(frozen=True)
class Rectangle(Section):
    """A solid rectangle.

    Attributes:
        width: along y, m.
        height: along z, m.
    """

    width: Number
    height: Number

    shape: ClassVar[str] = "rectangle"
    solid: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("square", "flat_bar", "block")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "side across the bending plane", "outer"),
        Dimension("height", "side in the bending plane", "outer"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); J within 1e-6 and shear areas within 1e-4 of the exact series for any aspect
        ratio.

        See `sections.formulas.closed_forms` for the series and their sources.
        """
        b, h = self.width, self.height
        return common_properties(
            shear=(rectangle_shear_factor(h, b, poisson_ratio), rectangle_shear_factor(b, h, poisson_ratio)),
            area=b * h,
            second_moment_y=b * h**3 / 12.0,
            second_moment_z=h * b**3 / 12.0,
            torsion_constant=rectangle_torsion_constant(b, h),
            plastic_modulus_y=0.25 * b * h**2,
            plastic_modulus_z=0.25 * h * b**2,
            torsion_modulus=rectangle_torsion_modulus(b, h),
            shear_stress_area_y=b * h / 1.5,
            shear_stress_area_z=b * h / 1.5,
            width=b,
            height=h,
        )

    def outline(self) -> Outline:
        """Four corners."""
        return [box(self.width, self.height)]


def box(width: float, height: float, *, clockwise: bool = False) -> NDArray[np.float64]:
    """A closed rectangle about the origin, 5 x 2, m."""
    y, z = 0.5 * width, 0.5 * height
    corners = [(-y, -z), (y, -z), (y, z), (-y, z)]
    return closed(corners[::-1] if clockwise else corners)
