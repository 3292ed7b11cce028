"""Rows that a rough model sets aside are asked again once names are known: they come back, others go, and what they
have in common is said."""

import numpy as np
import pytest

from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.by_cosines import GIVES, LENGTHS, MASS, SIGMA, file, noise, recording, tips

PLAY = 1.4e-3
"""rad, lost motion of joint 2."""


def held(seed, below, count=126):
    """Joint 2 has play: its load seats it to one side, but for loads below `below`, N*m, where friction leaves it on
    the side that it came from. Coordinates, tips without noise and the sides."""
    q = np.random.default_rng(seed).uniform(-2.3, 2.3, (count, 3))
    came = np.where(np.diff(q, axis=0, prepend=0.0) >= 0.0, 1.0, -1.0)
    angles = np.cumsum(q, axis=1)
    load = -9.81 * MASS * (np.cos(angles[:, 1:]) @ LENGTHS[1:])
    errors = np.zeros_like(q)
    errors[:, 1] = 0.5 * PLAY * np.where(np.abs(load) > below, np.sign(load), -came[:, 1])
    return q, tips(q, errors), came


def aside(result):
    return [row.row for row in result.rejected_rows]


def said(result):
    return [note for note in result.notes if note.startswith("All figures are without")]


def test_rows_that_tell_a_shape_come_back():
    """Four rows lie on the other side of the play: only the sides tell, and only what was named can hear them."""
    q, tip, came = held(5, 1.5)
    result = diagnose(file(), recording(q, tip + noise(5, len(q)), sides=came))
    assert aside(result) == []
    assert said(result) == []
    assert result.set_aside is None
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("backlash", (2,))
    values = {item.parameter: item for item in finding.parameters}
    low, high = values["total"].interval
    assert low < PLAY < high
    assert 0.5 < values["held_below"].value < 2.5


def test_rows_that_nothing_tells_are_no_chance_blunders():
    """The same without sides: what the figures leave out is said, and that the rows have something in common."""
    q, tip, _ = held(5, 1.5)
    result = diagnose(file(), recording(q, tip + noise(5, len(q))))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("backlash", (2,))]
    assert aside(result) == [26, 83, 102, 104]
    assert result.set_aside is not None
    assert result.set_aside.rms_with == pytest.approx(np.sqrt(4 / 126) * 0.69e-3, rel=0.2)
    assert result.set_aside.alike is not None
    assert result.set_aside.alike.p_value < 0.01
    (note,) = said(result)
    assert "(rows 26, 83, 102 and 104)" in note
    assert "no chance blunders" in note


def test_a_blunder_hides_no_other():
    """Of three rows that are wrong one has x and y exchanged, half a metre off: the scatter that it leaves hides the
    other two from a rough model. None has anything in common with another."""
    rng = np.random.default_rng(2)
    q = rng.uniform(-2.3, 2.3, (90, 3))
    tip = tips(q, gives=GIVES + np.array([0.0, 3e-5, 0.0])) + noise(2, len(q))
    tip[20] = tip[20, ::-1]
    tip[50] += 12.0 * SIGMA * np.array([1.0, 0.2])
    tip[70] += 25.0 * SIGMA * np.array([-0.3, -1.0])
    result = diagnose(file(), recording(q, tip))
    assert aside(result) == [21, 51, 71]
    assert result.rms_after < 1.15 * SIGMA * np.sqrt(2.0)
    assert result.findings[0].effect == "joint_compliance"
    assert result.set_aside is not None
    assert result.set_aside.alike is None
    (note,) = said(result)
    assert "no chance" not in note
