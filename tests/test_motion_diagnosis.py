"""Diagnosis of motion logs: torques of a small arm written by numpy alone, with known causes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Settings
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics, link_parameters
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.preparation import slope
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rules import RULES
from tests.costs import slow_but

Table = NDArray[np.float64]
MASS, LENGTH, OUT, INERTIA = (6.0, 3.0), (0.5, 0.4), (0.25, 0.2), (0.15, 0.05)
GRAVITY = 9.81


def two_links() -> Arm:
    """Two links in an upright plane, y up; their centres half-way."""
    links = tuple(
        Link(length, mass=mass, center_of_mass=out, inertia=(0.0, inertia, inertia, 0.0, 0.0, 0.0))
        for length, mass, out, inertia in zip(LENGTH, MASS, OUT, INERTIA, strict=True)
    )
    return Arm("two links", (Joint(), Joint()), links)


def swings(seed: int, seconds: float = 40.0, rate: float = 100.0) -> tuple[Table, Table, Table, Table]:
    """Clock, coordinates, speeds and accelerations of sums of sines."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 1.0 / rate)
    q, v, a = (np.zeros((len(time), 2)) for _ in range(3))
    for joint in range(2):
        q[:, joint] = rng.uniform(-0.5, 0.5)
        for k in range(1, 6):
            w = 2.0 * np.pi * 0.11 * k * rng.uniform(0.95, 1.05)
            size, phase = rng.normal() * 0.6 / k, rng.uniform(0.0, 2.0 * np.pi)
            q[:, joint] += size * np.sin(w * time + phase)
            v[:, joint] += size * w * np.cos(w * time + phase)
            a[:, joint] -= size * w**2 * np.sin(w * time + phase)
    return time, q, v, a


def lagrange(q: Table, v: Table, a: Table, mass: tuple[float, float] = MASS) -> Table:
    """Torques of two links by Lagrange's equations (M. W. Spong et al., Robot Modeling and Control, 2006, sec. 7.3)."""
    one, two = mass
    c2, s2 = np.cos(q[:, 1]), np.sin(q[:, 1])
    h = two * LENGTH[0] * OUT[1]
    m22 = two * OUT[1] ** 2 + INERTIA[1]
    m12 = m22 + h * c2
    m11 = one * OUT[0] ** 2 + INERTIA[0] + two * LENGTH[0] ** 2 + m22 + 2.0 * h * c2
    g2 = two * GRAVITY * OUT[1] * np.cos(q[:, 0] + q[:, 1])
    g1 = (one * OUT[0] + two * LENGTH[0]) * GRAVITY * np.cos(q[:, 0]) + g2
    first = m11 * a[:, 0] + m12 * a[:, 1] - h * s2 * (2.0 * v[:, 0] * v[:, 1] + v[:, 1] ** 2) + g1
    second = m12 * a[:, 0] + m22 * a[:, 1] + h * s2 * v[:, 0] ** 2 + g2
    return np.column_stack((first, second))


def noise(seed: int, shape: tuple[int, int], size: float) -> Table:
    """Noise that remembers a tenth of a second."""
    rng = np.random.default_rng(seed + 1000)
    white = rng.normal(size=shape)
    slow = np.zeros(shape)
    for k in range(1, shape[0]):
        slow[k] = 0.9 * slow[k - 1] + math.sqrt(1.0 - 0.81) * white[k]
    return size * (0.7 * slow + 0.7 * rng.normal(size=shape))


def log_of(seed: int, more: Table | None = None, *, mass: tuple[float, float] = MASS, size: float = 0.2) -> MotionLog:
    """A log of the two links with noise, and with `more` torque (N, 2)."""
    time, q, v, a = swings(seed)
    torque = lagrange(q, v, a, mass) + noise(seed, q.shape, size) + (0.0 if more is None else more)
    rows = np.arange(1, len(time) + 1)
    return MotionLog(f"log{seed}.csv", time, np.round(q, 5), torque, rows)


