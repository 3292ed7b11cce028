"""The measuring frame and the tool are found exactly where nothing else is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import matrices
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.diagnose.residual.alignment import aligned
from tests.diagnose.made_diagnosis import made_arm, made_recording


def at_rest(space):
    arm = made_arm(space)
    if space:  # a wrist across, or the tool's third direction is the base's
        joints = (*arm.joints[:2], replace(arm.joints[2], axis=(1.0, 0.0, 0.0)))
        links = (*arm.links[:1], replace(arm.links[1], end_rotation=rotation_rows("y", 0.7)), *arm.links[2:])
        arm = replace(arm, joints=joints, links=links)
    recording = made_recording(arm, repeats=1)
    state = solve(arm, list(recording.q.T), beams_of(arm))
    return recording, state


def directions(state, recording):
    return matrices(state.frames.orientation, recording.size, recording.tip.shape[1])


def rotation_rows(axis, angle):
    matrix = Rotation.from_euler(axis, angle).as_matrix()
    return tuple(tuple(float(x) for x in row) for row in matrix)


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize(("frame", "tool"), [(True, False), (False, True), (True, True)])
def test_frame_and_tool_are_recovered(space, frame, tool):
    """Measured points are exact: a frame turned anyhow and metres away, a tool some centimetres longer."""
    recording, state = at_rest(space)
    modelled, width = recording.tip, recording.tip.shape[1]
    offset = np.array([0.03, -0.02, 0.05])[:width] if tool else np.zeros(width)
    truth = modelled + matrices(state.frames.orientation, recording.size, width) @ offset
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0] if space else [0.0, 0.0, 2.0]).as_matrix()[:width, :width]
    shift = np.array([3.0, -2.0, 1.5])[:width]
    measured = (truth - shift) @ turn if frame else truth  # base = turn @ measured + shift
    asked = replace(recording, tip=measured, frame="free" if frame else "known", tool="free" if tool else "known")
    result = aligned(asked, directions(state, recording), modelled)
    assert result.residual == pytest.approx(0.0, abs=1e-9)
    assert result.tool == pytest.approx(offset, abs=1e-9)
    if frame:
        assert result.rotation == pytest.approx(turn, abs=1e-9)
        assert result.translation == pytest.approx(shift, abs=1e-9)
    assert measured @ result.rotation.T + result.translation == pytest.approx(truth, abs=1e-9)
    assert np.linalg.det(result.rotation) == pytest.approx(1.0)


def test_what_is_known_stays():
    recording, state = at_rest(space=False)
    result = aligned(
        replace(recording, tip=recording.tip + np.array([1e-3, 0.0])), directions(state, recording), recording.tip
    )
    assert result.residual == pytest.approx(np.tile([1e-3, 0.0], (recording.size, 1)))
    assert result.rotation == pytest.approx(np.eye(2))


@pytest.mark.parametrize("space", [False, True])
def test_points_on_a_line_are_no_mirror(space):
    """Points that hardly leave a line leave the turn about it open: it is still a turn."""
    recording, state = at_rest(space)
    width = recording.tip.shape[1]
    line = np.linspace(0.2, 0.9, recording.size)[:, None] * np.ones(width)
    asked = replace(recording, tip=line[:, ::-1] + 0.3, frame="free")
    result = aligned(asked, directions(state, recording), line)
    assert result.rotation @ result.rotation.T == pytest.approx(np.eye(width), abs=1e-12)
    assert np.linalg.det(result.rotation) == pytest.approx(1.0)
    assert result.residual == pytest.approx(0.0, abs=1e-9)
