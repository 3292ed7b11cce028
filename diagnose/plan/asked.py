"""What is asked of a plan, and what an instrument sees of the tip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np

from arm.chain.chain import Arm
from diagnose.instruments.instrument import Instrument
from diagnose.rules.rules import RULES, Rules
from sections.numeric import Array

INSTRUMENTS = MappingProxyType(
    {
        "tracker": ("x", "y", "z"), "x": ("x",), "y": ("y",), "z": ("z",), "xy": ("x", "y"), "xz": ("x", "z"),
        "yz": ("y", "z"), "along": ("along",), "distance": ("distance",),
    }
)  # fmt: skip
"""The instruments by name, each with the numbers that it reads: components of the tip in the measuring frame, its
height along a direction, its distance from an anchor."""

Place = tuple[str, tuple[int, ...]]
"""An effect and the joints or links (from 0; none: wherever) where it acts."""
Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Two corners, m, in the base frame."""


@dataclass(frozen=True)
class Asked:
    """`poses` visits of `repeats` readings each. `effects` are those to be seen (none: all that can be), each at one
    place or wherever it acts; `pairs_only` where they are to be told from each other and from nothing else.

    `sigma` (m) is what each component scatters by, `payloads` kg, `frame` and `tool` say what is fitted along, `avoid`
    are boxes that the arm keeps out of. `seed` fixes all draws. Where a height or a distance is read, `slots` (see
    `instruments.instrument`) and `reads` say so: along which direction, from which anchor, which the recording may not
    tell (`anchor_free`).
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
    slots: tuple[int, ...] = ()
    reads: Instrument = field(default_factory=Instrument)
    anchor_free: bool = False
    rules: Rules = RULES


def seen_axes(instrument: str, arm: Arm) -> tuple[str, ...]:
    """The numbers that an instrument reads of the tip; out of a planar arm's plane there is nothing to see.

    Raises ValueError where it sees nothing.
    """
    axes = tuple(axis for axis in INSTRUMENTS[instrument] if axis != "z" or not arm.planar())
    if not axes:
        raise ValueError(f"{instrument} is all out of the plane in which the arm moves; name x, y or tracker")
    return axes


def view(axes: Sequence[str], width: int) -> Array:
    """What a reading holds of the tip's components: a linear map (k, width)."""
    return np.eye(width)[["xyz".index(axis) for axis in axes]]
