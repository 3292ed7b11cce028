"""Whether the walls of links buckle before they yield: EN 1993-1-1:2005, table 5.2, class 3 (see `sections.walls`).

Every wall counts as evenly compressed, whatever presses it: safe for every load and pose.
"""

from __future__ import annotations

from dataclasses import dataclass

from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.sections import Section, is_solid, slenderness_limits
from linkwright.core.sections.taper import Tapered


@dataclass(frozen=True)
class LinkWalls:
    """The worst wall of a link (numbered from 0).

    `wall` says which it is ("the sides"), None where the link is solid or its walls are not known; `slenderness` is its
    width over its thickness and `greatest` what lets it yield before it buckles. `unknown` says why nothing is known.
    """

    link: int
    wall: str | None = None
    slenderness: float = 0.0
    greatest: float = 1.0
    unknown: str | None = None

    @property
    def utilisation(self) -> float | None:
        """Slenderness over the greatest: up to 1 the wall does not buckle; 0 for a solid link, None where unknown."""
        return None if self.unknown is not None else self.slenderness / self.greatest


@dataclass(frozen=True)
class WallsResult:
    """The worst wall of each link that has a section."""

    links: tuple[LinkWalls, ...]

    @property
    def worst(self) -> float | None:
        """The greatest utilisation of any wall; 0 where no link has walls, None where those of one are not known."""
        found = [link.utilisation for link in self.links]
        if any(each is None for each in found):
            return None
        return max((each for each in found if each is not None), default=0.0)

    @property
    def unknown(self) -> str | None:
        """Why the worst is not known; None where it is."""
        reasons = [link.unknown for link in self.links if link.unknown is not None]
        return "; ".join(reasons) or None


def walls_of(arm: Arm) -> WallsResult:
    """The worst wall of each of an arm's links, at its temperature. Raises `OutOfRange` beyond a material's data."""
    pairs = [(number, link) for number, link in enumerate(arm.links) if link.section is not None]
    return WallsResult(tuple(_worst_wall(arm, number, link) for number, link in pairs))


def _worst_wall(arm: Arm, number: int, link: Link) -> LinkWalls:
    # Along a taper the slenderest place is at one of its ends.
    sections: tuple[Section | None, ...] = (link.section,)
    if isinstance(link.section, Tapered):
        sections = (link.section.near, link.section.far)
    if all(section is not None and is_solid(type(section)) for section in sections):
        return LinkWalls(number)
    values = None if link.material is None else link.material.at(arm.temperature)
    if values is None or values.yield_strength is None or values.wall_modulus is None:
        return LinkWalls(number, unknown=f"the material of link {number + 1} has no yield strength")
    found = LinkWalls(number)
    for section in sections:
        assert section is not None
        known = slenderness_limits(section, values.yield_strength, values.wall_modulus)
        if known is None:
            return LinkWalls(number, unknown=f"the walls of link {number + 1} ({section.shape}) are not known")
        for each in known:
            own = LinkWalls(number, each.wall.text, float(each.wall.slenderness), float(each.greatest))
            if (own.utilisation or 0.0) > (found.utilisation or 0.0):
                found = own
    return found
