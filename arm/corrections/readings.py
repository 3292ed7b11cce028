"""Identified offsets and scales of encoders: a true coordinate is `(1 + scale) * reading + offset`."""

from __future__ import annotations

from dataclasses import dataclass

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.angles.encoder_offset import ENCODER_OFFSET
from linkwright.core.arm.effects.angles.encoder_scale import ENCODER_SCALE

READINGS = (ENCODER_OFFSET.id, ENCODER_SCALE.id)
"""The effects that it comes from."""


@dataclass(frozen=True)
class Reading:
    """Offset (rad or m) and scale that turn a joint's reading into its coordinate."""

    name: str
    offset: float = 0.0
    scale: float = 0.0

    @property
    def corrects(self) -> bool:
        """Whether the reading needs a correction."""
        return self.offset != 0.0 or self.scale != 0.0


def readings(arm: Arm) -> tuple[Reading, ...]:
    """What an arm's `effects` say of each joint's reading; a joint without a name is `jointN`, from 1."""

    def total(effect: str, parameter: str, number: int) -> float:
        entries = (entry for entry in arm.effects if entry.effect == effect and number in (entry.at or (number,)))
        return sum(entry.parameters.get(parameter, 0.0) for entry in entries)

    return tuple(
        Reading(
            joint.name or f"joint{number}",
            total(ENCODER_OFFSET.id, "offset", number),
            total(ENCODER_SCALE.id, "scale", number),
        )
        for number, joint in enumerate(arm.joints, start=1)
    )
