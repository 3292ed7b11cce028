"""The kinds of observation, and the slots that their readings take in a recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.vectors import unit

Kind = Literal["position", "along", "distance", "same_point", "plane", "tilt", "bar", "camera"]
Slots = NDArray[np.int64]

X, ALONG, DISTANCE, POINT, PLANE, TILT_X, TILT_Y, BAR, CAMERA, COUNT = 0, 3, 4, 5, 8, 9, 10, 11, 14, 14
"""A reading's slot says what its number is: 0 to 2 the tip's x, y, z, 3 its height along a direction, 4 its distance
from an anchor, 5 to 7 how far from a point that is touched again, 8 from a plane, 9 and 10 the sine of a level's tilt
about its x and y (what it rises in a metre, in m), 11 to 13 how far from where on a bar it touches, 14 to 16 where a
target is in a camera's frame, across its view and deep in it. What touches read is nought. `COUNT` are those of all
that are no camera's."""

KINDS: MappingProxyType[Kind, tuple[int, ...]] = MappingProxyType(
    {"position": (0, 1, 2), "along": (ALONG,), "distance": (DISTANCE,), "same_point": (5, 6, 7), "plane": (PLANE,),
     "tilt": (TILT_X, TILT_Y), "bar": (11, 12, 13), "camera": (14, 15, 16)}
)  # fmt: skip
"""The slots of each kind."""
NAMES = ("x", "y", "z", "along", "distance", "x of a point", "y of a point", "z of a point", "plane",
         "tilt x", "tilt y", "x of a bar", "y of a bar", "z of a bar", "camera x",
         "camera y", "camera depth")  # fmt: skip
"""What each slot is called."""
LABELS: MappingProxyType[Kind, str] = MappingProxyType({"same_point": "point", "plane": "plane", "bar": "bar"})
"""The columns that say which point, plane or bar was touched."""


@dataclass(frozen=True)
class Instrument:
    """What a recording observes. `direction` (a unit vector in the measuring frame) is that of `along`, `anchor` (m, in
    the measuring frame) that of `distance`, None where it is free; `labels` are the points, planes and bars touched.
    `tilt_link` is the link, from 1, on which the level of `tilt` stands, 0 the base. `camera` says where a camera is:
    `fixed`, and the target on the tool, or `on_tool`, and the target fixed."""

    kinds: tuple[Kind, ...] = ("position",)
    direction: tuple[float, float, float] | None = None
    anchor: tuple[float, float, float] | None = None
    labels: tuple[str, ...] = ()
    tilt_link: int = 0
    camera: Literal["fixed", "on_tool"] = "fixed"


def direction_along(numbers: Sequence[float]) -> tuple[float, float, float] | None:
    """The unit vector along two or three numbers, however large; None where they are no direction."""
    if len(numbers) not in (2, 3):
        return None
    x, y, z = [*numbers, 0.0][:3]
    try:
        return unit((x, y, z))
    except (ValueError, OverflowError):
        return None
