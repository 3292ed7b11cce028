"""Loads on drives by virtual work: what all weights and forces do as one coordinate moves, by the places alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.balance import IdealCounterbalance, PointMass, SpringCounterbalance
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.following import Following, Tie, turns
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.vectors import IDENTITY, from_roll_pitch_yaw
from linkwright.core.arm.effects.effect import drive_motion
from linkwright.core.arm.errors.tip import carried_to_tip
from linkwright.core.sections.numeric import Array

PULL = np.array([1.0, -9.0, 3.0])
FORCE = np.array([20.0, -5.0, 8.0])
PAYLOAD = 4.0
STEP = 1e-5


def drawn(seed: int) -> tuple[Arm, list[Beam], Array]:
    """A random arm: turning and sliding joints, offsets, followers, springs, what hangs."""
    random = np.random.default_rng(seed)
    size = int(random.integers(2, 6))

    def some(chance: float) -> bool:
        return bool(random.random() < chance)

    def vector(most: float) -> tuple[float, float, float]:
        x, y, z = random.uniform(-most, most, 3).tolist()
        return x, y, z

    joints: list[Joint] = []
    links: list[Link] = []
    for index in range(size):
        slides = some(0.3)
        axis = random.standard_normal(3)
        made = Joint("prismatic" if slides else "revolute", tuple((axis / np.linalg.norm(axis)).tolist()), mass=2.0)
        if some(0.5):
            made = replace(made, origin_translation=vector(0.2), origin_rotation=from_roll_pitch_yaw(*vector(1.0)))
        if index and some(0.5):
            driven = [number for number, joint in enumerate(joints) if joint.driven]
            tie = Tie(int(random.choice(driven)), float(random.uniform(-2.0, 2.0)))
            made = replace(made, follows=Following((tie,), 0.1, driven=some(0.6)))
        if not slides and some(0.3):
            spring = SpringCounterbalance(900.0, 0.1, 0.3, 1.2, 0.05, 5.0)
            made = replace(made, counterbalance=spring if some(0.5) else IdealCounterbalance(30.0, 0.4))
        joints.append(made)
        hung = tuple(PointMass(3.0, vector(0.2), "joint" if some(0.5) else "end") for _ in range(int(some(0.5))))
        links.append(Link(0.5, masses=hung))
    beams = [
        Beam(length=0.5, mass_per_length=6.0, lumped_mass=1.5, lumped_at=0.2, first_moment=vector(0.3)) for _ in links
    ]
    arm = Arm("any", tuple(joints), tuple(links), gravity=tuple(PULL.tolist()), tool=vector(0.1))
    arm = replace(arm, payload=LoadCase(PAYLOAD, tuple(FORCE.tolist())))
    return arm, beams, random.uniform(0.2, 0.9, size)


def work(arm: Arm, beams: list[Beam], q: Array) -> float:
    """What weights and forces have done up to a pose, but for a constant, J; by where each sits."""
    frames = place(arm, list(q), [beam.length for beam in beams])
    at, total = np.zeros(3), 0.0
    for index, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        beam, frame = beams[index], frames.links[index]
        axes, vector = np.array([frame.along, frame.height, frame.width]), np.array(frame.vector)
        at = at + np.array(frames.joints[index].lead)
        total += joint.mass * float(PULL @ at)
        total += beam.mass_per_length * beam.length * float(PULL @ (at + 0.5 * vector))
        total += beam.lumped_mass * float(PULL @ (at + beam.lumped_at * axes[0]))
        total += float(PULL @ (np.array(beam.first_moment) @ axes))
        for mass in link.masses:
            total += mass.mass * float(PULL @ (at + np.array(mass.at) @ axes + (vector if mass.on == "end" else 0.0)))
        at = at + vector
    at = at + np.array(frames.tool, dtype=float)
    return total + float((FORCE + PAYLOAD * PULL) @ at)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_drive_holds_what_its_coordinate_does_against_weights_and_forces(seed: int) -> None:
    """The drive's load is the slope of the work by its coordinate, and what its counterbalance takes off it."""
    arm, beams, q = drawn(seed)
    state, turned = solve(arm, q.tolist(), beams), turns(arm, q.tolist())
    for index, joint in enumerate(arm.joints):
        if not joint.driven:
            continue
        step = STEP * np.eye(arm.size)[index]
        slope = (work(arm, beams, q + step) - work(arm, beams, q - step)) / (2.0 * STEP)
        balanced = 0.0 if joint.counterbalance is None else joint.counterbalance.turning(turned[index])
        assert state.joints[index].drive_load == pytest.approx(slope + balanced, rel=1e-6, abs=1e-5)


def held_against_the_base(seed: int) -> tuple[Arm, list[Beam], Array]:
    """The same with absolute angles: axes along z, slides and offsets between, a tool, a moment at the tip."""
    arm, beams, q = drawn(seed)
    joints = [
        replace(
            joint,
            axis=(0.0, 0.0, 1.0) if joint.revolute else joint.axis,
            origin_rotation=IDENTITY,
            follows=None,
            counterbalance=None,
        )
        for joint in arm.joints
    ]
    return replace(arm, joints=tuple(joints), angles="absolute"), beams, q


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_drives_that_hold_their_links_against_the_base_turn_the_tool_and_what_rides_on_slides(seed: int) -> None:
    """By the same work; a moment at the tip does work only where the tool turns. A drive's motion moves the tip as the
    places say."""
    arm, beams, q = held_against_the_base(seed)
    moment = 7.0
    arm = replace(arm, payload=replace(arm.payload, moment=(0.0, 0.0, moment)))
    state, moved = solve(arm, q.tolist(), beams), jacobian(arm, q[None])[0]
    turning = [index for index, joint in enumerate(arm.joints) if joint.revolute]
    for index in range(arm.size):
        step = STEP * np.eye(arm.size)[index]
        slope = (work(arm, beams, q + step) - work(arm, beams, q - step)) / (2.0 * STEP)
        own = moment if turning and index == turning[-1] else 0.0
        assert state.joints[index].drive_load == pytest.approx(slope + own, rel=1e-6, abs=1e-5)
        by_place = (tip_position(arm, q + step) - tip_position(arm, q - step))[0] / (2.0 * STEP)
        assert moved[index] == pytest.approx(by_place, abs=1e-8)
        twists = drive_motion(state, index, 1.0)
        assert np.array(carried_to_tip(state, twists)) == pytest.approx(by_place, abs=1e-8)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_base_carries_all_weights_and_forces(seed: int) -> None:
    """The force at the first joint, whose own mass stands on the base."""
    arm, beams, q = drawn(seed)
    arm = replace(arm, joints=tuple(replace(joint, follows=None) for joint in arm.joints))
    base = solve(arm, q.tolist(), beams).joints[0]
    hung = sum(mass.mass for link in arm.links for mass in link.masses)
    weight = sum(beam.mass for beam in beams) + hung + 2.0 * (arm.size - 1) + PAYLOAD
    assert np.array(base.force) == pytest.approx(weight * PULL + FORCE, rel=1e-12)
