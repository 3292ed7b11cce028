"""What is made of findings that leave most of a mismatch, or that make readings worse which were held out."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.conclusion import Conclusion
from linkwright.core.diagnose.answer.confirmation import Confirmed
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.noise import noise_floor
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.search.naming import Named, Namer, _pruned
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import arm_of_drives, read, turned_by
from tests.diagnose.core_cases import group_of

ARM = arm_of_drives()
OFFSET = 1.7e-4
"""rad."""


def that_does_not_return(seed, times):
    """120 visits, each read twice, to as many poses or to fewer that are come back to after all others; encoder 2 is
    off by 0.17 mrad (80 um or so), and at every visit the tip is off anew by 0.1 mm a component, any way."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1.6, 1.6, (120 // times, 3))
    q = np.repeat(np.tile(poses, (times, 1)), 2, axis=0)
    off = turned_by(q, (0.0, OFFSET, 0.0))
    return read(q, off + 1e-4 * np.repeat(rng.standard_normal((120, 2)), 2, axis=0), rng)


def share_left(found):
    """What findings leave of a mismatch: sums of squares, less the noise of single readings."""
    floor = found.noise_floor**2
    return (found.rms_after**2 - floor) / (found.rms_before**2 - floor)


def returning_note(found):
    return any("does not return more exactly" in note for note in found.notes)


@pytest.mark.parametrize("seed", [pytest.param(0, marks=pytest.mark.slow), pytest.param(1, marks=pytest.mark.slow), 2])
def test_what_lasts_is_named_where_poses_are_come_back_to(seed):
    """Three visits to each pose tell that the rest, though most of the mismatch, is not there again."""
    result = diagnose(ARM, that_does_not_return(seed, 3))
    assert share_left(result) > 0.5
    assert result.verdict in ("named", "alias_class")
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    (offset,) = result.findings[0].parameters
    # Three standard errors: 240 components that scatter by 0.1 mm and move by 0.32 m a radian.
    assert offset.value == pytest.approx(OFFSET, abs=6e-5)
    assert returning_note(result)


@pytest.mark.slow
@pytest.mark.parametrize("seed", slow_but(range(3), 1))
def test_what_leaves_most_explains_nothing_where_no_pose_is_seen_again(seed):
    """The same arm, each pose visited once: the rest may be there for good, and what was named is small beside it. That
    it may be scatter is said, and how to tell."""
    result = diagnose(ARM, that_does_not_return(seed, 1))
    assert share_left(result) > 0.5
    assert result.verdict == "unknown"
    assert ("encoder_offset", (2,)) in [(finding.effect, finding.at) for finding in result.findings]
    assert any("may also be the arm's repeatability" in note for note in result.notes)
    assert result.unknown.decide.startswith("visit some poses three times or more")


def far_and_near(bent):
    """One pose with joint 3 at 1.5 rad that is come back to six times, and forty others within 0.24 rad of nought.
    Encoder 2 is off; encoder 3 errs by 0.4 mrad a radian at the far pose and, where it is `bent`, the other way round
    near nought: the far pose has next to all the leverage, and without it one would expect the opposite there."""
    rng = np.random.default_rng(1)
    poses = rng.uniform(-1.6, 1.6, (46, 3)) * [1.0, 1.0, 0.15]
    far = rng.permutation(46) < 6
    poses[far] = (0.4, -0.5, 1.5)
    q, there = np.repeat(poses, 2, axis=0), np.repeat(far, 2)
    errors = np.zeros_like(q)
    errors[:, 1] = 3e-4
    errors[:, 2] = 4e-4 * q[:, 2] * np.where(there | (not bent), 1.0, -1.0)
    return read(q, turned_by(q, errors), rng)


def concluded(recording):
    """What is concluded where the search has named a scale of encoder 3 and an offset of encoder 2, in this order, at
    p-values of 0.002 and 0.001."""
    noise = noise_floor(recording, ARM)
    prepared = prepare(observe(ARM, recording), Options(), noise.rms_m)
    namer = Namer(prepared, thorough=False, seed=0)
    members = (group_of(prepared, "encoder_scale", (2,)), group_of(prepared, "encoder_offset", (1,)))
    named = Named(members, (), (0.002, 0.001), namer.test(()), None)
    names = Confirmed(namer, named, noise, Options(), whole=None, progress=lambda *_: None)
    return Conclusion(names).result(ARM, recording, 0.0)


def test_a_finding_that_makes_held_out_readings_worse_is_left_out_again():
    """The scale explains most of what is left of the readings fitted, and predicts the far pose the wrong way. Without
    it a form stands beside the offset: what bends is unknown."""
    result = concluded(far_and_near(bent=True))
    assert result.verdict == "unknown"
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    assert result.findings[0].p_value < 0.01
    (note,) = (item for item in result.notes if "Held-out readings fit as well" in item)
    assert note.startswith("Set aside: scale of an encoder or of a gear ratio at joint 3, ")
    labels = [rung.label for rung in result.ladder]
    assert labels[:2] == ["model as given", "+ offset of an encoder's zero at joint 2"]
    assert not any("scale of an encoder" in label for label in labels)


def test_a_finding_that_predicts_held_out_readings_stays():
    """The same poses and findings, where the encoder errs alike everywhere."""
    result = concluded(far_and_near(bent=False))
    sizes = {finding.effect: finding.parameters[0].value for finding in result.findings}
    assert sizes == pytest.approx({"encoder_offset": 3e-4, "encoder_scale": 4e-4}, rel=0.1)
    assert {finding.effect: finding.p_value for finding in result.findings} == {
        "encoder_offset": 0.001,
        "encoder_scale": 0.002,
    }
    assert not any("Held-out readings fit as well" in note for note in result.notes)
    assert result.rms_after < 1.1 * result.noise_floor
    assert all(finding.rms_without_held_out > 2.0 * result.rms_after_held_out for finding in result.findings)


def test_what_stays_is_held_to_what_is_added():
    """Beside an encoder that is off by ten times its standard error, three causes that fit a per cent of noise each."""
    rng = np.random.default_rng(3)
    q = np.repeat(rng.uniform(-1.6, 1.6, (40, 3)), 2, axis=0)
    prepared = prepare(observe(ARM, read(q, turned_by(q, (0.0, 3e-4, 0.0)), rng)), Options())
    namer = Namer(prepared, thorough=False, seed=0)
    true = group_of(prepared, "encoder_offset", (1,))
    others = tuple(group_of(prepared, "link_length", (k,)) for k in range(3))
    members = (others[0], true, *others[1:])
    assert _pruned(namer, members, (0.4, 0.001, 0.3, 0.2)) == ((true,), (0.001,))
