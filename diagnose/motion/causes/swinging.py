"""How fast an arm swings on the drives that were found to give."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.elastic.elastic_drive import eigenfrequencies
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE, file_compliance
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.result import MotionFinding

_POSTURES = 500
"""Samples whose postures are looked at."""
_READ = (
    " Coordinates are taken to be of the motor's encoder (else write `encoders: joint` into recording.yaml).",
    " Coordinates are of an encoder on the joint's side.",
)
"""Of what coordinates are: of the motor's encoder, or of one on the joint's side."""


def _read(motion: Motion) -> str:
    return "" if motion.joint_side_rates is not None else _READ[motion.beyond_drive]


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
            f"With its motor held, the arm swings on the drive of joint {joint + 1} at {span}.{_read(motions[0])}"
        )
    return tuple(made)
