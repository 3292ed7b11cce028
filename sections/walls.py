"""The walls of a section: where each is and how it is held, and the slenderness at which it buckles before it yields.

EN 1993-1-1:2005, table 5.2, class 3: within the limits every wall reaches the yield strength before it buckles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

from linkwright.core.sections.numeric import Number, maximum, sqrt
from linkwright.core.sections.section import Constraint, Section
from linkwright.core.sections.shapes import (
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
from linkwright.core.sections.shapes.regular_polygon import half_side

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


Point: TypeAlias = tuple[Number, Number]
"""(y, z) of a point on a wall's middle line, about the section's centroid, m."""


@dataclass(frozen=True)
class Arc:
    """A point of a round wall and the radius (m) of the wall's middle line there; `y` and `z` are None where every
    direction is alike (a round tube)."""

    radius: Number
    y: Number | None = None
    z: Number | None = None


@dataclass(frozen=True)
class Wall:
    """A flat or round wall; where a section has mirror images of it, one of them.

    Attributes:
        name: short identifier.
        text: what it is, for reports.
        kind: how it is held.
        width: clear width, diameter where it is round, m: what `slenderness` counts.
        thickness: m.
        ends: the ends of a flat wall, first the one that is held; None where it is round.
        arcs: the points of a round wall.
        mirrored: whether the section has the wall's mirror image in height and in width too.
        encloses: the area (m^2) that the wall's closed section encloses, None of an open one.
    """

    name: str
    text: str
    kind: WallKind
    width: Number
    thickness: Number
    ends: tuple[Point, Point] | None = None
    arcs: tuple[Arc, ...] = ()
    mirrored: tuple[bool, bool] = (True, True)
    encloses: Number | None = None

    @property
    def slenderness(self) -> Number:
        """Clear width over thickness, c / t; diameter over thickness where it is round."""
        return self.width / self.thickness

    @property
    def free(self) -> bool:
        """Whether the second end is free."""
        return self.kind in ("outstand", "angle")


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


def slenderness_limits(
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
    known = (*known, *_both_legs(section)) if isinstance(section, Angle) else known
    limits: list[WallLimit] = []
    for wall in known:
        factor, power = LIMITS[wall.kind]
        limits.append(WallLimit(wall, factor * (square if power == 2 else sqrt(square))))
    return tuple(limits)


def is_solid(shape: type[Section]) -> bool:
    """Whether a shape is known to have no walls that could buckle."""
    return issubclass(shape, _SOLID)


def walls(section: Section, centroid: Point = (0.0, 0.0), *, bending_only: bool = False) -> tuple[Wall, ...] | None:
    """The walls of a section; none for a solid one, None where they are not known (a polygon's, say).

    `centroid` (m) is that of the section from the left and lower edge of its bounding box; without it, places count
    from there.
    """
    web: WallKind = "bent" if bending_only else "internal"
    for kind, make in _MAKERS.items():
        if isinstance(section, kind):
            return tuple(_about(wall, centroid) for wall in make(section, web))
    return () if is_solid(type(section)) else None


def _about(wall: Wall, centroid: Point) -> Wall:
    """The wall with its places counted from the centroid."""
    y, z = centroid
    ends = wall.ends
    if ends is not None:
        ends = ((ends[0][0] - y, ends[0][1] - z), (ends[1][0] - y, ends[1][1] - z))
    arcs = tuple(arc if arc.y is None else Arc(arc.radius, arc.y - y, arc.z - z) for arc in wall.arcs)
    return replace(wall, ends=ends, arcs=arcs)


def _tube(section: Tube, web: WallKind) -> tuple[Wall, ...]:
    del web
    radius = 0.5 * (section.diameter - section.thickness)
    enclosed = math.pi * radius**2
    return (
        Wall(
            "wall",
            "the wall",
            "round",
            section.diameter,
            section.thickness,
            arcs=(Arc(radius),),
            encloses=enclosed,
        ),
    )


def _elliptical(section: EllipticalTube, web: WallKind) -> tuple[Wall, ...]:
    """As a round tube of the curvature radius there: one axis squared over the other where its slenderness is asked
    for. Both are told, so that an optimiser meets no kink."""
    del web
    b, h, t = section.width, section.height, section.thickness
    half_b, half_h = 0.5 * (b - t), 0.5 * (h - t)
    arcs: list[tuple[Arc, ...]] = [(), ()]
    for step in range(_ARC_STEPS + 1):
        angle = 0.5 * math.pi * step / _ARC_STEPS
        cosine, sine = math.cos(angle), math.sin(angle)
        radius = ((half_b * sine) ** 2 + (half_h * cosine) ** 2) ** 1.5 / (half_b * half_h)
        # The points nearer to the top belong to it, the others to the sides.
        top = 2 * step >= _ARC_STEPS
        arcs[top] += (Arc(radius, 0.5 * b + half_b * cosine, 0.5 * h + half_h * sine),)
    enclosed = math.pi * half_b * half_h
    return (
        Wall("flange", "top and bottom of the wall", "round", b**2 / h, t, arcs=arcs[1], encloses=enclosed),
        Wall("web", "the sides of the wall", "round", h**2 / b, t, arcs=arcs[0], encloses=enclosed),
    )


def _rectangular(section: RectangularTube, web: WallKind) -> tuple[Wall, ...]:
    flange, side = section.walls
    b, h = section.width, section.height
    rounding = 0.0 if section.radii is None else section.radii[1]
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


def _i_section(section: ISection, web: WallKind) -> tuple[Wall, ...]:
    root = 0.0 if section.root_radius is None else section.root_radius
    top, bottom, height = section.top, section.bottom, section.height
    clear = height - top.thickness - bottom.thickness - 2.0 * root
    middle = 0.5 * maximum(top.width, bottom.width)
    same = section.symmetric
    flanges = [("flange", "the flanges", top, height - 0.5 * top.thickness)]
    if not same:
        flanges = [("top_flange", "the top flange", top, height - 0.5 * top.thickness)]
        flanges.append(("bottom_flange", "the bottom flange", bottom, 0.5 * bottom.thickness))
        web = "internal"
    stem = 0.5 * section.web_thickness + root
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
            section.web_thickness,
            ((middle, bottom.thickness + root), (middle, height - top.thickness - root)),
            mirrored=(same, True),
        ),
    )


def _angle(section: Angle, web: WallKind) -> tuple[Wall, ...]:
    del web
    b, h, t = section.width, section.height, section.thickness
    one, askew = 0.5 * t, (False, False)
    return (
        Wall("leg_width", "the lying leg", "angle", b, t, ((t, one), (b, one)), mirrored=askew),
        Wall("leg_height", "the standing leg", "angle", h, t, ((one, t), (one, h)), mirrored=askew),
    )


def _both_legs(section: Angle) -> tuple[Wall, ...]:
    """Of an angle the mean of its legs is limited too."""
    return (Wall("legs", "both legs", "legs", 0.5 * (section.width + section.height), section.thickness),)


def _channel(section: Channel, web: WallKind) -> tuple[Wall, ...]:
    b, h, flange, stem = section.width, section.height, section.flange_thickness, section.web_thickness
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


def _t_section(section: TSection, web: WallKind) -> tuple[Wall, ...]:
    """The web's free edge may be the compressed one, so it counts as an outstand too."""
    del web
    b, h, flange, stem = section.width, section.height, section.flange_thickness, section.web_thickness
    top, root, middle = h - 0.5 * flange, 0.5 * (b + stem), 0.5 * b
    mirrored = (False, True)
    return (
        Wall("flange", "the flange", "outstand", 0.5 * (b - stem), flange, ((root, top), (b, top)), mirrored=mirrored),
        Wall("web", "the web", "outstand", h - flange, stem, ((middle, h - flange), (middle, 0.0)), mirrored=mirrored),
    )


def _octagonal(section: OctagonalTube, web: WallKind) -> tuple[Wall, ...]:
    """Sides at the top, at the right and between them; the others are their mirror images."""
    del web
    t, tangent = section.thickness, half_side(section.sides)
    middle = 0.5 * section.width
    apothem, half = middle - 0.5 * t, (middle - t) * tangent
    enclosed = section.sides * tangent * apothem**2
    results: list[Wall] = []
    for name, turn in (("wall", 0.0), ("sloping", 0.25 * math.pi), ("web", 0.5 * math.pi)):
        y, z = math.sin(turn), math.cos(turn)
        ends = tuple((middle + apothem * y + s * half * z, middle + apothem * z - s * half * y) for s in (-1.0, 1.0))
        results.append(Wall(name, "each side", "internal", 2.0 * half, t, (ends[0], ends[1]), encloses=enclosed))
    return tuple(results)


def _triangular(section: TriangularTube, web: WallKind) -> tuple[Wall, ...]:
    """The hollow is the outer triangle shrunk about the centre of the inscribed circle."""
    del web
    b, h, t, radius = section.width, section.height, section.thickness, section.inscribed_radius
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


_ARC_STEPS = 8
"""Into how many steps of its parameter a quarter of an ellipse is parted."""
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
