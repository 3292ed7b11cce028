"""Angle: two legs of one thickness at right angles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.fits.fit import fitted
from linkwright.core.sections.formulas.closed_forms import rectangle_torsion_constant
from linkwright.core.sections.formulas.open_walls import angle_shear_centre, angle_warping_constant
from linkwright.core.sections.formulas.plastic import layered_modulus
from linkwright.core.sections.numeric import Number, exp, maximum, sqrt
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    Dimension,
    Outline,
    Section,
    closed,
    common_properties,
    opening,
    poisson_square,
    stress_area,
)
from linkwright.core.sections.wall import Wall, WallKind


@dataclass(frozen=True)
class Angle(Section):
    """An angle with sharp corners: one leg lies at the bottom, the other stands at its left end.

    Its axes y and z are not principal: `product_moment_yz` is not zero, and a force along z bends it sideways too.
    The second moments, section moduli and shear areas are those about y and z, as for a link that its joints keep
    in the plane; free to give way sideways it would bend by I_y - I_yz^2 / I_z. See `principal_moments`.

    Attributes:
        width: of the leg along y, m.
        height: of the leg along z, m.
        thickness: of both legs, m.
    """

    width: Number
    height: Number
    thickness: Number

    shape: ClassVar[str] = "angle"
    open: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("l_section", "l_profile")
    most_wall: ClassVar[float] = 1.0
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "length of the leg across the bending plane", "outer"),
        Dimension("height", "length of the leg in the bending plane", "outer"),
        Dimension("thickness", "thickness of both legs", "wall"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J, shear areas, shear centre and warping constant.

        These are fits to boundary element solutions, within 0.8 % for width / height from 0.3 to 3.5 and a thickness
        of 0.01 to 0.25 of the shorter leg. The torsion modulus is J over the thickness, the value for an open
        thin-walled section; the stress concentration at the inner corner is left out, as design codes do.
        """
        b, h, t = self.width, self.height, self.thickness
        rise = h - t
        area = t * (b + rise)
        y = (0.5 * b**2 + 0.5 * rise * t) / (b + rise)
        z = (0.5 * b * t + rise * (t + 0.5 * rise)) / (b + rise)
        legs = ((b * t, 0.5 * b - y, 0.5 * t - z), (t * rise, 0.5 * t - y, t + 0.5 * rise - z))
        second_moment_y = (b * t**3 + t * rise**3) / 12.0 + sum(a * dz**2 for a, _, dz in legs)
        second_moment_z = (t * b**3 + rise * t**3) / 12.0 + sum(a * dy**2 for a, dy, _ in legs)
        torsion = angle_torsion_base(b, h, t) * exp(fitted("angle_torsion", _features(b, h, t)))
        shear_centre = angle_shear_centre(b, h, t, (y, z))
        return common_properties(
            shear=angle_shear_factors(b, h, t, poisson_ratio),
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion,
            plastic_modulus_y=layered_modulus([(b, t), (t, rise)]),
            plastic_modulus_z=layered_modulus([(h, t), (t, b - t)]),
            extreme_fibre_y=maximum(z, h - z),
            extreme_fibre_z=maximum(y, b - y),
            torsion_modulus=torsion / t,
            width=b,
            height=h,
            centroid_y=y,
            centroid_z=z,
            product_moment_yz=sum(a * dy * dz for a, dy, dz in legs),
            shear_stress_area_y=stress_area(second_moment_z, t, 0.5 * t * (b - y) ** 2),
            shear_stress_area_z=stress_area(second_moment_y, t, 0.5 * t * (h - z) ** 2),
            shear_centre_y=shear_centre[0],
            shear_centre_z=shear_centre[1],
            warping_constant=angle_warping_constant(b, h, t),
        )

    def outline(self) -> Outline:
        """Six corners."""
        b, h, t = self.width, self.height, self.thickness
        result = self.properties(0.0)
        corners = [(0.0, 0.0), (b, 0.0), (b, t), (t, t), (t, h), (0.0, h)]
        return [closed([(y - result.centroid_y, z - result.centroid_z) for y, z in corners])]

    def constraints(self) -> tuple[Constraint, ...]:
        """The thickness must stay below both legs."""
        return (
            opening("leg_width", "the thickness", "the width", self.thickness / self.width),
            opening("leg_height", "the thickness", "the height", self.thickness / self.height),
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Where they are and how they are held."""
        del web
        b, h, t = self.width, self.height, self.thickness
        one, askew = 0.5 * t, (False, False)
        return (
            Wall("leg_width", "the lying leg", "angle", b, t, ((t, one), (b, one)), mirrored=askew),
            Wall("leg_height", "the standing leg", "angle", h, t, ((one, t), (one, h)), mirrored=askew),
        )

    def together(self) -> tuple[Wall, ...]:
        """Of an angle the mean of its legs is limited too."""
        return (Wall("legs", "both legs", "legs", 0.5 * (self.width + self.height), self.thickness),)


def _features(width: Number, height: Number, thickness: Number) -> tuple[Number, Number]:
    return (width - height) / (width + height), thickness / width + thickness / height


def angle_torsion_base(width: Number, height: Number, thickness: Number) -> Number:
    """J of an angle before the fit, m^4: between the corner given to one leg and to the other."""
    rectangle, t = rectangle_torsion_constant, thickness
    one = rectangle(width, t) + rectangle(height - t, t)
    other = rectangle(height, t) + rectangle(width - t, t)
    return sqrt(0.5 * (one**2 + other**2))


def angle_shear_factors(
    width: Number, height: Number, thickness: Number, poisson_ratio: Number
) -> tuple[Number, Number]:
    """A / A_sy and A / A_sz of an angle."""
    features = _features(width, height, thickness)
    poisson = poisson_square(poisson_ratio) * (thickness / height) ** 2
    along_y = exp(fitted("angle_shear_y", features)) + poisson * exp(fitted("angle_poisson_y", features))
    along_z = exp(fitted("angle_shear_z", features)) + poisson * exp(fitted("angle_poisson_z", features))
    return along_y, along_z
