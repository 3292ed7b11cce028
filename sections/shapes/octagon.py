"""Regular octagon, solid or as a tube of constant wall."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sections.coefficients_open import OCTAGON_POISSON, OCTAGON_SHEAR, OCTAGON_TORSION
from sections.numeric import Number, polynomial
from sections.properties import SectionProperties
from sections.section import (
    LEAST_OPENING,
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    common_properties,
    hollow_torsion_modulus,
    poisson_square,
)

TANGENT = math.tan(math.pi / 8.0)
"""Half a side over the distance of the side from the middle."""
AREA = 2.0 * TANGENT
"""Area of an octagon of unit width."""
SECOND_MOMENT = AREA / 16.0 * (1.0 + TANGENT**2 / 3.0)
"""Its second moment about any axis through the centroid: A a^2 / 4 (1 + tan^2(pi / 8) / 3), a half the width."""
FIRST_MOMENT = (
    TANGENT**2 / 2.0 + (1.0 - TANGENT**2) * TANGENT / 2.0 + (1.0 - TANGENT) ** 2 * (1.0 + 2.0 * TANGENT) / 6.0
) / 4.0
"""First moment of its upper half."""
SOLID_TORSION_MODULUS = 0.1840
"""Torsion modulus of a solid octagon of unit width, by boundary elements."""


@dataclass(frozen=True)
class Octagon(Section):
    """A solid regular octagon that lies on one of its sides.

    Attributes:
        width: across flats, m; the height is the same.
    """

    width: Number

    shape: ClassVar[str] = "octagon"
    dimensions: ClassVar[tuple[Dimension, ...]] = (Dimension("width", "across flats", "outer"),)
    variables: ClassVar[tuple[DesignVariable, ...]] = (DesignVariable("width", "across flats", "outer"),)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J and shear areas (fits, 0.01 %)."""
        return _properties(self.width, 0.0, poisson_ratio, SOLID_TORSION_MODULUS * self.width**3)

    def outline(self) -> Outline:
        """Eight corners."""
        return [_corners(self.width)]


@dataclass(frozen=True)
class OctagonalTube(Section):
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
    variables: ClassVar[tuple[DesignVariable, ...]] = (
        DesignVariable("width", "outer width across flats", "outer"),
        DesignVariable("thickness", "wall thickness", "wall"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J and shear areas (fits, 0.01 % for walls of 0.0075 widths to solid).

        The torsion modulus is that of the middle of a side (`hollow_torsion_modulus`).
        """
        inner = 1.0 - 2.0 * self.thickness / self.width
        enclosed = AREA * (self.width - self.thickness) ** 2
        modulus = hollow_torsion_modulus(enclosed, self.thickness, _torsion_constant(self.width, inner))
        return _properties(self.width, inner, poisson_ratio, modulus)

    def outline(self) -> Outline:
        """Both edges."""
        return [_corners(self.width), _corners(self.width - 2.0 * self.thickness)[::-1]]

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must leave a hollow."""
        return (
            Constraint(
                "hollow",
                f"two walls must stay below {1.0 - LEAST_OPENING:.0%} of the width",
                2.0 * self.thickness / self.width - 1.0 + LEAST_OPENING,
            ),
        )


def _torsion_constant(width: Number, inner: Number) -> Number:
    return width**4 * (1.0 - inner**4) * polynomial(OCTAGON_TORSION, (inner,))


def _properties(width: Number, inner: Number, poisson_ratio: Number, torsion_modulus: Number) -> SectionProperties:
    """Properties of an octagon with a hollow of the same shape, ``inner`` times as large."""
    square = inner**2
    second_moment = SECOND_MOMENT * width**4 * (1.0 - square**2)
    shear = polynomial(OCTAGON_SHEAR, (inner,)) + poisson_square(poisson_ratio) * (1.0 - square) ** 2 * polynomial(
        OCTAGON_POISSON, (inner,)
    )
    plastic = 2.0 * FIRST_MOMENT * width**3 * (1.0 - inner**3)
    return common_properties(
        shear=(shear, shear),
        area=AREA * width**2 * (1.0 - square),
        second_moment_y=second_moment,
        second_moment_z=second_moment,
        torsion_constant=_torsion_constant(width, inner),
        plastic_modulus_y=plastic,
        plastic_modulus_z=plastic,
        extreme_fibre_y=0.5 * width,
        extreme_fibre_z=0.5 * width,
        torsion_modulus=torsion_modulus,
        width=width,
        height=width,
        centroid_y=0.5 * width,
        centroid_z=0.5 * width,
    )


def _corners(width: float) -> NDArray[np.float64]:
    angle = math.pi / 8.0 + np.arange(8) * math.pi / 4.0
    points = 0.5 * width / math.cos(math.pi / 8.0) * np.column_stack((np.cos(angle), np.sin(angle)))
    return np.vstack((points, points[:1]))
