"""What hangs on an arm beside its links and joints, and what takes loads off its drives."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from linkwright.core.sections.numeric import cos, sin, sqrt

from .vectors import Scalar, times

End = Literal["joint", "end"]
"""The housing at a link's joint, which turns with the link, or what is fixed to its far end."""


@dataclass(frozen=True)
class PointMass:
    """A mass (kg) that one end of a link carries rigidly: a counterweight, a motor, a valve block.

    `at` (m) is where it is from that end: along the link, along its section's height and along its width. `motor_of` is
    the joint (from 1) whose motor it is, None of anything else. `chosen`: an optimiser chooses mass and place, which
    statics then take from the link's beam.
    """

    mass: float
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    on: End = "joint"
    motor_of: int | None = None
    chosen: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class IdealCounterbalance:
    """A torque on a joint's link against the link before: `torque` (N*m, towards increasing q where it is positive)
    times cos(q - greatest_at)."""

    torque: Scalar
    greatest_at: float = 0.0

    def turning(self, q: Scalar) -> Scalar:
        """The torque (N*m) on the link at a coordinate (rad)."""
        return times(self.torque, cos(q - self.greatest_at))


@dataclass(frozen=True)
class SpringCounterbalance:
    """A spring from the link, `on_link` m from the joint's axis (in the direction of q), to the link before, `on_base`
    m from the axis in the direction `base_at` (rad).

    It pulls with `stiffness` (N/m) times what it is longer than `free_length` (m), and `preload` (N) beyond that; a gas
    spring has a preload alone, negative where it pushes.
    """

    stiffness: float
    on_link: float
    on_base: float
    base_at: float
    free_length: float = 0.0
    preload: float = 0.0

    def turning(self, q: Scalar) -> Scalar:
        """The torque (N*m) on the link at a coordinate (rad): a b sin(base_at - q) times pull over length."""
        both, rest = self.on_link * self.on_base, self.preload - self.stiffness * self.free_length
        pull = self.stiffness  # over the length, as of a spring without length of its own
        if not (isinstance(rest, float) and rest == 0.0):
            length = sqrt(self.on_link**2 + self.on_base**2 - 2.0 * both * cos(self.base_at - q))
            pull = pull + rest / length
        return both * pull * sin(self.base_at - q)


Counterbalance = IdealCounterbalance | SpringCounterbalance
