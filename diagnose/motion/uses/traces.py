"""What is drawn of motion logs: torques as measured and by the model before and after, and what of it is friction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.motion.dynamics import torque_of, torque_stages
from linkwright.core.diagnose.motion.model.entries import with_entries
from linkwright.core.diagnose.motion.model.rows import LogRows
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.motion.result import Traces
from linkwright.core.sections.numeric import Array

_DRAWN = 2000
"""Samples of each log that are drawn."""
_FRICTION = "friction in motion"


def traces_of(rows: LogRows, written: LogRows, sizes: Array, arm: Arm) -> Traces:
    """What is drawn of a log: `rows` are about the arm as given, `written` about the `arm` that is written, with sizes
    (W,) beside it."""
    prepared = rows.prepared
    every = max(1, int(np.ceil(len(prepared.kept) / _DRAWN)))
    part = slice(None, None, every)
    at = prepared.kept[part]
    measured = prepared.filtered(prepared.measured)[at]
    return Traces(
        log=Path(prepared.log.file).name,
        time=prepared.motion.time[at],
        q=prepared.motion.q[at],
        velocity=prepared.motion.velocity[at],
        measured=measured,
        before=measured - rows.target[part],
        after=measured - (written.target - written.explained(sizes))[part],
        friction=_friction(prepared, arm)[part],
        moves=prepared.moving[part],
    )


def _friction(prepared: PreparedLog, arm: Arm) -> Array:
    """The torque (M, n) N*m of an arm's friction at the samples kept, filtered as the log is."""
    arm = with_entries(arm, prepared.entries)
    entries = [entry for entry in arm.effects if EFFECTS[entry.effect].cause == _FRICTION]
    friction = np.zeros((len(prepared.kept), arm.size))
    for part, numbers, within in prepared.pieces() if entries else ():
        motion = replace(prepared.piece(part), arm=arm)
        load = torque_stages(motion).load
        friction[numbers] = prepared.filtered(torque_of(replace(motion, torque=load), entries))[within]
    return friction
