"""A motion of the nominal arm and the torque that its file gives: what the columns of causes are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import Arm, Rigid

SHARP = 0.01  # rad/s or m/s
LARGE = 0.08
"""The share of a joint's RMS torque from which on a cause is large."""


@dataclass(frozen=True)
class Moved:
    """A motion of the nominal arm: (N,) s, (N, n) coordinates, speeds and accelerations."""

    arm: Arm
    time: Array
    q: Array
    velocity: Array
    acceleration: Array

    @cached_property
    def rigid(self) -> Array:
        """(N, n), of the bodies alone."""
        return Rigid.of(self.arm).torque(self.q, self.velocity, self.acceleration)

    @cached_property
    def torque(self) -> Array:
        """(N, n), with what the file declares of the drives."""
        coulomb, viscous, armature = self.arm.drives
        return self.rigid + armature * self.acceleration + viscous * self.velocity + coulomb * self.sign

    @cached_property
    def sign(self) -> Array:
        """(N, n), of the speeds."""
        return np.tanh(self.velocity / SHARP)

    @property
    def rate(self) -> float:
        """Instants a second."""
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    def every(self, steps: int) -> Moved:
        """At every so many instants."""
        each = (values[::steps] for values in (self.time, self.q, self.velocity, self.acceleration))
        return Moved(self.arm, *each)

    def slope(self, values: Array) -> Array:
        """Derivative with time."""
        return np.gradient(values, self.time, axis=0)

    def beyond(self, arm: Arm) -> Array:
        """(N, n), what another arm's bodies take more."""
        return Rigid.of(arm).torque(self.q, self.velocity, self.acceleration) - self.rigid


@dataclass(frozen=True)
class Cause:
    """An effect at joints or links (from 1); `sizes` multiply its columns, `shapes` give them their form (SI). `share`
    is the RMS of its torque over the joint's, at the joint where that is greatest."""

    effect: str
    at: tuple[int, ...]
    sizes: Mapping[str, float]
    shapes: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    share: float = 0.0

    @property
    def joint(self) -> int:
        """Its first joint or link, from 0."""
        return self.at[0] - 1

    @property
    def large(self) -> bool:
        """Whether it is to be named."""
        return self.share >= LARGE
