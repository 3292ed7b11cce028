"""A wall of a section: where it is and how it is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from linkwright.core.sections.numeric import Number

WallKind: TypeAlias = Literal["internal", "bent", "outstand", "angle", "legs", "round"]

Point: TypeAlias = tuple[Number, Number]
"""(y, z) of a point on a wall's middle line, from the left and lower edge of the section's bounding box, m."""


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
