"""Numbers that a pattern is not linear in are found between the values that were tried, and what stands beside them."""

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm

DRY, MORE = 1.5, 5.0
"""N*m of dry friction, and N*m more at no speed."""


@pytest.mark.parametrize("at", [0.14, 0.17])
def test_a_speed_between_two_that_were_tried_is_found(tmp_path: Path, at: float) -> None:
    """rad/s in which the friction falls to 37 %; 0.1 and 0.3 are tried."""

    def rubbed(_: np.ndarray, v: np.ndarray) -> np.ndarray:
        dry = DRY + MORE * np.exp(-np.abs(v[0]) / at)
        return np.array([dry * np.sign(v[0]), np.zeros_like(v[1])])

    log = logged(2, lambda time: np.full(len(time), HAND), rubbed)
    sizes = {
        (item.effect, size.parameter): size
        for item in diagnose_motion(plumb_arm(tmp_path), [log]).findings
        for size in item.parameters
        if item.at == (1,)
    }
    speed, more = sizes["friction_stribeck", "speed"], sizes["friction_stribeck", "torque"]
    assert speed.value == pytest.approx(at, rel=0.05)
    assert speed.interval[1] / speed.interval[0] < 1.5
    for size, true in ((speed, at), (more, MORE), (sizes["friction_coulomb", "torque"], DRY)):
        assert size.interval[0] <= true <= size.interval[1]
    assert more.value == pytest.approx(MORE, rel=0.05)
