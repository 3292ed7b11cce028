"""Rollouts against the equations of motion solved otherwise, and against the motion whose torques act."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.motion.dynamics import torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.motion.rollout.simulator import Courses, rolled_out, simulator
from linkwright.core.units.quantities import InputError

mujoco = pytest.importorskip("mujoco")

RATE, SAMPLES, COUNT = 200.0, 100, 12
FREE = np.array([[-50.0] * 3, [50.0] * 3])


def entry(effect, joint, **values):
    return EffectEntry(effect, (joint,) if joint else (), values)


WORDS = (
    entry("friction_viscous", 1, coefficient=4.0),
    entry("armature", 2, inertia=0.6),
    entry("spring", 3, stiffness=5.0, rest=0.3),
    entry("payload", 0, mass=1.2),
)
DRY = (entry("friction_coulomb", 1, torque=6.0), entry("friction_coulomb", 3, torque=1.0))
BESIDE = (
    entry("friction_load", 2, share=0.15),
    entry("friction_stribeck", 1, torque=2.0, speed=0.3),
    entry("friction_quadratic", 3, coefficient=0.8),
    entry("gear_ripple", 3, order=11.0, sine=1.0, cosine=0.5),
    entry("joint_coupling", 3, coefficient=0.7),
    entry("encoder_offset", 2, offset=0.02),
    entry("torque_curve", 2, torque_0=3.0, torque_90=-2.0),
)


def arm_with(*effects):
    """Three joints, one of them about another axis; links of some kilograms."""
    joints = (
        Joint(axis=(0.0, 1.0, 0.0)),
        Joint(),
        Joint(),
    )
    links = tuple(
        Link(length, mass=mass, center_of_mass=0.5 * length) for length, mass in ((0.3, 6.0), (0.4, 4.0), (0.3, 2.0))
    )
    return Arm("three", joints, links, payload=LoadCase(0.5), effects=effects)


def motion_of(arm, seed=0, *, turning=False):
    """Windows of sines, by default so fast a drift that no joint turns round."""
    draw = np.random.default_rng(seed)
    time = np.arange(COUNT * (SAMPLES + 1)) / RATE
    rate, phase = draw.uniform(1.0, 5.0, (3, 3)), draw.uniform(0.0, 6.0, (3, 3))
    size = draw.uniform(0.1, 0.4, (3, 3)) / rate
    angle = time[:, None, None] * rate + phase
    drift = np.zeros(3) if turning else np.array([1.6, -1.7, 1.8])
    q = (size * np.sin(angle)).sum(axis=1) + drift * time[:, None]
    velocity = (size * rate * np.cos(angle)).sum(axis=1) + drift
    acceleration = -(size * rate**2 * np.sin(angle)).sum(axis=1)
    return Motion(arm, time, q, velocity, acceleration)


def courses_of(motion):
    """The windows under the torques that the motion takes."""
    torque = torque_stages(motion).drive.reshape(COUNT, SAMPLES + 1, 3)
    nothing = np.zeros_like(torque)
    return Courses(motion, RATE, torque, nothing, nothing)


def off(arm, motion):
    """How far the simulated arm is from the motion (W, S + 1, n), rad."""
    rolled = rolled_out(simulator(arm, motion), courses_of(motion), FREE)
    assert not rolled.left.any()
    return rolled.q - motion.q.reshape(rolled.q.shape), rolled.velocity - motion.velocity.reshape(rolled.q.shape)


@pytest.mark.parametrize("effects", [(), WORDS, DRY, BESIDE, (*WORDS, *DRY, *BESIDE)])
def test_torques_of_a_motion_make_that_motion(effects):
    """What inverse dynamics asks for, forward dynamics turns into the same motion, within what steps of 1 ms leave, and
    torques that are straight between samples."""
    arm = arm_with(*effects)
    angle, speed = off(arm, motion_of(arm))
    assert np.abs(angle).max() < 2.5e-3
    assert np.abs(speed).max() < 2e-2


def test_what_mjcf_has_no_word_for_is_told():
    arm = arm_with(*WORDS, *BESIDE)
    made = simulator(arm, motion_of(arm))
    assert set(made.beside) == {item.effect for item in BESIDE}
    assert made.lasting == ()


@pytest.mark.parametrize(
    "lasting",
    [
        entry("friction_reversal", 1, torque=2.0, distance=0.01),
        entry("joint_compliance", 2, compliance=1e-3, retardation=5e-3),
    ],
)
def test_what_goes_by_the_course_of_a_motion_is_known_as_such(lasting):
    arm = arm_with(lasting, *DRY, *BESIDE)
    assert simulator(arm, motion_of(arm, turning=True)).lasting == (lasting,)


@pytest.mark.parametrize("seed", [1, 2])
def test_an_arm_falls_as_its_equations_say(seed):
    """Without any torque, from states at random: scipy solves the arm's own equations (accelerations by a linear system
    of its torques), MuJoCo its own."""
    arm = arm_with(*WORDS, *(item for item in BESIDE if not item.effect.startswith("friction_load")))
    draw = np.random.default_rng(seed)
    motion = motion_of(arm)
    q, velocity = draw.uniform(-2.0, 2.0, 3), draw.uniform(1.0, 2.0, 3) * [1.0, -1.0, 1.0]
    start = replace(motion.at(slice(0, SAMPLES + 1)), q=np.tile(q, (SAMPLES + 1, 1)))
    start = replace(start, velocity=np.tile(velocity, (SAMPLES + 1, 1)))
    slope = accelerations(arm, q, velocity)
    start = replace(start, acceleration=np.tile(slope, (SAMPLES + 1, 1)))
    nothing = np.zeros((1, SAMPLES + 1, 3))
    rolled = rolled_out(simulator(arm, motion), Courses(start, RATE, nothing, nothing, nothing), FREE)

    def rates(_time, state):
        return np.concatenate([state[3:], accelerations(arm, state[:3], state[3:])])

    time = np.arange(SAMPLES + 1) / RATE
    solved = solve_ivp(rates, (0.0, time[-1]), [*q, *velocity], t_eval=time, rtol=1e-8, atol=1e-9, max_step=0.01)
    far = np.abs(solved.y[:3].T - q).max()
    assert far > 0.5  # it moved
    assert np.abs(rolled.q[0] - solved.y[:3].T).max() < 0.01 * far


def accelerations(arm, q, velocity):
    """How an arm without torque accelerates (n,): its torques are straight in that."""
    rows = np.vstack([np.zeros(3), np.eye(3)])
    states = np.tile(q, (4, 1)), np.tile(velocity, (4, 1))
    torque = torque_stages(Motion(arm, np.arange(4.0), *states, rows)).drive
    return np.linalg.solve((torque[1:] - torque[0]).T, -torque[0])


def test_a_joint_held_by_friction_stays_where_it_is():
    """Less torque than dry friction moves nothing."""
    arm = replace(arm_with(entry("friction_coulomb", 0, torque=60.0)), gravity=(0.0, 0.0, 0.0))
    still = motion_of(arm)
    zero = np.zeros_like(still.q)
    still = replace(still, q=zero, velocity=zero, acceleration=zero)
    given = courses_of(still)
    rolled = rolled_out(simulator(arm, motion_of(arm)), replace(given, torque=given.torque + 20.0), FREE)
    assert np.abs(rolled.q).max() < 2e-3


def test_a_course_that_leaves_the_range_is_stopped_there():
    arm = arm_with()
    motion = motion_of(arm)
    given = courses_of(motion)
    pushed = given.torque.copy()
    pushed[3] += 300.0
    span = np.array([motion.q.min(axis=0) - 0.2, motion.q.max(axis=0) + 0.2])
    rolled = rolled_out(simulator(arm, motion), replace(given, torque=pushed), span)
    assert np.flatnonzero(rolled.left).tolist() == [3]
    assert (rolled.q >= span[0]).all()
    assert (rolled.q <= span[1]).all()
    assert not rolled.velocity[3, -1].any()


def test_an_arm_that_mjcf_cannot_hold_is_refused():
    """A force at the tip is in no MJCF."""
    arm = replace(arm_with(), payload=LoadCase(0.5, force=(0.0, 0.0, -30.0)))
    with pytest.raises(InputError, match="MJCF cannot hold the arm"):
        simulator(arm, motion_of(arm))
