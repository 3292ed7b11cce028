"""What turns too fast for the low-pass is named and sized as what is slow; what is late by several samples is late."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm


def nothing(q, _):
    """No torque beside the arm's own."""
    return np.zeros_like(q)


def whole(time):
    """The hand's mass at all times (N,)."""
    return np.full(len(time), HAND)


@pytest.mark.parametrize("order", [12, 25, 50, 90])
def test_a_fast_order_is_found_with_its_size(tmp_path, order):
    """Periods in a turn that are slower than the low-pass in part of the motion only."""
    sine, cosine = -2.0, 3.0

    def wave(q, v):
        return np.array([sine * np.sin(order * q[0]) + cosine * np.cos(order * q[0]), np.zeros_like(v[1])])

    found = diagnose_motion(plumb_arm(tmp_path), [logged(2, whole, wave, pace=0.3)]).findings
    (ripple,) = [item for item in found if item.effect == "gear_ripple"]
    sizes = {size.parameter: size for size in ripple.parameters}
    assert ripple.at == (1,)
    assert sizes["order"].value == order
    for name, true in (("sine", sine), ("cosine", cosine)):
        assert sizes[name].value == pytest.approx(true, rel=0.05)
        assert sizes[name].interval[0] <= true <= sizes[name].interval[1]


def test_a_drive_that_is_late_by_four_samples_is_late(tmp_path):
    """Late by more than any clock of a log, which by three quarters of a sample is nobody's cause."""
    log, late = logged(3, whole, nothing), 0.04
    second = CubicSpline(log.time, log.torque[:, 1])(log.time - late)
    found = diagnose_motion(
        plumb_arm(tmp_path), [replace(log, torque=np.column_stack([log.torque[:, 0], second]))]
    ).findings
    (delay,) = [item for item in found if item.effect == "torque_delay"]
    assert delay.at == (2,)
    assert delay.parameters[0].value == pytest.approx(late, rel=0.1)
