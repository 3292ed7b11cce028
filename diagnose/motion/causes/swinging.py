"""How fast an arm swings on the drives that were found to give, and the rotors that show it to encoders behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.arm.effects.elastic.elastic_drive import eigenfrequencies
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE, file_compliance
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.model.candidates import Candidates, candidates
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.motion.result import MotionFinding
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_POSTURES = 500
"""Samples whose postures are looked at."""
_READ = (
    "Coordinates are taken to be of the motor's encoder (else write `encoders: joint` into recording.yaml).",
    "Coordinates are of an encoder on the joint's side.",
)
"""Of what coordinates are: of the motor's encoder, or of one on the joint's side."""


def eigenfrequency_notes(arm: Arm, named: Sequence[MotionFinding], motions: Sequence[Motion]) -> tuple[str, ...]:
    """A sentence for each drive found to give, with its eigenfrequency over the postures of the logs.

    Args:
        arm: The arm with its masses.
        named: What was found.
        motions: Those of the logs.
    """
    q = np.concatenate([motion.q for motion in motions])
    q = q[:: max(1, len(q) // _POSTURES)]
    made: list[str] = []
    for item in named:
        if item.effect != JOINT_COMPLIANCE.id:
            continue
        joint = item.at[0] - 1
        compliance = file_compliance(arm, joint) + item.parameters[0].value
        if compliance <= 0.0:
            continue
        low, high = (f"{each:.3g}" for each in eigenfrequencies(arm, q, joint, compliance))
        span = f"{low} Hz" if low == high else f"{low} to {high} Hz"
        made.append(
            f"With its motor held, the arm swings on the drive of joint {joint + 1} at {span}. "
            f"{_READ[motions[0].beyond_drive]}"
        )
    return tuple(made)


def with_rotors(
    arm: Arm,
    effects: Sequence[Effect],
    pool: Candidates,
    prepared: Sequence[PreparedLog],
    masses: Array,
    sizes: Array,
    *,
    rules: Rules,
) -> tuple[Candidates, list[PreparedLog]]:
    """Candidates and logs where encoders on the joint's side show how drives give by their rotors alone: by those that
    the whole library makes of the logs, with sizes (W,), as far as the arm has none.

    Args:
        arm: The arm.
        effects: Effects that the logs may show.
        pool: The candidates so far.
        prepared: The logs.
        masses: (n, 10) the links' inertial parameters as the arm file has them.
        sizes: (W,) of the candidates' columns.
        rules: What is usual.
    """
    rotors = np.zeros(arm.size)
    for source in pool.sources:
        if source.effect is ARMATURE:
            rotors[source.at[0]] = max(float(sizes[source.start]), 0.0)
    logs = [replace(each, motion=replace(each.motion, rotors=rotors)) for each in prepared]
    beyond = next(each.motion for each in logs if each.motion.beyond_drive)
    return candidates(arm, effects, beyond, masses, pool.clock, rules=rules), logs
