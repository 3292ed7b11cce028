"""Hobby servos that log no current: voltages, or goals and angles, of a pendulum whose motor MuJoCo swings.

The motor makes k_t (u - k_t q')/R of the voltage u that its loop makes of the distance to the goal, up to its limit
(G. F. Franklin, J. D. Powell & A. Emami-Naeini, Feedback Control of Dynamic Systems, 7th ed., sec. 2.3); the mass on
the lever is known, and tells k_t/R.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.descriptions.in_motion import of_joint
from linkwright.core.arm.effects.effect import EffectEntry
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import DISTANCE, VOLTAGE
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.motion.reading.read import is_motion_log, read_log
from linkwright.core.diagnose.motion.weighed import weighed
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.quantities import InputError

PENDULUM = """<mujoco model="pendulum"><compiler angle="radian"/><option gravity="0 0 -9.81" timestep="0.0005"/>
<worldbody><body><joint name="j1" axis="0 1 0" range="-3 3"{more}/>
<inertial pos="0 0 -.12" mass="0.5" diaginertia="1e-5 1e-5 1e-5"/></body></worldbody></mujoco>"""
KT, R, SUPPLY, GAIN, LIMIT = 0.38, 4.0, 7.4, 6.0, 0.9
DRY, VISCOUS, ROTOR = 0.03, 0.004, 0.002
COUNT = 2.0 * np.pi / 4096.0
SERVO = f"servo: {{gain: {GAIN} 1/rad, supply: {SUPPLY} V, limit: {LIMIT}}}"


@functools.cache
def swung(seed: int, seconds: float = 40.0) -> tuple[np.ndarray, ...]:
    """Clock, angle in counts of the encoder, goal and voltage, at 100 Hz."""
    drive = f' frictionloss="{DRY}" damping="{VISCOUS}" armature="{ROTOR}"'
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(more=drive))
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    rates = 2.0 * np.pi * np.array([0.13, 0.31, 0.83, 1.7])
    sizes, phases = np.array([0.7, 0.5, 0.25, 0.12]), rng.uniform(0.0, 2.0 * np.pi, 4)
    each = round(0.01 / model.opt.timestep)
    rows = []
    for k in range(round(seconds / model.opt.timestep)):
        goal = float(sizes @ np.sin(rates * data.time + phases)) * min(1.0, data.time)
        angle = COUNT * round(float(data.qpos[0]) / COUNT)
        voltage = SUPPLY * float(np.clip(GAIN * (goal - angle), -LIMIT, LIMIT))
        if k % each == 0:
            rows.append((data.time, angle, goal, voltage))
        data.qfrc_applied[0] = KT / R * (voltage - KT * float(data.qvel[0]))
        mujoco.mj_step(model, data)
    return tuple(np.array(rows).T)


def written(folder, name: str, seed: int, settings: str, *, voltages: bool = False):
    """A log of it with its recording.yaml, and the arm as its maker describes it: no friction, no rotor."""
    time, angle, goal, voltage = swung(seed)
    last, header = (voltage, "voltage1_V") if voltages else (goal, "c1_rad")
    path = folder / f"{name}.csv"
    table = np.column_stack([time, angle, last])
    np.savetxt(path, table, delimiter=",", header=f"t_s,q1_rad,{header}", comments="", fmt="%.7g")
    (folder / f"{name}.yaml").write_text(f"observes: motion\n{settings}\n", encoding="utf-8")
    (folder / "pendulum.xml").write_text(PENDULUM.format(more=""), encoding="utf-8")
    return path, import_robot(folder / "pendulum.xml").arm


def holds(finding, true: float) -> bool:
    """Whether the interval of a finding's first size holds it."""
    low, high = finding.parameters[0].interval
    return low <= true <= high


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """A diagnosis of goals and angles, and the arm that was given."""
    path, arm = written(tmp_path_factory.mktemp("servo"), "log", 3, f"{SERVO}\ntorque_constants: free")
    return diagnose_motion(arm, [read_log(path, arm)])


def test_goals_and_angles_tell_what_a_servo_lacks(found):
    """Friction, rotor and constant, each within what is said of it."""
    named = {item.effect: item for item in found.findings}
    assert found.logs[0].drive is VOLTAGE
    assert found.logs[0].weighed == pytest.approx([KT / R], rel=0.05)
    assert found.logs[0].loop == pytest.approx([GAIN * SUPPLY])
    assert holds(named["friction_coulomb"], DRY)
    assert holds(named["armature"], ROTOR)
    assert holds(named.get("friction_viscous") or named["back_emf"], VISCOUS + KT**2 / R)
    assert found.rms_held_out < 0.1 * found.rms_before


def test_viscous_friction_and_back_emf_are_one_of(found):
    """Of voltages their sum alone is known."""
    speed = next(item for item in found.findings if item.effect in ("friction_viscous", "back_emf"))
    other = {"friction_viscous": "back_emf", "back_emf": "friction_viscous"}[speed.effect]
    assert ((other, (1,)),) in [each.effects for each in speed.alternatives]


