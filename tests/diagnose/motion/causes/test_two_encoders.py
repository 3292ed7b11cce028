"""Encoders on both sides of the drives: MuJoCo swings an arm whose second joint is a motor with a gear behind it."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.signal import lfilter

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.encoders.between import between_encoders
from linkwright.core.diagnose.motion.encoders.load_rows import Torques
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.json.motion import motion_json
from tests.costs import slow_but
from tests.diagnose.motion.causes.three_joints import NAMES, THREE
from tests.diagnose.motion.test_file_is_the_model import read_back

GEAR = '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-8 1e-8 1e-8"/><body><joint name="gear" axis="0 1 0" {does}/>'
ROTORS = np.array([0.5, 0.6, 0.2])
RUBS = np.array([1.5, 2.0, 0.8])
"""N*m, dry friction of the motors."""
STIFFNESS, RETARDATION, PLAY = 700.0, 0.01, 2e-3
SPRING = f'stiffness="{STIFFNESS}" damping="{RETARDATION * STIFFNESS}"'
LOOSE = f'limited="true" range="{-PLAY / 2} {PLAY / 2}" solreflimit="-2e6 -800" damping="0.05"'


def log_of(does="", seed=3, step=5e-4, offset=(0.0, 0.0, 0.0), noise=1e-5):
    """25 s at 100 Hz under a controller: coordinates of motors and of links, these with an `offset`, noise of both, and
    torques with a noise of 0.05 N*m. `does` says what the gear of the second joint is; nothing: it is stiff."""
    rng = np.random.default_rng(seed)
    text = THREE.format(step=step, gear=GEAR.format(does=does) if does else "", end="</body>" if does else "")
    model = mujoco.MjModel.from_xml_string(text)
    at = np.array([model.joint(name).dofadr[0] for name in NAMES])
    model.dof_armature[at], model.dof_frictionloss[at] = ROTORS, RUBS
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    rates = 2.0 * np.pi / 25.0 * rng.choice(np.arange(3, 40), (3, 5), replace=False)
    sizes, start = 0.6 * rng.uniform(0.5, 1.0, (3, 5)) / rates, rng.uniform(0.0, 6.0, (3, 5))

    upright = np.array([0.0, -0.5 * np.pi, 0.0])

    def asked(time):
        """Coordinates and speeds about an upright arm, whose loads pull to either side."""
        part = min(max(time / 3.0 - 1.0, 0.0), 1.0)
        grown, growing = part**2 * (3.0 - 2.0 * part), 2.0 * part * (1.0 - part)
        wave = np.sum(sizes * np.sin(rates * time + start), 1)
        return upright + grown * wave, growing * wave + grown * np.sum(sizes * rates * np.cos(rates * time + start), 1)

    data.qpos[at] = asked(0.0)[0]
    rows = []
    every = round(0.01 / step)
    for number in range(28 * 100 * every):
        q, v = asked(data.time)
        torque = 900.0 * ROTORS * (q - data.qpos[at]) + 60.0 * ROTORS * (v - data.qvel[at])
        if number % every == 0:
            behind = np.array([0.0, data.qpos[model.joint("gear").qposadr[0]] if does else 0.0, 0.0])
            rows.append((data.time, *data.qpos[at], *data.qpos[at] + behind, *torque))
        data.qfrc_applied[at] = torque
        mujoco.mj_step(model, data)
    table = np.array(rows)[300:]
    motor, link = (part + noise * rng.standard_normal(part.shape) for part in (table[:, 1:4], table[:, 4:7]))
    noisy = table[:, 7:] + 0.05 * rng.standard_normal(motor.shape)
    return MotionLog(
        "log", table[:, 0] - table[0, 0], motor, noisy, np.arange(len(table)), joint_side=link + np.array(offset)
    )


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("three") / "three.xml"
    path.write_text(THREE.format(step=5e-4, gear="", end=""), encoding="utf-8")
    known = [("armature", {"inertia": float(size)}) for size in ROTORS]
    known += [("friction_coulomb", {"torque": float(size)}) for size in RUBS]
    entries = (EffectEntry(effect, (k % 3 + 1,), size) for k, (effect, size) in enumerate(known))
    return replace(import_robot(path).arm, effects=tuple(entries))


@pytest.fixture(scope="module")
def springy():
    return log_of(SPRING)


def named(result):
    return {(item.effect, item.at): {each.parameter: each for each in item.parameters} for item in result.findings}


def rounded(log, to=2e-4):
    """The log with coordinates in counts (rad)."""
    return replace(log, q=to * np.round(log.q / to), joint_side=to * np.round(log.joint_side / to))


def test_a_gear_between_two_encoders_is_named_with_stiffness_and_damping(arm, springy):
    result = diagnose_motion(arm, [springy])
    assert result.verdict == "named"
    found = named(result)
    assert set(found) == {("joint_compliance", (2,))}
    sizes = found["joint_compliance", (2,)]
    for name, true, within in (("compliance", 1.0 / STIFFNESS, 0.005), ("retardation", RETARDATION, 0.03)):
        low, high = sizes[name].interval
        assert low < true < high
        assert high - low < 2.0 * within * true
    assert any("q is of the motor's side" in note for note in result.notes)
    (finding,) = motion_json(result)["missing"]
    between = finding["between_encoders_rms"]
    assert max(between["left"], between["written"]) < 1e-4 < 1e-2 < between["without"] == between["nominal"]


@pytest.mark.parametrize("stiffness", slow_but([350.0, STIFFNESS, 1400.0], 350.0))
def test_what_the_file_gives_a_drive_counts(arm, springy, stiffness):
    """Found is the compliance beyond that of the file. This says nothing of the gear's damping, which is the whole
    drive's once it is written."""
    joints = tuple(replace(joint, stiffness=stiffness if k == 1 else None) for k, joint in enumerate(arm.joints))
    result = diagnose_motion(replace(arm, joints=joints), [springy])
    found = named(result)
    if stiffness == STIFFNESS:
        assert found == {}
        return
    low, high = found["joint_compliance", (2,)]["compliance"].interval
    assert low < 1.0 / STIFFNESS - 1.0 / stiffness < high
    assert high - low < 0.01 / STIFFNESS
    low, high = found["joint_compliance", (2,)]["retardation"].interval
    assert low < RETARDATION < high
    assert result.findings[0].apart.written < 1e-5 < 8e-3 < result.findings[0].apart.nominal


