"""Isosceles triangular tube of constant wall."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.formulas.closed_forms import triangle_torsion_constant
from linkwright.core.sections.formulas.open_walls import triangular_tube_shear_centre
from linkwright.core.sections.numeric import Number, absolute, exp, maximum, minimum, sqrt
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    Dimension,
    Outline,
    Section,
    closed,
    common_properties,
    hollow_torsion_modulus,
    opening,
    poisson_square,
    stress_area,
)
from linkwright.core.sections.wall import Wall, WallKind


@dataclass(frozen=True)
class TriangularTube(Section):
    """A tube whose outer edge is an isosceles triangle, base down, with a constant wall and sharp corners.

    Attributes:
        width: outer base along y, m.
        height: outer height along z, m.
        thickness: of the wall, square to it, m.
    """

    width: Number
    height: Number
    thickness: Number

    shape: ClassVar[str] = "triangular_tube"
    most_wall: ClassVar[float] = 1.0 / (1.0 + math.sqrt(5.0))
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer base, across the bending plane", "outer"),
        Dimension("height", "outer height, in the bending plane", "outer"),
        Dimension("thickness", "wall thickness", "wall"),
    )

    @property
    def inscribed_radius(self) -> Number:
        """Radius of the circle inscribed in the outer triangle, m: the wall that would fill it."""
        return self.width * self.height / (self.width + sqrt(self.width**2 + 4.0 * self.height**2))

    @property
    def inner_diameter(self) -> Number:
        """Of the hollow's inscribed circle, m."""
        return 2.0 * (self.inscribed_radius - self.thickness)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J and shear areas.

        These are fits to boundary element solutions, within 0.5 % for width / height from 0.3 to 3.5 and a wall of
        0.05 to 0.75 of the inscribed radius. The hollow is the outer triangle shrunk about the centre of the
        inscribed circle. The torsion modulus leaves out the inner corners' stress concentration, as design
        codes do (`hollow_torsion_modulus`).
        """
        b, h, t = self.width, self.height, self.thickness
        radius = self.inscribed_radius
        inner = 1.0 - t / radius
        square = inner**2
        outer_area = 0.5 * b * h
        solid, hollow = h / 3.0, radius + inner * (h / 3.0 - radius)
        centroid = (solid - square * hollow) / (1.0 - square)
        second_moment_y = b * h**3 / 36.0 * (1.0 - square**2) + outer_area * (
            (solid - centroid) ** 2 - square * (hollow - centroid) ** 2
        )
        # The wall that is cut at the apex, upright.
        leg_cut = h - (t + inner * h)
        features = (b / (b + h), inner)
        solid_torsion = triangle_torsion_constant(b, h)
        torsion = solid_torsion * (1.0 - square**2) * exp(fitted("triangular_tube_torsion", features))
        return common_properties(
            shear=_shear_factors(features, poisson_ratio),
            area=outer_area * (1.0 - square),
            second_moment_y=second_moment_y,
            second_moment_z=h * b**3 / 48.0 * (1.0 - square**2),
            torsion_constant=torsion,
            plastic_modulus_y=self._plastic_modulus_y(),
            plastic_modulus_z=h * b**2 / 12.0 * (1.0 - inner**3),
            extreme_fibre_y=maximum(h - centroid, centroid),
            shear_stress_area_y=stress_area(
                h * b**3 / 48.0 * (1.0 - square**2), t + leg_cut, h * b**2 / 24.0 * (1.0 - inner**3)
            ),
            shear_stress_area_z=stress_area(
                second_moment_y, 2.0 * t * sqrt(0.25 * b**2 + h**2) / h, self._first(centroid)
            ),
            torsion_modulus=hollow_torsion_modulus(outer_area * (1.0 - 0.5 * t / radius) ** 2, t, torsion),
            width=b,
            height=h,
            centroid_z=centroid,
            shear_centre_z=triangular_tube_shear_centre(b, h, inner),
        )

    def _first(self, line: Number) -> Number:
        """First moment (m^3) of what lies above a line at this height about it, where that is its centroid's."""
        b, h, t = self.width, self.height, self.thickness
        inner = 1.0 - t / self.inscribed_radius
        return 0.5 * (_distance_integral(b, h, 0.0, line) - _distance_integral(inner * b, inner * h, t, line))

    def _plastic_modulus_y(self) -> Number:
        """By the line that halves the area, found where it crosses base, hollow or point of the tube."""
        b, h, t = self.width, self.height, self.thickness
        inner = 1.0 - t / self.inscribed_radius
        slope, top = b / h, t + inner * h
        half = 0.25 * b * h * (1.0 - inner**2)
        in_base = minimum(h - sqrt(maximum(h**2 - 2.0 * half / slope, 0.0)), t)
        # Between: both outer triangle and hollow narrow at the same rate, so the walls' width stays.
        walls = slope * (h - top)
        below = 0.5 * slope * (h**2 - (h - t) ** 2)
        in_walls = minimum(maximum(t + (half - below) / walls, t), top)
        in_point = maximum(h - sqrt(2.0 * half / slope), top)
        least: Number = None
        for line in (in_base, in_walls, in_point):
            total = _distance_integral(b, h, 0.0, line) - _distance_integral(inner * b, inner * h, t, line)
            least = total if least is None else minimum(least, total)
        return least

    def outline(self) -> Outline:
        """Both triangles."""
        result = self.properties(0.0)
        inner = 1.0 - self.thickness / self.inscribed_radius
        y, low, high = 0.5 * self.width, -result.centroid_z, self.height - result.centroid_z
        floor = low + self.thickness
        hole = [(0.0, floor + inner * self.height), (inner * y, floor), (-inner * y, floor)]
        return [closed([(-y, low), (y, low), (0.0, high)]), closed(hole)]

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must leave a hollow."""
        return (opening("hollow", "the wall", "the inscribed circle's radius", self.thickness / self.inscribed_radius),)

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """The hollow is the outer triangle shrunk about the centre of the inscribed circle."""
        del web
        b, h, t, radius = self.width, self.height, self.thickness, self.inscribed_radius
        inner = 1.0 - t / radius
        leg = sqrt(0.25 * b**2 + h**2)
        enclosed = 0.5 * b * h * (1.0 - 0.5 * t / radius) ** 2
        middle, reach, apex = 0.5 * b, 0.5 * inner * b, radius + inner * (h - radius)
        out_y, out_z = 0.5 * t * h / leg, 0.5 * t * 0.5 * b / leg
        mirrored = (False, True)
        return (
            Wall(
                "base",
                "the base",
                "internal",
                inner * b,
                t,
                ((middle - reach, 0.5 * t), (middle + reach, 0.5 * t)),
                mirrored=mirrored,
                encloses=enclosed,
            ),
            Wall(
                "legs",
                "the legs",
                "internal",
                inner * leg,
                t,
                ((middle + reach + out_y, t + out_z), (middle + out_y, apex + out_z)),
                mirrored=mirrored,
                encloses=enclosed,
            ),
        )


def _distance_integral(base: Number, height: Number, floor: Number, line: Number) -> Number:
    """Integral of the distance from a horizontal line over a triangle that stands on its base at ``floor``, m^3."""
    slope, low, apex = base / height, floor - line, floor + height - line
    # |u| times the width slope (apex - u), from low to apex: primitive u |u| (apex / 2 - u / 3).
    return slope * (apex * absolute(apex) * apex / 6.0 - low * absolute(low) * (0.5 * apex - low / 3.0))


def _shear_factors(features: tuple[Number, Number], poisson_ratio: Number) -> tuple[Number, Number]:
    poisson = poisson_square(poisson_ratio) * (1.0 - features[1]) ** 2
    along_y = exp(fitted("triangular_tube_shear_y", features)) + poisson * exp(
        fitted("triangular_tube_poisson_y", features)
    )
    along_z = exp(fitted("triangular_tube_shear_z", features)) + poisson * exp(
        fitted("triangular_tube_poisson_z", features)
    )
    return along_y, along_z
