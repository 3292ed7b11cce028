"""Torques of any shape over one joint's angle, where nothing else in the library explains what is left there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.diagnose.motion.unknown import Structure
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array


def curves_left(
    arm: Arm, structures: Sequence[Structure], loud: Array, effects: Sequence[Effect], *, rules: Rules
) -> list[tuple[Effect, int, Mapping[str, float]]]:
    """The effects of last resort at each joint (from 0) where what is left is loud, or depends on its coordinate most.

    Args:
        arm: The arm.
        structures: (n) what is left of each joint's torque.
        loud: (n,) whether it is no noise.
        effects: Those that may be sought.
        rules: What chance leaves.
    """
    return [
        (effect, joint, {})
        for joint, (left, axis) in enumerate(zip(structures, arm.joints, strict=True))
        for effect in effects
        if effect.recording.last_resort
        and effect.can_act(joint, revolute=axis.revolute, passive=axis.passive)
        and (loud[joint] or (left.names[:1] == (f"q{joint + 1}",) and left.p_value <= rules.residual.level))
    ]
