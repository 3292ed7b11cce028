"""What instruments read where nothing is wrong: exactly what the model says, wherever they stand."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.instruments.view import viewed
from linkwright.core.diagnose.residual.observe import beyond_first_order, observe
from tests.diagnose.instruments.spatial_arm import Truth, placed, read, session, spatial_arm, tips

ALONG = slots_of("along")[0]
DISTANCE = slots_of("distance")[0]
PLANE = slots_of("plane")[0]

ANCHOR = (0.7, -0.4, 0.9)
UP = (0.36, 0.48, 0.8)
SLANT = Rotation.from_rotvec([0.9, -1.7, 0.4]).as_matrix()
SHIFT = np.array([1.5, -0.7, 0.3])
POSES, PAYLOAD = session(40, seed=2, repeats=1)
TIPS = placed(POSES)[0]


def _slots(*slots: int) -> np.ndarray:
    return np.tile(slots, (len(POSES), 1))


def _distance(tip: np.ndarray) -> np.ndarray:
    return np.linalg.norm(tip - ANCHOR, axis=1)[:, None]


@pytest.mark.parametrize(
    ("values", "slots", "instrument", "frame"),
    [
        (TIPS[:, 2:], (2,), Instrument(), "known"),
        (TIPS[:, [0, 2]], (0, 2), Instrument(), "known"),
        (TIPS @ np.array(UP)[:, None], (ALONG,), Instrument(("along",), direction=UP), "known"),
        (_distance(TIPS), (DISTANCE,), Instrument(("distance",), anchor=ANCHOR), "known"),
        (_distance(TIPS), (DISTANCE,), Instrument(("distance",)), "known"),
        (_distance(TIPS @ SLANT.T + SHIFT), (DISTANCE,), Instrument(("distance",), anchor=ANCHOR), "free"),
        ((TIPS @ SLANT.T + SHIFT)[:, :2], (0, 1), Instrument(), "free"),
        ((TIPS @ SLANT.T + SHIFT) @ np.array(UP)[:, None], (ALONG,), Instrument(("along",), direction=UP), "free"),
    ],
)
def test_a_sound_arm_leaves_nothing_wherever_the_instrument_stands(values, slots, instrument, frame):
    recording = read(POSES, PAYLOAD, values, slots=_slots(*slots), instrument=instrument, frame=frame)

    assert np.abs(observe(spatial_arm(), recording).residual).max() < 1e-9


def test_a_distance_is_not_linearised():
    """A zero of 20 mrad beside which first order is off by a tenth of a millimetre and more."""
    truth = Truth(zeros=(0.0, 0.02, 0.0, 0.0, 0.0))
    real = tips(POSES, PAYLOAD, truth)
    instrument = Instrument(("distance",), anchor=ANCHOR)
    recording = read(POSES, PAYLOAD, _distance(real), slots=_slots(DISTANCE), instrument=instrument)
    observed = observe(spatial_arm(), recording)

    entry = EffectEntry("encoder_offset", (2,), {"offset": 0.02})
    first = observed.view.of_tip(real - TIPS)
    assert np.abs(observed.residual - first).max() > 1e-4
    assert observed.view.change(real - TIPS) == pytest.approx(observed.residual, abs=1e-12)
    about = observe(spatial_arm(), recording, about=(entry,))
    linear = about.drive_moved(1)[:, :1] * 0.02
    assert about.residual == pytest.approx(linear, abs=1e-9)
    assert np.abs(beyond_first_order(observed, (entry,))).max() > 1e-4


def test_touches_of_a_point_leave_how_far_they_lie_from_their_middle():
    touches = np.arange(len(POSES)) % 4
    nothing = np.zeros((len(POSES), 3))
    instrument = Instrument(("same_point",), labels=("a", "b", "c", "d"))
    recording = read(POSES, PAYLOAD, nothing, slots=_slots(5, 6, 7), touches=touches, instrument=instrument)
    left = observe(spatial_arm(), recording).residual

    for label in range(4):
        own = TIPS[touches == label]
        assert left[touches == label] == pytest.approx(own.mean(axis=0) - own, abs=1e-12)


def test_touches_of_a_plane_leave_how_far_they_lie_from_it():
    """Tips brought onto two planes by their distances from them: those are what is left, up to a sign."""
    rng = np.random.default_rng(4)
    normal = np.array([0.6, 0.0, 0.8])
    touches = np.arange(len(POSES)) % 2
    off = 1e-4 * rng.standard_normal(len(POSES))
    on_plane = TIPS - (TIPS @ normal)[:, None] * normal + np.outer(0.3 * touches + off, normal)

    recording = read(
        POSES, PAYLOAD, np.zeros((len(POSES), 1)), slots=_slots(PLANE), touches=touches,
        instrument=Instrument(("plane",), labels=("left", "right")),
    )  # fmt: skip
    view = viewed(recording, on_plane, np.tile(np.eye(3), (len(POSES), 1, 1)), flat=False)

    for label in range(2):
        rows = touches == label
        design = np.column_stack([np.ones(rows.sum()), on_plane[rows] @ [0.8, 0.0, -0.6], on_plane[rows][:, 1]])
        beyond = off[rows] - design @ np.linalg.lstsq(design, off[rows], rcond=None)[0]
        left = view.residual[rows, 0]
        assert min(np.abs(left - beyond).max(), np.abs(left + beyond).max()) < 1e-7
    assert len(view.names) == 6
