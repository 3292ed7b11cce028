"""What is asked of a plan, and what an instrument sees of the tip."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from arm.chain.chain import Arm
from diagnose.rules.rules import RULES, Rules
from sections.numeric import Array

INSTRUMENTS = MappingProxyType({"tracker": "xyz", "x": "x", "y": "y", "z": "z", "xy": "xy", "xz": "xz", "yz": "yz"})
"""The instruments by name, each with the components of the tip that it sees, in the measuring frame."""

Place = tuple[str, tuple[int, ...]]
"""An effect and the joints or links (from 0; none: wherever) where it acts."""
Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Two corners, m, in the base frame."""


@dataclass(frozen=True)
class Asked:
    """`poses` visits of `repeats` readings each. `effects` are those to be seen (none: all that can be), each at one
    place or wherever it acts; `pairs_only` where they are to be told from each other and from nothing else.

    `sigma` (m) is what each component scatters by, `payloads` kg, `frame` and `tool` say what is fitted along, `avoid`
    are boxes that the arm keeps out of. `seed` fixes all draws.
    """

    poses: int
    effects: tuple[Place, ...] = ()
    instrument: str = "tracker"
    sigma: float = 15e-6
    repeats: int = 3
    payloads: tuple[float, ...] = (0.0,)
    frame: Literal["known", "free"] = "known"
    tool: Literal["known", "free"] = "known"
    avoid: tuple[Box, ...] = ()
    seed: int = 1
    pairs_only: bool = False
    rules: Rules = RULES


def seen_axes(instrument: str, arm: Arm) -> str:
    """The components of the tip that an instrument sees; out of a planar arm's plane there is nothing to see.

    Raises ValueError where it sees nothing.
    """
    axes = "".join(axis for axis in INSTRUMENTS[instrument] if axis in ("xy" if arm.planar() else "xyz"))
    if not axes:
        raise ValueError(f"{instrument} is all out of the plane in which the arm moves; name x, y or tracker")
    return axes


def view(axes: str, width: int) -> Array:
    """What a reading holds of the tip's components: a linear map (k, width)."""
    return np.eye(width)[["xyz".index(axis) for axis in axes]]
