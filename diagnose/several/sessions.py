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
    own = recordings[index]
    lasts = _lasts(own)
    pauses = {
        other: pause
        for other, each in enumerate(recordings)
        if other != index
        and (own.unit, own.date, own.branch) == (each.unit, each.date, each.branch)
        and 0.0 < (pause := _pause(each, own)) <= rules.same_session * (lasts + _lasts(each))
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
    times = [each.time + start for each, start in zip(parts, starts, strict=True) if each.time is not None]
    return Earlier(
        np.concatenate(times),
        _whole([each.payload_mass for each in parts]),
        _whole([each.temperature for each in parts]),
        _whole([each.link_temperature for each in parts]),
    )


def _whole(columns: Sequence[Array | None]) -> Array | None:
    told = [each for each in columns if each is not None]
    return np.concatenate(told) if len(told) == len(columns) else None
