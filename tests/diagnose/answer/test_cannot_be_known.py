"""What a recording cannot show is said, and nothing is named for it: recordings by plain sums of cosines."""

import numpy as np
import pytest

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.by_cosines import GIVES, SIGMA, file, noise, poses, recording, tips

NAMES = {"encoder_offset", "encoder_scale", "joint_compliance", "link_bending", "link_length", "backlash"}


@pytest.mark.parametrize("turns", [0.0, 2e-4])
def test_a_target_that_hardly_turns_leaves_the_tool_alone(turns):
    """Frame and tool are free, the tool keeps its direction to within `turns`: it must not run off, and encoder 2, 0.3
    mrad off, is found as it is among a few names."""
    q = poses(1)
    q[:, 2] = -q[:, 0] - q[:, 1] + turns * np.random.default_rng(2).standard_normal(len(q))
    q = np.repeat(q, 2, axis=0)
    tip = tips(q, errors=np.array([0.0, 3e-4, 0.0])) + noise(1, len(q))
    turned = tip @ np.array([[0.8, 0.6], [-0.6, 0.8]]) + [2.0, -1.0]
    read = recording(q, turned, frame="free", tool="free")
    assert np.abs(observe(file(), read).alignment.tool).max() < 1e-5
    result = diagnose(file(), read, Options(without=frozenset(EFFECTS) - NAMES))
    assert "along x and y cannot be told" in result.notes[0]
    offset = next(finding for finding in result.findings if finding.effect == "encoder_offset").parameters[0]
    assert offset.interval[0] < 3e-4 < offset.interval[1]
    assert offset.interval[1] - offset.interval[0] < 5e-5


def test_a_target_that_turns_is_found_on_the_tool():
    """The same with a wrist that turns: nothing is left open."""
    q = np.repeat(poses(1), 2, axis=0)
    angle = q.sum(axis=1)
    at = tips(q) + 5e-3 * np.stack([np.cos(angle), np.sin(angle)], axis=1) + noise(1, len(q))
    result = observe(file(), recording(q, at, frame="free", tool="free")).alignment
    assert result.tool == pytest.approx([5e-3, 0.0], abs=3e-5)
    assert result.undetermined == ()


@pytest.mark.parametrize("jitter", [0.0, 1e-5])
@pytest.mark.parametrize("off", [0.0, 3e-4])
def test_one_pose_read_fifty_times_is_insufficient(off, jitter):
    """However far off the tip is there, and whether the encoders' last digit stands still or not."""
    rng = np.random.default_rng(3)
    q = np.tile([0.5, 0.7, -0.4], (50, 1))
    tip = tips(q, errors=np.array([0.0, off, 0.0])) + noise(2, 50)
    result = diagnose(file(), recording(q + jitter * rng.standard_normal(q.shape), tip))
    assert result.verdict == "insufficient_data"
    assert result.sentence.startswith("One pose, read 50 times")
    assert result.unknown is None


def rounded(gives, **settings):
    q = np.repeat(poses(3), 3, axis=0)
    return diagnose(file(), recording(q, np.round(tips(q, gives=gives) + noise(3, len(q)), 3), **settings))


@pytest.mark.parametrize("sigma", [None, SIGMA])
def test_readings_rounded_to_a_millimetre_are_no_mismatch(sigma):
    """Each visit's repeats are rounded alike: what they are off by together is rounding, whatever sigma is declared."""
    result = rounded(GIVES, sigma=sigma)
    assert result.verdict == "none"
    assert result.sentence.startswith("No mismatch beyond the noise floor")
    assert result.noise_floor == pytest.approx(1e-3 / np.sqrt(6.0))
    assert any("less than readings in steps of 1 mm" in note for note in result.notes) is (sigma is not None)


def test_rounded_readings_still_show_what_is_large():
    """A drive that gives 30 urad/(N*m) more: named, and its interval counts each visit once."""
    result = rounded(GIVES + np.array([0.0, 3e-5, 0.0]))
    assert result.findings[0].effect == "joint_compliance"
    assert result.findings[0].at == (2,)
    size = result.findings[0].parameters[0]
    assert size.interval[0] < 3e-5 < size.interval[1]
    assert size.interval[1] - size.interval[0] > 8e-6
    assert result.unknown is None


@pytest.mark.parametrize("gives", slow_but([0.0, 3e-5], 0.0))
def test_a_fifth_of_bad_readings_is_set_aside_not_explained(gives):
    """Pairs at 50 poses, one reading in five off by a millimetre: the pair's other reading tells that it is no
    physics."""
    rng = np.random.default_rng(5)
    q = np.repeat(poses(5, 50), 2, axis=0)
    tip = tips(q, gives=GIVES + np.array([0.0, gives, 0.0])) + noise(5, len(q))
    bad = rng.random(len(q)) < 0.2
    tip[bad] += 1e-3 * rng.standard_normal((bad.sum(), 2))
    result = diagnose(file(), recording(q, tip))
    assert {row.row for row in result.rejected_rows} <= set((np.flatnonzero(bad) + 1).tolist())
    assert len(result.rejected_rows) > 0.9 * bad.sum()
    assert result.rms_after < 1.1 * result.noise_floor
    assert result.noise_floor == pytest.approx(SIGMA * np.sqrt(2.0), rel=0.3)
    assert result.unknown is None
    assert {(finding.effect, finding.at) for finding in result.findings} == (
        {("joint_compliance", (2,))} if gives else set()
    )


def test_bad_readings_that_nothing_checks_are_said():
    rng = np.random.default_rng(6)
    q = poses(6, 80)
    bad = rng.choice(80, 15, replace=False)
    tip = tips(q) + noise(6, 80)
    tip[bad] += 1e-3 * rng.standard_normal((15, 2))
    result = diagnose(file(), recording(q, tip))
    assert result.findings == ()
    assert any("readings lie further off than scatter explains" in note for note in result.notes)
