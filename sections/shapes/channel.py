"""Channel: a web and two equal flanges on the same side of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.formulas.open_walls import (
    channel_shear_centre,
    channel_shear_factors,
    channel_torsion_constant,
    channel_warping_constant,
)
from linkwright.core.sections.formulas.plastic import layered_modulus
from linkwright.core.sections.numeric import Number, maximum
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    Dimension,
    Outline,
    Section,
    closed,
    common_properties,
    opening,
    stress_area,
)
from linkwright.core.sections.wall import Wall, WallKind


@dataclass(frozen=True)
class Channel(Section):
    """A channel (U-section) with sharp corners and parallel flanges: the web stands at the left, along the height.

    Its shear centre is not at its centroid but outside the web, for thin walls 3 b^2 t_f / (6 b t_f + h t_w) to the
    left of the web's middle (b and h between the middles of the walls): a load through the centroids twists it.

    Attributes:
        width: of the flanges, from the outside of the web, m.
        height: overall, along z, m.
        flange_thickness: of both flanges, m.
        web_thickness: m.
    """

    width: Number
    height: Number
    flange_thickness: Number
    web_thickness: Number

    shape: ClassVar[str] = "channel"
    open: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("u_section", "u_profile", "c_section", "c_profile")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "width of both flanges, with the web", "outer"),
        Dimension("height", "overall height, in the bending plane", "outer"),
        Dimension("flange_thickness", "thickness of both flanges", "wall"),
        Dimension("web_thickness", "thickness of the web", "wall"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J, shear areas, shear centre and warping constant.

        These hold within 1 % of boundary element solutions for width / height from 0.2 to 1.6, flanges of 0.01 to 0.25
        of the height and a web of 0.01 to 0.25 of the width (`sections.formulas.open_walls`).
        """
        b, h, t, w = self.width, self.height, self.flange_thickness, self.web_thickness
        clear = h - 2.0 * t
        area = 2.0 * b * t + clear * w
        y = (b**2 * t + 0.5 * clear * w**2) / area
        second_moment_y = (b * h**3 - (b - w) * clear**3) / 12.0
        in_flanges = 2.0 * (t * b**3 / 12.0 + b * t * (0.5 * b - y) ** 2)
        second_moment_z = in_flanges + clear * w**3 / 12.0 + clear * w * (0.5 * w - y) ** 2
        torsion = channel_torsion_constant(b, h, t, w)
        return common_properties(
            shear=channel_shear_factors(b, h, t, w, poisson_ratio, area, y, (second_moment_y, second_moment_z)),
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion,
            plastic_modulus_y=layered_modulus([(b, t), (w, clear), (b, t)]),
            plastic_modulus_z=layered_modulus([(h, w), (2.0 * t, b - w)]),
            extreme_fibre_z=maximum(y, b - y),
            torsion_modulus=torsion / maximum(t, w),
            width=b,
            height=h,
            centroid_y=y,
            shear_centre_y=-channel_shear_centre(b, h, t, w, y),
            shear_stress_area_y=stress_area(second_moment_z, 2.0 * t, t * (b - y) ** 2),
            shear_stress_area_z=stress_area(second_moment_y, w, 0.5 * b * t * (h - t) + 0.125 * w * clear**2),
            junction_modulus_y=2.0 * second_moment_y / clear,
            junction_shear_area_z=stress_area(second_moment_y, w, 0.5 * b * t * (h - t)),
            warping_constant=channel_warping_constant(b, h, t, w),
        )

    def outline(self) -> Outline:
        """Eight corners."""
        b, h, t, w = self.width, self.height, self.flange_thickness, self.web_thickness
        y = self.properties(0.0).centroid_y
        corners = [(0.0, 0.0), (b, 0.0), (b, t), (w, t), (w, h - t), (b, h - t), (b, h), (0.0, h)]
        return [closed([(corner - y, z - 0.5 * h) for corner, z in corners])]

    def constraints(self) -> tuple[Constraint, ...]:
        """Flanges must overhang the web and leave a web between them."""
        return (
            opening("web_height", "both flange thicknesses", "the height", 2.0 * self.flange_thickness / self.height),
            opening("flange_overhang", "the web thickness", "the width", self.web_thickness / self.width),
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Where they are and how they are held."""
        b, h, flange, stem = self.width, self.height, self.flange_thickness, self.web_thickness
        top = h - 0.5 * flange
        mirrored = (True, False)
        return (
            Wall("flange", "the flanges", "outstand", b - stem, flange, ((stem, top), (b, top)), mirrored=mirrored),
            Wall(
                "web",
                "the web",
                web,
                h - 2.0 * flange,
                stem,
                ((0.5 * stem, flange), (0.5 * stem, h - flange)),
                mirrored=mirrored,
            ),
        )
