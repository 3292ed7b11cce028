"""Free frames and tools: the base in the measuring frame and the tip on the last link, against what was planted."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.json.diagnosis import diagnosis_json
from linkwright.results.diagnoses.described import describe
from linkwright.screen.console import console
from linkwright.screen.described import show
from tests.diagnose.instruments.six_joint_arm import RANGE, six_joint_arm
from tests.diagnose.made_diagnosis import made_arm

NOISE = 20e-6
FEW = Options(without=frozenset({"link_length", "axis_misalignment", "joint_compliance", "hidden_joint"}))


@pytest.fixture(scope="module", params=["space", "plane"])
def found(request):
    """An arm whose frame and tool nobody knows, read in both: (result, base, turn as a matrix, tool)."""
    rng = np.random.default_rng(8)
    flat = request.param == "plane"
    arm = made_arm() if flat else six_joint_arm()
    width = 2 if flat else 3
    base, tool = np.array([1.3, -2.1, 0.4])[:width], np.array([0.03, -0.02, 0.05])[:width]
    turn = Rotation.from_rotvec([0.0, 0.0, 2.2] if flat else [0.4, -0.9, 2.0]).as_matrix()[:width, :width]
    if flat:
        # Straight links and a rigid arm: what loads bend is no matter here.
        arm = replace(
            arm,
            joints=tuple(replace(joint, stiffness=None) for joint in arm.joints),
            links=tuple(replace(link, section=None, material=None, mass=0.0) for link in arm.links),
        )
    q = np.repeat(rng.uniform(-RANGE, RANGE, (40, arm.size)), 2, axis=0)
    true = replace(arm, tool=(*tool.tolist(), 0.0)[:3])
    tips = tip_position(true, q)[:, :width] @ turn.T + base + NOISE * rng.standard_normal((80, width))
    recording = Recording("r.csv", q, tips, np.arange(1, 81), frame="free", tool="free")
    return diagnose(arm, recording, FEW), base, turn, tool


def test_frame_and_tool_are_where_they_were_put(found):
    """Within the intervals, which are about as wide as the noise makes them; by name, place and unit."""
    result, base, turn, tool = found
    frame, held = result.placements
    assert (frame.of, held.of) == ("frame", "tool")
    values = {item.name: item for item in frame.parameters}
    whole = np.eye(3)
    whole[: len(base), : len(base)] = turn
    yaw, pitch, roll = Rotation.from_matrix(whole).as_euler("ZYX")
    planted = dict(zip(("x", "y", "z"), base.tolist(), strict=False)) | {"roll": roll, "pitch": pitch, "yaw": yaw}
    outside = 0
    for name, item in values.items():
        half = 0.5 * (item.interval[1] - item.interval[0])
        assert 0.1 * NOISE < half < 20.0 * NOISE
        assert item.value == pytest.approx(planted[name], abs=2.0 * half)
        outside += not item.interval[0] <= planted[name] <= item.interval[1]
    for item, at in zip(held.parameters, tool.tolist(), strict=True):
        half = 0.5 * (item.interval[1] - item.interval[0])
        assert item.value == pytest.approx(at, abs=2.0 * half)
    assert outside <= 1


def test_they_are_shown(found, capsys):
    """On the screen a row each, and in the JSON in mm and degrees; nothing of them where they are known."""
    result, base, _, tool = found
    show(console(), describe(result))
    screen = capsys.readouterr().out
    assert "the base in the measuring frame" in screen
    assert "the tip at the last link's end" in " ".join(screen.split())
    content = diagnosis_json(result)
    assert content["frame"][0]["xyz_mm"] == pytest.approx((1e3 * base).tolist(), abs=0.5)
    assert len(content["frame"][0]["rpy_deg"]) == 3
    assert content["tool"][0]["xyz_mm"] == pytest.approx((1e3 * tool).tolist(), abs=0.5)
    known = diagnosis_json(replace(result, placements=()))
    assert (known["frame"], known["tool"]) == ([], [])
