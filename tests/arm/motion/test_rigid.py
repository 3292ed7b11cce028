"""Inverse dynamics and regressors: against Pinocchio and MuJoCo, statics, and what mechanics demands."""

import doctest
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.bodies.beams import PropertyNeeded, beam_of
from linkwright.core.arm.chain.balance import IdealCounterbalance, PointMass
from linkwright.core.arm.chain.chain import Arm, Branch, Joint, Link, LoadCase
from linkwright.core.arm.chain.following import Following, Tie
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.vectors import from_roll_pitch_yaw, unit
from linkwright.core.arm.descriptions.formats import export_arm
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.motion import dynamics, rigid
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.moving import moving
from linkwright.core.arm.motion.rigid import (
    inverse_dynamics,
    link_parameters,
    pseudo_inertia,
    regressor,
    rigid_torque,
)
from linkwright.core.diagnose.motion import simulate
from linkwright.core.units.quantities import InputError
from tests.arm.motion.by_mujoco import inverse
from tests.arm.motion.robots import PANDA, UR10E, urdf_of

# pinocchio.rnea (Pinocchio 4.1.0) of the two URDFs at the states of `states_of`.
PINOCCHIO = {
    "UR10e": (
        UR10E,
        [
            [7.882706710473346, -92.89485514988867, -24.149251923587627, 0.8552364246713162, -0.04103073130962569,
             0.0004438449244546648],
            [-22.179068215518274, -58.14963132143647, -9.55121127229025, -0.46987579401011687, 0.026919831791917485,
             0.0005603451323285914],
            [11.776453682939117, -89.06130789773016, -21.60817789582326, -0.22305694979077575, 0.015620454510291345,
             0.0018356958786037874],
        ],
    ),
    "Panda": (
        PANDA,
        [
            [6.620435429343089, -53.889644740477, 4.160417961939159, 19.38994056613626, -0.4241481286637936,
             -1.3158387291291689, 0.0787223541211404],
            [-1.2457222427563879, 35.16187521634364, -2.536718739982212, -15.713683202463024, 0.389787244388992,
             0.8797437658970816, -0.11158171683664034],
            [0.1139387409429837, 4.903835308456973, -1.0667433362800443, -0.5037950763903867, 0.33244457339692945,
             0.37549897632425266, 0.010714742041925393],
        ],
    ),
}  # fmt: skip


def states_of(size):
    s, k = np.arange(1.0, 4.0)[:, None], np.arange(1, size + 1)
    return np.sin(s * k), np.cos(1.5 * s * k), 3.0 * np.sin(2.2 * s * k)


def motion_of(arm, q, velocity, acceleration, **more):
    return Motion(arm, np.arange(float(len(q))), q, velocity, acceleration, **more)


def by_mujoco(model, q, velocity, acceleration):
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_DAMPER
    return inverse(model, q, velocity, acceleration)


