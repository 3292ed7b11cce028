"""Motion logs from a model: within limits, by the model's torques, and read again as they were written."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.motion.simulate import simulate_motion
from linkwright.core.diagnose.motion.written import log_text

ARM = Arm(
    "scara",
    (
        Joint(range=(-2.0, 2.0), velocity=1.5),
        Joint(range=(-1.0, 2.5), velocity=2.0),
        Joint("prismatic", (0.0, 0.0, 1.0), (-0.2, 0.1), velocity=0.3),
    ),
    (Link(0.4, mass=8.0), Link(0.3, mass=5.0), Link(0.1, direction=(0.0, 0.0, 1.0), mass=2.0)),
    gravity=(0.0, 0.0, -9.81),
)
RUBS = (EffectEntry("friction_coulomb", (1, 2), {"torque": 4.0}), EffectEntry("armature", (1,), {"inertia": 1.5}))


def test_a_trajectory_keeps_to_ranges_and_speeds():
    log = simulate_motion(ARM, effects=RUBS, seconds=10.0)
    low, high = np.array([joint.range for joint in ARM.joints]).T
    assert (log.q >= low).all()
    assert (log.q <= high).all()
    assert (np.abs(log.velocity).max(axis=0) < [1.5, 2.0, 0.3]).all()
    assert (np.ptp(log.q, axis=0) > 0.1 * (high - low)).all()


def test_torques_are_the_models_and_noise_as_asked():
    quiet = simulate_motion(ARM, effects=RUBS, noise=0.0, seed=3)
    motion = Motion(replace(ARM, effects=RUBS), quiet.time, quiet.q, quiet.velocity, np.zeros(quiet.q.shape))
    # Without accelerations gravity and friction are left of the model: at the ends, where the arm rests.
    np.testing.assert_allclose(quiet.torque[[0, -1]], model_torque(motion)[[0, -1]], rtol=0, atol=1e-9)
    loud = simulate_motion(ARM, effects=RUBS, noise=(0.5, 0.2, 1.0), seed=3)
    assert np.std(loud.torque - quiet.torque, axis=0) == pytest.approx([0.5, 0.2, 1.0], rel=0.1)
    assert np.array_equal(loud.torque, simulate_motion(ARM, effects=RUBS, noise=(0.5, 0.2, 1.0), seed=3).torque)


def test_what_is_written_is_read_again(tmp_path):
    log = simulate_motion(ARM, effects=RUBS, seconds=4.0)
    path = tmp_path / "log.csv"
    path.write_text(log_text(log, ARM), encoding="utf-8")
    again = read_log(path, ARM)
    for name in ("time", "q", "velocity", "torque"):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name), rtol=1e-6, atol=1e-6)
