"""A load at the tip where nobody says the torque constants: what of the currents is the load's, and what nobody can
tell from the gain of all drives. Three links in a plumb plane with point masses at their ends, by d'Alembert's
principle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import CURRENT, TORQUE, MotionLog
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.motion.weighed import load_words, weighed
from linkwright.core.diagnose.rules.rules import RULES
from tests.costs import slow_but

LENGTHS, MASSES = (0.4, 0.35, 0.2), (6.0, 3.0, 1.5)
CONSTANTS = np.array([14.0, 11.0, 6.0])
LOAD, NOISE = 1.2, 0.05


def arm(share=1.0, masses=MASSES):
    """The arm as a file has it, all masses by one share."""
    links = (
        Link(length, mass=share * mass, center_of_mass=length) for length, mass in zip(LENGTHS, masses, strict=True)
    )
    return Arm("chain", (Joint(), Joint(), Joint()), tuple(links))


def torques(q, v, a, masses):
    """Of each joint the sum over masses m of dp/dq (p'' + g), with p their places (3, N)."""
    turned, speed, rate = (np.cumsum(item, axis=0) for item in (q, v, a))
    along, across = np.stack([np.cos(turned), np.sin(turned)]), np.stack([-np.sin(turned), np.cos(turned)])
    lengths = np.array(LENGTHS)[:, None]
    of_links = lengths * (rate * across - speed**2 * along)
    pulled = np.cumsum(of_links, axis=1) + np.array([0.0, 9.81])[:, None, None]
    made = np.zeros_like(q)
    for joint in range(3):
        for end in range(joint, 3):
            lever = (lengths * across)[:, joint : end + 1].sum(axis=1)
            made[joint] += masses[end] * np.sum(lever * pulled[:, end], axis=0)
    return made


def currents(seed, load, masses=MASSES, file="log.csv"):
    """Thirty seconds at 100 Hz with `load` kg at the tip, in A."""
    rng = np.random.default_rng(seed)
    time = np.arange(3000) / 100.0
    rates, phases = 2.0 * np.pi * rng.uniform(0.1, 0.5, (3, 5, 1)), rng.uniform(0.0, 6.28, (3, 5, 1))
    swings, turned = rng.uniform(0.2, 0.6, (3, 5, 1)), rates * time + phases
    q = np.sum(swings * np.sin(turned), axis=1)
    v = np.sum(swings * rates * np.cos(turned), axis=1)
    a = -np.sum(swings * rates**2 * np.sin(turned), axis=1)
    torque = torques(q, v, a, (*masses[:2], masses[2] + load)) + NOISE * rng.standard_normal(q.shape)
    rows = np.arange(1, 3001)
    return MotionLog(file, time, q.T, torque.T / CONSTANTS, rows, drive=CURRENT, torque_constants_free=True)


def constants(of, *logs):
    """The torque constants that an arm's weights make."""
    return np.array(weighed(of, [prepare(of, log, rules=RULES) for log in logs], rules=RULES)[0].weighed)


@pytest.mark.parametrize("loads", [(0.0,), (LOAD,), (0.0, LOAD), (LOAD, 0.0, 0.7)])
def test_a_load_is_no_part_of_the_constants(loads):
    logs = [currents(3 + k, load) for k, load in enumerate(loads)]
    np.testing.assert_allclose(constants(arm(), *logs), CONSTANTS, rtol=0.03)


def test_where_all_that_the_arm_weighs_may_be_a_load_its_weights_count_alone():
    light = (0.0, 0.0, 1.5)
    np.testing.assert_allclose(constants(arm(masses=light), currents(5, 0.0, light)), CONSTANTS, rtol=0.02)
    with_it = constants(arm(masses=light), currents(5, LOAD, light))
    np.testing.assert_allclose(with_it, CONSTANTS / (1.0 + LOAD / light[2]), rtol=0.02)


@pytest.mark.parametrize("share", slow_but([1.0, 0.85], 0.85))
def test_the_interval_of_a_load_holds_the_gain_of_all_drives(share):
    """The file's masses are right, or all too small by 15 %, which nothing in the currents tells."""
    logs = [currents(7, 0.0, file="free.csv"), currents(8, LOAD, file="loaded.csv")]
    result = diagnose_motion(arm(share), logs)
    (finding,) = (item for item in result.findings if item.effect == "payload")
    (mass,) = (item for item in finding.parameters if item.parameter == "mass")
    assert finding.recording == "loaded.csv"
    assert mass.value == pytest.approx(share * LOAD, rel=0.02)
    assert mass.interval[0] < LOAD < mass.interval[1] < 1.5 * mass.value
    assert "cannot tell the load from the gain of all drives" in result.sentence


@pytest.mark.slow
def test_a_load_is_as_exact_as_constants_that_were_told():
    logs = [currents(7 + k, load, file=f"{k}.csv") for k, load in enumerate((0.0, LOAD))]
    told = [replace(log, torque=log.torque * CONSTANTS, torque_constants_free=False) for log in logs]
    result = diagnose_motion(arm(), told)
    (finding,) = (item for item in result.findings if item.effect == "payload")
    (mass,) = (item for item in finding.parameters if item.parameter == "mass")
    assert mass.interval[0] < LOAD < mass.interval[1]
    assert mass.value == pytest.approx(LOAD, rel=0.02)
    assert "cannot tell the load from the gain" not in result.sentence
    assert "The load is as exact as the torque constants" in result.sentence
    without_mass = replace(finding, recording="", parameters=tuple(item for item in finding.parameters if item != mass))
    assert "a log of the same arm without it would tell" in load_words([without_mass], told)[-1]
    in_newton_metres = [replace(log, drive=TORQUE) for log in told]
    assert load_words([finding], in_newton_metres) == []
    assert len(load_words([without_mass], in_newton_metres)) == 1
