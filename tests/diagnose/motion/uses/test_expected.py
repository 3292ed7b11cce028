"""How far a motion tells each name, held against least squares written out by hand, and against motions at random."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.avoid.poses import Room
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.uses.expected import RATE, Patterns, expected_by
from linkwright.core.diagnose.motion.uses.plan import plan_motion
from linkwright.core.diagnose.motion.uses.trajectory import limits_of, moved, random_series
from linkwright.core.units.quantities import InputError

FRICTION = [("friction_coulomb", (1,)), ("friction_viscous", (1,))]


def an_arm(**changed):
    """Two links that hang in a vertical plane."""
    joint = replace(Joint(range=(-math.pi / 2, math.pi / 2), velocity=2.0), **changed)
    links = tuple(Link(length, mass=4.0, center_of_mass=0.5 * length) for length in (0.4, 0.3))
    return Arm("planar", (joint, joint), links)


def a_motion(arm, seed=1, seconds=12.0):
    draw = np.random.default_rng(seed)
    room = Room()
    return moved(arm, random_series(arm, draw, 1)[0], limits_of(arm, room, draw), seconds, RATE, room)


def test_intervals_are_those_of_least_squares():
    """Dry and viscous friction of a joint beside its offset and its rotor: the covariance of the four columns with a
    prior of the usual size, by hand, with rows at rest left out."""
    arm = an_arm()
    motion, sigma = a_motion(arm), np.array([0.7, 0.3])
    patterns = Patterns.of(arm, FRICTION, motion, sigma)
    expected = patterns.uncertain(patterns.gram(motion))
    moves = np.abs(motion.velocity[:, 0]) > 0.03
    speed, acceleration = motion.velocity[moves, 0], motion.acceleration[moves, 0]
    columns = np.stack([np.sign(speed), speed, np.ones_like(speed), acceleration], axis=1)
    numbers = [patterns.single[name] for name in (*FRICTION, ("torque_offset", (1,)), ("armature", (1,)))]
    usual = np.array([patterns.pool.groups[k].usual[0] for k in numbers])
    information = columns.T @ columns / sigma[0] ** 2 + np.diag(usual**-2.0)
    by_hand = 1.96 * np.sqrt(np.diag(np.linalg.inv(information)))[:2]
    order = [patterns.asked.index(k) for k in numbers[:2]]
    # Signs are smoothed within 0.01 rad/s, which rows above 0.03 rad/s hardly see.
    assert expected[order] * usual[:2] == pytest.approx(by_hand, rel=0.01)


def test_names_that_go_together_are_told_so():
    """A load at the tip is mass of the last link: asked for together neither is told, the load alone is."""
    arm, motion = an_arm(), a_motion(an_arm(), 2)
    payload, link = ("payload", ()), ("link_inertial", (2,))
    both = Patterns.of(arm, [payload, link], motion)
    told = {item.name: item for item in both.expected(both.gram(motion))}
    assert not told[payload].shown
    assert (told[payload].beside, told[link].beside) == (link, payload)
    alone = Patterns.of(arm, [payload], motion)
    (item,) = alone.expected(alone.gram(motion))
    assert item.shown
    assert item.share < 0.1


def test_a_log_says_what_it_tells():
    """By the noise of its torques: four times as loud, intervals four times as wide; a joint at rest tells nothing."""
    arm = an_arm()
    draw = np.random.default_rng(3)
    limits = limits_of(arm, Room(), draw)
    motion = moved(arm, random_series(arm, draw, 1)[0], limits, 20.0, 200.0, Room())
    still = motion.q.copy()
    still[:, 1] = still[0, 1]
    torque = model_torque(Motion(arm, motion.time, still, np.gradient(still, 0.005, axis=0), np.zeros_like(still)))

    def expected(loud):
        noise = loud * draw.standard_normal(torque.shape)
        log = MotionLog("log.csv", motion.time, still, torque + noise, np.arange(len(still)))
        return {item.name: item for item in expected_by(arm, log, [*FRICTION, ("friction_viscous", (2,))])[2]}

    quiet, loud = expected(0.5), expected(2.0)
    assert loud[FRICTION[1]].half / quiet[FRICTION[1]].half == pytest.approx(4.0, rel=0.1)
    resting = quiet["friction_viscous", (2,)]
    assert (resting.shown, resting.beside) == (False, None)


@pytest.mark.slow
def test_a_planned_motion_tells_more_than_twenty_at_random():
    """A rotor and a load: 0.6 times the median interval or less, and drives give what it takes."""
    arm = an_arm(peak_torque=34.0)
    wanted = [("armature", (1,)), ("payload", ())]
    plan = plan_motion(arm, wanted, Room(), seconds=10.0)
    assert {item.name for item in plan.expected} == set(wanted)
    ratios = [item.share / item.random for item in plan.expected]
    assert math.exp(np.mean(np.log(ratios))) < 0.6
    assert np.abs(model_torque(plan.motion)).max() <= 34.0
    loose = plan_motion(an_arm(), wanted, Room(), seconds=10.0)
    assert np.abs(model_torque(loose.motion)).max() > 34.0
    with pytest.raises(InputError, match="peak_torque"):
        plan_motion(an_arm(peak_torque=0.01), wanted, Room(), seconds=10.0)


def test_friction_of_the_file_counts_against_peak_torque():
    """What the drive gives includes what its friction takes."""
    rubs = replace(an_arm(peak_torque=36.0), effects=(EffectEntry("friction_coulomb", (1,), {"torque": 3.0}),))
    plan = plan_motion(rubs, [("armature", (1,))], Room(), seconds=10.0)
    assert np.abs(model_torque(plan.motion)).max() <= 36.0
