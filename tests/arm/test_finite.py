"""Finite motions along a chain against trigonometry and against first order."""

import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from arm.chain import EffectEntry
from arm.effects import EFFECTS, Settings, Twist
from arm.error import active_effects, carried_to_tip
from arm.finite import beyond_first_order
from arm.model import beams_of
from arm.recorded import Asked, seen_of_model
from arm.statics import solve
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip, poses


def state_of(q, arm=None):
    arm = arm or planar_arm()
    return solve(arm, [q[:, k] for k in range(arm.size)], beams_of(arm))


def moved(state, effect, index, values, rows):
    """First order and what lies beyond, added up."""
    twists = list(EFFECTS[effect].twists(state, Settings(index, MappingProxyType(values))))
    first = np.stack([np.broadcast_to(np.asarray(x, dtype=float), (rows,)) for x in carried_to_tip(state, twists)], 1)
    return first, first + beyond_first_order(state, twists, rows)[0]


@pytest.mark.parametrize("joint", [0, 1, 2])
def test_a_zero_off_by_degrees_is_exact(joint):
    q = poses(25)
    off = np.zeros(3)
    off[joint] = math.radians(4.0)
    first, whole = moved(state_of(q), "encoder_offset", (joint,), {"offset": off[joint]}, 25)
    exact = planar_tip(q + off) - planar_tip(q)
    np.testing.assert_allclose(whole[:, :2], exact, atol=1e-14)
    assert np.abs(first[:, :2] - exact).max() > 1e-4


def test_motions_of_several_joints_and_lengths_compose():
    q = poses(25, seed=5)
    off, longer = np.radians([1.0, -2.0, 3.0]), np.array([0.004, -0.006, 0.002])
    state = state_of(q)
    twists: list[Twist] = []
    for k in range(3):
        twists += EFFECTS["encoder_offset"].twists(state, Settings((k,), MappingProxyType({"offset": off[k]})))
        twists += EFFECTS["link_length"].twists(state, Settings((k,), MappingProxyType({"length": longer[k]})))
    first = np.stack([np.asarray(x, dtype=float) + np.zeros(25) for x in carried_to_tip(state, twists)], axis=1)
    exact = planar_tip(q + off, tuple(np.add(LENGTHS, longer))) - planar_tip(q)
    np.testing.assert_allclose((first + beyond_first_order(state, twists, 25)[0])[:, :2], exact, atol=1e-14)


def test_what_lies_beyond_falls_with_the_square():
    q = poses(25)
    state = state_of(q)
    sizes = []
    for offset in (1e-2, 1e-3):
        first, whole = moved(state, "encoder_offset", (1,), {"offset": offset}, 25)
        sizes.append(np.linalg.norm(whole - first))
    assert sizes[0] / sizes[1] == pytest.approx(100.0, rel=0.02)


def test_a_model_has_its_listed_effects_as_finite_motions():
    """An offset among the arm's effects moves the tip as the same offset in the joint's zero does."""
    q = poses(25)
    arm = planar_arm()
    listed = replace(arm, effects=(EffectEntry("encoder_offset", (2,), MappingProxyType({"offset": 0.05})),))
    tip = seen_of_model(state_of(q, listed), active_effects(listed), Asked(25)).tip
    np.testing.assert_allclose(tip[:, :2], planar_tip(q + np.array([0.0, 0.05, 0.0])) - planar_tip(q), atol=1e-14)
