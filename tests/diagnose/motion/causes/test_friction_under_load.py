"""Friction by load and speed together, and loss by the direction of power, of two links in closed form."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from tests.diagnose.motion.plumb_arm import HAND, logged, plumb_arm, torques


def under_load(law):
    """What a law of load and speed (2, N) takes; the load is that of the motion in closed form."""

    def more(q, v):
        time = np.arange(q.shape[1]) / 100.0
        a = CubicSpline(time, v, axis=1)(time, 1)
        return law(torques(q, v, a, np.full(q.shape[1], HAND)), v)

    return more


def diagnosed(tmp_path, law):
    log = logged(5, lambda time: np.full(len(time), HAND), under_load(law))
    return diagnose_motion(plumb_arm(tmp_path), [log])


def test_a_gears_efficiencies_both_ways_are_named_as_one_of_several(tmp_path):
    """85 % where the drives lift, 70 % where the load drives: as well friction of 25 % on masses that are 6 % less."""
    result = diagnosed(tmp_path, lambda load, v: np.where(load * v > 0.0, load / 0.85, 0.7 * load) - load)
    found = {item.at: item for item in result.findings}
    assert {item.effect for item in result.findings} == {"gear_efficiency"}
    assert set(found) == {(1,), (2,)}
    for item in result.findings:
        forward, backward = item.parameters
        assert forward.value == pytest.approx(1.0 / 0.85 - 1.0, abs=0.01)
        assert backward.value == pytest.approx(0.3, abs=0.01)
        assert any(
            {name for name, _ in other.effects} == {"friction_load", "link_inertial"} for other in item.alternatives
        )
    assert result.verdict == "alias_class"


def test_friction_under_load_that_falls_with_speed_is_told_from_both(tmp_path):
    def law(load, v):
        rubs = np.array([0.2, 0.0])[:, None] * np.abs(load) * np.exp(-np.abs(v) / 0.3)
        return np.sign(v) * rubs

    result = diagnosed(tmp_path, law)
    (item,) = result.findings
    assert (item.effect, item.at) == ("friction_load_stribeck", (1,))
    share, speed = item.parameters
    assert speed.value == pytest.approx(0.3)
    assert share.interval[0] < 0.2 < share.interval[1]
