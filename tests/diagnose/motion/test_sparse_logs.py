"""Logs whose samples are far apart: torques of a planar arm in closed form at poses that have nothing to do with each
other (M. W. Spong et al., Robot Modeling and Control, 2006, sec. 7.3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

MASS, LENGTH, OUT, INERTIA, GRAVITY = (4.0, 2.0), (0.4, 0.4), (0.2, 0.2), (0.06, 0.03), 9.81
DRY = np.array([1.5, 0.6])


def arm() -> Arm:
    """Two links on a vertical plane, y up."""
    links = tuple(
        Link(length, mass=mass, center_of_mass=out, inertia=(0.0, inertia, inertia, 0.0, 0.0, 0.0))
        for length, mass, out, inertia in zip(LENGTH, MASS, OUT, INERTIA, strict=True)
    )
    return Arm("two links", (Joint(), Joint()), links)


def torques(q: Array, v: Array, a: Array, second: float = MASS[1]) -> Array:
    """Torques by Lagrange's equations, the second link's mass being so many kg, with its inertia in proportion."""
    one, two, own = MASS[0], second, INERTIA[1] * second / MASS[1]
    h = two * LENGTH[0] * OUT[1]
    m22 = two * OUT[1] ** 2 + own
    m12 = m22 + h * np.cos(q[:, 1])
    m11 = one * OUT[0] ** 2 + INERTIA[0] + two * LENGTH[0] ** 2 + 2.0 * m12 - m22
    g2 = two * GRAVITY * OUT[1] * np.cos(q.sum(axis=1))
    g1 = (one * OUT[0] + two * LENGTH[0]) * GRAVITY * np.cos(q[:, 0]) + g2
    swirl = h * np.sin(q[:, 1])
    first = m11 * a[:, 0] + m12 * a[:, 1] - swirl * (2.0 * v[:, 0] * v[:, 1] + v[:, 1] ** 2) + g1
    return np.column_stack((first, m12 * a[:, 0] + m22 * a[:, 1] + swirl * v[:, 0] ** 2 + g2))


def table(seed: int, *, second: float = MASS[1], dry: Array = DRY, late: float = 2.0, count: int = 80) -> MotionLog:
    """Poses about 5 s apart (give or take `late`/2) through which the joints go at speeds of their own."""
    rng = np.random.default_rng(seed)
    time = 5.0 * np.arange(count) + rng.uniform(0.0, late, count)
    q = rng.uniform(-1.0, 1.0, (count, 2)) * [1.5, 2.0]
    v = rng.uniform(0.1, 0.8, (count, 2)) * rng.choice((-1.0, 1.0), (count, 2))
    torque = torques(q, v, 0.0 * v, second) + dry * np.sign(v) + rng.normal(scale=0.02, size=q.shape)
    return MotionLog("table.csv", time - time[0], q, torque, np.arange(1, count + 1), velocity=v)


def swings(rate: float, rotor: float = 0.0) -> tuple[MotionLog, Array, Array]:
    """A log of a motion of up to 0.29 Hz without its speeds, with the second drive's rotor; its true speeds and
    accelerations."""
    time = np.arange(0.0, 120.0, 1.0 / rate)
    size, omega = np.array([[0.7, 0.9], [0.4, 0.3]]), 2.0 * np.pi * np.array([[0.07, 0.11], [0.17, 0.29]])
    phase = time[:, None, None] * omega + [[0.3, 1.1], [0.9, 2.1]]
    q, v = (size * np.sin(phase)).sum(axis=1), (size * omega * np.cos(phase)).sum(axis=1)
    a = (-size * omega**2 * np.sin(phase)).sum(axis=1)
    torque = torques(q, v, a) + np.random.default_rng(3).normal(scale=0.02, size=q.shape)
    torque[:, 1] += rotor * a[:, 1]
    return MotionLog("swings.csv", time, q, torque, np.arange(1, len(time) + 1)), v, a


@pytest.mark.parametrize("seed", [1, 2])
def test_poses_with_speeds_tell_weights_and_friction(seed: int) -> None:
    result = diagnose_motion(arm(), [table(seed, second=1.25 * MASS[1])])
    by_name = {(finding.effect, finding.at): finding for finding in result.findings}
    # Half a kilogram on link 2's axis, 0.2 m before the tip: of the link or carried, no torque tells.
    assert set(by_name) == {("friction_coulomb", (1,)), ("friction_coulomb", (2,)), ("payload", ())}
    weight = by_name["payload", ()]
    assert (("link_inertial", (2,)),) in [alternative.effects for alternative in weight.alternatives]
    sizes = {(name, item.parameter): item for name, found in by_name.items() for item in found.parameters}
    for name, parameter, truth in (
        (("friction_coulomb", (1,)), "torque", 1.5),
        (("friction_coulomb", (2,)), "torque", 0.6),
        (("payload", ()), "mass", 0.25 * MASS[1]),
        (("payload", ()), "first_moment_x", 0.25 * MASS[1] * (OUT[1] - LENGTH[1])),
    ):
        told = sizes[name, parameter]
        assert told.interval[0] < truth < told.interval[1]
        assert told.value == pytest.approx(truth, rel=0.05)
    assert result.rms_after < 0.03
    assert any("0 % of how fast things change" in note for note in result.notes)


def test_poses_whose_model_holds_all_lack_nothing() -> None:
    result = diagnose_motion(arm(), [table(5, dry=0.0 * DRY)])
    assert (result.verdict, result.findings, result.cutoff) == ("none", (), None)


def test_what_rubs_is_less_than_was_logged_by_what_a_torque_constant_adds() -> None:
    """The arm that is written gives the torques that were logged: the constant acts on its friction too."""
    poses = np.random.default_rng(8).uniform(-1.0, 1.0, (400, 2)) * [1.5, 2.0]
    speeds = np.random.default_rng(9).choice((-0.4, 0.4), poses.shape)
    true = torques(poses, speeds, 0.0 * speeds) + DRY * np.sign(speeds)
    logged = true * [1.0, 1.25] + np.random.default_rng(10).normal(scale=0.02, size=poses.shape)
    rows = np.arange(1, len(poses) + 1)
    log = MotionLog("table.csv", 5.0 * np.arange(len(poses)), poses, logged, rows, velocity=speeds)
    result = diagnose_motion(arm(), [log])
    assert ("torque_constant", (2,)) in {(finding.effect, finding.at) for finding in result.findings}
    rubs = {
        entry.at: entry.parameters["torque"] for entry in result.corrected.effects if entry.effect == "friction_coulomb"
    }
    said = {
        finding.at: finding.parameters[0].value for finding in result.findings if finding.effect == "friction_coulomb"
    }
    assert said == pytest.approx(rubs, rel=1e-12)
    assert rubs[1,] == pytest.approx(DRY[0], abs=0.01)
    assert rubs[2,] == pytest.approx(DRY[1], abs=0.01)
    np.testing.assert_allclose(
        model_torque(Motion(result.corrected, log.time, poses, speeds, 0.0 * speeds)), logged, atol=0.1
    )


def test_unknown_accelerations_are_noise() -> None:
    """Inertia at each pose that nobody logged leaves what it makes, and no name stands for it."""
    log = table(6, dry=0.0 * DRY)
    assert log.velocity is not None
    a = np.random.default_rng(60).normal(scale=2.0, size=log.q.shape)
    shaken = replace(log, torque=log.torque + torques(log.q, log.velocity, a) - torques(log.q, log.velocity, 0.0 * a))
    result = diagnose_motion(arm(), [shaken])
    assert result.findings == ()
    assert result.rms_before > 0.5


def test_samples_far_apart_stand_as_they_are() -> None:
    log = table(7)
    made = prepare(arm(), log, rules=RULES)
    assert made.motion.sampled == 0.0
    np.testing.assert_array_equal(made.motion.q, log.q)
    np.testing.assert_array_equal(made.motion.velocity, log.velocity)
    np.testing.assert_array_equal(made.measured, log.torque)
    assert not made.motion.acceleration.any()
    assert made.moving.all()
    assert len(made.kept) == log.size
    # Straight from the closed form: friction is all that the arm lacks, and the noise.
    assert predict_motion(arm(), log).rms == pytest.approx(np.hypot(DRY, 0.02), rel=0.02)


def test_poses_without_speeds_hold_no_motion() -> None:
    result = diagnose_motion(arm(), [replace(table(8), velocity=None)])
    assert result.verdict == "insufficient_data"
    assert any("0 % of how fast things change" in note for note in result.notes)


@pytest.mark.parametrize(("rate", "least"), [(8.0, 0.999), (4.0, 0.99)])
def test_a_slow_motion_is_a_motion_at_a_few_samples_a_second(rate: float, least: float) -> None:
    log, v, a = swings(rate, rotor=0.5)
    motion = prepare(arm(), log, rules=RULES).motion
    assert least < motion.sampled < 1.0
    inner = slice(8, -8)
    np.testing.assert_allclose(motion.velocity[inner], v[inner], rtol=0, atol=0.01 * np.abs(v).max())
    np.testing.assert_allclose(motion.acceleration[inner], a[inner], rtol=0, atol=0.03 * np.abs(a).max())
    result = diagnose_motion(arm(), [log])
    assert [(finding.effect, finding.at) for finding in result.findings] == [("armature", (2,))]
    assert result.findings[0].parameters[0].value == pytest.approx(0.5, rel=0.05)


def test_what_samples_tell_falls_as_they_come_further_apart() -> None:
    told = [prepare(arm(), swings(rate)[0], rules=RULES).motion.sampled for rate in (20.0, 8.0, 2.0, 0.7, 0.3)]
    assert told[0] == 1.0
    assert told == sorted(told, reverse=True)
    assert told[-1] < 0.1
