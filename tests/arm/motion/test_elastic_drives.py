"""A drive that gives between its encoder and its link, against the equations of motion integrated by themselves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.effects.elastic.elastic_drive import eigenfrequencies
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from tests.arm.effects.test_torques import ARM, MOTION

MASS, LENGTH, CENTRE, GRAVITY = 3.0, 0.8, 0.4, 9.81
INERTIA = MASS * LENGTH**2 / 3.0
ROD = Arm("rod", (Joint(),), (Link(LENGTH, mass=MASS, center_of_mass=CENTRE),))
TIME = np.linspace(0.0, 8.0, 1601)


def motor(time, order=0):
    """The motor's angle, or a derivative of it."""
    waves = ((0.5, 2.0, 0.0), (0.1, 7.0, 1.0))
    return sum(w**order * a * np.sin(w * time + p + order * np.pi / 2.0) for a, w, p in waves)


TURNING = Motion(ROD, TIME, *(motor(TIME, order)[:, None] for order in range(3)))


def link_behind(stiffness, damping):
    """The torque (N,) in the gear of a rod that its motor drags along, by the rod's equation of motion."""

    def gear(time, q, v):
        return stiffness * (motor(time) - q) + damping * (motor(time, 1) - v)

    def slopes(time, state):
        q, v = state
        return v, (gear(time, q, v) - MASS * GRAVITY * CENTRE * np.cos(q)) / INERTIA

    start = (motor(0.0) - inverse_dynamics(TURNING)[0, 0] / stiffness, motor(0.0, 1))
    way = solve_ivp(slopes, (0.0, TIME[-1]), start, t_eval=TIME, rtol=1e-9, atol=1e-10, max_step=0.005)
    return gear(TIME, *way.y)


@pytest.mark.parametrize("frequency", [2.5, 4.0, 12.0])
def test_a_motor_drags_a_rod_along_through_a_spring(frequency):
    """Slower than the eigenfrequency and near it: what is left is a hundredth of what the spring changes."""
    stiffness = INERTIA * (2.0 * np.pi * frequency) ** 2
    damping = 0.3 * np.sqrt(stiffness * INERTIA)
    values = {"compliance": 1.0 / stiffness, "retardation": damping / stiffness}
    more = EFFECTS["joint_compliance"].torques(TURNING, Settings((0,), values))[0]
    late = slice(600, -20)  # how it began has died away
    rigid = INERTIA * motor(TIME, 2) + MASS * GRAVITY * CENTRE * np.cos(motor(TIME))
    left = link_behind(stiffness, damping) - rigid - more
    assert np.std(left[late]) < 0.012 * np.std(more[late])
    low, high = eigenfrequencies(ROD, TURNING.q, 0, 1.0 / stiffness)
    assert (low, high) == pytest.approx((frequency, frequency), rel=5e-3)


def test_the_slope_is_that_of_the_torque():
    effect = EFFECTS["joint_compliance"].torques
    for compliance in (0.0, 2e-3):
        here = Settings((1,), {"compliance": compliance})
        ends = [effect(MOTION, Settings((1,), {"compliance": compliance + step})) for step in (4e-6, 0.0)]
        ends = [effect(MOTION, Settings((1,), {"compliance": compliance + step})) for step in (2e-6, -2e-6)]
        for joint, slope in effect.slope(MOTION, here).items():
            expected = (ends[0][joint] - ends[1].get(joint, 0.0)) / 4e-6
            np.testing.assert_allclose(slope[5:-5], expected[5:-5], rtol=0, atol=0.02 * np.abs(expected).max())


def test_the_files_stiffness_counts_and_what_effects_add_comes_on_top():
    joints = tuple(replace(joint, stiffness=8e3 if k == 1 else None) for k, joint in enumerate(ARM.joints))
    stiff = replace(MOTION, arm=replace(ARM, joints=joints))
    entry = EffectEntry("joint_compliance", (2,), {"compliance": 1.0 / 8e3})
    softer = replace(stiff, arm=replace(stiff.arm, effects=(entry,)))
    alike = replace(MOTION, arm=replace(ARM, effects=(replace(entry, parameters={"compliance": 2.0 / 8e3}),)))
    np.testing.assert_allclose(model_torque(softer), model_torque(alike), rtol=0, atol=1e-9)
    rigid = replace(stiff, arm=replace(stiff.arm, leave_out=frozenset({"joint_compliance"})))
    np.testing.assert_allclose(model_torque(rigid), inverse_dynamics(MOTION), rtol=0, atol=1e-9)
    assert np.abs(model_torque(stiff) - model_torque(rigid)).max() > 0.01


ROTOR = 0.4


def two_masses(stiffness, damping):
    """Angles, speeds and accelerations of a rotor and of the rod that it drags along, as a loop's torque (N,) makes the
    rotor follow `motor`, by the equations of both."""

    def rates(time, state):
        of_rotor, v, q, w = state
        gear = stiffness * (of_rotor - q) + damping * (v - w)
        torque = 900.0 * (motor(time) - of_rotor) + 60.0 * (motor(time, 1) - v)
        return v, (torque - gear) / ROTOR, w, (gear - MASS * GRAVITY * CENTRE * np.cos(q)) / INERTIA, torque

    start = (motor(0.0), motor(0.0, 1), motor(0.0), motor(0.0, 1))
    way = solve_ivp(lambda t, s: rates(t, s)[:4], (0.0, TIME[-1]), start, t_eval=TIME, rtol=1e-9, atol=1e-10).y
    of_rotor, v, q, w = way
    _, a, _, b, torque = rates(TIME, way)
    return (
        Motion(ROD, TIME, *(item[:, None] for item in (of_rotor, v, a))),
        Motion(ROD, TIME, *(item[:, None] for item in (q, w, b)), beyond_drive=True),
        torque,
    )


def left_by(motion, entries, torque):
    """The RMS of what a rod with these effects leaves of a torque, once how it began has died away."""
    rod = replace(motion, arm=replace(ROD, effects=entries))
    return np.std((torque - model_torque(rod)[:, 0])[600:-20])


@pytest.mark.parametrize("frequency", [2.5, 4.0])
def test_the_encoder_sits_on_either_side_of_a_drive_that_gives(frequency):
    """By the rotor's angle and by the rod's the torque is the same, and the other side's is far off."""
    stiffness = INERTIA * (2.0 * np.pi * frequency) ** 2
    damping = 0.3 * np.sqrt(stiffness * INERTIA)
    values = {"compliance": 1.0 / stiffness, "retardation": damping / stiffness}
    entries = (EffectEntry("armature", (1,), {"inertia": ROTOR}), EffectEntry("joint_compliance", (1,), values))
    of_rotor, of_rod, torque = two_masses(stiffness, damping)
    for motion in (of_rotor, of_rod):
        other = replace(motion, beyond_drive=not motion.beyond_drive)
        assert left_by(motion, entries, torque) < 0.05 * left_by(other, entries, torque)
    rubs = EffectEntry("friction_viscous", (1,), {"coefficient": 5.0})
    with_friction = torque + 5.0 * of_rotor.velocity[:, 0]
    assert left_by(of_rod, (*entries, rubs), with_friction) < 0.05 * left_by(of_rod, (entries[0], rubs), with_friction)


def test_beyond_a_drive_nothing_shows_without_a_rotor():
    values = {"compliance": 1e-3}
    assert EFFECTS["joint_compliance"].torques(replace(TURNING, beyond_drive=True), Settings((0,), values)) == {}
