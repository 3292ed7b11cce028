"""What to keep clear of, as arm files, recordings' settings and problems hold them."""

from __future__ import annotations

import math
from typing import Any, Literal

from linkwright.core.arm.avoid.links import OtherLinks
from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.avoid.regions import AXES, Region, between, beyond
from linkwright.core.units.quantities import format_quantity, read_quantity, shown
from linkwright.core.units.reading import Mapping

_EXAMPLE = "{below: {z: 0 mm}} or {box: [[0 m, -1 m, 0 m], [1 m, 1 m, 0.4 m]]}"
_SIDES: tuple[Literal["below", "above"], ...] = ("below", "above")


def read_avoid(mapping: Mapping) -> tuple[Obstacle, ...]:
    """What is under `avoid`, none where it is absent: `{box: [corner, corner]}`, `{below: {z: 0 mm}}` or `above`, of x,
    y or z, and `{links: true}`. Raises `InputError`."""
    return tuple(_obstacle(entry) for entry in mapping.mappings("avoid")) if mapping.has("avoid") else ()


def _obstacle(entry: Mapping) -> Obstacle:
    with entry.reading():
        kinds = [name for name in ("box", *_SIDES, "links") if entry.has(name)]
        if len(kinds) != 1:
            raise entry.error("", f"needs one of box, below, above and links, e.g. {_EXAMPLE}")
        if kinds[0] == "links":
            if entry.raw("links") is not True:
                raise entry.error("links", "is true: links that share no joint keep clear of one another")
            return OtherLinks()
        if kinds[0] == "box":
            corners = entry.items("box")
            corner_values = [_corner(entry, value, number) for number, value in enumerate(corners, start=1)]
            if len(corner_values) != 2 or len(corner_values[0]) != len(corner_values[1]):
                raise entry.error("box", f"needs two corners of as many coordinates, e.g. {_EXAMPLE}")
            return between(*corner_values)
        side = _SIDES[0] if kinds[0] == _SIDES[0] else _SIDES[1]
        with entry.mapping(side).reading() as body:
            axes = [axis for axis in AXES if body.has(axis)]
            if len(axes) != 1:
                raise body.error("", f"needs one of x, y and z, e.g. {_EXAMPLE}")
            return beyond(side, axes[0], body.quantity(axes[0], "length"))


def _corner(entry: Mapping, value: object, number: int) -> list[float]:
    key = entry.path_of(f"box[{number}]")
    if not isinstance(value, list) or len(value) not in (2, 3):  # pyright: ignore[reportUnknownArgumentType]
        raise entry.error(f"box[{number}]", f"is a corner of two or three coordinates, not {shown(value)}")
    parts: list[object] = list(value)  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    return [
        read_quantity(part, "length", file=entry.file, key=f"{key}[{place}]") for place, part in enumerate(parts, 1)
    ]


def avoid_to_list(obstacles: tuple[Obstacle, ...]) -> list[dict[str, Any]]:
    """What is to be avoided as a file holds it."""
    return [_to_mapping(item) if isinstance(item, Region) else {"links": True} for item in obstacles]


def _to_mapping(region: Region) -> dict[str, Any]:
    ends = list(zip(AXES, region.low, region.high, strict=True))
    open_ = [math.isinf(low) or math.isinf(high) for _, low, high in ends]
    if sum(open_) == len(ends):
        axis, low, high = next(end for end in ends if math.isfinite(end[1]) or math.isfinite(end[2]))
        side, value = ("below", high) if math.isinf(low) else ("above", low)
        return {side: {axis: format_quantity(value, "length")}}
    width = 2 if open_[2] else 3
    return {"box": [[format_quantity(x, "length") for x in corner[:width]] for corner in (region.low, region.high)]}
