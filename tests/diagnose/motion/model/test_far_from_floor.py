"""A few names that leave far more than the whole library leaves are no explanation."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm

LOAD = 1.2
"""kg at the tip that the file lacks."""


def rubs(_, v):
    """Dry and viscous friction in both joints."""
    return np.array([[0.8], [0.5]]) * np.sign(v) + np.array([[0.4], [0.3]]) * v


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_a_torque_that_counts_twice(tmp_path, factor):
    """The load's part of it counts twice too, which no sum of names is; without the factor the same names are named."""
    log = logged(5, lambda time: np.full_like(time, HAND + LOAD), rubs)
    torque = log.torque * [1.0, factor]
    result = diagnose_motion(plumb_arm(tmp_path), [replace(log, torque=torque)])
    found = {finding.effect: finding for finding in result.findings}
    if factor == 1.0:
        assert result.verdict != "unknown"
        assert set(found) == {"payload", "friction_coulomb", "friction_viscous"}
        return
    assert result.verdict == "unknown"
    assert 2 in result.unknown.joints
    worst = result.per_joint[result.unknown.worst - 1]
    assert 10.0 * worst.floor < result.unknown.amplitude < worst.before
    assert all(max(finding.rms_explained) > 1e-3 * worst.floor for finding in result.findings)
