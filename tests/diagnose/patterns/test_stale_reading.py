"""Angles logged before the joints had settled, recorded by the textbook's kinematics."""

import numpy as np
import pytest

from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import SIGMA, arm_of_drives
from tests.diagnose.recorded import planar_tip, table, written

ARM = arm_of_drives()
SETTINGS = f"sigma: {1e6 * SIGMA:g} um\n"


def logged(folder, seed, share, commands=False):
    """A recording whose angles lack a share of the move just made; the arm stands where it was commanded."""
    rng = np.random.default_rng(seed)
    stood = rng.uniform(-1.6, 1.6, (160, 3))
    logged_angles = stood - np.diff(stood, axis=0, prepend=stood[:1]) * share
    tip = planar_tip(stood) + SIGMA * rng.standard_normal((160, 2))
    columns = table(logged_angles, tip)
    if commands:
        columns |= {f"c{k + 1}_deg": [f"{degree:.7f}" for degree in np.degrees(stood[:, k])] for k in range(3)}
    (folder / "recording.yaml").write_text(SETTINGS, encoding="utf-8")
    return read_recording(written(folder / "recording.csv", columns), ARM, folder / "recording.yaml")


@pytest.mark.parametrize("seed", slow_but(range(3), 1))
def test_the_share_of_the_move_still_to_come_is_found(tmp_path, seed):
    """The move is told by the logged angles, whose differences lack a share of a share: 3e-4 of it."""
    result = diagnose(ARM, logged(tmp_path, seed, np.array([0.0, 3e-4, 0.0])))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("stale_reading", (2,))]
    assert result.unknown is None
    size = result.findings[0].parameters[0]
    assert size.parameter == "share_of_move"
    assert size.value == pytest.approx(3e-4, rel=0.05)


@pytest.mark.slow
def test_where_commands_are_logged_the_joint_stood_at_them(tmp_path):
    result = diagnose(ARM, logged(tmp_path, 1, np.array([4e-4, 0.0, 0.0]), commands=True))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("stale_reading", (1,))]
    size = result.findings[0].parameters[0]
    assert size.parameter == "share_of_command"
    assert size.value == pytest.approx(1.0, rel=0.05)
    assert len(result.findings[0].parameters) == 1


@pytest.mark.slow
def test_angles_read_in_time_are_not_called_stale(tmp_path):
    for seed in range(4):
        assert diagnose(ARM, logged(tmp_path, seed, np.zeros(3))).verdict == "none"
