"""The arm's mechanics against an independent frame solver, and against the paper's own arm."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.kinematics import place, section_directions
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.vectors import from_roll_pitch_yaw, unit
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.limits.modes import segmented
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build
from tests import frame_solver
from tests.arm.builders import arm_of, chain_arm, chain_motion, elastic_motion, rod_lines
from tests.random_chains import (
    RandomChain,
    build_frame,
    random_planar_chain,
    random_spatial_chain,
    tip_motion,
)

MAKERS = [random_planar_chain, random_spatial_chain]
ChainMaker = Callable[..., RandomChain]


def agree(ours: np.ndarray, theirs: np.ndarray, relative: float) -> bool:
    return float(np.linalg.norm(ours - theirs)) <= relative * float(np.linalg.norm(theirs)) + 1e-18


# Both sides are first-order theory on straight members, so they differ by rounding only: 8e-10 was the most
# seen over 200 chains (in the plane, without shear); 1e-8 leaves a factor of ten.
@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("shear", [False, True])
@pytest.mark.parametrize("seed", range(50))
def test_tip_moves_and_turns_as_the_frame_solver_says(maker: ChainMaker, shear: bool, seed: int) -> None:
    chain = maker(np.random.default_rng([seed, 4]))
    displacement, rotation = chain_motion(chain, shear=shear)
    expected_displacement, expected_rotation = tip_motion(chain, shear=shear)
    assert agree(displacement, expected_displacement, 1e-8)
    assert agree(rotation, expected_rotation, 1e-8)


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("part", ["joint_mass", "joint_stiffness", "payload_mass", "tip_force"])
def test_each_kind_of_load_and_softness_counts_as_in_the_frame_solver(maker: ChainMaker, part: str) -> None:
    """The difference that one part makes agrees, so nothing is missed by being small in the sum."""
    chain = maker(np.random.default_rng(11), links=3)
    sideways = 0.0 if maker is random_planar_chain else 9.0
    chain = replace(chain, payload_mass=2.5, tip_force=(30.0, -20.0, sideways))
    chain = replace(chain, links=tuple(replace(x, joint_mass=4.0, joint_stiffness=3e4) for x in chain.links))
    without = {
        "joint_mass": replace(chain, links=tuple(replace(x, joint_mass=0.0) for x in chain.links)),
        "joint_stiffness": replace(chain, links=tuple(replace(x, joint_stiffness=None) for x in chain.links)),
        "payload_mass": replace(chain, payload_mass=0.0),
        "tip_force": replace(chain, tip_force=(0.0, 0.0, 0.0)),
    }[part]
    ours = chain_motion(chain, shear=True)[0] - chain_motion(without, shear=True)[0]
    theirs = tip_motion(chain)[0] - tip_motion(without)[0]
    assert np.linalg.norm(theirs) > 1e-6
    assert agree(ours, theirs, 1e-7)


@pytest.mark.parametrize("maker", MAKERS)
def test_compiled_model_gives_the_same_vector_as_plain_numbers(maker: ChainMaker) -> None:
    """The arm of a random chain through `error_model`, whose symbols stand for the links' rigidities."""
    for seed in range(5):
        chain = maker(np.random.default_rng([seed, 9]))
        arm, beams, q = chain_arm(chain, shear=True)
        # Any section and material make a link elastic; the rigidities in p are the chain's own.
        stand_in = arm_with_rods(arm)
        vector = error_model(stand_in).cases[0].arrays(np.array([q]), beam_values(beams)).vector[0]
        assert agree(vector, tip_motion(chain)[0], 1e-8)


def arm_with_rods(arm: Arm) -> Arm:
    material = load_catalogue(user=False).find("steel-s355")
    section = build("circle", {"diameter": 0.05})
    return arm.with_links(tuple(replace(link, section=section, material=material) for link in arm.links))


