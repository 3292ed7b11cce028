"""A load that is taken on the way: since when, and how much; and no change where a torque goes with the angle."""

import numpy as np
import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog

UPPER, FORE, MID, HAND, TAKEN = 0.4, 0.3, 6.0, 3.0, 1.2
"""Two links (m) that turn in a plumb plane, with point masses at their ends, and a load taken at the tip (kg)."""
NOISE, SINCE, ROUNDING = 0.05, 17.0, 1e-9
ARM = f"""name: plumb
gravity: [0 m/s^2, -9.81 m/s^2, 0 m/s^2]
chain:
  - joint: {{axis: z, range: [-3 rad, 3 rad]}}
    link:
      {{length: {UPPER} m, rigid: true, mass: 0 kg, masses: [{{mass: {MID} kg, at: [{UPPER} m, 0 m, 0 m], on: joint}}]}}
  - joint: {{axis: z, range: [-3 rad, 3 rad]}}
    link:
      {{length: {FORE} m, rigid: true, mass: 0 kg, masses: [{{mass: {HAND} kg, at: [{FORE} m, 0 m, 0 m], on: joint}}]}}
"""


def torques(q, v, a, hand):
    """In closed form (M. W. Spong et al., Robot Modeling and Control, 2006, section 7.3), `hand` (N,) kg at the tip."""
    both, far = hand * UPPER * FORE * np.cos(q[1]), hand * FORE**2
    pull = hand * UPPER * FORE * np.sin(q[1])
    near = (MID + hand) * UPPER**2 + far + 2.0 * both
    weight = 9.81 * hand * FORE * np.cos(q[0] + q[1])
    first = near * a[0] + (far + both) * a[1] - pull * (2.0 * v[0] * v[1] + v[1] ** 2)
    second = (far + both) * a[0] + far * a[1] + pull * v[0] ** 2
    return np.array([first + 9.81 * (MID + hand) * UPPER * np.cos(q[0]) + weight, second + weight])


def diagnosed(tmp_path, seed, hand_of, more_of):
    """Thirty seconds at 100 Hz: `hand_of` time at the tip, `more_of` angles beside at joint 2."""
    rng = np.random.default_rng(seed)
    time = np.arange(3000) / 100.0
    rates = 2.0 * np.pi * rng.uniform(0.1, 0.5, (2, 5))
    phases, swings = rng.uniform(0.0, 6.28, (2, 5)), rng.uniform(0.3, 0.8, (2, 5))
    turned = rates[:, :, None] * time + phases[:, :, None]
    q = np.sum(swings[:, :, None] * np.sin(turned), axis=1)
    v = np.sum((swings * rates)[:, :, None] * np.cos(turned), axis=1)
    a = -np.sum((swings * rates**2)[:, :, None] * np.sin(turned), axis=1)
    torque = torques(q, v, a, hand_of(time)) + NOISE * rng.standard_normal(q.shape)
    torque[1] += more_of(q[1])
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    log = MotionLog("log.csv", time, q.T, torque.T, np.arange(1, 3001))
    return diagnose_motion(read_arm(tmp_path / "arm.yaml"), [log])


@pytest.mark.parametrize("seed", [1, 2])
def test_a_load_that_is_taken_on_the_way(tmp_path, seed):
    """Payload, when and how much: the intervals hold the truth, and rows are 0.08 s apart."""
    result = diagnosed(tmp_path, seed, lambda t: HAND + TAKEN * (t >= SINCE), np.zeros_like)
    assert result.verdict == "unknown"
    assert result.unknown is not None
    change = result.unknown.change
    assert change is not None
    assert (change.effect, change.share > 0.9) == ("payload", True)
    assert change.interval[0] - ROUNDING <= SINCE <= change.interval[1] + ROUNDING
    assert change.time == pytest.approx(SINCE, abs=0.1)
    (mass,) = (item for item in change.parameters if item.parameter == "mass")
    assert mass.interval[0] <= TAKEN <= mass.interval[1]
    assert mass.value == pytest.approx(TAKEN, rel=0.03)
    assert f"changed at {change.time:.4g} s" in result.sentence


def test_a_bump_over_the_angle_is_no_change(tmp_path):
    """Torque that goes with the angle is there from the beginning; nor is it noise, small as it is."""
    result = diagnosed(tmp_path, 3, lambda t: np.full_like(t, HAND), lambda q: 0.5 * np.exp(-(((q - 0.3) / 0.2) ** 2)))
    assert result.verdict == "unknown"
    assert result.unknown is not None
    assert result.unknown.joints == (2,)
    assert "q2" in result.unknown.depends_on
    assert result.unknown.change is None


def test_noise_is_no_structure(tmp_path):
    """The same motion with nothing beside."""
    assert diagnosed(tmp_path, 4, lambda t: np.full_like(t, HAND), np.zeros_like).verdict == "none"