def test_the_written_arm_explains_both_encoders(arm, springy):
    """The file is the arm of the next diagnosis, in which nothing is missing; torques are foretold as promised."""
    result = diagnose_motion(arm, [springy])
    assert any(entry.effect == "joint_compliance" for entry in result.corrected.effects)
    rms = np.array(predict_motion(result.corrected, springy).rms)
    assert float(np.sqrt(np.mean(rms**2))) == pytest.approx(result.rms_after, rel=1e-6)
    assert diagnose_motion(result.corrected, [springy]).findings == ()


def test_links_move_as_the_encoders_behind_the_gears_say(arm, springy):
    """By the motors' encoders alone the torques lack what the links swing."""
    alone = replace(springy, joint_side=None)
    by_links, by_motors = (predict_motion(arm, log).rms[1] for log in (springy, alone))
    assert by_links < 0.03
    assert by_motors > 10.0 * by_links


@pytest.mark.parametrize("said", slow_but([False, True], True))
def test_loads_show_which_encoder_is_the_motors(arm, springy, said):
    """Whatever recording.yaml says."""
    swapped = replace(springy, q=springy.joint_side, joint_side=springy.q, beyond_drive=said)
    result = diagnose_motion(arm, [swapped])
    compliance = named(result)["joint_compliance", (2,)]["compliance"]
    assert compliance.value == pytest.approx(1.0 / STIFFNESS, rel=0.005)
    assert any("q is of the link's side" in note for note in result.notes)


@pytest.fixture(scope="module")
def loose():
    return log_of(LOOSE, step=1e-4)


@pytest.mark.parametrize("counts", slow_but([False, True], False))
def test_play_between_two_encoders_is_backlash_and_no_compliance(arm, loose, counts):
    found = named(diagnose_motion(arm, [rounded(loose) if counts else loose]))
    assert set(found) == {("backlash", (2,))}
    low, high = found["backlash", (2,)]["total"].interval
    assert low < PLAY < high
    assert high - low < 0.1 * PLAY


def test_encoders_with_other_zeros_and_clocks_show_nothing_of_the_arm(arm):
    log = log_of(offset=(0.02, -0.01, 0.005))
    later = replace(log, joint_side=np.vstack((log.joint_side[:1], log.joint_side[:-1])))
    for each, late in ((log, 0.0), (rounded(log), 0.0), (later, 10.0)):
        result = diagnose_motion(arm, [each])
        assert result.verdict == "none"
        (note,) = (note for note in result.notes if "Zeros of j" in note)
        assert "20 mrad, -10 mrad, 5 mrad" in note
        assert float(note.split("read ")[1].split(" ms")[0]) == pytest.approx(late, abs=0.2)


def not_of_loads(log, size):
    """What encoders that are eccentric, a gear of seven waves a turn and friction behind the gear make of a link's
    coordinate (rad)."""
    speed = np.gradient(log.q, log.time, axis=0)
    return size * (np.sin(log.q + 1.0) + 0.3 * np.sin(7.0 * log.q) + 0.3 * np.tanh(speed / 0.02))


@pytest.mark.slow
def test_what_goes_with_angles_and_speeds_is_no_compliance(arm):
    log = log_of()
    assert diagnose_motion(arm, [replace(log, joint_side=log.joint_side + not_of_loads(log, 5e-4))]).findings == ()


@pytest.mark.slow
def test_what_goes_with_angles_and_speeds_hides_no_compliance(arm):
    stiff = 2e4
    log = log_of(f'stiffness="{stiff}" damping="100"', step=1e-4)
    found = named(diagnose_motion(arm, [replace(log, joint_side=log.joint_side + not_of_loads(log, 2e-4))]))
    assert set(found) == {("joint_compliance", (2,))}
    low, high = found["joint_compliance", (2,)]["compliance"].interval
    assert low < 1.0 / stiff < high
    assert high - low < 0.1 / stiff