def random_arm(seed, *, size=None, slides=True):
    """An arm in space of rigid links with tensors of their own and masses off their axes."""
    rng = np.random.default_rng(seed)
    joints, links = [], []
    for number in range(size or int(rng.integers(1, 6))):
        axis = unit(tuple(rng.normal(size=3)))
        turned = from_roll_pitch_yaw(*rng.uniform(-3, 3, 3))
        kind = "prismatic" if slides and rng.random() < 0.3 else "revolute"
        shift = tuple(rng.uniform(-0.3, 0.3, 3).tolist())
        joints.append(
            Joint(
                kind, axis, zero=float(rng.uniform(-1, 1)), origin_rotation=turned, origin_translation=shift, mass=2.0
            )
        )
        along = unit(tuple(rng.normal(size=3)))
        bones = rng.normal(size=(3, 3)) * 0.2
        tensor = bones @ bones.T
        tensor = np.trace(tensor) * np.eye(3) - tensor
        inertia = tuple(tensor[at] for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        links.append(
            Link(
                float(rng.uniform(0.2, 0.8)), direction=along, end_rotation=from_roll_pitch_yaw(*rng.uniform(-3, 3, 3)),
                mass=float(rng.uniform(1, 9)), masses=(PointMass(1.5, tuple(rng.uniform(-0.2, 0.2, 3).tolist())),),
                inertia=inertia if number % 2 else None,
            )
        )  # fmt: skip
    gravity = tuple(rng.normal(size=3).tolist())
    load = LoadCase(float(rng.uniform(0, 4)))
    tool = tuple(rng.uniform(-0.2, 0.2, 3).tolist())
    return Arm("random", tuple(joints), tuple(links), gravity=gravity, payload=load, tool=tool)


def random_states(arm, seed, rows=4):
    rng = np.random.default_rng(seed)
    return tuple(rng.uniform(-1, 1, (rows, arm.size)) * most for most in (2.0, 3.0, 9.0))


@pytest.mark.parametrize("robot", PINOCCHIO)
def test_an_imported_urdf_takes_the_torques_of_pinocchio_and_mujoco(robot, tmp_path):
    rows, expected = PINOCCHIO[robot]
    urdf, states = tmp_path / "robot.urdf", states_of(len(rows))
    urdf.write_text(urdf_of(rows), encoding="utf-8")
    imported = import_robot(urdf)
    (tmp_path / "arm.yaml").write_text(imported.to_yaml(), encoding="utf-8")
    for arm in (imported.arm, read_arm(tmp_path / "arm.yaml")):
        result = inverse_dynamics(motion_of(arm, *states))
        np.testing.assert_allclose(result, expected, rtol=0, atol=1e-10)
    model = mujoco.MjModel.from_xml_path(str(urdf))
    np.testing.assert_allclose(by_mujoco(model, *states), expected, rtol=0, atol=1e-10)


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_random_arms_take_the_torques_of_mujoco(seed):
    arm = random_arm(seed)
    states = random_states(arm, seed)
    model = mujoco.MjModel.from_xml_string(export_arm(arm, "mjcf").text)
    np.testing.assert_allclose(inverse_dynamics(motion_of(arm, *states)), by_mujoco(model, *states), rtol=0, atol=1e-9)


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_regressor_times_parameters_is_inverse_dynamics(seed):
    arm = random_arm(seed)
    states = random_states(arm, seed)
    result = regressor(arm, *states) @ link_parameters(arm).ravel()
    np.testing.assert_allclose(result, inverse_dynamics(motion_of(arm, *states)), rtol=0, atol=1e-10)


def kinetic_energy(arm, q, velocity):
    """By the mass matrix: what accelerations of that size take at rest and without weight."""
    momentum = rigid_torque(arm, link_parameters(arm), q, np.zeros(q.shape), velocity, gravity=(0.0, 0.0, 0.0))
    return 0.5 * np.sum(momentum * velocity, axis=1)


def potential_energy(arm, q):
    result, still = np.zeros(len(q)), np.zeros(q.shape)
    for link, own in zip(moving(arm, q, still, still).links, link_parameters(arm), strict=True):
        moments = own[0] * link.origin + np.einsum("abm,b->am", link.rotation, own[1:4])
        result -= np.array(arm.gravity) @ moments
    return result


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_the_drives_power_is_what_the_energy_gains(seed):
    arm = random_arm(seed)
    q, velocity, acceleration = random_states(arm, seed)
    step = 1e-4

    def energy(sign):
        there = q + sign * step * velocity + 0.5 * step**2 * acceleration
        moving = velocity + sign * step * acceleration
        return kinetic_energy(arm, there, moving) + potential_energy(arm, there)

    gained = (energy(1.0) - energy(-1.0)) / (2.0 * step)
    power = np.sum(inverse_dynamics(motion_of(arm, q, velocity, acceleration)) * velocity, axis=1)
    np.testing.assert_allclose(power, gained, rtol=1e-5, atol=1e-4)


@given(st.integers(0, 10**6))
@settings(max_examples=15, deadline=None)
def test_played_backwards_a_motion_takes_the_same_torques(seed):
    arm = random_arm(seed)
    q, velocity, acceleration = random_states(arm, seed)
    forth, back = (inverse_dynamics(motion_of(arm, q, way * velocity, acceleration)) for way in (1.0, -1.0))
    np.testing.assert_allclose(forth, back, rtol=0, atol=1e-10)


@pytest.mark.parametrize("angles", ["relative", "absolute"])
def test_at_rest_drives_hold_what_statics_says_they_carry(angles):
    joints = (Joint(mass=3.0), Joint(mass=2.0, counterbalance=IdealCounterbalance(40.0, 0.3)), Joint(mass=1.0))
    links = tuple(Link(length, mass=4.0) for length in (0.5, 0.4, 0.3))
    load = LoadCase(2.0, (15.0, -10.0, 0.0), (0.0, 0.0, 3.0 if angles == "relative" else 0.0))
    tool = (0.1, 0.05, 0.0) if angles == "relative" else (0.0, 0.0, 0.0)
    arm = Arm("plane", joints, links, angles=angles, payload=load, tool=tool)
    q = np.random.default_rng(1).uniform(-2, 2, (5, 3))
    carried = solve(arm, list(q.T), [beam_of(arm, index) for index in range(3)])
    still = np.zeros(q.shape)
    result = inverse_dynamics(motion_of(arm, q, still, still))
    for index, joint in enumerate(carried.joints):
        np.testing.assert_allclose(result[:, index], -joint.drive_load, rtol=0, atol=1e-10)


def test_absolute_angles_are_the_same_arm_in_other_coordinates():
    relative = Arm("plane", (Joint(),) * 3, tuple(Link(length, mass=4.0) for length in (0.5, 0.4, 0.3)))
    absolute = replace(relative, angles="absolute")
    against = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    states = random_states(relative, 5)
    about = inverse_dynamics(motion_of(relative, *(state @ against.T for state in states)))
    np.testing.assert_allclose(inverse_dynamics(motion_of(absolute, *states)), about @ against, rtol=0, atol=1e-10)
    np.testing.assert_allclose(
        regressor(absolute, *states) @ link_parameters(absolute).ravel(), about @ against, rtol=0, atol=1e-10
    )


def test_a_follower_loads_the_drive_that_moves_it():
    free = random_arm(11, size=3, slides=False)
    follows = Following((Tie(0, -0.5), Tie(1, 2.0)), 0.2)
    tied = replace(free, joints=(*free.joints[:2], replace(free.joints[2], follows=follows)))
    weights = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 2.0, 0.0]])
    q, velocity, acceleration = random_states(free, 11)
    whole = (q @ weights.T + np.array([0.0, 0.0, 0.2]), velocity @ weights.T, acceleration @ weights.T)
    expected = inverse_dynamics(motion_of(free, *whole)) @ weights
    np.testing.assert_allclose(
        inverse_dynamics(motion_of(tied, q, velocity, acceleration)), expected, rtol=0, atol=1e-10
    )


