"""Exact motion against an independent rod, trigonometry and first order."""

import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.exact import deformed
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, seen_of_model
from linkwright.core.arm.errors.tip import ActiveEffect, active_effects, carried_to_tip
from tests.cosserat_rod import Rod, rod_tip
from tests.costs import slow_but
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip, poses


def columns(vector, rows):
    return np.stack([np.broadcast_to(np.asarray(x, dtype=float), (rows,)) for x in vector], axis=1)


def state_of(q, arm=None):
    arm = arm or planar_arm()
    return solve(arm, [q[:, k] for k in range(arm.size)], beams_of(arm))


def at_work(effect, at, **values):
    return ActiveEffect(EFFECTS[effect], Settings(at, MappingProxyType(values)))


def first_order(state, effects, rows):
    return columns(carried_to_tip(state, [t for e in effects for t in e.effect.twists(state, e.settings)]), rows)


def random_rods(rng, spatial):
    """Thin-walled aluminium tubes with drives that give; in space as wide as they are not high."""
    axes = [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)] if spatial else [(0.0, 0.0, 1.0)] * 3
    rods = []
    for axis in axes:
        diameter, wall = rng.uniform(0.045, 0.09), rng.uniform(0.002, 0.004)
        area, second_moment = math.pi * diameter * wall, math.pi * diameter**3 * wall / 8.0
        aspect = rng.uniform(0.6, 1.6) if spatial else 1.0
        rods.append(
            Rod(
                length=rng.uniform(0.3, 0.7),
                axis=axis,
                compliance=rng.uniform(0.0, 2e-5),
                axial=70e9 * area,
                shear_y=13e9 * area,
                shear_z=13e9 * area,
                torsion=52e9 * second_moment,
                bend_y=70e9 * second_moment * aspect,
                bend_z=70e9 * second_moment / aspect,
                mass_per_length=2700.0 * area,
                joint_mass=rng.uniform(0.0, 6.0),
            )
        )
    return rods


def rods_as_arm(rods, gravity, payload, force):
    joints = tuple(Joint(axis=rod.axis, stiffness=1.0 / rod.compliance, mass=rod.joint_mass) for rod in rods)
    beams = tuple(
        Beam(
            length=rod.length,
            mass_per_length=rod.mass_per_length,
            axial_rigidity=rod.axial,
            flexural_rigidity_height=rod.bend_y,
            flexural_rigidity_width=rod.bend_z,
            torsional_rigidity=rod.torsion,
            shear_rigidity_height=rod.shear_y,
            shear_rigidity_width=rod.shear_z,
        )
        for rod in rods
    )
    links = tuple(Link(rod.length) for rod in rods)
    return Arm("rods", joints, links, gravity=gravity, payload=LoadCase(mass=payload, force=force)), beams


@pytest.mark.parametrize("seed", slow_but(range(20), *range(5)))
@pytest.mark.parametrize("spatial", [False, True], ids=["plane", "space"])
def test_bent_arms_stand_where_an_exact_rod_does(seed, spatial):
    """Arms that bend by 1 to 10 mm, within 0.5 um RMS; first order misses by 100 times that where they bend most."""
    rng = np.random.default_rng([seed, spatial])
    rods = random_rods(rng, spatial)
    gravity = (0.0, 0.0, -9.81) if spatial else (0.0, -9.81, 0.0)
    q = rng.uniform(-1.5, 1.5, (3, len(rods)))
    direction = rng.standard_normal(3) * ([1, 1, 1] if spatial else [1, 1, 0])
    force = 20.0 * direction / np.linalg.norm(direction)
    payload = 3.0
    while True:  # the load that bends this arm by 1 to 10 mm
        arm, beams = rods_as_arm(rods, gravity, payload, tuple(force.tolist()))
        state = solve(arm, [q[:, k] for k in range(arm.size)], beams)
        bent = np.sqrt(np.mean(np.sum(first_order(state, active_effects(arm), 3) ** 2, axis=1)))
        if bent < 10e-3:
            break
        payload, force = 0.7 * payload, 0.7 * force
        rods = [replace(rod, bend_y=1.3 * rod.bend_y, bend_z=1.3 * rod.bend_z) for rod in rods]
    result = deformed(state, active_effects(arm), 3)
    nominal = columns(state.tip(), 3)
    exact = [rod_tip(rods, item, np.array(gravity), payload, np.array(force)) for item in q]
    off = nominal + result.tip - np.array([place for place, _ in exact])
    assert result.settled.all()
    assert bent > 0.5e-3
    assert np.sqrt(np.mean(np.sum(off**2, axis=1))) < 0.5e-6