def friction(seed: int, coulomb: float, viscous: float, joint: int = 1) -> Table:
    """Dry and viscous friction at a joint (from 0)."""
    _, q, v, _ = swings(seed)
    result = np.zeros_like(q)
    result[:, joint] = coulomb * np.sign(v[:, joint]) + viscous * v[:, joint]
    return result


def named(found: MotionDiagnosis) -> set[tuple[str, tuple[int, ...]]]:
    """Effects and places of the findings."""
    return {(finding.effect, finding.at) for finding in found.findings}


def sizes(found: MotionDiagnosis) -> dict[str, tuple[float, tuple[float, float]]]:
    """Values and intervals by effect and parameter."""
    return {f"{f.effect}.{p.name}": (p.value, p.interval) for f in found.findings for p in f.parameters}


@pytest.mark.parametrize("seed", slow_but((1, 2, 3), 1))
def test_a_model_that_holds_all_lacks_nothing(seed: int) -> None:
    result = diagnose_motion(two_links(), [log_of(seed)])
    assert result.verdict == "none", result.sentence
    assert not result.findings
    assert result.corrected.effects == ()


def test_friction_is_named_with_its_joint_and_its_size() -> None:
    result = diagnose_motion(two_links(), [log_of(5, friction(5, 2.0, 3.0))])
    assert result.verdict == "named"
    assert named(result) == {("friction_coulomb", (2,)), ("friction_viscous", (2,))}
    for name, truth in (("friction_coulomb.torque_2", 2.0), ("friction_viscous.coefficient_2", 3.0)):
        value, (lower, upper) = sizes(result)[name]
        assert lower < truth < upper
        assert value == pytest.approx(truth, rel=0.05)


def test_friction_that_the_arm_file_has_counts() -> None:
    entry = EffectEntry("friction_viscous", (2,), {"coefficient": 3.0})
    arm = replace(two_links(), effects=(entry,))
    result = diagnose_motion(arm, [log_of(6, friction(6, 0.0, 2.0))])
    assert named(result) == {("friction_viscous", (2,))}
    assert sizes(result)["friction_viscous.coefficient_2"][0] == pytest.approx(-1.0, abs=0.1)
    (written,) = result.corrected.effects
    assert written.parameters["coefficient"] == pytest.approx(2.0, abs=0.1)


def test_all_gains_and_all_masses_are_one_class() -> None:
    _, q, v, a = swings(7)
    result = diagnose_motion(two_links(), [log_of(7, 0.08 * lagrange(q, v, a))])
    assert result.verdict == "alias_class"
    (only,) = result.findings
    names = {only.effect, *(effect for other in only.alternatives for effect, _ in other.effects)}
    assert {"torque_constant", "link_inertial"} <= names
    assert only.parameters[0].value == pytest.approx(0.08, abs=0.005)


def test_all_masses_by_one_factor_are_told_as_a_share() -> None:
    """Of an arm that lies flat, whose first link shows its inertia about the axis alone."""
    _, q, v, a = swings(7)
    flat = lagrange(q, v, a) - lagrange(q, 0.0 * v, 0.0 * a)
    given = log_of(7)
    log = replace(given, torque=given.torque - lagrange(q, v, a) + 1.2 * flat)
    arm = replace(two_links(), gravity=(0.0, 0.0, -GRAVITY))
    result = diagnose_motion(arm, [log], Options(without=frozenset({"torque_constant"})))
    (only,) = result.findings
    assert (only.effect, only.at) == ("link_inertial", (1, 2))
    (share,) = only.parameters
    assert (share.parameter, share.kind) == ("share", "dimensionless")
    assert share.value == pytest.approx(0.2, abs=0.01)


def test_what_was_learned_holds_on_another_log() -> None:
    arm = two_links()
    result = diagnose_motion(arm, [log_of(8, friction(8, 2.0, 3.0)), log_of(9, friction(9, 2.0, 3.0))])
    assert result.split == "logs"
    fresh = log_of(10, friction(10, 2.0, 3.0))
    before, after = predict_motion(arm, fresh), predict_motion(result.corrected, fresh)
    assert after.rms[1] < 0.25 * before.rms[1]
    assert after.rms[0] == pytest.approx(before.rms[0], rel=0.05)


