"""A torque of any shape over a joint's angle is named as that, with its curve; MuJoCo moves the arm against it."""

import numpy as np

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.predict import predict_motion
from tests.diagnose.motion.causes.test_elastic_drive import arm, log_of

__all__ = ["arm"]


def bump(q):
    """What a cable pushes joint 2 with: 4 N*m at 0.4 rad, within 0.1 rad of there."""
    return np.array([0.0, -4.0 * np.exp(-(((q[1] - 0.4) / 0.1) ** 2)), 0.0])


def test_a_bump_is_named_with_its_curve_and_its_file_predicts_another_motion(arm):
    result = diagnose_motion(arm, [log_of(gear=False, push=bump)])
    (found,) = result.findings
    assert (found.effect, found.at, result.unknown) == ("torque_curve", (2,), None)
    for parameter in found.parameters:
        angle = np.radians(float(parameter.parameter.split("_")[1]))
        low, high = parameter.interval
        assert low - 0.3 < -bump([0.0, (angle + np.pi) % (2.0 * np.pi) - np.pi])[1] < high + 0.3
    other = log_of(gear=False, push=bump, seed=4)
    before, after = (np.array(predict_motion(model, other).rms) for model in (arm, result.corrected))
    assert after[1] < 0.3 * before[1]


def test_a_wave_that_a_curve_would_hold_is_named_as_ripple(arm):
    """Four periods a turn, of 4 N*m."""
    result = diagnose_motion(arm, [log_of(gear=False, push=lambda q: np.array([0.0, -4.0 * np.sin(4.0 * q[1]), 0.0]))])
    (found,) = result.findings
    assert (found.effect, found.at) == ("gear_ripple", (2,))
    sine, _, order = found.parameters
    assert order.value == 4.0
    assert sine.interval[0] <= 4.0 <= sine.interval[1]
