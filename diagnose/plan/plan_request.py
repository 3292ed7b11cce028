"""What is asked of a plan, and what an instrument sees of the tip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np

from linkwright.core.arm.avoid.poses import Room
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

_PLACES = MappingProxyType(
    {
        "tracker": ("x", "y", "z"), "x": ("x",), "y": ("y",), "z": ("z",), "xy": ("x", "y"), "xz": ("x", "z"),
        "yz": ("y", "z"),
    }
)  # fmt: skip
"""The instruments of the tip's place, each with the components in the measuring frame that it reads."""
TURNS = ("turn about x", "turn about y", "turn about z")
"""What a camera reads beside its numbers."""


def instruments() -> tuple[str, ...]:
    """The instruments by name: of the tip's place, and every other kind."""
    return (*_PLACES, *(name for name in INSTRUMENTS if name != "position"))


Place = tuple[str, tuple[int, ...]]
"""An effect and the joints or links (from 0; none: wherever) where it acts."""


@dataclass(frozen=True)
class Asked:
    """`poses` visits of `repeats` readings each. `effects` are those to be seen (none: all that can be), each at one
    place or wherever it acts; `pairs_only` where they are to be distinguished from each other and from nothing else.

    `sigma` is what each component scatters by (m, of tilts rad; of a camera across its view, `camera_noise` being that
    of its depths, m, and turns, rad), `payloads` kg, `frame` and `tool` say what is fitted along, `room`
    is where the arm may be put. `seed` fixes all draws. Where a height or a distance is read, `slots` (see
    `instruments.instrument`) and `reads` say so: along which direction, from which anchor, which the recording may not
    tell (`anchor_free`); so they do of tilts and cameras. Bars are touched at places `bar` along them, m, and lie
    in `bars` places at most (0: as many as there are touches enough for). `torque_noise` (n,; none: they are not read)
    is what each drive's torque scatters by, N*m, of slides N.
    """

    poses: int
    effects: tuple[Place, ...] = ()
    instrument: str = "tracker"
    sigma: float = 15e-6
    repeats: int = 3
    payloads: tuple[float, ...] = (0.0,)
    frame: Literal["known", "free"] = "known"
    tool: Literal["known", "free"] = "known"
    room: Room = field(default_factory=Room)
    seed: int = 1
    pairs_only: bool = False
    slots: tuple[int, ...] = ()
    reads: Instrument = field(default_factory=Instrument)
    anchor_free: bool = False
    camera_noise: tuple[float, float] = (0.0, 0.0)
    torque_noise: tuple[float, ...] = ()
    bar: tuple[float, ...] = ()
    bars: int = 0
    rules: Rules = RULES

    @property
    def touches(self) -> bool:
        """Whether points, planes or bars are touched."""
        return self.instrument in INSTRUMENTS and bool(INSTRUMENTS[self.instrument].label)

    def scatter(self, axes: Sequence[str]) -> Array:
        """What each of the numbers read (k,) scatters by, m and rad."""
        deep, turns = self.camera_noise
        by_channel = {"camera depth": deep, "turn about x": turns, "turn about y": turns, "turn about z": turns}
        return np.array([by_channel.get(axis, self.sigma) for axis in axes])


def seen_axes(instrument: str, arm: Arm) -> tuple[str, ...]:
    """The numbers that an instrument reads of the tip; out of a planar arm's plane there is nothing to see.

    Raises ValueError where it sees nothing.
    """
    if instrument == "camera" and arm.planar():
        raise ValueError("camera needs an arm in space; of one in the plane, name x, y or tracker")
    if instrument in _PLACES:
        axes = tuple(axis for axis in _PLACES[instrument] if axis != "z" or not arm.planar())
    else:
        kind = INSTRUMENTS[instrument]
        axes = tuple(number.name for number in kind.numbers[: kind.count(flat=arm.planar())])
        axes = (*axes, *TURNS) if instrument == "camera" else axes
    if not axes:
        raise ValueError(f"{instrument} is all out of the plane in which the arm moves; name x, y or tracker")
    return axes


def view(axes: Sequence[str], width: int) -> Array:
    """What a reading holds of the tip's components: a linear map (k, width)."""
    return np.eye(width)[["xyz".index(axis) for axis in axes]]