@pytest.mark.parametrize("pieces", [2, 5])
def test_dividing_the_links_changes_nothing(pieces: int) -> None:
    """A link cut into rigidly joined pieces bends as before, weight and all (uniform load is exact per piece)."""
    for seed in range(6):
        chain = random_spatial_chain(np.random.default_rng([seed, 2]))
        arm, beams, q = chain_arm(chain, shear=True)
        joints: list[Joint] = []
        links: list[Link] = []
        shares: list[Beam] = []
        angles: list[float] = []
        for joint, link, beam, angle in zip(arm.joints, arm.links, beams, q, strict=True):
            height, _ = section_directions(link, joint)
            joints += [joint] + [Joint()] * (pieces - 1)
            angles += [angle] + [0.0] * (pieces - 1)
            links += [Link(link.length / pieces, height_direction=height)] * pieces
            shares += [replace(beam, length=beam.length / pieces)] * pieces
        cut = replace(arm, joints=tuple(joints), links=tuple(links))
        displacement, rotation = elastic_motion(cut, solve(cut, angles, shares))
        whole = elastic_motion(arm, solve(arm, q, beams))
        assert agree(displacement, whole[0], 1e-10)
        assert agree(rotation, whole[1], 1e-10)
        frame, tip = build_frame(chain, pieces=pieces)
        assert agree(displacement, frame_solver.solve(frame)[tip][:3], 1e-7)


def test_segments_of_the_frequency_model_keep_lengths_and_directions() -> None:
    chain = random_spatial_chain(np.random.default_rng(3), links=3)
    arm, _, _ = chain_arm(chain, shear=True)
    pieces = segmented(arm_with_rods(arm))
    (way,) = pieces.ways
    for number, length in enumerate(arm.lengths):
        own = [link.length for link, owner in zip(way.arm.links, pieces.owner, strict=True) if owner == number]
        assert math.isclose(sum(own), length, rel_tol=1e-12)


# ---- a tool, shifted and turned joints, slides: by virtual work on rigid bodies


@pytest.mark.parametrize("seed", range(20))
def test_drive_loads_are_the_derivatives_of_the_loads_work(seed: int) -> None:
    """tau_i = d(work of all dead loads)/dq_i, with offsets, turned joints, slides, rigid links and a tool."""
    rng = np.random.default_rng(seed)
    arm = odd_arm(rng)
    beams = tuple(
        Beam(length=link.length, mass_per_length=float(rng.uniform(0.0, 9.0)), lumped_mass=float(rng.uniform(0.0, 5.0)),
             lumped_at=float(rng.uniform(0.0, 0.5)))
        for link in arm.links
    )  # fmt: skip
    q = rng.uniform(-1.0, 1.0, arm.size)

    def work(at: np.ndarray) -> float:
        frames = place(arm, at.tolist())
        gravity, here, total = np.array(arm.gravity), np.zeros(3), 0.0
        for joint, frame, link, beam in zip(frames.joints, frames.links, arm.joints, beams, strict=True):
            here = here + np.array(joint.lead)
            total += link.mass * gravity @ here
            along, vector = np.array(frame.along), np.array(frame.vector)
            total += beam.mass_per_length * beam.length * gravity @ (here + 0.5 * vector)
            total += beam.lumped_mass * gravity @ (here + beam.lumped_at * along)
            here = here + vector
        tip = np.array(frames.tip())
        return float(total + (arm.payload.mass * gravity + np.array(arm.payload.force)) @ tip)

    state = solve(arm, q.tolist(), beams)
    step = 1e-6
    for index in range(arm.size):
        shift = np.eye(arm.size)[index] * step
        expected = (work(q + shift) - work(q - shift)) / (2.0 * step)
        assert state.joints[index].drive_load == pytest.approx(expected, abs=2e-6)


def odd_arm(rng: np.random.Generator) -> Arm:
    """Four joints with turned and shifted frames, one of them a slide, and a tool beside the last link."""

    def direction() -> tuple[float, float, float]:
        x, y, z = rng.normal(size=3)
        return unit((x, y, z))

    slide = int(rng.integers(4))
    joints = tuple(
        Joint(
            "prismatic" if index == slide else "revolute",
            axis=direction(),
            range=(-1.0, 1.0),
            mass=float(rng.uniform(0.0, 5.0)),
            zero=float(rng.normal()) * 0.1,
            origin_rotation=from_roll_pitch_yaw(*rng.normal(size=3)),
            origin_translation=tuple(rng.normal(size=3) * 0.1),  # type: ignore[arg-type]
        )
        for index in range(4)
    )
    links = tuple(
        Link(
            float(rng.uniform(0.1, 0.6)),
            direction=direction(),
            end_rotation=from_roll_pitch_yaw(*rng.normal(size=3)),
        )
        for _ in range(4)
    )
    load = LoadCase(2.0, (5.0, -3.0, 8.0))
    return Arm("odd", joints, links, gravity=(1.0, -9.0, 3.0), payload=load, tool=(0.05, -0.1, 0.02))


