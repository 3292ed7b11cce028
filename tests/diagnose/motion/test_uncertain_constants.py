"""Friction of a drive whose torque constant is off: known no better than the constant is, by MuJoCo's dynamics."""

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.reading.read import read_log
from tests.arm.motion.by_mujoco import as_csv, inverse

PENDULUM = """<mujoco model="pendulum"><compiler angle="radian"/><option gravity="0 0 -9.81"/><worldbody>
<body><joint name="j1" axis="0 1 0" range="-1 1"/><inertial pos="0 0 .3" mass="4" diaginertia=".03 .03 .01"/>
<body pos="0 0 .5"><joint name="j2" axis="0 1 0" range="-1 1"/>
<inertial pos="0 0 .2" mass="2" diaginertia=".01 .01 .004"/></body></body></worldbody></mujoco>"""
EXCESS, DRY = 0.12, np.array([40.0, 1.5])


def log_of_a_pendulum(seed: int) -> str:
    """q, speeds and torques of 30 s at 100 Hz, the first drive's logged too large, with noise, as CSV."""
    rng, time = np.random.default_rng(seed), np.arange(3000) / 100.0
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    rates = 2.0 * np.pi * np.array([[0.11, 0.17], [0.29, 0.37], [0.53, 0.47]])
    angle = rates * time[:, None, None] + rng.uniform(0.0, 6.28, (3, 2))
    q, v, a = (0.3 * item.sum(axis=1) for item in (np.sin(angle), rates * np.cos(angle), -(rates**2) * np.sin(angle)))
    torque = inverse(model, q, v, a)
    torque = (torque + DRY * np.sign(v)) * [1.0 + EXCESS, 1.0]
    torque += [2.0, 0.3] * rng.normal(size=torque.shape)
    return as_csv(["t_s", "q1_rad", "q2_rad", "dq1_radps", "dq2_radps", "tau1_Nm", "tau2_Nm"], time, q, v, torque)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_friction_is_known_no_better_than_the_constant(tmp_path, seed):
    (tmp_path / "pendulum.xml").write_text(PENDULUM, encoding="utf-8")
    (tmp_path / "log.csv").write_text(log_of_a_pendulum(seed), encoding="utf-8")
    arm = import_robot(tmp_path / "pendulum.xml").arm
    diagnosis = diagnose_motion(arm, [read_log(tmp_path / "log.csv", arm)])
    named = {item.effect: item.parameters[0] for item in diagnosis.findings if item.at == (1,)}
    constant, friction = named["torque_constant"], named["friction_coulomb"]
    assert friction.interval[0] <= DRY[0] <= friction.interval[1]
    share, of_constant = (
        (item.interval[1] - item.interval[0]) / whole
        for item, whole in ((friction, friction.value), (constant, 1.0 + constant.value))
    )
    assert share > 0.8 * of_constant
