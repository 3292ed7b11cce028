"""Where the tip is: against 4x4 matrices multiplied out here, for real robots' parameters and for random chains."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.vectors import from_roll_pitch_yaw, to_roll_pitch_yaw
from linkwright.core.sections.numeric import Array
from tests.arm.builders import arm_of
from tests.random_chains import places, random_spatial_chain, rotation_about

# Universal Robots, "DH parameters for calculations of kinematics and dynamics", UR10 (a, d in mm, alpha in degrees).
UR10 = [(0, 127.3, 90), (-612, 0, 0), (-572.3, 0, 0), (0, 163.941, 90), (0, 115.7, -90), (0, 92.2, 0)]

# Motoman MA2010 (an open data set's nominal model): axes and offsets at zero, mm.
MA2010_AXES = [(0, 0, 1), (0, 1, 0), (0, -1, 0), (-1, 0, 0), (0, -1, 0), (-1, 0, 0)]
MA2010_OFFSETS = [(0, 0, 0), (150, 0, 0), (0, 0, 760), (1082, 0, 200), (0, 0, 0), (0, 0, 0), (100, 0, 0)]


def transform(rotation: Array, translation: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


def denavit_hartenberg(a: float, d: float, alpha: float, theta: float) -> Array:
    """The classic matrix (Denavit & Hartenberg 1955, distal form), written out."""
    ct, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array([[ct, -s * ca, s * sa, a * ct], [s, ct * ca, -ct * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1.0]])


def dh_file(rows: list[tuple[float, float, float]]) -> str:
    return "chain:\n" + "".join(
        f"  - joint: {{}}\n    dh: {{a: {a} mm, d: {d} mm, alpha: {alpha} deg, theta: {10 * k} deg}}\n"
        f"    link: {{rigid: true, mass: 1 kg}}\n"
        for k, (a, d, alpha) in enumerate(rows)
    )


@pytest.mark.parametrize("seed", range(5))
def test_ur10_from_its_dh_parameters(seed: int, tmp_path: Path) -> None:
    arm = arm_of(dh_file(UR10), tmp_path)
    q = np.random.default_rng(seed).uniform(-math.pi, math.pi, 6)
    expected = np.eye(4)
    for k, (a, d, alpha) in enumerate(UR10):
        expected = expected @ denavit_hartenberg(a / 1e3, d / 1e3, math.radians(alpha), q[k] + math.radians(10 * k))
    assert tip_position(arm, q)[0] == pytest.approx(expected[:3, 3], abs=1e-12)
    assert np.array(place(arm, q.tolist()).orientation) == pytest.approx(expected[:3, :3], abs=1e-12)


def test_ur10_stretched_at_zero(tmp_path: Path) -> None:
    """By hand: x = a2 + a3 = -1184.3 mm, y = -(d4 + d6) = -256.141 mm, z = d1 - d5 = 11.6 mm."""
    text = dh_file(UR10)
    for k in range(6):
        text = text.replace(f"theta: {10 * k} deg", "theta: 0 deg")
    tip = tip_position(arm_of(text, tmp_path), np.zeros(6))[0]
    assert tip * 1e3 == pytest.approx([-1184.3, -256.141, 11.6], abs=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_ma2010_from_its_product_of_exponentials(seed: int, tmp_path: Path) -> None:
    """p = P0 + R1 (P1 + R2 (P2 + ...)), R_k the turn about axis k."""
    lists = ", ".join(f"[{x} mm, {y} mm, {z} mm]" for x, y, z in MA2010_OFFSETS)
    text = (
        f"product_of_exponentials:\n  axes: {[list(axis) for axis in MA2010_AXES]}\n  offsets: [{lists}]\nchain:\n"
        + "  - {joint: {}, link: {rigid: true, mass: 1 kg}}\n" * 6
    )
    arm = arm_of(text, tmp_path)
    q = np.random.default_rng(seed).uniform(-math.pi, math.pi, 6)
    total = transform(np.eye(3), np.array(MA2010_OFFSETS[0]) / 1e3)
    for axis, offset, angle in zip(MA2010_AXES, MA2010_OFFSETS[1:], q, strict=True):
        turn = transform(rotation_about(axis, angle), np.zeros(3))
        total = total @ turn @ transform(np.eye(3), np.array(offset) / 1e3)
    assert tip_position(arm, q)[0] == pytest.approx(total[:3, 3], abs=1e-12)
    assert tip_position(arm, np.zeros(6))[0] * 1e3 == pytest.approx([1332.0, 0.0, 960.0], abs=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_origins_slides_and_tools_multiply_out(seed: int) -> None:
    """Trans(xyz) Rot(rpy) [joint] Trans(link) Rot(end) for every entry, then the tool."""
    rng = np.random.default_rng(seed)
    joints, links, total = [], [], np.eye(4)
    q = rng.uniform(-1.0, 1.0, 4)
    for index in range(4):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        shift, rpy, end = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
        slides, length, zero = bool(rng.random() < 0.4), float(rng.uniform(0.1, 1.0)), float(rng.normal())
        joints.append(
            Joint("prismatic" if slides else "revolute", axis=tuple(axis), zero=zero, origin_translation=tuple(shift),
                  origin_rotation=from_roll_pitch_yaw(*rpy))  # type: ignore[arg-type]
        )  # fmt: skip
        links.append(Link(length, direction=tuple(direction), end_rotation=from_roll_pitch_yaw(*end)))  # type: ignore[arg-type]
        total = total @ transform(yaw_pitch_roll(rpy), shift)
        moved = q[index] + zero
        if slides:
            total = total @ transform(np.eye(3), moved * axis)
        else:
            total = total @ transform(rotation_about(axis, moved), np.zeros(3))
        total = total @ transform(yaw_pitch_roll(end), length * direction)
    arm = Arm("odd", tuple(joints), tuple(links), tool=(0.1, 0.2, -0.3))
    assert tip_position(arm, q)[0] == pytest.approx((total @ [0.1, 0.2, -0.3, 1.0])[:3], abs=1e-12)


def yaw_pitch_roll(angles: Array) -> Array:
    roll, pitch, yaw = angles
    return rotation_about((0, 0, 1), yaw) @ rotation_about((0, 1, 0), pitch) @ rotation_about((1, 0, 0), roll)


def test_random_chains_stand_where_the_frame_solver_puts_them() -> None:
    for seed in range(20):
        chain = random_spatial_chain(np.random.default_rng(seed))
        arm = Arm("c", tuple(Joint(axis=x.axis) for x in chain.links), tuple(Link(x.length) for x in chain.links))
        frames = place(arm, [link.angle for link in chain.links])
        where = places(chain)
        assert np.array(frames.tip()) == pytest.approx(where[-1].end, abs=1e-12)
        for ours, theirs in zip(frames.links, where, strict=True):
            assert np.array(ours.height) == pytest.approx(theirs.height, abs=1e-9)
            assert np.array(ours.width) == pytest.approx(theirs.width, abs=1e-9)


def test_absolute_angles_are_against_the_base() -> None:
    arm = Arm("linkage", (Joint(),) * 3, (Link(0.4), Link(0.42), Link(0.3)), angles="absolute")
    expected = [0.4 * math.cos(0.3) + 0.42 * math.cos(-0.5) + 0.3 * math.cos(1.1),
                0.4 * math.sin(0.3) + 0.42 * math.sin(-0.5) + 0.3 * math.sin(1.1), 0.0]  # fmt: skip
    assert tip_position(arm, [0.3, -0.5, 1.1])[0] == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    "angles", [(0.3, -0.7, 2.0), (0.4, math.pi / 2, 0.0), (1.0, -math.pi / 2, 0.0), (3.1, 0.0, -3.0)]
)
def test_roll_pitch_yaw_there_and_back(angles: tuple[float, float, float]) -> None:
    rotation = from_roll_pitch_yaw(*angles)
    assert np.array(rotation) == pytest.approx(yaw_pitch_roll(np.array(angles)), abs=1e-12)
    assert np.array(from_roll_pitch_yaw(*to_roll_pitch_yaw(rotation))) == pytest.approx(np.array(rotation), abs=1e-12)
