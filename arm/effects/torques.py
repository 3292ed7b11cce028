"""What effects of a moving arm share: torques of each drive by itself, and which way a joint moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from linkwright.core.arm.effects.traits import DriveTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

from .effect import Effect, Only, Settings, among

AT_REST = 0.01
"""rad/s, m/s; below some such speed a joint stands as far as a log tells, and friction has no sign."""


def direction(velocity: Array) -> Array:
    """Which way a joint moves at velocities (rad/s, m/s): 1, -1, and in between where it hardly does."""
    return np.tanh(velocity / AT_REST)


@runtime_checkable
class Bent(Protocol):
    """Torques that are not in proportion to the one size of an effect."""

    def __call__(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """The torques (N,) by joint."""
        ...

    def slope(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """How they change with the size at its value in the settings, per unit of it."""
        ...

    def usual(self, motion: Motion, joint: int) -> float:
        """The size that is common at a joint (from 0) of an arm of these masses."""
        ...


@dataclass(frozen=True)
class OfEachDrive:
    """The torques of an effect that takes something of each drive where it acts, by that joint's motion.

    `amount` (N,) N*m (N) is that of a motion, the effect's parameters and a joint (from 0). Joints without a drive have
    none; with `only` some joints, the others neither.
    """

    amount: Callable[[Motion, Mapping[str, float], int], Array]
    only: Only | None = None

    def __call__(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """The torques by joint."""
        return {
            index: self.amount(motion, settings.values, index)
            for index, joint in enumerate(motion.arm.joints)
            if settings.acts_at(index)
            and joint.driven
            and not joint.passive
            and among(self.only, index, revolute=joint.revolute)
        }


def drive_effect(
    amount: Callable[[Motion, Mapping[str, float], int], Array], *, only: Only | None = None, **fields: Any
) -> Effect:
    """An effect that takes something of each drive, in proportion to its sizes: `amount` as for `OfEachDrive`, `fields`
    those of `Effect` beside."""
    torques = OfEachDrive(amount, only)
    return Effect(place="joint", drive=DriveTraits(needed=True), linear=True, only=only, torques=torques, **fields)