def test_masses_that_are_wrong_are_not_taken_for_a_soft_gear(arm, springy):
    """Loads are those of the arm as it is written."""
    links = tuple(
        replace(link, masses=tuple(replace(mass, mass=1.2 * mass.mass) for mass in link.masses)) for link in arm.links
    )
    found = named(diagnose_motion(replace(arm, links=links), [springy]))
    low, high = found["joint_compliance", (2,)]["compliance"].interval
    assert low < 1.0 / STIFFNESS < high


def left_between(arm, log):
    """What an arm is found to leave between two encoders, joint by joint, the last third of the log being held out."""
    prepared = prepare(arm, log, rules=RULES)
    left = np.zeros((len(prepared.kept), 3))
    for part, numbers, within in prepared.pieces():
        left[numbers] = prepared.filtered(prepared.measured[part] - model_torque(prepared.piece(part)))[within]
    fold = (3 * np.arange(len(left)) // len(left) == 2).astype(np.int64)
    return between_encoders(arm, [prepared], Torques((left,), (prepared.moving,), (fold,)), (), rules=RULES)


def test_what_is_left_between_two_encoders_is_what_the_file_leaves_once_read(arm, springy):
    log = replace(springy, joint_side=springy.joint_side + not_of_loads(springy, 2e-4))
    result = diagnose_motion(arm, [log])
    (finding,) = result.findings
    shown, again = left_between(arm, log)[1], left_between(read_back(result.corrected), log)[1]
    assert finding.apart.nominal == pytest.approx(shown.before, rel=1e-9)
    assert finding.apart.written == pytest.approx(again.before, rel=1e-6)
    assert again.causes == ()
    assert any(f"{1e3 * finding.apart.left:.3g} mrad RMS" in note for note in result.notes)


def test_what_no_entry_holds_stays_in_what_is_left(arm):
    """Waves and friction behind the gear are fitted beside the causes, but are in no file: all of them are left but an
    offset and a delay, and the low-pass takes little."""
    log = log_of()
    added, speed = not_of_loads(log, 2e-4), np.gradient(log.q, log.time, axis=0)
    for item in left_between(arm, replace(log, joint_side=log.joint_side + added)):
        here = item.joint - 1
        beside = np.column_stack((np.ones(len(speed)), speed[:, here]))
        alone = added[:, here] - beside @ np.linalg.lstsq(beside, added[:, here], rcond=None)[0]
        assert item.causes == ()
        assert item.before == item.held_out == pytest.approx(item.after, rel=1e-9)
        assert item.after == pytest.approx(rms(alone), rel=0.1)


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def drawn(random, log):
    """What instruments make of a link's coordinates (rad), of which drives know nothing: eccentric encoders, a drift,
    warming by friction that cools slowly, hysteresis, noise that lasts, and counts."""
    size = np.exp(random.uniform(np.log(2e-5), np.log(2e-4), (6, 3)))
    turn, step = random.uniform(0.0, 6.0, (2, 3)), log.time[1] - log.time[0]
    eccentric = size[0] * np.sin(log.q + turn[0]) + 0.2 * size[1] * np.sin(2.0 * log.q + turn[1])

    def lasting(memory):
        keeps = np.exp(-step / memory)
        noise = random.standard_normal((len(log.time) + round(5.0 * memory / step), 3))
        return lfilter([np.sqrt(1.0 - keeps**2)], [1.0, -keeps], noise, axis=0)[-len(log.time) :]

    speed = np.abs(np.gradient(log.q, log.time, axis=0))
    warm = lfilter([step / 20.0], [1.0, step / 20.0 - 1.0], speed, axis=0)
    behind = np.array(log.q)
    for now in range(1, len(behind)):
        behind[now] = np.clip(behind[now - 1], log.q[now] - 0.1, log.q[now] + 0.1)
    slow = size[2] * lasting(30.0) + 0.5 * size[3] * warm / warm.std(axis=0) + 0.5 * size[4] * behind
    return eccentric + slow + 0.5 * size[5] * lasting(random.uniform(0.03, 3.0))


@pytest.mark.parametrize("seeds", [range(3), pytest.param(range(3, 60), marks=pytest.mark.slow)])
def test_what_instruments_make_is_nothing_of_the_arm(arm, seeds):
    """Chance is held to one log in a hundred."""
    log, alarms = log_of(), 0
    for seed in seeds:
        spoiled = replace(log, joint_side=log.joint_side + drawn(np.random.default_rng(seed), log))
        alarms += bool(diagnose_motion(arm, [rounded(spoiled, 5e-5)]).findings)
    assert alarms <= len(seeds) // 50


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda log: [replace(log, joint_side=-log.joint_side)], "tell of another motion"),
        (lambda log: [log, replace(log, joint_side=None)], "some logs have none"),
    ],
)
def test_second_encoders_that_cannot_be_are_not_used(arm, springy, spoil, why):
    result = diagnose_motion(arm, spoil(springy))
    assert any(why in note for note in result.notes)
    assert all(item.apart is None for item in result.findings)
