"""What instruments of a number or two find of what an arm in the plane really has, and what they own not to see."""

import numpy as np
import pytest

from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.instruments.split import laid_out
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.arm_of_drives import turned_by, visited
from tests.diagnose.recorded import planar_arm, planar_tip

ALONG = slots_of("along")[0]
DISTANCE = slots_of("distance")[0]

SIGMA = 15e-6
OFF = 6e-4
ANCHOR = np.array([0.3, -0.9])


def _tips(joint, poses=45, seed=7):
    """Poses read twice each and where the tip is with one zero off."""
    q = visited(np.random.default_rng(seed), poses, 2)
    return q, planar_tip(q) + turned_by(q, tuple(OFF * (k == joint) for k in range(3)))


def _read(q, values, slots, instrument=None, **further):
    noise = SIGMA * np.random.default_rng(3).standard_normal(values.shape)
    slots = np.broadcast_to(slots, values.shape) if np.ndim(slots) == 1 else slots
    return Recording(
        "r.csv", q, np.where(slots >= 0, values + noise, 0.0), np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)),
        slots=np.array(slots), instrument=instrument or Instrument(), **further,
    )  # fmt: skip


def _offset(result, joint):
    """The interval of the offset of a joint's zero, whatever else could be meant."""
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("encoder_offset", (joint,))
    (parameter,) = finding.parameters
    return parameter.interval


def _distance(tip, anchor=ANCHOR):
    return np.linalg.norm(tip - anchor, axis=1)[:, None]


def _says(result, words):
    return [note for note in result.notes if words in note]


def test_heights_alone_find_a_zero_and_take_nothing_else_into_account():
    q, tip = _tips(1)
    result = diagnose(planar_arm(), _read(q, tip[:, 1:], (1,)))

    low, high = _offset(result, 2)
    assert low < OFF < high
    assert high - low < 0.1 * OFF
    assert result.noise_floor == pytest.approx(SIGMA, rel=0.25)
    assert result.rms_after == pytest.approx(SIGMA, rel=0.15)
    assert _says(result, "It does not show 1 of the 3 ways")
    assert _says(result, "shifted along x")


def test_a_dial_gauge_that_leans_in_a_frame_of_its_own():
    q, tip = _tips(2)
    lean, told = 0.02, np.array([-0.6, 0.8])
    turned = np.array([[np.cos(lean), -np.sin(lean)], [np.sin(lean), np.cos(lean)]]) @ told
    instrument = Instrument(("along",), direction=(*told, 0.0))
    result = diagnose(planar_arm(), _read(q, (tip @ turned + 0.123)[:, None], (ALONG,), instrument, frame="free"))

    low, high = _offset(result, 3)
    assert low < OFF < high
    assert ("encoder_offset", (1,)) in result.invisible


@pytest.mark.parametrize("anchor", [(*ANCHOR, 0.0), None])
def test_distances_find_a_zero_from_a_known_and_from_an_unknown_place(anchor):
    q, tip = _tips(1)
    instrument = Instrument(("distance",), anchor=anchor)
    result = diagnose(planar_arm(), _read(q, _distance(tip), (DISTANCE,), instrument))

    low, high = _offset(result, 2)
    assert low < OFF < high
    assert result.rms_after == pytest.approx(SIGMA, rel=0.15)
    if anchor is None:
        assert ("encoder_offset", (1,)) in result.invisible
        assert _says(result, "It does not show 3 of the 3 ways")


def test_distances_from_the_first_joints_axis_do_not_show_how_the_base_is_turned():
    """A zero of joint 1 turns the arm about the anchor: nothing moves, and nothing may be named."""
    q, tip = _tips(0)
    instrument = Instrument(("distance",), anchor=(0.0, 0.0, 0.0))
    result = diagnose(planar_arm(), _read(q, _distance(tip, np.zeros(2)), (DISTANCE,), instrument))

    assert result.verdict == "none"
    assert _says(result, "does not see joint 1 move")
    assert _says(result, "turned about z")


def test_rows_of_different_instruments_each_by_its_own_noise():
    """A rough tracker in half of the rows and a fine ballbar in the others: the fine one says how large it is."""
    q, tip = _tips(1, poses=60)
    rng = np.random.default_rng(8)
    both = np.column_stack([tip + 80e-6 * rng.standard_normal(tip.shape), _distance(tip)])
    half = (np.arange(len(q)) // 2) % 2 == 0
    slots = np.where(half[:, None], (0, 1, -1), (-1, -1, DISTANCE))
    instrument = Instrument(("position", "distance"), anchor=(*ANCHOR, 0.0))
    recording = laid_out(_read(q, both, slots, instrument))
    assert recording.tip.shape == (60 * 2 + 60, 1)

    result = diagnose(planar_arm(), recording)
    low, high = _offset(result, 2)
    assert low < OFF < high
    assert high - low < 0.1 * OFF
    assert "distance: The noise floor is" in result.noise_source
    expected = np.sqrt((2 * (80e-6**2 + SIGMA**2) + SIGMA**2) / 3)
    assert result.noise_floor == pytest.approx(expected, rel=0.2)


def test_a_ballbar_at_three_sockets_and_a_height_gauge_are_one_recording():
    """Each with an unknown anchor of its own; the gauge sees what these cannot, and all are noisy in their own way."""
    arm, recordings = planar_arm(), []
    for number, anchor in enumerate(([0.3, -0.9], [1.1, 0.4], [-0.5, 0.6])):
        q, tip = _tips(1, poses=20, seed=20 + number)
        instrument = Instrument(("distance",))
        recordings.append(_read(q, _distance(tip, np.array(anchor)), (DISTANCE,), instrument, unit=f"socket {number}"))
    q, tip = _tips(1, poses=20, seed=30)
    recordings.append(_read(q, tip, (0, 1), Instrument(), unit="camera"))

    alone = together(recordings[:3], arm)
    assert alone.tip.shape == (120, 1)
    everything = together(recordings, arm)
    assert everything.tip.shape == (200, 1)
    result = diagnose(arm, everything)
    low, high = _offset(result, 2)
    assert low < OFF < high
    assert len(result.recordings) == 4
    assert all(recording.rms_after == pytest.approx(SIGMA, rel=0.35) for recording in result.recordings)
