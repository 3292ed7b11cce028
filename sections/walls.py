"""The walls of a section: where each is and how it is held, and the slenderness at which it buckles before it yields.

EN 1993-1-1:2005, table 5.2, class 3: within the limits every wall reaches the yield strength before it buckles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from linkwright.core.sections.numeric import Number, sqrt
from linkwright.core.sections.section import Constraint, Section
from linkwright.core.sections.wall import Arc, Point, Wall, WallKind

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
    limits: list[WallLimit] = []
    for wall in (*known, *section.together()):
        factor, power = LIMITS[wall.kind]
        limits.append(WallLimit(wall, factor * (square if power == 2 else sqrt(square))))
    return tuple(limits)


def is_solid(shape: type[Section]) -> bool:
    """Whether a shape is known to have no walls that could buckle."""
    return shape.solid


def walls(section: Section, centroid: Point = (0.0, 0.0), *, bending_only: bool = False) -> tuple[Wall, ...] | None:
    """The walls of a section; none for a solid one, None where they are not known (a polygon's, say).

    `centroid` (m) is that of the section from the left and lower edge of its bounding box; without it, places count
    from there.
    """
    known = section.wall_parts("bent" if bending_only else "internal")
    return None if known is None else tuple(_about(wall, centroid) for wall in known)


def _about(wall: Wall, centroid: Point) -> Wall:
    """The wall with its places counted from the centroid."""
    y, z = centroid
    ends = wall.ends
    if ends is not None:
        ends = ((ends[0][0] - y, ends[0][1] - z), (ends[1][0] - y, ends[1][1] - z))
    arcs = tuple(arc if arc.y is None else Arc(arc.radius, arc.y - y, arc.z - z) for arc in wall.arcs)
    return replace(wall, ends=ends, arcs=arcs)
