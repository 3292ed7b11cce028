"""What an arm file is worth on a motion log: nothing is fitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

from .log import MotionLog
from .preparation import prepare


@dataclass(frozen=True)
class MotionPrediction:
    """A model on a log, by joint: `rms` (n,) N*m (N) of measured less predicted torque where the joint moves, and
    `share` (n,) of the torque's RMS, nan where it never does; `samples` (n,) that counted, `cutoff` Hz of the
    low-pass on both sides, None where there is none."""

    rms: tuple[float, ...]
    share: tuple[float, ...]
    samples: tuple[int, ...]
    cutoff: float | None


def predict_motion(arm: Arm, log: MotionLog, *, rules: Rules = RULES) -> MotionPrediction:
    """What an arm file leaves of the torques in a log.

    Args:
        arm: The model, its `effects` included.
        log: The log.
        rules: Which samples count.

    Returns:
        RMS and share of the torque by joint.

    Raises:
        InputError: The log has other joints than the arm, or no stretch of a second.
    """
    prepared = prepare(arm, log, rules=rules)
    left, logged = np.zeros((len(prepared.kept), arm.size)), np.zeros((len(prepared.kept), arm.size))
    for part, numbers, within in prepared.pieces():
        measured = prepared.measured[part]
        left[numbers] = prepared.filtered(measured - model_torque(prepared.piece(part)))[within]
        logged[numbers] = prepared.filtered(measured)[within]
    use = prepared.moving
    size, torque = _rms(left, use), _rms(logged, use)
    share = size / np.maximum(torque, 1e-12)
    return MotionPrediction(
        tuple(size.tolist()), tuple(share.tolist()), tuple(use.sum(axis=0).tolist()), prepared.low_pass
    )


def _rms(values: Array, use: NDArray[np.bool_]) -> Array:
    count = use.sum(axis=0)
    return np.where(count > 0, np.sqrt((values**2 * use).sum(axis=0) / np.maximum(count, 1)), np.nan)
