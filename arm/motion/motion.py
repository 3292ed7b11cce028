"""A motion of an arm, sampled in time: what an effect needs to say what it takes of the drives' torque."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array

_Made = TypeVar("_Made")


@dataclass(frozen=True)
class Motion:
    """A motion of an arm at N instants.

    Args:
        arm: The arm that moves; its links' masses, centres and inertias, gravity and payload count.
        time: (N,) s, ascending; instants need not be evenly spaced.
        q: (N, n) joint coordinates as the arm file counts them, rad (m for slides).
        velocity: (N, n) rad/s (m/s).
        acceleration: (N, n) rad/s^2 (m/s^2).
        torque: (N, n) N*m (N), what the drives give by the model as it stands, positive towards increasing q: what acts
            in proportion to a load (friction under load, a torque constant, a delay) goes by it. None: the rigid
            model's own.
        commanded: (N, n) commanded coordinates; None where they were not logged.
        joint_side: (N, n) coordinates by a second encoder behind the gear, where `q` is of the motor's; None alike.
        joint_side_rates: Velocity and acceleration (N, n) by it, rad/s and rad/s^2 (m/s, m/s^2): links then move as it
            says, rotors and friction as `q`. None: all goes by `q`.
        payload_mass: (N,) kg in place of the arm's payload; None: as the arm has it.
        temperature: (N,) K; None where it was not logged.
        sampled: How much of the rates of change the samples tell: 1 of a motion sampled densely, 0 of poses of which
            nobody knows how the arm went from one to the next.
        beyond_drive: Whether `q` is of encoders on the joint's side, behind a drive that gives; else of the motor's.
        rotors: (n,) kg*m^2 (kg for slides), inertia of the drives' rotors as far as the arm has none; None: nothing.
    """

    arm: Arm
    time: Array
    q: Array
    velocity: Array
    acceleration: Array
    torque: Array | None = None
    commanded: Array | None = None
    joint_side: Array | None = None
    joint_side_rates: tuple[Array, Array] | None = None
    payload_mass: Array | None = None
    temperature: Array | None = None
    sampled: float = 1.0
    beyond_drive: bool = False
    rotors: Array | None = None
    _kept: dict[str, Any] = field(default_factory=dict[str, Any], init=False, repr=False, compare=False)

    @property
    def size(self) -> int:
        """The number of instants, N."""
        return len(self.time)

    @property
    def of_links(self) -> Motion:
        """The motion of the links: by the encoders behind the gears where these were logged, else the same."""
        if self.joint_side is None or self.joint_side_rates is None:
            return self
        velocity, acceleration = self.joint_side_rates
        return replace(
            self,
            q=self.joint_side,
            velocity=velocity,
            acceleration=acceleration,
            joint_side=None,
            joint_side_rates=None,
        )

    def at(self, rows: slice | NDArray[np.int64]) -> Motion:
        """The motion at some of its instants."""

        def cut(values: Array | None) -> Array | None:
            return None if values is None else values[rows]

        return replace(
            self,
            time=self.time[rows],
            q=self.q[rows],
            velocity=self.velocity[rows],
            acceleration=self.acceleration[rows],
            torque=cut(self.torque),
            commanded=cut(self.commanded),
            joint_side=cut(self.joint_side),
            joint_side_rates=None
            if self.joint_side_rates is None
            else (self.joint_side_rates[0][rows], self.joint_side_rates[1][rows]),
            payload_mass=cut(self.payload_mass),
            temperature=cut(self.temperature),
        )

    def once(self, name: str, make: Callable[[], _Made]) -> _Made:
        """What an effect makes of this motion, by a name: made once for all its sizes and shapes."""
        if name not in self._kept:
            self._kept[name] = make()
        return self._kept[name]

    def rate(self, values: Array) -> Array:
        """The rate of change (N,) per second of values (N,) along the motion, as far as its samples tell it."""
        return np.asarray(self.sampled * np.gradient(values, self.time))
