"""T-section: a flange on top of a web."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from linkwright.core.sections.formulas.open_walls import (
    t_shear_centre,
    t_shear_factors,
    t_torsion_constant,
    t_warping_constant,
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
class TSection(Section):
    """A T-section with sharp corners: the flange lies on top, the web hangs from its middle.

    Its shear centre is where flange and web meet, not at the centroid. Loads in the plane of the web pass through both,
    and do not twist it; a load across that plane does.

    Attributes:
        width: of the flange, m.
        height: overall, along z, m.
        flange_thickness: m.
        web_thickness: m.
    """

    width: Number
    height: Number
    flange_thickness: Number
    web_thickness: Number

    shape: ClassVar[str] = "t_section"
    open: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("t_beam", "tee", "t_profile")
    most_wall: ClassVar[float] = 1.0
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "width of the flange", "outer"),
        Dimension("height", "overall height, in the bending plane", "outer"),
        Dimension("flange_thickness", "thickness of the flange", "wall"),
        Dimension("web_thickness", "thickness of the web", "wall"),
    )

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI), exact but for J, shear areas, shear centre and warping constant.

        These hold within 1 % of boundary element solutions for width / height from 0.6 to 3, a flange of 0.01 to 0.25
        of the height and a web of 0.01 to 0.25 of the width (`sections.formulas.open_walls`).
        """
        b, h, t, w = self.width, self.height, self.flange_thickness, self.web_thickness
        clear = h - t
        area = b * t + clear * w
        below_top = (0.5 * b * t**2 + clear * w * (t + 0.5 * clear)) / area
        in_flange = b * t**3 / 12.0 + b * t * (below_top - 0.5 * t) ** 2
        second_moment_y = in_flange + w * clear**3 / 12.0 + w * clear * (t + 0.5 * clear - below_top) ** 2
        second_moment_z = (t * b**3 + clear * w**3) / 12.0
        torsion = t_torsion_constant(b, h, t, w)
        return common_properties(
            shear=t_shear_factors(b, h, t, w, poisson_ratio, area, below_top, (second_moment_y, second_moment_z)),
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion,
            plastic_modulus_y=layered_modulus([(w, clear), (b, t)]),
            plastic_modulus_z=0.25 * (t * b**2 + clear * w**2),
            extreme_fibre_y=maximum(below_top, h - below_top),
            torsion_modulus=torsion / maximum(t, w),
            width=b,
            height=h,
            centroid_z=h - below_top,
            shear_centre_z=t_shear_centre(b, h, t, w, below_top),
            shear_stress_area_y=stress_area(second_moment_z, t, 0.125 * (t * b**2 + clear * w**2)),
            shear_stress_area_z=stress_area(second_moment_y, w, 0.5 * w * (h - below_top) ** 2),
            junction_modulus_y=second_moment_y / maximum(below_top - t, 0.01 * h),
            junction_shear_area_z=stress_area(second_moment_y, w, b * t * (below_top - 0.5 * t)),
            warping_constant=t_warping_constant(b, h, t, w),
        )

    def outline(self) -> Outline:
        """Eight corners."""
        b, h, t, w = 0.5 * self.width, self.height, self.flange_thickness, 0.5 * self.web_thickness
        z0 = self.properties(0.0).centroid_z
        corners = [(-w, 0.0), (w, 0.0), (w, h - t), (b, h - t), (b, h), (-b, h), (-b, h - t), (-w, h - t)]
        return [closed([(y, z - z0) for y, z in corners])]

    def constraints(self) -> tuple[Constraint, ...]:
        """The flange must overhang the web and leave some web below it."""
        return (
            opening("web_height", "the flange thickness", "the height", self.flange_thickness / self.height),
            opening("flange_overhang", "the web thickness", "the width", self.web_thickness / self.width),
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """The web's free edge may be the compressed one, so it counts as an outstand too."""
        del web
        b, h, flange, stem = self.width, self.height, self.flange_thickness, self.web_thickness
        top, root, middle = h - 0.5 * flange, 0.5 * (b + stem), 0.5 * b
        mirrored = (False, True)
        return (
            Wall(
                "flange", "the flange", "outstand", 0.5 * (b - stem), flange, ((root, top), (b, top)), mirrored=mirrored
            ),
            Wall(
                "web", "the web", "outstand", h - flange, stem, ((middle, h - flange), (middle, 0.0)), mirrored=mirrored
            ),
        )
