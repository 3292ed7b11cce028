"""What an arm file is worth on a recording."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.residual.observe import observe, residual_in_pieces
from tests.diagnose.core_cases import made_arm, recorded, with_effects


def test_droop_that_the_encoder_sees_moves_no_tip():
    """Where commands are logged beside the encoders, a servo that sags is seen by these, and the tip is where they say;
    where the coordinates are commands it sags with it."""
    arm = made_arm()
    sagging = with_effects(arm, ("servo_droop", (2,), {"compliance": 1e-5}))
    recording = recorded(sagging, commands=True, poses=12)
    assert predict(sagging, recording).rms == pytest.approx(predict(arm, recording).rms, rel=1e-9)
    alone = recorded(sagging, poses=12)
    assert predict(sagging, alone).rms < 0.5 * predict(arm, alone).rms


@pytest.mark.parametrize("free", [(), ("frame",), ("tool",), ("frame", "tool")])
def test_in_pieces_as_in_whole(free):
    """The model is evaluated for some readings after others. What runs on from one to the next (a lag of the links'
    warming, creep, time) and what all say together (frame and tool) is as in one piece."""
    arm = with_effects(
        made_arm(),
        ("thermal_expansion", (1, 2), {"lag": 900.0}),
        ("creep", (2,), {"compliance": 1e-6, "time_constant": 600.0}),
        ("frame_drift", (), {"x": 1e-8}),
        ("backlash", (1,), {"width": 1e-4}),
        ("friction_windup", (2,), {"windup": 1e-4}),
    )
    given = recorded(arm, poses=30)
    rows = given.size
    warm = 293.0 + 8.0 * np.sin(np.arange(rows) / 7.0)
    asked = replace(
        given,
        tip=given.tip + 1e-5 * np.random.default_rng(4).normal(size=given.tip.shape),
        time=45.0 * np.arange(rows),
        temperature=warm,
        payload_mass=np.where(np.arange(rows) % 20 < 9, 2.0, 5.0),
        frame="free" if "frame" in free else "known",
        tool="free" if "tool" in free else "known",
    )
    whole = observe(arm, asked).tip_residual()
    heard = []
    pieces = residual_in_pieces(arm, asked, at_once=7, heard=lambda *done: heard.append(done))
    assert np.abs(pieces - whole).max() < 1e-12
    assert heard[-1] == (rows, rows)
    assert len(heard) >= rows // 7
    without = replace(arm, effects=arm.effects[1:])
    assert np.abs(residual_in_pieces(without, asked) - whole).max() > 1e-6  # what lags shows at all