def test_the_file_foretells_another_motion(tmp_path, found):
    """By the constant that was found, of a log of voltages; a motor's back-EMF is damping to a simulator."""
    (constant,) = found.logs[0].weighed
    path, _ = written(tmp_path, "other", 8, f"torque_constants: [{constant:.6g} N*m/V]", voltages=True)
    log = read_log(path, found.corrected)
    assert predict_motion(found.corrected, log).share[0] < 0.15
    damping = of_joint(found.corrected, "mjcf", 0)["damping"]
    assert damping == pytest.approx(VISCOUS + KT**2 / R, rel=0.1)


def test_a_known_back_emf_leaves_viscous_friction(tmp_path):
    """Where the arm file has the one, the other is what remains."""
    path, arm = written(tmp_path, "log", 3, "torque_constants: free", voltages=True)
    known = EffectEntry("back_emf", (1,), {"coefficient": KT**2 / R})
    result = diagnose_motion(arm.__class__(**{**vars(arm), "effects": (known,)}), [read_log(path, arm)])
    assert sum(
        item.parameters[0].value for item in result.findings if item.effect in ("friction_viscous", "back_emf")
    ) == pytest.approx(VISCOUS, abs=0.004)


def test_droop_tells_a_loop_of_unknown_gain(tmp_path):
    """Distances to the goal, up to how stiff the loop holds, N m/rad."""
    path, arm = written(tmp_path, "log", 3, "servo: {gain: free}")
    log = read_log(path, arm)
    assert log.drive is DISTANCE
    assert log.torque_constants_free
    time, angle, goal, _ = swung(3)
    assert log.torque[:, 0] == pytest.approx(
        (goal - angle)[np.isin(np.round(time, 6), np.round(log.time, 6))], abs=1e-5
    )
    assert any("torque_constants" in line and "N*m/rad" in line for line in log.warnings)
    (held,) = weighed(arm, [prepare(arm, log, rules=RULES)], rules=RULES)
    assert held.weighed == pytest.approx([KT / R * GAIN * SUPPLY], rel=0.05)


@pytest.mark.slow
def test_short_logs_suffice_together(tmp_path):
    """A bus is read for seconds at a time: of none of these logs alone could anything be said."""
    path, arm = written(tmp_path, "log", 3, f"torque_constants: [{KT / R} N*m/V]", voltages=True)
    log = read_log(path, arm)
    parts = [(log.time >= begin) & (log.time < begin + 3.0) for begin in range(1, 25, 3)]
    logs = [
        replace(log, time=log.time[part], q=log.q[part], torque=log.torque[part], row=log.row[part]) for part in parts
    ]
    assert diagnose_motion(arm, logs[:1]).verdict == "insufficient_data"
    together = diagnose_motion(arm, logs)
    assert "friction_coulomb" in {item.effect for item in together.findings}


def test_a_limited_loop_gives_its_limit(tmp_path):
    """As the servo itself does."""
    path, arm = written(tmp_path, "log", 5, SERVO)
    log, voltage = read_log(path, arm), swung(5)[3]
    assert np.abs(log.torque).max() == pytest.approx(np.abs(voltage).max(), abs=1e-3)
    assert np.abs(voltage).max() == pytest.approx(LIMIT * SUPPLY)


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ("servo: {gain: 6, supply: 7.4 V, limit: 1.4}", r"servo\.limit: .*at most 1"),
        ("servo: {gain: 6}", r"servo\.supply: goes with a `gain`"),
        ("servo: {supply: 7.4 V}", r"servo\.gain: is missing"),
        ("servo: {gain: [6, 5], supply: 7.4 V}", r"servo\.gain: has 2 numbers"),
        ("servo: {gain: 6 V, supply: 7.4 V}", r"servo\.gain"),
        ("servo: {gain: free, suply: 7.4 V}", r"suply"),
        ("torque_constants: [0.1 N*m]", r"torque_constants.*N\*m/A"),
    ],
)
def test_what_is_wrong_with_a_servo_is_one_line(tmp_path, settings, says):
    path, arm = written(tmp_path, "log", 5, settings)
    with pytest.raises(InputError, match=says) as error:
        read_log(path, arm)
    assert "\n" not in str(error.value)


def test_a_servo_without_goals_or_with_voltages(tmp_path):
    """The first is refused, in the second the voltages count."""
    path, arm = written(tmp_path, "log", 5, SERVO, voltages=True)
    log = read_log(path, arm)
    assert is_motion_log(path, arm)
    assert "servo is not used: the log has voltages." in log.warnings
    bare = tmp_path / "bare.csv"
    bare.write_text("t_s,q1_rad\n" + "".join(f"{k / 100},{np.sin(k / 100)}\n" for k in range(400)), encoding="utf-8")
    (tmp_path / "bare.yaml").write_text(SERVO + "\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"servo: needs the goals .*c1_rad"):
        read_log(bare, arm)


def test_a_servos_load_is_no_payload(tmp_path):
    """What a bus calls the load is its PWM, of either sign."""
    path, arm = written(tmp_path, "log", 5, "", voltages=True)
    rows = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([f"{rows[0]},load", *(f"{row},{k % 7 - 3}" for k, row in enumerate(rows[1:]))]) + "\n")
    log = read_log(path, arm)
    assert log.payload_mass is None
    assert any("no payload is less than nothing" in line for line in log.warnings)
