"""Torques of any shape over one joint's angle, where nothing else in the library explains what is left there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.diagnose.motion.model.candidates import Candidates, scanned
from linkwright.core.diagnose.motion.unknown import Structure
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array


def curves_left(
    arm: Arm, pool: Candidates, structures: Sequence[Structure], loud: Array, effects: Sequence[Effect], *, rules: Rules
) -> list[tuple[Effect, int, Mapping[str, float]]]:
    """The effects of last resort at each joint (from 0) where what is left is loud, or depends on its coordinate most,
    beside the waves that such a curve would hold, with four points of its table a period.

    Args:
        arm: The arm.
        pool: What was sought already.
        structures: (n) what is left of each joint's torque.
        loud: (n,) whether it is no noise.
        effects: Those that may be sought.
        rules: What chance leaves.
    """
    made = list[tuple[Effect, int, Mapping[str, float]]]()
    sought = [(source.effect, source.at[0], source.shapes) for source in pool.sources if source.at]
    for joint, (axis, left) in enumerate(zip(arm.joints, structures, strict=True)):
        if not (loud[joint] or (left.names[:1] == (f"q{joint + 1}",) and left.p_value <= rules.residual.level)):
            continue
        acting = [e for e in effects if e.can_act(joint, revolute=axis.revolute, passive=axis.passive)]
        curves = [effect for effect in acting if effect.recording.last_resort]
        finest = max((len(effect.torque_sizes) / 4 for effect in curves), default=0.0)
        made += [(effect, joint, {}) for effect in curves]
        waves = [(e, joint, {e.shapes[0].name: order}) for e, orders in scanned(acting) for order in orders]
        made += [each for each in waves if next(iter(each[2].values())) <= finest and each not in sought]
    return made
