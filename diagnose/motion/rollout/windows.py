"""Windows of a log in which an arm is simulated, and the torques that its drives give there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.motion.dynamics import acting, torque_of, torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.model.entries import with_entries
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.sections.numeric import Array

from .simulator import Courses, Simulator, simulator

_ROUNDS = 6
"""Times that what the instrument makes of a torque is taken off it: a share of 15 % leaves a hundred-thousandth."""
_FRICTION = "friction in motion"


@dataclass(frozen=True)
class Windows:
    """Windows of a prepared log: the samples `rows` (W, S + 1) of each, and in which block of time each lies."""

    prepared: PreparedLog
    rows: NDArray[np.int64]

    @property
    def time(self) -> Array:
        """The clock (W, S + 1), s."""
        return self.prepared.motion.time[self.rows]

    def only(self, which: NDArray[np.bool_] | NDArray[np.int64]) -> Windows:
        """Some of the windows."""
        return replace(self, rows=self.rows[which])


def windows(prepared: PreparedLog, seconds: float) -> Windows:
    """The windows of a log, one after the other; those count nowhere in which something else acts than the arm's
    physics, or a torque is not known."""
    samples = max(2, round(seconds * prepared.rate))
    starts = [np.arange(part.start, part.stop - samples, samples, dtype=np.int64) for part in prepared.stretches]
    rows = np.concatenate(starts)[:, None] + np.arange(samples + 1)
    log, time = prepared.log, prepared.motion.time
    lacks = np.interp(time, log.time, (~np.isfinite(log.torque)).any(axis=1).astype(float)) > 0.0
    for begin, end in log.aside:
        lacks |= (time >= begin) & (time <= end)
    return Windows(prepared, rows[~lacks[rows].any(axis=1)])


def courses(arm: Arm, given: Windows) -> Iterator[tuple[NDArray[np.int64], Simulator, Courses]]:
    """The windows' numbers, the simulated arm and the courses, for each payload that the log has.

    Raises what `simulator` raises.
    """
    motion = given.prepared.motion
    if motion.payload_mass is None:
        yield np.arange(len(given.rows)), *_of_one(arm, given)
        return
    carried = motion.payload_mass[given.rows[:, 0]].round(3)
    for mass in np.unique(carried).tolist():
        which = np.flatnonzero(carried == mass)
        yield which, *_of_one(replace(arm, payload=replace(arm.payload, mass=mass)), given.only(which))


def _of_one(arm: Arm, given: Windows) -> tuple[Simulator, Courses]:
    prepared = given.prepared
    motion = replace(prepared.motion, arm=with_entries(arm, prepared.entries), payload_mass=None)
    simulated = simulator(motion.arm, motion)
    torque = np.zeros(motion.q.shape)
    lasting, rubbing = torque.copy(), torque.copy()
    friction = [entry for entry in simulated.lasting if EFFECTS[entry.effect].cause == _FRICTION]
    others = [entry for entry in simulated.lasting if entry not in friction]
    for stretch in prepared.stretches:
        part = slice(stretch.start, stretch.stop)
        here = motion.at(part)
        torque[part] = driven(here, prepared.measured[part], prepared)
        if simulated.lasting:
            loaded = replace(here, torque=torque_stages(here).load)
            lasting[part] = torque_of(loaded, others)
            rubbing[part] = torque_of(loaded, friction) * np.where(here.velocity < 0.0, -1.0, 1.0)
    rows = given.rows
    flat = motion.at(rows.ravel())
    return simulated, Courses(flat, prepared.rate, torque[rows], lasting[rows], rubbing[rows])


def driven(motion: Motion, logged: Array, prepared: PreparedLog) -> Array:
    """The torques (N, n) that drives give where the instrument logs these: what it makes of them, filtered as a log is,
    is taken off."""
    instrument: tuple[EffectEntry, ...] = acting(motion.arm).instrument
    torque = logged
    for _ in range(_ROUNDS if instrument else 0):
        torque = logged - torque_of(replace(motion, torque=prepared.filtered(torque)), instrument)
    return torque
