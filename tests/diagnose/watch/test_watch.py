"""An arm watched over weeks, mounted anew each time: tips by the textbook, drives that give by the weight's torque."""

import datetime
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.watch.watch import watch
from tests.diagnose.several.days import arm, day

FIRST = datetime.date(2026, 1, 5)
SOFT = 40e-6


def _weeks(count, **of_week):
    """Weekly recordings; each keyword is a function of the week."""
    return [
        replace(
            day(100 + week, poses=10, **{name: of(week) for name, of in of_week.items()}),
            date=(FIRST + datetime.timedelta(weeks=week)).isoformat(),
        )
        for week in range(count)
    ]


@pytest.fixture(scope="module")
def moved():
    """A drive that softened before the tenth week, a zero off in the fourth alone; given in no order."""
    weeks = _weeks(
        16, compliance=lambda week: {2: SOFT * (1.25 if week >= 9 else 1.0)}, zeros=lambda week: {3: 3e-3 * (week == 3)}
    )
    return watch(arm(), [*weeks[8:], *weeks[:8]])


def _of(result, effect, at):
    return next(
        parameter
        for parameter in result.parameters
        if (parameter.parameter.effect, parameter.parameter.at) == (effect, at)
    )


def test_what_moved_and_when(moved):
    drive, zero = _of(moved, "joint_compliance", (2,)), _of(moved, "encoder_offset", (3,))
    (step,) = drive.changes
    assert (step.kind, step.first) == ("step", 9)
    assert step.interval[0] < 0.25 * SOFT < step.interval[1]
    assert step.p_value < 0.01
    (once,) = zero.changes
    assert (once.kind, once.first) == ("once", 3)
    assert once.interval[0] < 3e-3 < once.interval[1]
    assert {item.parameter.effect for item in moved.moved} == {"joint_compliance", "encoder_offset"}
    assert drive.level[[0, -1]] == pytest.approx([SOFT, 1.25 * SOFT], rel=0.02)
    # What was found is the file's to say how well: the errors are honest, frames mounted anew and all.
    known = np.abs(drive.values - SOFT * np.where(np.arange(16) >= 9, 1.25, 1.0)) / drive.errors
    assert np.sqrt(np.mean(known**2)) == pytest.approx(1.0, abs=0.6)


def test_what_frame_and_weights_hide_is_not_watched(moved):
    """A frame that stands anywhere swallows the first zero."""
    assert {(item.effect, item.at) for item in moved.unwatched} >= {("encoder_offset", (1,))}
    assert [recording.date for recording in moved.recordings] == sorted(
        recording.date for recording in moved.recordings
    )


def test_quiet_weeks_and_what_nothing_holds():
    """Quiet: nothing moves. An instrument three times as loud from a week on is in what is left."""
    basics = ("encoder_offset", "joint_compliance")
    quiet = _weeks(12)
    heard = []
    assert not watch(arm(), quiet, basics, progress=lambda *said: heard.append(said), search=False).moved
    assert [text for text, _ in heard if "recording" in text] == [f"fitting recording {k} of 12" for k in range(1, 13)]
    assert [share for _, share in heard] == sorted(share for _, share in heard)
    loud = _weeks(14, sigma=lambda week: 15e-6 * (4.0 if week >= 8 else 1.0))
    result = watch(arm(), loud, basics, search=False)
    assert result.left.moved
    assert result.left.changes[0].first == 8
    assert not any(parameter.moved for parameter in result.parameters)
