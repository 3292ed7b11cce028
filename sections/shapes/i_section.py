"""I-section: two flanges on a web."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from linkwright.core.sections.formulas.fillets import ARC_CHORDS, fillet_factors, fillet_torsion, spandrel
from linkwright.core.sections.formulas.open_walls import i_section_warping
from linkwright.core.sections.formulas.plastic import layered_modulus
from linkwright.core.sections.formulas.thin_walls import Flange, i_section_shear_factors, i_section_torsion_constant
from linkwright.core.sections.numeric import Number, maximum
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    SectionError,
    closed,
    common_properties,
    design_variables,
    opening,
    stress_area,
)
from linkwright.core.sections.wall import Wall, WallKind


@dataclass(frozen=True)
class ISection(Section):
    """An I-section, symmetric about its web; the flanges may differ. A rolled one has root fillets.

    In short form (width, height, flange_thickness, web_thickness) both flanges are equal, and an optimiser
    chooses
    just these four. `FreeFlangeISection` frees each flange.

    Attributes:
        width: of every flange whose width is not given by itself, m.
        height: overall, along z, m.
        flange_thickness: of every flange whose thickness is not given by itself, m.
        web_thickness: m.
        top_flange_width: m.
        bottom_flange_width: m.
        top_flange_thickness: m.
        bottom_flange_thickness: m.
        root_radius: of the fillets between web and flanges, m; sharp without. An optimiser does not choose it.
    """

    width: Number | None = None
    height: Number = None
    flange_thickness: Number | None = None
    web_thickness: Number = None
    top_flange_width: Number | None = None
    bottom_flange_width: Number | None = None
    top_flange_thickness: Number | None = None
    bottom_flange_thickness: Number | None = None
    root_radius: Number | None = None

    shape: ClassVar[str] = "i_section"
    open: ClassVar[bool] = True
    synonyms: ClassVar[tuple[str, ...]] = ("i_beam", "h_beam", "ibeam", "i", "i_profile", "double_t", "wide_flange")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "width of both flanges", "outer", unless=("top_flange_width", "bottom_flange_width")),
        Dimension("height", "overall height, in the bending plane", "outer"),
        Dimension(
            "flange_thickness",
            "thickness of both flanges",
            "wall",
            unless=("top_flange_thickness", "bottom_flange_thickness"),
        ),
        Dimension("web_thickness", "thickness of the web", "wall"),
        Dimension("top_flange_width", "width of the top flange", "outer", optional=True),
        Dimension("bottom_flange_width", "width of the bottom flange", "outer", optional=True),
        Dimension("top_flange_thickness", "thickness of the top flange", "wall", optional=True),
        Dimension("bottom_flange_thickness", "thickness of the bottom flange", "wall", optional=True),
        Dimension("root_radius", "radius of the fillets between web and flanges", "radius", optional=True),
    )

    def __post_init__(self) -> None:
        for name in ("height", "web_thickness"):
            if getattr(self, name) is None:
                raise SectionError(name, "is missing")
        for flange in (self.top, self.bottom):
            if flange.width is None:
                raise SectionError("width", "give width, or top_flange_width and bottom_flange_width")
            if flange.thickness is None:
                raise SectionError(
                    "flange_thickness",
                    "give flange_thickness, or top_flange_thickness and bottom_flange_thickness",
                )
        if self.root_radius is not None and not self.symmetric:
            raise SectionError("root_radius", "goes with equal flanges only (width and flange_thickness)")

    @property
    def top(self) -> Flange:
        """Width and thickness of the top flange."""
        return Flange(
            self.width if self.top_flange_width is None else self.top_flange_width,
            self.flange_thickness if self.top_flange_thickness is None else self.top_flange_thickness,
        )

    @property
    def bottom(self) -> Flange:
        """Width and thickness of the bottom flange."""
        return Flange(
            self.width if self.bottom_flange_width is None else self.bottom_flange_width,
            self.flange_thickness if self.bottom_flange_thickness is None else self.bottom_flange_thickness,
        )

    @property
    def symmetric(self) -> bool:
        """Whether both flanges are given by the same dimensions."""
        entries = (
            self.top_flange_width,
            self.bottom_flange_width,
            self.top_flange_thickness,
            self.bottom_flange_thickness,
        )
        return all(value is None for value in entries)

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); J and shear areas are fits, see `sections.formulas.thin_walls` for their range and error.

        Root fillets enter area, second and plastic moduli exactly, J and shear areas as `sections.formulas.fillets`
        says, the warping constant not at all: they are near the middle, where nothing warps. The torsion modulus is J
        over the greatest thickness, the value for an open thin-walled section; the stress concentration at the inner
        corners is left out, as design codes do.
        """
        top, bottom, web = self.top, self.bottom, self.web_thickness
        height = self.height
        web_height = height - top.thickness - bottom.thickness
        parts = (
            (bottom.width, bottom.thickness, 0.5 * bottom.thickness),
            (web, web_height, bottom.thickness + 0.5 * web_height),
            (top.width, top.thickness, height - 0.5 * top.thickness),
        )
        area = sum(b * t for b, t, _ in parts)
        plastic_y = layered_modulus([(b, t) for b, t, _ in parts])
        centroid = 0.5 * height if self.symmetric else sum(b * t * z for b, t, z in parts) / area
        second_moment_y = sum(b * t**3 / 12.0 + b * t * (z - centroid) ** 2 for b, t, z in parts)
        second_moment_z = sum(t * b**3 / 12.0 for b, t, _ in parts)
        plastic_z = 0.25 * sum(t * b**2 for b, t, _ in parts)
        same = self.symmetric
        width = top.width if same else maximum(top.width, bottom.width)
        fibre = 0.5 * height if same else maximum(centroid, height - centroid)
        thickest = maximum(top.thickness if same else maximum(top.thickness, bottom.thickness), web)
        torsion_constant = i_section_torsion_constant(top, None if same else bottom, height, web)
        shear_centre, warping = i_section_warping(top, None if same else bottom, height, web, centroid)
        moments = (area, centroid, second_moment_y, second_moment_z)
        shear = i_section_shear_factors(top, None if same else bottom, height, web, poisson_ratio, *moments)
        upper = top.width * top.thickness * (height - 0.5 * top.thickness - centroid)
        lower = bottom.width * bottom.thickness * (centroid - 0.5 * bottom.thickness)
        ends = height - top.thickness - centroid, centroid - bottom.thickness
        junction = ends[0] if same else maximum(*ends)
        radius = self.root_radius
        if radius is not None:
            without = i_section_shear_factors(top, None, height, web, 0.0, *moments)
            along_z, along_y, by_poisson = fillet_factors(width, height, top.thickness, web, radius)
            shear = (without[0] * along_y + (shear[0] - without[0]) * by_poisson, shear[1] * along_z)
            torsion_constant = fillet_torsion(width, top.thickness, web, radius, torsion_constant)
            in_y = spandrel(radius, top.thickness - 0.5 * height, 1.0)
            in_z = spandrel(radius, 0.5 * web, 1.0)
            area = area + 4.0 * in_y.area
            second_moment_y = second_moment_y + 4.0 * in_y.second
            second_moment_z = second_moment_z + 4.0 * in_z.second
            plastic_y = plastic_y - 4.0 * in_y.first
            plastic_z = plastic_z + 4.0 * in_z.first
        return common_properties(
            shear=shear,
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion_constant,
            plastic_modulus_y=plastic_y,
            plastic_modulus_z=plastic_z,
            extreme_fibre_y=fibre,
            torsion_modulus=torsion_constant / thickest,
            width=width,
            height=height,
            centroid_z=centroid,
            shear_centre_z=shear_centre,
            warping_constant=warping,
            shear_stress_area_y=stress_area(
                second_moment_z, top.thickness + bottom.thickness, 0.125 * sum(t * b**2 for b, t, _ in parts)
            ),
            shear_stress_area_z=stress_area(
                second_moment_y, web, upper + 0.5 * web * (height - top.thickness - centroid) ** 2
            ),
            junction_modulus_y=second_moment_y / junction,
            junction_shear_area_z=stress_area(second_moment_y, web, upper if same else maximum(upper, lower)),
        )

    def outline(self) -> Outline:
        """Twelve corners, four of them with fillets where there is a root radius."""
        top, bottom = self.top, self.bottom
        w, h = 0.5 * self.web_thickness, self.height
        low, high = [(w, bottom.thickness)], [(w, h - top.thickness)]
        if self.root_radius is not None:
            r = self.root_radius
            turn = np.linspace(0.0, 0.5 * math.pi, ARC_CHORDS + 1)
            rise = [(w + r * (1.0 - math.cos(a)), r * (1.0 - math.sin(a))) for a in turn]
            low = [(y, bottom.thickness + z) for y, z in reversed(rise)]
            high = [(y, h - top.thickness - z) for y, z in rise]
        right = [
            (0.5 * bottom.width, 0.0),
            (0.5 * bottom.width, bottom.thickness),
            *low,
            *high,
            (0.5 * top.width, h - top.thickness),
            (0.5 * top.width, h),
        ]
        points = right + [(-y, z) for y, z in reversed(right)]
        centroid = self.properties(0.0).centroid_z
        return [closed([(y, z - centroid) for y, z in points])]

    def constraints(self) -> tuple[Constraint, ...]:
        """Flanges must overhang the web and leave a web between them."""
        top, bottom = self.top, self.bottom
        overhangs = [("flange", top)] if self.symmetric else [("top flange", top), ("bottom flange", bottom)]
        return (
            opening(
                "web_height", "both flange thicknesses", "the height", (top.thickness + bottom.thickness) / self.height
            ),
            *(
                opening(
                    name.replace(" ", "_") + "_overhang",
                    "the web thickness",
                    f"the {name} width",
                    self.web_thickness / flange.width,
                )
                for name, flange in overhangs
            ),
            *self._fillet_constraints(),
        )

    def _fillet_constraints(self) -> tuple[Constraint, ...]:
        if self.root_radius is None:
            return ()
        overhang = 0.5 * (self.top.width - self.web_thickness)
        clear = 0.5 * (self.height - self.top.thickness - self.bottom.thickness)
        return (
            # Over the whole, since the web and the overhang themselves may be none.
            Constraint(
                "root_radius", "the root radius must leave a web", 2.0 * (self.root_radius - clear) / self.height
            ),
            Constraint(
                "root_overhang",
                "the root radius must fit under the flange",
                2.0 * (self.root_radius - overhang) / self.top.width,
            ),
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """Where they are and how they are held."""
        root = 0.0 if self.root_radius is None else self.root_radius
        top, bottom, height = self.top, self.bottom, self.height
        clear = height - top.thickness - bottom.thickness - 2.0 * root
        middle = 0.5 * maximum(top.width, bottom.width)
        same = self.symmetric
        flanges = [("flange", "the flanges", top, height - 0.5 * top.thickness)]
        if not same:
            flanges = [("top_flange", "the top flange", top, height - 0.5 * top.thickness)]
            flanges.append(("bottom_flange", "the bottom flange", bottom, 0.5 * bottom.thickness))
            web = "internal"
        stem = 0.5 * self.web_thickness + root
        return (
            *(
                Wall(
                    name,
                    text,
                    "outstand",
                    0.5 * flange.width - stem,
                    flange.thickness,
                    ((middle + stem, z), (middle + 0.5 * flange.width, z)),
                    mirrored=(same, True),
                )
                for name, text, flange, z in flanges
            ),
            Wall(
                "web",
                "the web",
                web,
                clear,
                self.web_thickness,
                ((middle, bottom.thickness + root), (middle, height - top.thickness - root)),
                mirrored=(same, True),
            ),
        )


@dataclass(frozen=True)
class FreeFlangeISection(ISection):
    """The same shape with six design variables: an optimiser may make the flanges differ."""

    variables: ClassVar[tuple[DesignVariable, ...]] = design_variables(
        ISection.dimensions,
        "top_flange_width",
        "bottom_flange_width",
        "height",
        "top_flange_thickness",
        "bottom_flange_thickness",
        "web_thickness",
    )

    def variable_values(self) -> tuple[Number, ...]:
        """Both flange widths, the height, both flange thicknesses and the web thickness (m)."""
        top, bottom = self.top, self.bottom
        return (top.width, bottom.width, self.height, top.thickness, bottom.thickness, self.web_thickness)
