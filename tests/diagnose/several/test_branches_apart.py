"""Two tips of one torso measured at once: two places, and recordings that stay told apart once they are joined."""

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.visits import poses
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.units.quantities import InputError
from linkwright.face.diagnosis import recordings_of
from linkwright.face.recording import Recording as Shown
from tests import two_arms

FREE = "origin: free"


def torso(folder, *, free=False):
    text = two_arms.arm_text()
    known = "origin: {xyz: [0.0 m, 0.2 m, 0.05 m]}"
    assert known in text
    (folder / "arm.yaml").write_text(text.replace(known, FREE) if free else text, encoding="utf-8")
    return folder / "arm.yaml"


def of_tip(branch, q):
    """A recording of one tip at the origin, which is enough to say what belongs together."""
    return Recording(f"{branch}.csv", q, np.zeros((len(q), 3)), np.arange(1, len(q) + 1), branch=branch)


def test_tips_measured_at_once_are_no_visits_of_one_pose(tmp_path):
    arm = lw.read_arm(torso(tmp_path), tip="").model
    q = np.random.default_rng(4).uniform(-0.5, 0.5, (6, arm.size))
    both = together([of_tip(tip, q) for tip in ("left", "right")], arm)
    pose = poses(observe(arm, both))
    assert len(set(pose[:6])) == len(set(pose[6:])) == 6
    assert not set(pose[:6]) & set(pose[6:])
    again = together([of_tip("left", q), of_tip("left", q)], arm)
    assert (poses(observe(arm, again))[:6] == poses(observe(arm, again))[6:]).all()


def test_joined_recordings_are_of_their_tips(tmp_path):
    """What the command line hands on is joined already."""
    given = lw.read_arm(torso(tmp_path, free=True), tip="")
    q = np.zeros((4, given.model.size))
    both = together([of_tip(tip, q) for tip in ("left", "right")], given.model)
    assert recordings_of(Shown(given, both), given).found is both
    one = together([of_tip("right", q), of_tip("right", q + 0.1)], given.model)
    with pytest.raises(InputError, match="no recording is of left's tip"):
        recordings_of(Shown(given, one), given)


def test_predict_asks_for_free_transforms_before_it_reads(tmp_path):
    """Reading against an arm whose transforms are free seeks them, which takes minutes."""
    with pytest.raises(InputError, match="origin: is free: nobody knows"):
        lw.predict(torso(tmp_path, free=True), tmp_path / "not there.csv")
