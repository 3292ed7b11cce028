"""Rectangular tube whose walls are equal in pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from sections.numeric import Number, minimum
from sections.properties import SectionProperties
from sections.section import (
    LEAST_OPENING,
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    SectionError,
    common_properties,
)
from sections.shapes.rectangle import box
from sections.thin_walls import tube_shear_factor, tube_torsion_constant


@dataclass(frozen=True)
class RectangularTube(Section):
    """A rectangular tube with sharp corners; top and bottom walls are equal, and so are both side walls.

    Attributes:
        width: outer, along y, m.
        height: outer, along z, m.
        thickness: of every wall that is not given by itself, m.
        flange_thickness: of top and bottom, m.
        web_thickness: of both sides, m.
    """

    width: Number
    height: Number
    thickness: Number | None = None
    flange_thickness: Number | None = None
    web_thickness: Number | None = None

    shape: ClassVar[str] = "rectangular_tube"
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer width, across the bending plane", "outer"),
        Dimension("height", "outer height, in the bending plane", "outer"),
        Dimension(
            "thickness", "thickness of all walls", "wall", unless=("flange_thickness", "web_thickness")
        ),
        Dimension("flange_thickness", "thickness of top and bottom", "wall", optional=True),
        Dimension("web_thickness", "thickness of both sides", "wall", optional=True),
    )
    variables: ClassVar[tuple[DesignVariable, ...]] = (
        DesignVariable("width", "outer width, across the bending plane", "outer"),
        DesignVariable("height", "outer height, in the bending plane", "outer"),
        DesignVariable("flange_thickness", "thickness of top and bottom", "wall"),
        DesignVariable("web_thickness", "thickness of both sides", "wall"),
    )

    def __post_init__(self) -> None:
        if self.thickness is None and (self.flange_thickness is None or self.web_thickness is None):
            raise SectionError("thickness", "give thickness, or flange_thickness and web_thickness")

    @property
    def walls(self) -> tuple[Number, Number]:
        """Thickness of top and bottom, and of the sides, m."""
        return (
            self.thickness if self.flange_thickness is None else self.flange_thickness,
            self.thickness if self.web_thickness is None else self.web_thickness,
        )

    def variable_values(self) -> tuple[Number, ...]:
        """Width, height and both walls (m)."""
        return (self.width, self.height, *self.walls)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); J and shear areas are fits, see `sections.thin_walls` for their range and error.

        The torsion modulus is Bredt's, twice the area within the wall's middle line times the thinner wall;
        the
        stress concentration at the inner corners is left out, as design codes do.
        """
        b, h = self.width, self.height
        flange, web = self.walls
        inner_b, inner_h = b - 2.0 * web, h - 2.0 * flange
        area = 2.0 * (b * flange + inner_h * web)
        # Sums of walls, not outer minus inner: no cancellation in thin walls.
        second_moment_y = (
            b * flange * (h**2 - 2.0 * h * flange + 4.0 / 3.0 * flange**2) / 2.0 + web * inner_h**3 / 6.0
        )
        second_moment_z = (
            h * web * (b**2 - 2.0 * b * web + 4.0 / 3.0 * web**2) / 2.0 + flange * inner_b**3 / 6.0
        )
        return common_properties(
            shear=(
                tube_shear_factor(h, b, web, flange, poisson_ratio, area, second_moment_z),
                tube_shear_factor(b, h, flange, web, poisson_ratio, area, second_moment_y),
            ),
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=tube_torsion_constant(b, h, flange, web),
            extreme_fibre_y=0.5 * h,
            extreme_fibre_z=0.5 * b,
            torsion_modulus=2.0 * (b - web) * (h - flange) * minimum(flange, web),
            width=b,
            height=h,
            centroid_y=0.5 * b,
            centroid_z=0.5 * h,
        )

    def outline(self) -> Outline:
        """The outer and the inner rectangle."""
        flange, web = self.walls
        inner = box(self.width - 2.0 * web, self.height - 2.0 * flange, clockwise=True)
        return [box(self.width, self.height), inner]

    def constraints(self) -> tuple[Constraint, ...]:
        """The walls must leave a hollow."""
        flange, web = self.walls
        share = f"{1.0 - LEAST_OPENING:.0%}"
        return (
            Constraint(
                "hollow_width",
                f"two web thicknesses must stay below {share} of the width",
                2.0 * web / self.width - 1.0 + LEAST_OPENING,
            ),
            Constraint(
                "hollow_height",
                f"two flange thicknesses must stay below {share} of the height",
                2.0 * flange / self.height - 1.0 + LEAST_OPENING,
            ),
        )
