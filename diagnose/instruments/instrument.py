"""What a recording says of its instrument."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.vectors import unit

Slots = NDArray[np.int64]
"""What each number of a reading is (`registry.slots_of`); -1 where there is none."""


@dataclass(frozen=True)
class Instrument:
    """What a recording observes, by the names of kinds. `direction` (a unit vector in the measuring frame) is that of
    `along`, `anchor` (m, in the measuring frame) that of `distance`, None where it is free; `labels` are the points,
    planes and bars touched. `tilt_link` is the link, from 1, on which the level of `tilt` stands, 0 the base. `camera`
    says where a camera is: `fixed`, and the target on the tool, or `on_tool`, and the target fixed. `settings` are
    those of other kinds, by name."""

    kinds: tuple[str, ...] = ("position",)
    direction: tuple[float, float, float] | None = None
    anchor: tuple[float, float, float] | None = None
    labels: tuple[str, ...] = ()
    tilt_link: int = 0
    camera: Literal["fixed", "on_tool"] = "fixed"
    settings: tuple[tuple[str, Any], ...] = ()

    def setting(self, name: str) -> Any:
        """A setting of a kind that brings its own. Raises KeyError where there is none of that name."""
        return dict(self.settings)[name]


def direction_along(numbers: Sequence[float]) -> tuple[float, float, float] | None:
    """The unit vector along two or three numbers, however large; None where they are no direction."""
    if len(numbers) not in (2, 3):
        return None
    x, y, z = [*numbers, 0.0][:3]
    try:
        return unit((x, y, z))
    except (ValueError, OverflowError):
        return None