def test_what_no_effect_does_is_unknown_and_told_by_what_it_depends_on() -> None:
    _, q, v, _ = swings(11, 40.0)
    more = np.zeros_like(q)
    more[:, 1] = 3.0 * np.sign(v[:, 1]) * np.sign(np.sin(6.0 * q[:, 1]))
    result = diagnose_motion(two_links(), [log_of(11, more)])
    assert result.verdict == "unknown"
    assert result.unknown is not None
    assert 2 in result.unknown.joints
    assert "q2" in result.unknown.depends_on


def test_intervals_hold_the_truth() -> None:
    """Dry and viscous friction of both joints: four intervals of each log."""
    truth = {
        f"friction_{law}_{joint}": size
        for joint in (1, 2)
        for law, size in (("coulomb.torque", 1.5), ("viscous.coefficient", 2.0))
    }
    held = []
    for seed in range(20, 24):
        rubs = friction(seed, 1.5, 2.0, joint=0) + friction(seed, 1.5, 2.0, joint=1)
        estimates = sizes(diagnose_motion(two_links(), [log_of(seed, rubs)]))
        held += [estimates[name][1][0] <= size <= estimates[name][1][1] for name, size in truth.items()]
    assert sum(held) >= 13


def test_a_log_at_rest_is_too_little() -> None:
    time, q, _, _ = swings(12)
    still = np.tile(q[0], (len(time), 1))
    torque = lagrange(still, 0.0 * q, 0.0 * q) + noise(12, q.shape, 0.2)
    result = diagnose_motion(two_links(), [MotionLog("rest.csv", time, still, torque, np.arange(len(time)))])
    assert result.verdict == "insufficient_data"


def test_a_joint_that_only_trembles_tells_nothing() -> None:
    """Its torque is whatever holds it: nothing is named of its drive, and no figure is given for it."""
    time, q, v, a = swings(13)
    shake = 2.0 * np.pi * 4.0 * time
    q[:, 0], v[:, 0] = 0.3 + 2e-3 * np.sin(shake), 2e-3 * 2.0 * np.pi * 4.0 * np.cos(shake)
    a[:, 0] = -2e-3 * (2.0 * np.pi * 4.0) ** 2 * np.sin(shake)
    assert np.abs(v[:, 0]).max() > RULES.motion.slow
    torque = lagrange(q, v, a) + noise(13, q.shape, 0.2) + friction(13, 2.0, 3.0)
    torque[:, 0] += 5.0 * np.tanh(v[:, 0] / 0.02)
    log = MotionLog("held.csv", time, q, torque, np.arange(len(time)))
    result, told = diagnose_motion(two_links(), [log]), predict_motion(two_links(), log)
    assert all(finding.at != (1,) for finding in result.findings)
    assert result.unknown is None or result.unknown.joints == (2,)
    first, second = result.per_joint
    assert all(math.isnan(item) for item in (first.before, first.after, first.held_out, first.floor, first.share))
    assert math.isnan(told.rms[0])
    assert math.isnan(told.share[0])
    assert second.before == pytest.approx(result.rms_before)
    assert second.held_out == pytest.approx(result.rms_held_out)


def test_a_log_of_other_joints_is_one_line() -> None:
    time, q, _, _ = swings(13)
    log = MotionLog("three.csv", time, np.column_stack((q, q[:, 0])), np.zeros((len(time), 3)), np.arange(len(time)))
    with pytest.raises(lw.InputError, match=r"three.csv: the log has 3 joints, the arm 2"):
        diagnose_motion(two_links(), [log])
    with pytest.raises(lw.InputError, match=r"the log has 3 joints"):
        predict_motion(two_links(), log)


def test_links_with_what_is_named_are_bodies() -> None:
    """Even where a log's torques have the wrong sign, file and findings together weigh what some body can."""
    arm, log = two_links(), log_of(31)
    result = diagnose_motion(arm, [replace(log, torque=-log.torque)])
    whole = link_parameters(arm)
    for entry in result.corrected.effects:
        torques = EFFECTS[entry.effect].torques
        if isinstance(torques, OfInertia):
            whole += torques.parameters(arm, Settings(tuple(at - 1 for at in entry.at), entry.parameters))
    for own in whole:
        # An upright plane shows of a link its mass, the centre in the plane, and one moment.
        mass, x, y, moment = own[0], own[1], own[2], own[9]
        assert mass > -1e-6
        assert moment * mass >= x**2 + y**2 - 1e-4


