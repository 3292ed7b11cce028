"""Recordings that go on from one another: one clock runs through them, and what the arm remembers goes on as well."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.diagnose.recording import Earlier, Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array


def gone_on_from(recordings: Sequence[Recording], *, rules: ResidualRules = RULES.residual) -> tuple[int | None, ...]:
    """For each recording the one (from 0) that it goes on from: of the same unit, day and tip, whose file's clock ends
    before this one's begins, by a pause that is short beside what both last. None where there is no such."""
    return tuple(_before(recordings, index, rules) for index in range(len(recordings)))


def _before(recordings: Sequence[Recording], index: int, rules: ResidualRules) -> int | None:
    recording = recordings[index]
    lasts = _lasts(recording)
    pauses = {
        other: pause
        for other, item in enumerate(recordings)
        if other != index
        and (recording.unit, recording.date, recording.branch) == (item.unit, item.date, item.branch)
        and 0.0 < (pause := _pause(item, recording)) <= rules.same_session * (lasts + _lasts(item))
    }
    return min(pauses, key=lambda other: pauses[other]) if pauses else None


def _lasts(recording: Recording) -> float:
    return 0.0 if recording.time is None else float(np.ptp(recording.time))


def _pause(before: Recording, then: Recording) -> float:
    """How long after the last reading of one recording the other begins on their files' clock, s; nan where there is no
    such clock."""
    if before.time is None or then.time is None or before.started is None or then.started is None:
        return np.nan
    return then.started - before.started - float(np.max(before.time))


def earlier(parts: Sequence[Recording], starts: Sequence[float]) -> Earlier:
    """What an arm had been through in the recordings that one goes on from, the first of them first, each of which
    began at `starts` on its clock, s."""
    times = [part.time + start for part, start in zip(parts, starts, strict=True) if part.time is not None]
    return Earlier(
        np.concatenate(times),
        _whole([part.payload_mass for part in parts]),
        _whole([part.temperature for part in parts]),
        _whole([part.link_temperature for part in parts]),
    )


def _whole(columns: Sequence[Array | None]) -> Array | None:
    present = [column for column in columns if column is not None]
    return np.concatenate(present) if len(present) == len(columns) else None
