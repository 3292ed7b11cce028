"""Solid elliptical bar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.numeric import Number, maximum, minimum
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
class Ellipse(Section):
    """A solid ellipse with its axes along width and height.

    Attributes:
        width: full axis along y, m.
        height: full axis along z, m.
    """

    width: Number
    height: Number

    shape: ClassVar[str] = "ellipse"
    solid: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("oval",)
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "full axis across the bending plane", "outer"),
        Dimension("height", "full axis in the bending plane", "outer"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Exact properties (SI) for any aspect ratio.

        Torsion: S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed. (1970), section 106.
        Shear: the flexure functions of an ellipse are cubic polynomials; see `shear_factor`.
        """
        b, h = self.width, self.height
        area = 0.25 * math.pi * b * h
        return common_properties(
            shear=(shear_factor(h, b, poisson_ratio), shear_factor(b, h, poisson_ratio)),
            area=area,
            second_moment_y=area * h**2 / 16.0,
            second_moment_z=area * b**2 / 16.0,
            torsion_constant=0.25 * area * b**2 * h**2 / (b**2 + h**2),
            plastic_modulus_y=b * h**2 / 6.0,
            plastic_modulus_z=h * b**2 / 6.0,
            torsion_modulus=0.25 * area * minimum(b, h),
            shear_stress_area_y=0.75 * area,
            shear_stress_area_z=0.75 * area,
            width=b,
            height=h,
        )

    @property
    def greatest_radius(self) -> Number:
        """Half of its longer axis, m."""
        return 0.5 * maximum(self.width, self.height)

    def outline(self) -> Outline:
        """One ellipse."""
        return [ellipse_points(self.width, self.height)]


def shear_factor(across: Number, along: Number, poisson_ratio: Number) -> Number:
    """A / A_s for a shear force along the axis ``along`` (full axes, m).

    With p, q the semi-axes across and along the force and D = 3 q^2 + p^2,
    A / A_s = (10 q^2 + 4 p^2) / (3 D) + (nu / (1 + nu))^2 2 p^4 / (3 q^2 D).
    """
    ratio = (across / along) ** 2
    denominator = 3.0 * (3.0 + ratio)
    return (10.0 + 4.0 * ratio + 2.0 * ratio**2 * poisson_square(poisson_ratio)) / denominator