def test_a_slope_is_that_of_the_motion() -> None:
    # 2.5 Hz at 50 Hz: differences of samples give sin(0.314)/0.314 of it, 1.6 % too little.
    time = np.arange(0.0, 4.0, 0.02)
    omega = 2.0 * math.pi * 2.5
    quick = slope(np.sin(omega * time)[:, None], time)[20:-20, 0]
    np.testing.assert_allclose(quick, omega * np.cos(omega * time[20:-20]), rtol=0, atol=1e-3 * omega)


def test_an_amplitude_that_goes_with_its_shape_has_a_sign() -> None:
    """Of friction that falls over minutes 40 s show the drift: hardly how far it goes and how long, but which way."""
    time, _, v, _ = swings(8)
    fallen = np.zeros_like(v)
    fallen[:, 1] = -15.0 * (1.0 - np.exp(-time / 200.0)) * np.sign(v[:, 1])
    result = diagnose_motion(two_links(), [log_of(8, fallen)])
    (only,) = result.findings
    assert (only.effect, only.at) == ("friction_warmup", (2,))
    size = {parameter.name: parameter for parameter in only.parameters}["torque_2"]
    assert size.interval[0] < -15.0 < size.interval[1] < 0.0


def test_a_shape_between_those_that_are_tried_is_held_with_its_amplitude() -> None:
    """A decay of 25 s; 12 s and 60 s are tried."""
    time, _, v, _ = swings(8)
    fallen = np.zeros_like(v)
    fallen[:, 1] = -6.0 * (1.0 - np.exp(-time / 25.0)) * np.sign(v[:, 1])
    found = sizes(diagnose_motion(two_links(), [log_of(8, fallen)]))
    assert found["friction_warmup.time_2"][0] == pytest.approx(25.0, rel=0.05)
    for name, truth in (("time_2", 25.0), ("torque_2", -6.0)):
        lower, upper = found[f"friction_warmup.{name}"][1]
        assert lower < truth < upper
    assert found["friction_warmup.torque_2"][1][1] < 0.0


def test_a_trifle_is_no_name_however_long_the_log_is() -> None:
    """A torque constant that is off by 0.05 %, which no filter tells: beyond any doubt by its noise alone."""
    _, q, v, a = swings(21)
    result = diagnose_motion(two_links(), [log_of(21, 5e-4 * lagrange(q, v, a), size=1e-4)])
    assert result.verdict == "none", result.sentence


def test_an_encoders_zero_that_is_far_off_is_no_mass() -> None:
    """Four degrees: seventy times what is usual of encoders. In space no other mass takes as much."""
    rods = tuple(
        Link(0.5, mass=mass, center_of_mass=0.25, inertia=(0.02, 0.1, 0.1, 0.0, 0.0, 0.0)) for mass in (6, 4, 3)
    )
    axes = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
    arm = Arm("in space", tuple(Joint(axis=axis) for axis in axes), rods, gravity=(0.0, 0.0, -GRAVITY))
    time, *two = swings(22)
    q, v, a = (np.column_stack((one, other[:, 0])) for one, other in zip(two, swings(23)[1:], strict=True))
    torque = inverse_dynamics(Motion(arm, time, q + np.array([0.0, 0.07, 0.0]), v, a)) + noise(22, q.shape, 0.2)
    log = MotionLog("log.csv", time, np.round(q, 5), torque, np.arange(1, len(time) + 1))
    result = diagnose_motion(arm, [log])
    assert ("encoder_offset", (2,)) in named(result), result.sentence
    value, (lower, upper) = sizes(result)["encoder_offset.offset_2"]
    assert lower < 0.07 < upper
    assert value == pytest.approx(0.07, rel=0.05)
