"""What an arm file is worth on a recording."""

import pytest

from diagnose.predict import predict
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
