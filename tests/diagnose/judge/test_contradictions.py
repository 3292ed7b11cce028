"""Held-out figures that contradict each other are said with what they mean, and those of sound recordings are not."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.judge.contradictions import contradictions
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.judge.test_for_file import NOISE, arm, tips
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm


def recorded(poses: int, repeats: int, seed: int, slip: float = 0.0, field: float = 1.0) -> Recording:
    """Poses in random order, each read so many times at once. The second joint's zero slips (rad) after four fifths."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.3, 1.3, (poses, 3)), repeats, axis=0)
    time = 10.0 * np.arange(len(q))
    turned = q + slip * np.outer(time > 0.8 * time[-1], [0.0, 1.0, 0.0])
    measured = tips(turned, field) + NOISE * rng.standard_normal((len(q), 2))
    return Recording("made", q, measured, np.arange(1, len(q) + 1), time=time)


def said(recording: Recording) -> list[str]:
    return [note for note in diagnose(arm(), recording).notes if note.startswith("Held-out")]


def test_repeated_rows():
    """24 poses in a field, each read eight times: a row's repeats tell it, and no other pose does."""
    (line,) = said(recorded(24, 8, 1))
    assert line.startswith("Held-out blocks of poses leave 0.3")
    assert "Expect the larger figure at other poses." in line


def test_drift_between_stretches():
    """No other stretch tells a zero that slips late, and poses all over the workspace do."""
    (line,) = said(recorded(60, 2, 3, slip=2e-3, field=0.0))
    assert line.startswith("Held-out stretches of time leave 0.6")
    assert "changed during the recording" in line


def test_sound_recordings():
    """Neither without the slip, nor of motion with a load."""
    assert said(recorded(60, 2, 3, field=0.0)) == []


def test_recordings_that_foretell_each_other_badly():
    """Grid and lines of the Motoman: blocks of poses of both 0.163 mm, a recording by the other 0.665 mm."""
    figures = {"pose blocks": 0.163, "random rows": 0.133, "one recording at a time": 0.665}
    (line,) = contradictions(0.131, figures, "{:.3g} mm".format, rules=RULES)
    assert line.startswith(
        "Held-out recordings leave 0.665 mm, held-out blocks of poses 0.163 mm. Each recording shows"
    )
    assert contradictions(0.131, {**figures, "one recording at a time": 0.3}, "{:.3g} mm".format, rules=RULES) == ()


def loaded(rules=RULES, folder=None):
    log = logged(5, lambda time: np.full_like(time, HAND + 1.2), lambda _, v: np.zeros_like(v))
    result = diagnose_motion(plumb_arm(folder), [log], Options(rules=rules))
    return [note for note in result.notes if "eld-out" in note]


def test_motion(tmp_path):
    """A load that the log tells contradicts nothing. By a ratio of one its worst joint would."""
    assert loaded(folder=tmp_path) == []
    strict = replace(RULES, answer=replace(RULES.answer, held_out_apart=1.01))
    (line,) = loaded(strict, tmp_path)
    assert "held-out stretches of time leave" in line.lower()
    assert line.endswith("Record more varied motion before using the arm file.")


@pytest.mark.parametrize(
    ("held_out", "noise", "begins"),
    [
        ({"pose blocks": 0.110}, 0.0, ["Held-out readings leave 0.11 mm and fitted ones 0.145 mm"]),
        ({"pose blocks": 0.140}, 0.0, []),
        ({"pose blocks": 0.110}, 0.2, []),
        ({"pose blocks": 0.45, "random rows": 0.147}, 0.0, ["Held-out blocks of poses leave 0.45 mm"]),
        ({"pose blocks": 0.15, "random rows": 0.147, "time blocks": 2.4}, 0.0, ["Held-out stretches of time leave"]),
        ({"pose blocks": 0.15, "random rows": 0.147, "time blocks": 2.4}, 2.5, []),
        ({"logs": 0.5}, 0.0, ["Held-out logs leave 0.5 mm, the motion that was fitted 0.145 mm"]),
    ],
)
def test_figures(held_out, noise, begins):
    """Each ratio by itself, and what noise alone makes of it."""
    lines = contradictions(0.145, held_out, "{:.3g} mm".format, rules=RULES, noise=noise)
    assert len(lines) == len(begins)
    assert all(line.startswith(start) for line, start in zip(lines, begins, strict=True))
