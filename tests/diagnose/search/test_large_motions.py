"""Findings so large that first order does not hold: named alone, in full, and by the right one of two like names."""

import math

import numpy as np
import pytest

from diagnose.diagnosis import diagnose
from diagnose.reading.read import read_recording
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip, poses, table, written

SIGMA = 20e-6


def measured(tmp_path, off, longer=(0.0, 0.0, 0.0), frame="known"):
    """Forty poses, each read three times, by textbook kinematics with zeros (rad) and lengths (m) off."""
    rng = np.random.default_rng(11)
    q = np.repeat(poses(40), 3, axis=0)
    tip = planar_tip(q + np.array(off), tuple(np.add(LENGTHS, longer))) + SIGMA * rng.standard_normal((120, 2))
    arm = planar_arm()
    path = written(tmp_path / "recording.csv", table(q, tip))
    if frame == "free":
        (tmp_path / "recording.yaml").write_text("frame: free\n", encoding="utf-8")
        return arm, read_recording(path, arm, tmp_path / "recording.yaml")
    return arm, read_recording(path, arm)


@pytest.mark.parametrize("frame", ["known", "free"])
def test_a_zero_off_by_two_degrees_is_named_alone(tmp_path, frame):
    off = math.radians(2.0)
    arm, recording = measured(tmp_path, (0.0, off, 0.0), frame=frame)
    found = diagnose(arm, recording)
    assert [(each.effect, each.at) for each in found.findings] == [("encoder_offset", (2,))]
    low, high = found.findings[0].parameters[0].interval
    assert low < off < high
    assert found.rms_after < 1.1 * found.noise_floor
    assert any("beyond first order" in note for note in found.notes)
    assert diagnose(found.corrected, recording).verdict == "none"


def test_the_last_joints_zero_is_not_taken_for_the_tool(tmp_path):
    """To first order they are one; a degree of the zero is one number where a tool's offset is two."""
    arm, recording = measured(tmp_path, (0.0, 0.0, math.radians(-1.0)))
    found = diagnose(arm, recording)
    assert [(each.effect, each.at) for each in found.findings] == [("encoder_offset", (3,))]
    assert ("tool_offset", ()) in [(each.effect, each.at) for each in found.findings[0].alternatives]


def test_a_zero_and_a_length_together(tmp_path):
    arm, recording = measured(tmp_path, (0.0, math.radians(1.5), 0.0), (0.006, 0.0, 0.0))
    found = diagnose(arm, recording)
    assert {(each.effect, each.at) for each in found.findings} == {("encoder_offset", (2,)), ("link_length", (1,))}
    assert found.rms_after < 1.1 * found.noise_floor
