"""How the tool is turned, as a channel beside its place."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.orientation import with_sound_orientation
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError
from tests.diagnose.core_cases import with_effects
from tests.diagnose.made_diagnosis import made_arm
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

SIGMA, TURN_SIGMA = 20e-6, 20e-6
SCALE = 8e-4
SOFT = ("joint_compliance", (2,), {"compliance": 2e-6})


def turned(angles):
    """Rotations about z as quaternions, the columns of a file."""
    nothing = np.zeros_like(angles)
    return {"qx": nothing, "qy": nothing, "qz": np.sin(0.5 * angles), "qw": np.cos(0.5 * angles)}


def scaled(tmp_path, seat=0.4):
    """A planar arm whose third encoder reads too little, by the textbook; the target sits turned on the tool."""
    rng = np.random.default_rng(2)
    q = np.repeat(poses(40), 2, axis=0)
    true = q + np.array([0.0, 0.0, SCALE]) * q
    tip = planar_tip(true) + SIGMA * rng.standard_normal((80, 2))
    angle = true.sum(axis=1) + seat + TURN_SIGMA * rng.standard_normal(80)
    columns = table(q, tip)
    for name, values in turned(angle).items():
        columns[name] = [f"{x:.9f}" for x in values]
    (tmp_path / "recording.yaml").write_text("orientation: free\n", encoding="utf-8")
    return q, read_recording(written(tmp_path / "recording.csv", columns), planar_arm())


def test_what_is_left_of_a_turn_is_what_the_model_lacks(tmp_path):
    """An encoder's scale turns the tool in proportion to the joint's angle, but for a constant: the target's seat."""
    q, recording = scaled(tmp_path)
    observed = observe(planar_arm(), recording)
    left = observed.residual[:, observed.turn_columns][:, 0]
    expected = SCALE * q[:, 2]
    np.testing.assert_allclose(left - left.mean(), expected - expected.mean(), atol=5.0 * TURN_SIGMA)


def test_readings_without_orientation_count_for_their_place(tmp_path):
    _, whole = scaled(tmp_path)
    matrices = whole.orientation.copy()
    matrices[::3] = np.nan
    some = replace(whole, orientation=matrices)
    observed = observe(planar_arm(), some)
    assert np.all(observed.residual[::3, observed.turn_columns] == 0.0)
    signature = observed.turns(np.ones((80, 3)))
    assert np.all(signature[::3] == 0.0)
    assert np.all(signature[1::3] == 1.0)
    for recording in (whole, some):
        result = diagnose(planar_arm(), recording)
        assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_scale", (3,))]
        low, high = result.findings[0].parameters[0].interval
        assert low < SCALE < high


def test_turns_tell_more_of_the_same(tmp_path):
    """With the tool's turn recorded the interval of a scale is narrower, and holds the truth."""
    _, recording = scaled(tmp_path)
    widths = []
    for given in (recording, replace(recording, orientation=None)):
        parameter = diagnose(planar_arm(), given).findings[0].parameters[0]
        assert parameter.interval[0] < SCALE < parameter.interval[1]
        widths.append(parameter.interval[1] - parameter.interval[0])
    assert widths[0] < 0.8 * widths[1]


def test_orientations_are_used_only_where_the_settings_say_so(tmp_path):
    """The default leaves them: what a target's few markers make of a turn is not the arm's."""
    _, recording = scaled(tmp_path)
    unused = replace(recording, seat="unused")
    without = diagnose(planar_arm(), replace(recording, orientation=None))
    assert diagnose(planar_arm(), unused).findings == without.findings
    (tmp_path / "recording.yaml").write_text("orientation: yes please\n", encoding="utf-8")
    with pytest.raises(InputError, match="orientation"):
        read_recording(tmp_path / "recording.csv", planar_arm())


@pytest.mark.slow
def test_orientations_of_another_convention_are_left_out(tmp_path):
    """Angles with the wrong sign: said once, and the places are used as if there were no orientations."""
    q, recording = scaled(tmp_path)
    mirrored = replace(recording, orientation=np.transpose(recording.orientation, (0, 2, 1)))
    left_out = with_sound_orientation(planar_arm(), mirrored)
    assert left_out.seat == "unused"
    assert "Check the order" in left_out.warnings[-1]
    assert with_sound_orientation(planar_arm(), recording) is recording
    result = diagnose(planar_arm(), mirrored)
    assert any("Check the order" in note for note in result.notes)
    assert result.rms_after == diagnose(planar_arm(), replace(recording, orientation=None)).rms_after
    assert len(q) == result.recording.size


def test_in_space_too_transposed_matrices_are_left_out():
    plan = Plan(poses=16, repeats=2, orientation=True, free_frame=True)
    recording = simulate(made_arm(space=True), plan).recording
    assert with_sound_orientation(made_arm(space=True), recording) is recording
    transposed = replace(recording, orientation=np.transpose(recording.orientation, (0, 2, 1)))
    assert with_sound_orientation(made_arm(space=True), transposed).seat == "unused"


@pytest.mark.parametrize(
    ("space", "free"),
    [
        (False, False),
        (True, True),
        pytest.param(False, True, marks=pytest.mark.slow),
        pytest.param(True, False, marks=pytest.mark.slow),
    ],
)
def test_no_mismatch_stays_none(space, free):
    arm = made_arm(space)
    plan = Plan(poses=16, repeats=2, payloads=(0.0, 5.0), orientation=True, free_frame=free, seed=5)
    assert diagnose(arm, simulate(arm, plan).recording).verdict == "none"


@pytest.mark.slow
@pytest.mark.parametrize("free", [False, True], ids=["known frame", "free frame"])
def test_a_drive_that_gives_is_found_by_place_and_turn(free):
    arm = made_arm(space=True)
    plan = Plan(poses=20, repeats=3, payloads=(0.0, 5.0), orientation=True, free_frame=free, seed=3)
    result = diagnose(arm, simulate(with_effects(arm, SOFT), plan).recording)
    first = result.findings[0]
    assert ("joint_compliance", (2,)) in [(first.effect, first.at), *((a.effect, a.at) for a in first.alternatives)]
    assert result.rms_after < 1.1 * result.noise_floor
    again = simulate(with_effects(arm, SOFT), replace(plan, seed=8)).recording
    assert diagnose(result.corrected, again).verdict == "none"