# ---- the paper's arm


RODS = rod_lines([400, 420, 420], joint=", range: [-120 deg, 120 deg]")


def test_paper_arm_sags_as_one_cantilever(tmp_path: Path) -> None:
    """Straight out and clamped, three rods are one: q L^4/(8 E I) = 0.17640 mm (Gere & Goodno, cantilever tables)."""
    arm = arm_of(f"name: rods\n{RODS}leave_out: [shear_deformation]\n", tmp_path)
    result = evaluate(arm)
    by_hand = 1e3 * 2700 * 9.81 * (math.pi / 4 * 0.1**2) * 1.24**4 / (8 * 71e9 * math.pi / 64 * 0.1**4)
    assert by_hand == pytest.approx(0.17640, abs=5e-6)
    assert result.max_error * 1e3 == pytest.approx(by_hand, rel=1e-9)
    assert result.worst.poses[0].q == pytest.approx((0.0, 0.0, 0.0), abs=1e-5)


def test_paper_arm_without_slopes_sags_a_quarter_of_that(tmp_path: Path) -> None:
    """Each link's own cantilever deflection only, as the paper adds them up: 0.0449 mm (0.04493)."""
    arm = arm_of(f"name: rods\n{RODS}leave_out: [shear_deformation, slope_propagation]\n", tmp_path)
    rigidity = 71e9 * math.pi / 64 * 0.1**4
    per_length = 2700 * 9.81 * math.pi / 4 * 0.1**2
    beyond, expected = 0.0, 0.0
    for length in (0.42, 0.42, 0.4):  # from the tip inwards; `beyond` is the length that the link carries
        force, moment = per_length * beyond, per_length * beyond**2 / 2
        expected += (force * length**3 / 3 + moment * length**2 / 2 + per_length * length**4 / 8) / rigidity
        beyond += length
    assert 1e3 * expected == pytest.approx(0.04493, abs=5e-6)
    assert evaluate(arm).max_error == pytest.approx(expected, rel=1e-9)


def test_paper_arm_with_its_tool(tmp_path: Path) -> None:
    """A tool of 7.6 N, as the paper's figures imply, adds F L^3/(3 E I) = 0.01386 mm: 0.19026 mm in all."""
    text = f"name: rods\n{RODS}payload: {{mass: 0.77472 kg}}\nleave_out: [shear_deformation]\n"
    added = 0.77472 * 9.81 * 1.24**3 / (3 * 71e9 * math.pi / 64 * 0.1**4)
    assert 0.17640 + 1e3 * added == pytest.approx(0.19026, abs=1e-5)
    assert evaluate(arm_of(text, tmp_path)).max_error * 1e3 == pytest.approx(0.19026, abs=5e-6)


def test_shear_adds_the_cantilevers_shear_deflection(tmp_path: Path) -> None:
    """w L^2/(2 G A_s) on top, with the circle's A_s = kappa A by strain energy, nu = 0.33."""
    with_shear = arm_of(f"name: rods\n{RODS}", tmp_path)
    section = with_shear.links[0].section
    assert section is not None
    area = section.properties(0.33).shear_area_z
    modulus = 71e9 / (2 * 1.33)
    added = 2700 * 9.81 * math.pi / 4 * 0.1**2 * 1.24**2 / (2 * modulus * area)
    without = evaluate(replace(with_shear, leave_out=frozenset({"shear_deformation"}))).max_error
    assert evaluate(with_shear).max_error - without == pytest.approx(added, rel=1e-6)
    assert [beam.length for beam in beams_of(with_shear)] == [0.4, 0.42, 0.42]
