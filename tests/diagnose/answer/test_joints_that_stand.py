"""Joints that hardly move in a recording are accused of nothing, or of what they do: by vectors turned by hand.

A post that turns, two links that nod and a wrist; gravity's torques on the drives are sums over the links' middles.
"""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Finding
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
WAYS = ((0.0, 0.0, 1.0), *((1.0, 0.0, 0.0),) * 4)
LENGTHS, MASSES = (0.4, 0.5, 0.45, 0.1, 0.15), (10.0, 8.0, 5.0, 1.0, 1.0)
COMPLIANCE = np.array([0.0, 1e-5, 3e-5, 0.0, 0.0])
SIGMA, TRAVEL = 15e-6, 4e-3
TILT, SHIFT, SAG = 5e-3, 2e-3, 2e-3
"""rad, m and rad: more than any of these is no size of this arm."""


def turns(axis: Array, angle: Array) -> Array:
    """Rotations (N, 3, 3) about an axis, by Rodrigues."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)


def placed(q: Array, tilts: Array) -> tuple[Array, Array]:
    """Where joints and tip are (N, 6, 3) and along what the joints turn (N, 5, 3); `tilts` (5, 3) turn each axis."""
    turned, at = np.tile(np.eye(3), (len(q), 1, 1)), np.zeros((len(q), 3))
    places, axes = [at], []
    for k, axis in enumerate(AXES):
        size = float(np.linalg.norm(tilts[k]))
        if size > 0.0:
            turned = turned @ turns(tilts[k] / size, np.full(len(q), size))
        axes.append(turned @ np.array(axis))
        turned = turned @ turns(np.array(axis), q[:, k])
        at = at + turned @ (LENGTHS[k] * np.array(WAYS[k]))
        places.append(at)
    return np.stack(places, axis=1), np.stack(axes, axis=1)


def sagged(q: Array, compliance: Array, tilts: Array) -> Array:
    """How far drives turn (N, 5), rad, under the links' weight."""
    turned = np.zeros_like(q)
    for _ in range(6):
        places, axes = placed(q + turned, tilts)
        middle, torque = 0.5 * (places[:, :-1] + places[:, 1:]), np.zeros_like(q)
        for joint in range(5):
            for link in range(joint, 5):
                moment = np.cross(middle[:, link] - places[:, joint], [0.0, 0.0, -9.81 * MASSES[link]])
                torque[:, joint] += np.sum(axes[:, joint] * moment, axis=1)
        turned = compliance * torque
    return turned


def arm(*, weighed: bool) -> Arm:
    links = tuple(
        Link(length, way, mass=mass if weighed else None)
        for length, way, mass in zip(LENGTHS, WAYS, MASSES, strict=True)
    )
    joints = tuple(Joint(axis=axis, range=(-3.0, 3.0)) for axis in AXES)
    return Arm("a joint of it stands", joints, links, gravity=(0.0, 0.0, -9.81))


def visited(rng: np.random.Generator, still: int) -> Array:
    q = rng.uniform(-1.3, 1.3, (80, 5))
    q[:, still - 1] = 0.4 + TRAVEL * rng.uniform(-1.0, 1.0, 80)
    return np.repeat(q, 2, axis=0)


def read(q: Array, places: Array, rng: np.random.Generator, *, free: bool) -> Recording:
    tip = places[:, -1] + (np.array([0.3, 0.2, -0.1]) if free else 0.0)
    how = "free" if free else "known"
    tip = tip + SIGMA * rng.standard_normal(tip.shape)
    return Recording("made", q, tip, np.arange(1, len(q) + 1), frame=how, tool=how)


def sizes_of(finding: Finding) -> dict[str, float]:
    return {parameter.parameter: parameter.value for parameter in finding.parameters}


@pytest.mark.parametrize(("still", "free"), [(2, True), pytest.param(4, False, marks=pytest.mark.slow)])
def test_a_tilted_axis_beside_one_that_stands(still: int, free: bool) -> None:
    rng = np.random.default_rng(1)
    q, tilts = visited(rng, still), np.zeros((5, 3))
    tilts[2] = [8e-4, 0.0, 5e-4]
    result = diagnose(arm(weighed=True), read(q, placed(q, tilts)[0], rng, free=free))
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("axis_misalignment", (3,))
    sizes = sizes_of(finding)
    assert np.hypot(sizes["tilt_u"], sizes["tilt_v"]) == pytest.approx(np.hypot(8e-4, 5e-4), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("free", [True, False])
def test_a_drive_that_stands_sags_by_what_hangs_on_it(free: bool) -> None:
    """Joint 2 moves by 4 mrad and its load with joint 3; links that nobody has weighed."""
    rng = np.random.default_rng(1)
    q, straight = visited(rng, 2), np.zeros((5, 3))
    sag = sagged(q, COMPLIANCE, straight)
    result = diagnose(arm(weighed=False), read(q, placed(q + sag, straight)[0], rng, free=free))
    assert {(item.effect, item.at) for item in result.findings} == {("joint_compliance", (k,)) for k in (2, 3)}
    assert result.verdict in ("named", "alias_class")
    assert result.noise_floor is not None
    assert result.rms_after < 1.1 * result.noise_floor
    for finding in result.findings:
        turned = sag[:, finding.at[0] - 1]
        (size,) = finding.parameters
        truth = float(np.ptp(turned)) if free else float(turned[np.argmax(np.abs(turned))])
        assert size.value == pytest.approx(truth, rel=0.25 if free else 0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("still", "free"), [(2, True), (4, False)])
def test_many_small_causes_make_nothing_large_of_a_joint_that_stands(still: int, free: bool) -> None:
    """Axes askew by 0.5 mrad, zeros, gears and drives that give, joints that return by 0.03 mrad."""
    rng = np.random.default_rng(1)
    q = visited(rng, still)
    tilts, zeros = 5e-4 * rng.standard_normal((5, 3)), 2e-4 * rng.standard_normal(5)
    off = zeros + np.repeat(3e-5 * rng.standard_normal((80, 5)), 2, axis=0)
    off[:, 2] += 1e-4 * np.sin(3.0 * q[:, 2])
    off[:, 0] += 1e-4 * np.sin(2.0 * q[:, 0])
    sag = sagged(q, COMPLIANCE, tilts)
    result = diagnose(arm(weighed=False), read(q, placed(q + off + sag, tilts)[0], rng, free=free))
    assert result.findings
    for finding in result.findings:
        for name, value in sizes_of(finding).items():
            most = {"tilt": TILT, "shift": SHIFT, "sag": SAG, "offset": TILT}.get(name.partition("_")[0], np.inf)
            assert abs(value) < most, (finding.effect, finding.at, name)
