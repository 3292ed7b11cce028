"""A bar of known length that lies anywhere, and is touched at both its ends by an independent arm."""

import numpy as np
import pytest

from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.instruments.test_touches import OFF, SIGMA, _gone
from tests.diagnose.recorded import planar_arm, planar_tip

LENGTH = 0.3
MIDDLES = np.array([[0.6, 0.25], [0.5, -0.35], [0.7, -0.05], [0.35, 0.5]])
TURNS = np.array([0.3, 1.4, 2.2, -0.7])


def _touched(joint, count, seed, longer=0.0):
    """Readings (N, 3), which bar and where along it, at which the real arm touches bars, each end in turn."""
    ends = (
        MIDDLES[:, None]
        + (np.array([-0.5, 0.5]) * LENGTH)[None, :, None] * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1)[:, None]
    )
    places = ends.reshape(-1, 2)

    def goal(tip, n):
        return tip * (1.0 + longer) - places[n % len(places)], np.tile(np.eye(2), (len(tip), 1, 1))

    q, number = _gone(goal, joint, count, seed)
    place = number % len(places)
    return q, place // 2, LENGTH * (place % 2)


def _recording(q, label, along):
    count = len(MIDDLES)
    return Recording(
        "r.csv", q, np.zeros((len(q), 2)), np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)),
        slots=np.tile((11, 12), (len(q), 1)), touches=label.astype(np.int64), bar_at=along,
        instrument=Instrument(("bar",), labels=tuple("abcd"[:count])),
    )  # fmt: skip


def test_what_is_left_is_how_far_the_ends_are_from_the_bars_length():
    """Two touches of one bar: whatever way it lies, half of what its length is missed by, at either end, along it."""
    q = np.array([[0.2, 0.4, -0.3], [-0.5, 0.8, 0.1]])
    tips = planar_tip(q)
    apart = np.linalg.norm(tips[1] - tips[0])
    along = np.array([0.0, apart + 1e-3])
    recording = _recording(q, np.zeros(2, dtype=np.int64), along)
    left = observe(planar_arm(), recording).residual

    assert np.linalg.norm(left, axis=1) == pytest.approx([5e-4, 5e-4], abs=1e-12)
    assert left[0] == pytest.approx(-left[1], abs=1e-12)
    assert abs(left[1] @ (tips[1] - tips[0])) / apart == pytest.approx(5e-4, abs=1e-12)


def test_bars_find_a_zero_and_not_that_of_joint_1():
    q, label, along = _touched(1, 72, 5)
    assert len(q) > 90
    result = diagnose(planar_arm(), _recording(q, label, along))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("encoder_offset", (2,))
    low, high = finding.parameters[0].interval
    assert low < OFF < high
    assert result.noise_floor == pytest.approx(np.sqrt(2) * SIGMA, rel=0.25)
    assert result.rms_after == pytest.approx(np.sqrt(2) * SIGMA, rel=0.2)
    (first,) = [item for item in result.detectable if (item.effect, item.at) == ("encoder_offset", (1,))]
    assert first.visible < 1e-3
    assert any("3 of the 3 ways" in note for note in result.notes)


def test_bars_tell_that_all_links_are_longer_which_sockets_do_not():
    """Of an arm larger by a tenth of a percent all over, a bar is shorter: postures alone would never tell."""
    q, label, along = _touched(9, 72, 6, longer=1e-3)
    result = diagnose(planar_arm(), _recording(q, label, along))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("link_length", (1, 2, 3))
    (stretch,) = finding.parameters
    low, high = stretch.interval
    assert low < 1e-3 < high
    assert high - low < 1e-4
