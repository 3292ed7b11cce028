"""Local buckling of walls: how slender each wall of a section is, and the slenderness at which it buckles first.

EN 1993-1-1:2005, table 5.2, class 3: within the limits every wall reaches the yield strength before it buckles.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

from sections.numeric import Number, sqrt
from sections.section import Constraint, Section
from sections.shapes import (
    Angle,
    Channel,
    Circle,
    Ellipse,
    EllipticalTube,
    ISection,
    Octagon,
    OctagonalTube,
    Rectangle,
    RectangularTube,
    Triangle,
    TriangularTube,
    TSection,
    Tube,
)
from sections.shapes.regular_polygon import half_side

WallKind: TypeAlias = Literal["internal", "bent", "outstand", "angle", "legs", "round"]

LIMITS: Mapping[WallKind, tuple[float, int]] = MappingProxyType(
    {
        "internal": (42.0, 1),
        "bent": (124.0, 1),
        "outstand": (14.0, 1),
        "angle": (15.0, 1),
        "legs": (11.5, 1),
        "round": (90.0, 2),
    }
)
"""Greatest slenderness over a power of epsilon, class 3: held at both edges and compressed evenly; the same and bent
about the middle; held at one edge; leg of an angle; mean of its legs; diameter over wall of a round tube."""


@dataclass(frozen=True)
class Wall:
    """A flat or round wall.

    Attributes:
        name: short identifier.
        text: what it is, for reports.
        kind: how it is held.
        slenderness: clear width over thickness, c / t; diameter over thickness where it is round.
    """

    name: str
    text: str
    kind: WallKind
    slenderness: Number


@dataclass(frozen=True)
class WallLimit:
    """A wall and how slender it may be.

    Attributes:
        wall: the wall.
        greatest: the slenderness up to which it yields before it buckles.
    """

    wall: Wall
    greatest: Number

    @property
    def utilisation(self) -> Number:
        """Slenderness over the greatest; up to 1 the wall does not buckle."""
        return self.wall.slenderness / self.greatest

    @property
    def constraint(self) -> Constraint:
        """The limit as an inequality for an optimiser."""
        text = f"{self.wall.text} must not buckle before it yields"
        return Constraint(f"buckling_{self.wall.name}", text, self.utilisation - 1.0)


def local_buckling(
    section: Section, yield_strength: Number, elastic_modulus: Number, *, bending_only: bool = False
) -> tuple[WallLimit, ...] | None:
    """The walls of a section with their limits, for strength and modulus in Pa; empty for a solid section, None for
    one whose walls are not known.

    With ``bending_only`` the walls along the height of rectangular tubes and I-sections count as bent about the
    middle (c / t up to 124 epsilon), as in a link without axial force bent in the plane; otherwise every wall counts
    as evenly compressed. epsilon is sqrt(235 MPa / f_y), times sqrt(E / 210 GPa) for materials other than steel, as
    EN 1993-1-4 has it: buckling stresses are proportional to E.
    """
    square = 235e6 / yield_strength * (elastic_modulus / 210e9)
    known = walls(section, bending_only=bending_only)
    if known is None:
        return None
    found: list[WallLimit] = []
    for wall in known:
        factor, power = LIMITS[wall.kind]
        found.append(WallLimit(wall, factor * (square if power == 2 else sqrt(square))))
    return tuple(found)


def is_solid(shape: type[Section]) -> bool:
    """Whether a shape is known to have no walls that could buckle."""
    return issubclass(shape, _SOLID)


def walls(section: Section, *, bending_only: bool = False) -> tuple[Wall, ...] | None:
    """The walls of a section; none for a solid one, None where they are not known (a polygon's, say)."""
    web: WallKind = "bent" if bending_only else "internal"
    for kind, make in _MAKERS.items():
        if isinstance(section, kind):
            return make(section, web)
    return () if is_solid(type(section)) else None


def _tube(section: Tube, web: WallKind) -> tuple[Wall, ...]:
    del web
    return (Wall("wall", "the wall", "round", section.diameter / section.thickness),)


def _elliptical(section: EllipticalTube, web: WallKind) -> tuple[Wall, ...]:
    """As a round tube of the curvature radius there: one axis squared over the other. The flatter part counts; both
    are told, so that an optimiser meets no kink."""
    del web
    b, h = section.width, section.height
    return (
        Wall("flange", "top and bottom of the wall", "round", b**2 / h / section.thickness),
        Wall("web", "the sides of the wall", "round", h**2 / b / section.thickness),
    )


def _rectangular(section: RectangularTube, web: WallKind) -> tuple[Wall, ...]:
    flange, side = section.walls
    rounding = 0.0 if section.radii is None else section.radii[1]
    across = section.width - 2.0 * side - 2.0 * rounding
    along = section.height - 2.0 * flange - 2.0 * rounding
    return (
        Wall("flange", "top and bottom", "internal", across / flange),
        Wall("web", "the sides", web, along / side),
    )


def _i_section(section: ISection, web: WallKind) -> tuple[Wall, ...]:
    root = 0.0 if section.root_radius is None else section.root_radius
    clear = section.height - section.top.thickness - section.bottom.thickness - 2.0 * root
    flanges = [("flange", "the flanges", section.top)]
    if not section.symmetric:
        flanges = [("top_flange", "the top flange", section.top)]
        flanges.append(("bottom_flange", "the bottom flange", section.bottom))
        web = "internal"
    return (
        *(
            Wall(name, text, "outstand", (0.5 * (f.width - section.web_thickness) - root) / f.thickness)
            for name, text, f in flanges
        ),
        Wall("web", "the web", web, clear / section.web_thickness),
    )


def _angle(section: Angle, web: WallKind) -> tuple[Wall, ...]:
    del web
    return (
        Wall("leg_width", "the lying leg", "angle", section.width / section.thickness),
        Wall("leg_height", "the standing leg", "angle", section.height / section.thickness),
        Wall("legs", "both legs", "legs", 0.5 * (section.width + section.height) / section.thickness),
    )


def _channel(section: Channel, web: WallKind) -> tuple[Wall, ...]:
    overhang = section.width - section.web_thickness
    clear = section.height - 2.0 * section.flange_thickness
    return (
        Wall("flange", "the flanges", "outstand", overhang / section.flange_thickness),
        Wall("web", "the web", web, clear / section.web_thickness),
    )


def _t_section(section: TSection, web: WallKind) -> tuple[Wall, ...]:
    """The web's free edge may be the compressed one, so it counts as an outstand too."""
    del web
    overhang = 0.5 * (section.width - section.web_thickness)
    clear = section.height - section.flange_thickness
    return (
        Wall("flange", "the flange", "outstand", overhang / section.flange_thickness),
        Wall("web", "the web", "outstand", clear / section.web_thickness),
    )


def _octagonal(section: OctagonalTube, web: WallKind) -> tuple[Wall, ...]:
    del web
    side = (section.width - 2.0 * section.thickness) * half_side(section.sides)
    return (Wall("wall", "each side", "internal", side / section.thickness),)


def _triangular(section: TriangularTube, web: WallKind) -> tuple[Wall, ...]:
    del web
    inner = 1.0 - section.thickness / section.inscribed_radius
    leg = sqrt(0.25 * section.width**2 + section.height**2)
    return (
        Wall("base", "the base", "internal", inner * section.width / section.thickness),
        Wall("legs", "the legs", "internal", inner * leg / section.thickness),
    )


_SOLID = (Circle, Ellipse, Rectangle, Triangle, Octagon)
"""Shapes that are solid. One that is neither here nor below has walls that nobody knows."""

_MAKERS: Mapping[type[Section], Callable[[Any, WallKind], tuple[Wall, ...]]] = MappingProxyType(
    {
        Tube: _tube,
        EllipticalTube: _elliptical,
        RectangularTube: _rectangular,
        ISection: _i_section,
        Channel: _channel,
        TSection: _t_section,
        Angle: _angle,
        OctagonalTube: _octagonal,
        TriangularTube: _triangular,
    }
)
