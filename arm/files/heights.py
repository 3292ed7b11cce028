"""Where an arm file has a section's height point: `up`, which is told of the whole arm."""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.arm.chain.vectors import cross, norm, subtract
from linkwright.core.arm.placed.heights import height_up
from linkwright.core.units.reading import Mapping

UP = "up"
"""Against gravity, with all joints at zero."""
_AS_READ = 1e-9


def stood_up(mapping: Mapping, arm: Arm) -> Arm:
    """The arm with the heights that its file calls `up` as directions in their links' frames. Raises `InputError` where
    nothing is up, and for a height that lies along its link."""
    links: list[Link] = []
    for index, link in enumerate(arm.links):
        key = f"chain[{index + 1}].link.height_direction"
        if link.height_up:
            if not any(arm.gravity):
                raise mapping.error(key, f"cannot be {UP} where gravity is zero; give a vector in the link's frame")
            up = height_up(arm, index)
            if up is None:
                message = f"cannot be {UP}: with all joints at zero the link stands upright; give a vector across it"
                raise mapping.error(key, f"{message}, e.g. [0, 1, 0] in the link's frame")
            link = replace(link, height_direction=up)
        if link.height_direction is not None and norm(cross(link.direction, link.height_direction)) < _AS_READ:
            raise mapping.error(key, "lies along the link; it must point across")
        links.append(link)
    return arm.with_links(tuple(links))


def height_to_value(arm: Arm, index: int) -> object:
    """The direction of a link's height (from 0) as an arm file holds it: `up` where it was called so and still is."""
    link = arm.links[index]
    if link.height_up and link.height_direction is not None:
        up = height_up(arm, index)
        if up is not None and norm(subtract(up, link.height_direction)) < _AS_READ:
            return UP
    return None if link.height_direction is None else list(link.height_direction)
