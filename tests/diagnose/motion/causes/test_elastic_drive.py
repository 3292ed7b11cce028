"""A drive that gives is named from a log with its stiffness: MuJoCo swings the arm, a second joint is the gear."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog
from tests.diagnose.motion.causes.three_joints import NAMES, THREE

STIFFNESS, RETARDATION = 700.0, 0.01
GEAR = (
    '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-8 1e-8 1e-8"/><body>'
    f'<joint name="gear" axis="0 1 0" stiffness="{STIFFNESS}" damping="{RETARDATION * STIFFNESS}"/>'
)


def log_of(gear, seed=3, push=None, beyond=False):
    """25 s at 100 Hz under a controller: coordinates of the motors, or `beyond` the gear, and torques with a noise of
    0.05 N*m. What `push` says at the coordinates pushes the joints."""
    rng = np.random.default_rng(seed)
    text = THREE.format(step=5e-4, gear=GEAR if gear else "", end="</body>" if gear else "")
    model = mujoco.MjModel.from_xml_string(text)
    rotors = np.array([0.5, 0.6, 0.2])
    at = np.array([model.joint(name).dofadr[0] for name in NAMES])
    model.dof_armature[at] = rotors
    gears = np.array([0.0, float(beyond), 0.0])
    at_gear = model.joint("gear").dofadr[0] if gear else at[0]
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    rates = 2.0 * np.pi / 25.0 * rng.choice(np.arange(3, 40), (3, 5), replace=False)
    sizes, start = rng.uniform(0.5, 1.0, (3, 5)) / rates, rng.uniform(0.0, 6.0, (3, 5))
    sizes *= 0.6

    def asked(time):
        """Coordinates and speeds of a motion that begins at rest, 3 s after the arm was let go."""
        part = min(max(time / 3.0 - 1.0, 0.0), 1.0)
        grown, growing = part**2 * (3.0 - 2.0 * part), 2.0 * part * (1.0 - part)
        wave = np.sum(sizes * np.sin(rates * time + start), 1)
        return grown * wave, growing * wave + grown * np.sum(sizes * rates * np.cos(rates * time + start), 1)

    data.qpos[at], data.qvel[at] = asked(0.0)
    rows = []
    for step in range(56_000):
        q, v = asked(data.time)
        torque = 900.0 * rotors * (q - data.qpos[at]) + 60.0 * rotors * (v - data.qvel[at])
        if step % 20 == 0:
            q, v = (item[at] + gears * item[at_gear] for item in (data.qpos, data.qvel))
            rows.append((data.time, *q, *v, *torque))
        data.qfrc_applied[at] = torque if push is None else torque + push(data.qpos[at])
        mujoco.mj_step(model, data)
    table = np.array(rows)[300:]
    noisy = table[:, 7:] + 0.05 * rng.standard_normal((len(table), 3))
    time, row = table[:, 0] - table[0, 0], np.arange(len(table))
    return MotionLog("log", time, table[:, 1:4], noisy, row, table[:, 4:7], beyond_drive=beyond)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("three") / "three.xml"
    path.write_text(THREE.format(step=5e-4, gear="", end=""), encoding="utf-8")
    arm = import_robot(path).arm
    rotors = (EffectEntry("armature", (k + 1,), {"inertia": size}) for k, size in enumerate((0.5, 0.6, 0.2)))
    return type(arm)(**{**arm.__dict__, "effects": tuple(rotors)})


def test_a_gear_that_gives_is_named_with_its_stiffness(arm):
    result = diagnose_motion(arm, [log_of(gear=True)])
    assert [(item.effect, item.at) for item in result.findings] == [("joint_compliance", (2,))]
    compliance = result.findings[0].parameters[0]
    assert 1.0 / compliance.value == pytest.approx(STIFFNESS, rel=0.03)
    assert compliance.interval[0] < 1.0 / STIFFNESS < compliance.interval[1]
    assert any("swings on the drive of joint 2 at" in note for note in result.notes)
    assert result.rms_held_out < 0.2 * result.rms_before


@pytest.fixture(scope="module")
def behind_the_gear():
    return log_of(gear=True, seed=6, beyond=True)


@pytest.mark.parametrize("rotors", [True, False])
def test_encoders_behind_a_gear_show_it_by_the_motors_rotor(arm, behind_the_gear, rotors):
    """Whether the arm file says what turns there, or the log alone."""
    arm = arm if rotors else replace(arm, effects=())
    result = diagnose_motion(arm, [behind_the_gear])
    sizes = {(item.effect, item.at): item.parameters[0] for item in result.findings}
    compliance = sizes.pop(("joint_compliance", (2,)))
    assert 1.0 / compliance.value == pytest.approx(STIFFNESS, rel=0.03)
    assert compliance.interval[0] < 1.0 / STIFFNESS < compliance.interval[1]
    assert set(sizes) == (set() if rotors else {("armature", (k,)) for k in (1, 2, 3)})
    assert any("an encoder on the joint's side" in note for note in result.notes)


def test_a_gear_that_is_stiff_is_not(arm):
    assert diagnose_motion(arm, [log_of(gear=False)]).verdict == "none"