def test_another_payload_counts_in_place_of_the_arms():
    arm = random_arm(3, size=4)
    states = random_states(arm, 3)
    mass = np.array([0.0, 1.0, 2.5, 4.0])
    result = inverse_dynamics(motion_of(arm, *states, payload_mass=mass))
    for row, own in enumerate(mass):
        alone = replace(arm, payload=LoadCase(float(own)))
        expected = inverse_dynamics(motion_of(alone, *states))[row]
        np.testing.assert_allclose(result[row], expected, rtol=0, atol=1e-10)


def test_long_motions_are_taken_in_pieces_that_fit_together():
    arm = random_arm(8, size=2)
    states = random_states(arm, 8, rows=10_000)
    whole, rows = inverse_dynamics(motion_of(arm, *states)), [0, 8191, 8192, 9999]
    few = tuple(state[rows] for state in states)
    np.testing.assert_array_equal(whole[rows], inverse_dynamics(motion_of(arm, *few)))
    np.testing.assert_array_equal(regressor(arm, *states)[rows], regressor(arm, *few))


@given(st.integers(0, 10**6))
@settings(max_examples=15, deadline=None)
def test_bodies_have_a_pseudo_inertia_that_is_positive(seed):
    for own in link_parameters(random_arm(seed)):
        assert np.linalg.eigvalsh(pseudo_inertia(own))[0] > -1e-12
    lighter = own.copy()
    lighter[4:] = 0.0
    assert np.linalg.eigvalsh(pseudo_inertia(lighter))[0] < 0.0


@pytest.mark.parametrize("module", [rigid, dynamics, simulate])
def test_examples_in_docstrings_are_what_they_say(module):
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0


def test_what_no_rigid_chain_is_is_refused_in_one_line():
    arm = random_arm(2, size=4, slides=False)
    still = np.zeros((1, 4))
    forked = replace(arm, branches=(Branch("left", 2, 3), Branch("right", 3, 4)))
    boom = replace(arm, links=(*arm.links[:3], replace(arm.links[3], runs_out=True)))
    unweighed = replace(arm, links=(replace(arm.links[0], mass=None), *arm.links[1:]))
    for wrong, error, said in (
        (forked, InputError, "branches: end in several tips"),
        (boom, InputError, "link 4: runs out of a sleeve"),
        (unweighed, PropertyNeeded, "the mass of link 1 is unknown"),
    ):
        with pytest.raises(error, match=said):
            inverse_dynamics(motion_of(wrong, still, still, still))
