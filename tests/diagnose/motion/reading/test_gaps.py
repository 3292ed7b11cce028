"""A log with gaps under the right convention is taken as it is: nothing is differentiated across them."""

import numpy as np
import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.first_look.smoothing import smoothed
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.rules.rules import RULES

UPPER, FORE, MID, HAND = 0.33, 0.25, 6.0, 3.5
"""Two level links (m) with point masses at their ends (kg)."""
ARM = f"""name: level
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {{axis: z, range: [-2 rad, 2 rad]}}
    link:
      {{length: {UPPER} m, rigid: true, mass: 0 kg, masses: [{{mass: {MID} kg, at: [{UPPER} m, 0 m, 0 m], on: joint}}]}}
  - joint: {{axis: z, range: [-2 rad, 2 rad]}}
    link:
      {{length: {FORE} m, rigid: true, mass: 0 kg, masses: [{{mass: {HAND} kg, at: [{FORE} m, 0 m, 0 m], on: joint}}]}}
"""
GAPS = (2500, 2600)


def moved(rng):
    """Twenty seconds at 250 Hz: angles, and torques in closed form (M. W. Spong et al., Robot Modeling and Control,
    2006, section 7.3) with friction and noise."""
    time = np.arange(5000) / 250.0
    rates = 2.0 * np.pi * rng.uniform(0.3, 1.5, (2, 5))
    phases, swings = rng.uniform(0.0, 6.28, (2, 5)), rng.uniform(0.3, 1.0, (2, 5)) / rates
    turned = rates[:, :, None] * time + phases[:, :, None]
    q = np.sum(swings[:, :, None] * np.sin(turned), axis=1)
    v = np.sum((swings * rates)[:, :, None] * np.cos(turned), axis=1)
    a = -np.sum((swings * rates**2)[:, :, None] * np.sin(turned), axis=1)
    both, far = HAND * UPPER * FORE * np.cos(q[1]), HAND * FORE**2
    pull = HAND * UPPER * FORE * np.sin(q[1])
    near = (MID + HAND) * UPPER**2 + far + 2.0 * both
    first = near * a[0] + (far + both) * a[1] - pull * (2.0 * v[0] * v[1] + v[1] ** 2)
    second = (far + both) * a[0] + far * a[1] + pull * v[0] ** 2
    torque = np.array([first, second]) + np.array([[1.0], [0.5]]) * np.sign(v)
    return time, q, torque + 0.02 * rng.standard_normal(torque.shape)


def test_what_lies_across_a_gap_is_no_acceleration(tmp_path):
    """0.24 s without samples were differentiated across: angles that "count from another zero" left less of that."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    time, q, torque = moved(np.random.default_rng(5))
    there = ~np.isin(np.arange(len(time)), [k + n for k in GAPS for n in range(60)])
    table = np.column_stack([time, *q, *torque])[there]
    header = "t_s,q1_rad,q2_rad,tau1_Nm,tau2_Nm"
    np.savetxt(tmp_path / "log.csv", table, fmt="%.6f", delimiter=",", header=header, comments="")
    log = read_log(tmp_path / "log.csv", read_arm(tmp_path / "arm.yaml"))
    assert log.size == len(table)


def test_torques_and_accelerations_pass_one_filter():
    """A double integrator at 4 Hz: averages over 0.1 s take 43 % off either, and their ratio stays the inertia."""
    time = np.arange(1000) / 250.0
    turned = 8.0 * np.pi * time[:, None]
    log = MotionLog("log.csv", time, np.sin(turned), -5.0 * (8.0 * np.pi) ** 2 * np.sin(turned), np.arange(1, 1001))
    found, clear = smoothed(log, RULES.log)
    assert len(clear) == 1000
    middle = slice(100, 900)
    assert found.torque[middle] == pytest.approx(5.0 * found.acceleration[middle], abs=0.01 * np.ptp(found.torque))
    assert np.ptp(found.torque[middle]) == pytest.approx(np.sinc(0.4) ** 2 * np.ptp(log.torque), rel=0.01)


def test_poses_seconds_apart_all_count():
    """Nothing is averaged there, so that a longer wait spoils none beside it."""
    time = 2.0 * np.arange(40) + 60.0 * (np.arange(40) > 20)
    log = MotionLog("log.csv", time, np.zeros((40, 1)), np.ones((40, 1)), np.arange(1, 41))
    assert len(smoothed(log, RULES.log)[1]) == 40
