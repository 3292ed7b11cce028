"""Rectangular tube whose walls are equal in pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.formulas.fillets import rounded_box, rounded_tube_shear, rounded_tube_torsion, spandrel
from linkwright.core.sections.formulas.thin_walls import tube_shear_factor, tube_torsion_constant
from linkwright.core.sections.numeric import Number, maximum, minimum
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    SectionError,
    common_properties,
    design_variables,
    opening,
    stress_area,
)
from linkwright.core.sections.shapes.rectangle import box
from linkwright.core.sections.wall import Wall, WallKind


@dataclass(frozen=True)
class RectangularTube(Section):
    """A rectangular tube; top and bottom walls are equal, and so are both side walls.

    Corners are sharp unless a corner radius is given; an optimiser does not choose radii.

    Attributes:
        width: outer, along y, m.
        height: outer, along z, m.
        thickness: of every wall that is not given by itself, m.
        flange_thickness: of top and bottom, m.
        web_thickness: of both sides, m.
        corner_radius: outer radius of the corners, m.
        inner_corner_radius: m; a wall less than the outer one (or zero) if it is not given.
    """

    width: Number
    height: Number
    thickness: Number | None = None
    flange_thickness: Number | None = None
    web_thickness: Number | None = None
    corner_radius: Number | None = None
    inner_corner_radius: Number | None = None

    shape: ClassVar[str] = "rectangular_tube"
    synonyms: ClassVar[tuple[str, ...]] = ("box", "box_section", "square_tube", "hollow_rectangle", "rhs", "shs")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer width, across the bending plane", "outer"),
        Dimension("height", "outer height, in the bending plane", "outer"),
        Dimension("thickness", "thickness of all walls", "wall", unless=("flange_thickness", "web_thickness")),
        Dimension("flange_thickness", "thickness of top and bottom", "wall", optional=True),
        Dimension("web_thickness", "thickness of both sides", "wall", optional=True),
        Dimension("corner_radius", "outer radius of the corners", "radius", optional=True),
        Dimension("inner_corner_radius", "inner radius of the corners", "radius", optional=True),
    )
    variables: ClassVar[tuple[DesignVariable, ...]] = design_variables(
        dimensions, "width", "height", "flange_thickness", "web_thickness"
    )

    def __post_init__(self) -> None:
        if self.thickness is None and (self.flange_thickness is None or self.web_thickness is None):
            raise SectionError("thickness", "give thickness, or flange_thickness and web_thickness")
        if self.corner_radius is None and self.inner_corner_radius is not None:
            raise SectionError("inner_corner_radius", "give corner_radius with it")

    @property
    def walls(self) -> tuple[Number, Number]:
        """Thickness of top and bottom, and of the sides, m."""
        return (
            self.thickness if self.flange_thickness is None else self.flange_thickness,
            self.thickness if self.web_thickness is None else self.web_thickness,
        )

    @property
    def inner_diameter(self) -> Number:
        """The lesser side of the hollow, m."""
        return minimum(*self.inner_widths)

    @property
    def inner_widths(self) -> tuple[Number, Number]:
        """Both sides of the hollow, m."""
        flange, web = self.walls
        return self.height - 2.0 * flange, self.width - 2.0 * web

    @property
    def radii(self) -> tuple[Number, Number] | None:
        """Outer and inner radius of the corners, m; None where they are sharp."""
        if self.corner_radius is None:
            return None
        if self.inner_corner_radius is not None:
            return self.corner_radius, self.inner_corner_radius
        flange, web = self.walls
        return self.corner_radius, maximum(self.corner_radius - 0.5 * (flange + web), 0.0)

    def variable_values(self) -> tuple[Number, ...]:
        """Width, height and both walls (m)."""
        return (self.width, self.height, *self.walls)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); J and shear areas are fits, see `sections.formulas.thin_walls` for their range and error.

        Rounded corners enter area, second and plastic moduli exactly, J and shear areas as `sections.formulas.fillets`
        says.

        The torsion modulus is Bredt's, twice the area within the wall's middle line times the thinner wall;
        the
        stress concentration at the inner corners is left out, as design codes do.
        """
        b, h = self.width, self.height
        flange, web = self.walls
        inner_b, inner_h = b - 2.0 * web, h - 2.0 * flange
        area = 2.0 * (b * flange + inner_h * web)
        # Sums of walls, not outer minus inner: no cancellation in thin walls.
        second_moment_y = b * flange * (h**2 - 2.0 * h * flange + 4.0 / 3.0 * flange**2) / 2.0 + web * inner_h**3 / 6.0
        second_moment_z = h * web * (b**2 - 2.0 * b * web + 4.0 / 3.0 * web**2) / 2.0 + flange * inner_b**3 / 6.0
        shear = (
            tube_shear_factor(h, b, web, flange, poisson_ratio, area, second_moment_z),
            tube_shear_factor(b, h, flange, web, poisson_ratio, area, second_moment_y),
        )
        torsion_constant = tube_torsion_constant(b, h, flange, web)
        plastic_y = 0.25 * (b * h**2 - inner_b * inner_h**2)
        plastic_z = 0.25 * (h * b**2 - inner_h * inner_b**2)
        if self.radii is not None:
            outer, inner = self.radii
            torsion_constant = rounded_tube_torsion(b, h, flange, web, outer, inner, torsion_constant)
            lost_y = spandrel(outer, -0.5 * h, 1.0), spandrel(inner, -0.5 * inner_h, 1.0)
            lost_z = spandrel(outer, -0.5 * b, 1.0), spandrel(inner, -0.5 * inner_b, 1.0)
            area = area - 4.0 * (lost_y[0].area - lost_y[1].area)
            second_moment_y = second_moment_y - 4.0 * (lost_y[0].second - lost_y[1].second)
            second_moment_z = second_moment_z - 4.0 * (lost_z[0].second - lost_z[1].second)
            plastic_y = plastic_y + 4.0 * (lost_y[0].first - lost_y[1].first)
            plastic_z = plastic_z + 4.0 * (lost_z[0].first - lost_z[1].first)
            shear = (
                rounded_tube_shear(h, b, web, flange, (outer, inner), (area, second_moment_z), shear[0]),
                rounded_tube_shear(b, h, flange, web, (outer, inner), (area, second_moment_y), shear[1]),
            )
        return common_properties(
            shear=shear,
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion_constant,
            plastic_modulus_y=plastic_y,
            plastic_modulus_z=plastic_z,
            torsion_modulus=2.0 * (b - web) * (h - flange) * minimum(flange, web),
            shear_stress_area_y=stress_area(second_moment_z, 2.0 * flange, 0.5 * plastic_z),
            shear_stress_area_z=stress_area(second_moment_y, 2.0 * web, 0.5 * plastic_y),
            junction_modulus_y=2.0 * second_moment_y / (h - 2.0 * flange),
            junction_shear_area_z=stress_area(second_moment_y, 2.0 * web, 0.5 * b * flange * (h - flange)),
            width=b,
            height=h,
        )

    def outline(self) -> Outline:
        """The outer and the inner rectangle."""
        flange, web = self.walls
        inner_b, inner_h = self.width - 2.0 * web, self.height - 2.0 * flange
        if self.radii is None:
            return [box(self.width, self.height), box(inner_b, inner_h, clockwise=True)]
        outer, inner = self.radii
        return [rounded_box(self.width, self.height, outer), rounded_box(inner_b, inner_h, inner)[::-1]]

    def constraints(self) -> tuple[Constraint, ...]:
        """The walls must leave a hollow."""
        flange, web = self.walls
        return (
            opening("hollow_width", "two web thicknesses", "the width", 2.0 * web / self.width),
            opening("hollow_height", "two flange thicknesses", "the height", 2.0 * flange / self.height),
            *self._radius_constraints(),
        )

    def _radius_constraints(self) -> tuple[Constraint, ...]:
        if self.radii is None:
            return ()
        flange, web = self.walls
        outer, inner = self.radii
        half = 0.5 * minimum(self.width, self.height)
        hollow = 0.5 * minimum(self.width - 2.0 * web, self.height - 2.0 * flange)
        return (
            Constraint("corner_radius", "the corner radius must be at most half the least side", outer / half - 1.0),
            Constraint(
                "inner_corner_radius",
                "the inner corner radius must be at most half the hollow",
                (inner - hollow) / half,  # the hollow itself may be none
            ),
            Constraint(
                "corner_wall",
                "the corner must not be thinner than the wall: inner radius at most the outer one",
                (inner - outer) / half,
            ),
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Where they are and how they are held."""
        flange, side = self.walls
        b, h = self.width, self.height
        rounding = 0.0 if self.radii is None else self.radii[1]
        across = b - 2.0 * side - 2.0 * rounding
        along = h - 2.0 * flange - 2.0 * rounding
        enclosed = (b - side) * (h - flange)
        top, right = h - 0.5 * flange, b - 0.5 * side
        return (
            Wall(
                "flange",
                "top and bottom",
                "internal",
                across,
                flange,
                ((side + rounding, top), (b - side - rounding, top)),
                encloses=enclosed,
            ),
            Wall(
                "web",
                "the sides",
                web,
                along,
                side,
                ((right, flange + rounding), (right, h - flange - rounding)),
                encloses=enclosed,
            ),
        )
