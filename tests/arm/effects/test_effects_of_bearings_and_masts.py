"""What gives beside links and drives: bearings across their axes, masts and booms along which slides travel."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.evaluation import evaluate
from tests.arm.effects.effect_states import moved

G = 9.81
UPRIGHT, LEVEL = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)


def carried(joints: tuple[Joint, ...], lengths: tuple[float, ...], q: list[float], load: LoadCase) -> PoseState:
    """A weightless arm of rigid links under gravity along -z, at one pose."""
    links = tuple(Link(length, mass=0.0) for length in lengths)
    arm = Arm("made", joints, links, gravity=(0.0, 0.0, -G), payload=load)
    beams = [Beam(length) for length in lengths]
    return solve(arm, [np.array([item]) for item in q], beams)


def tip(state: PoseState, effect: str, **values: float) -> np.ndarray:
    return moved(state, effect, values)[0]


def test_a_bearing_tilts_by_the_moment_across_its_axis() -> None:
    """A level arm on an upright axis: the payload tilts it by c m g L, and the tip drops by L times that."""
    joint = Joint(axis=UPRIGHT, range=(-3.0, 3.0))
    for angle in (0.0, 0.7, -2.0):
        state = carried((joint,), (1.5,), [angle], LoadCase(4.0))
        result = tip(state, "lateral_compliance", compliance=1e-6)
        assert result == pytest.approx([0.0, 0.0, -1e-6 * 4.0 * G * 1.5**2], rel=1e-9, abs=1e-15)


def test_a_joint_brings_the_stiffness_of_its_bearing() -> None:
    """As the compliance that is one over it, without being named; on top of what `effects` names."""
    joint = Joint(axis=UPRIGHT, range=(-3.0, 3.0), tilting_stiffness=2.5e5)
    link = Link(1.5, mass=0.0)
    arm = Arm("made", (joint,), (link,), gravity=(0.0, 0.0, -G), payload=LoadCase(4.0))
    drop = 4.0 * G * 1.5**2 / 2.5e5
    result = evaluate(arm)
    assert result.max_error == pytest.approx(drop, rel=1e-9)
    assert result.by_effect["lateral_compliance"] == pytest.approx(drop, rel=1e-9)
    assert 1.0 / result.stiffness.value == pytest.approx(1.5**2 / 2.5e5, rel=1e-9)
    both = replace(arm, effects=(EffectEntry("lateral_compliance", (1,), {"compliance": 1e-6}),))
    assert evaluate(both).max_error == pytest.approx(drop * (1.0 + 2.5e5 * 1e-6), rel=1e-9)
    without = replace(arm, leave_out=frozenset({"lateral_compliance"}))
    assert evaluate(without).max_error == pytest.approx(0.0, abs=1e-15)


def test_a_bearing_swings_out_of_the_plane_and_sideways_alone() -> None:
    """A planar arm errs none by its bearing; across its plane a force tilts it by F L, so that K/L^2 is its stiffness;
    a mass at the end of a level arm on an upright axis swings at sqrt(K/(m L^2))/2 pi."""
    joint = Joint(axis=UPRIGHT, range=(-1.0, 1.0), tilting_stiffness=4e5, stiffness=1e9)
    planar = Arm("flat", (joint,), (Link(2.0, mass=0.0),), payload=LoadCase(5.0))
    result = evaluate(planar)
    assert "lateral_compliance" not in result.by_effect
    assert result.sideways.value == pytest.approx(4e5 / 2.0**2, rel=1e-9)
    level = evaluate(replace(planar, gravity=(0.0, 0.0, -G)))
    assert level.frequency.value == pytest.approx(math.sqrt(4e5 / 5.0) / 2.0 / (2.0 * math.pi), rel=1e-3)


def test_a_drive_carries_what_is_about_the_axis() -> None:
    """An axis across a level arm: all of the payload's moment is about it, and the bearing has nothing to bear."""
    joint = Joint(axis=(0.0, 1.0, 0.0), range=(-3.0, 3.0))
    state = carried((joint,), (1.5,), [0.0], LoadCase(4.0))
    assert tip(state, "lateral_compliance", compliance=1e-6) == pytest.approx([0.0] * 3, abs=1e-15)
    drop = [0.0, 0.0, -1e-6 * 4.0 * G * 1.5**2]
    assert tip(state, "joint_compliance", compliance=1e-6) == pytest.approx(drop, rel=1e-9, abs=1e-15)


@given(st.floats(-3.0, 3.0), st.floats(-1.5, 1.5), st.tuples(*[st.floats(-50.0, 50.0)] * 3))
def test_the_first_bearing_is_the_base_where_its_axis_is_upright(
    turn: float, lift: float, force: tuple[float, float, float]
) -> None:
    """The base tilts about x and y alone, and so does what turns about z on it."""
    joints = (Joint(axis=UPRIGHT, range=(-3.0, 3.0)), Joint(axis=(0.0, 1.0, 0.0), range=(-2.0, 2.0)))
    state = carried(joints, (0.0, 1.2), [turn, lift], LoadCase(3.0, force))
    bearing = moved(state, "lateral_compliance", {"compliance": 2e-6}, (0,))[0]
    assert bearing == pytest.approx(tip(state, "base_compliance", compliance=2e-6), rel=1e-9, abs=1e-13)


@pytest.mark.parametrize("height", [0.0, 0.4, 1.1, 2.0])
@pytest.mark.parametrize("before", [0.0, 0.3])
def test_a_mast_bends_as_a_cantilever_up_to_its_carriage(height: float, before: float) -> None:
    """A boom of length a on a mast's carriage at height h, payload P and side force H at its tip (Gere & Goodno, table
    of cantilevers): across P a h^2/(2EI) + H h^3/(3EI), slope P a h/EI + H h^2/(2EI), by which the tip drops a times.
    """
    ei, boom, weight, side = 2.5e5, 0.8, 12.0 * G, 60.0
    slide = Joint("prismatic", axis=UPRIGHT, range=(0.0, 2.0))
    link = Link(boom, mass=0.0, direction=LEVEL)
    arm = Arm("mast", (slide,), (link,), gravity=(0.0, 0.0, -G), payload=LoadCase(12.0, (side, 0.0, 0.0)))
    state = solve(arm, [np.array([height])], [Beam(boom)])
    h = height + before
    across = (weight * boom * h**2 / 2.0 + side * h**3 / 3.0) / ei
    slope = (weight * boom * h + side * h**2 / 2.0) / ei
    result = tip(state, "column_bending", flexibility=1.0 / ei, length_at_zero=before)
    assert result == pytest.approx([across, 0.0, -slope * boom], rel=1e-9, abs=1e-15)


def test_a_boom_bends_by_its_own_reach() -> None:
    """A level slide pushed out by h with the payload at its carriage: P h^3/(3EI), whichever way it is pushed."""
    for way in (1.0, -1.0):
        slide = Joint("prismatic", axis=(way, 0.0, 0.0), range=(0.0, 2.0))
        state = carried((slide,), (0.0,), [1.5], LoadCase(10.0))
        result = tip(state, "column_bending", flexibility=1e-6)
        assert result == pytest.approx([0.0, 0.0, -10.0 * G * 1.5**3 / 3.0 * 1e-6], rel=1e-9, abs=1e-15)