def test_first_order_is_what_small_loads_leave():
    """Exact less linear falls with the square of the load."""
    rods = random_rods(np.random.default_rng(3), True)
    q = np.random.default_rng(4).uniform(-1.5, 1.5, (5, 4))
    beyond = []
    for factor in (1.0, 0.1):
        arm, beams = rods_as_arm(rods, (0.0, 0.0, -9.81 * factor), 4.0, (0.0, 0.0, 0.0))
        state = solve(arm, [q[:, k] for k in range(4)], beams)
        linear = first_order(state, active_effects(arm), 5)
        beyond.append(np.linalg.norm(deformed(state, active_effects(arm), 5).tip - linear))
    assert beyond[0] / beyond[1] == pytest.approx(100.0, rel=0.05)


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_a_zero_off_by_degrees_is_exact(joint):
    q = poses(25)
    off = np.zeros(3)
    off[joint] = math.radians(4.0)
    state, effects = state_of(q), [at_work("encoder_offset", (joint,), offset=off[joint])]
    exact = planar_tip(q + off) - planar_tip(q)
    np.testing.assert_allclose(deformed(state, effects, 25).tip[:, :2], exact, atol=1e-14)
    assert np.abs(first_order(state, effects, 25)[:, :2] - exact).max() > 1e-4


def test_motions_of_several_joints_and_lengths_compose():
    q = poses(25, seed=5)
    off, longer = np.radians([1.0, -2.0, 3.0]), np.array([0.004, -0.006, 0.002])
    effects = [at_work("encoder_offset", (k,), offset=off[k]) for k in range(3)]
    effects += [at_work("link_length", (k,), length=longer[k]) for k in range(3)]
    exact = planar_tip(q + off, tuple(np.add(LENGTHS, longer))) - planar_tip(q)
    np.testing.assert_allclose(deformed(state_of(q), effects, 25).tip[:, :2], exact, atol=1e-14)


def test_a_longer_link_bends_as_one_that_was_drawn_longer():
    """A length off by 50 mm: bending, weights and torques are those of the true length."""
    rods = random_rods(np.random.default_rng(7), False)
    q = np.random.default_rng(8).uniform(-1.5, 1.5, (4, 3))
    gravity = (0.0, -9.81, 0.0)
    arm, beams = rods_as_arm(rods, gravity, 2.0, (0.0, 0.0, 0.0))
    state = solve(arm, [q[:, k] for k in range(3)], beams)
    result = deformed(state, [*active_effects(arm), at_work("link_length", (1,), length=0.05)], 4)
    truth = [rods[0], replace(rods[1], length=rods[1].length + 0.05), rods[2]]
    exact = np.array([rod_tip(truth, item, np.array(gravity), 2.0, np.zeros(3))[0] for item in q])
    assert np.linalg.norm(columns(state.tip(), 4) + result.tip - exact, axis=1).max() < 0.5e-6


def test_an_instrument_that_is_off_moves_nothing_of_the_arm():
    """Its frame turned by 20 mrad: the arm hangs as before, and is seen turned."""
    q = poses(6)
    state = state_of(q)
    turn = 0.02
    result = deformed(state, [at_work("frame_misalignment", (), about_z=turn, x=1e-3)], 6)
    tip = planar_tip(q)
    c, s = math.cos(turn), math.sin(turn)
    np.testing.assert_allclose(result.tip[:, :2], tip @ np.array([[c, s], [-s, c]]) + [1e-3, 0.0] - tip, atol=1e-12)


def test_an_arm_about_to_buckle_is_not_said_to_have_settled():
    """Far beyond what it carries no shape is found, and that is said."""
    rods = [replace(rod, bend_y=2.0, bend_z=2.0) for rod in random_rods(np.random.default_rng(1), False)]
    arm, beams = rods_as_arm(rods, (0.0, -9.81, 0.0), 50.0, (0.0, 0.0, 0.0))
    state = solve(arm, [np.array([1.5]), np.array([0.1]), np.array([0.0])], beams)
    assert not deformed(state, active_effects(arm), 1).settled.any()


def test_a_model_has_its_listed_effects_as_finite_motions():
    """An offset among the arm's effects moves the tip as the same offset in the joint's zero does."""
    q = poses(25)
    arm = planar_arm()
    listed = replace(arm, effects=(EffectEntry("encoder_offset", (2,), MappingProxyType({"offset": 0.05})),))
    tip = seen_of_model(state_of(q, listed), active_effects(listed), Asked(25)).tip
    np.testing.assert_allclose(tip[:, :2], planar_tip(q + np.array([0.0, 0.05, 0.0])) - planar_tip(q), atol=1e-14)
