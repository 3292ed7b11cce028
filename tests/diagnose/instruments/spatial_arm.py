"""An arm in space by its own rotation matrices, and recordings of it that see a part of the tip's place.

Nothing here comes from the library but the description of the arm that a diagnosis is given.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
LENGTHS = (0.15, 0.45, 0.4, 0.1, 0.12)
RANGE = 1.4
SIGMA = 10e-6
GRAVITY = 9.80665


def spatial_arm() -> Arm:
    """Five joints, rigid weightless links, loads that pull down along z."""
    joints = tuple(Joint(range=(-RANGE, RANGE), axis=axis) for axis in AXES)
    links = tuple(Link(length, mass=0.0) for length in LENGTHS)
    return Arm("spatial test arm", joints, links, gravity=(0.0, 0.0, -GRAVITY), payload=LoadCase(mass=0.0))


@dataclass(frozen=True)
class Truth:
    """What the real arm has: joints' angles beside their readings (rad), drives that give (rad/(N*m))."""

    zeros: tuple[float, ...] = (0.0,) * 5
    compliance: tuple[float, ...] = (0.0,) * 5
    longer: float = 0.0
    """m, of link 2."""


def placed(q: Array, longer: float = 0.0) -> tuple[Array, Array, Array]:
    """Tips (N, 3), where each joint is (N, 5, 3) and its axis (N, 5, 3): a chain of rotations and straight links."""
    turned, at = Rotation.identity(len(q)), np.zeros((len(q), 3))
    places, axes = [], []
    for index, (axis, length) in enumerate(zip(AXES, LENGTHS, strict=True)):
        places.append(at)
        axes.append(turned.apply(np.tile(axis, (len(q), 1))))
        turned = turned * Rotation.from_rotvec(np.outer(q[:, index], axis))
        at = at + turned.apply(np.tile([length + (longer if index == 1 else 0.0), 0.0, 0.0], (len(q), 1)))
    return at, np.stack(places, axis=1), np.stack(axes, axis=1)


def tips(q: Array, payload: Array, truth: Truth) -> Array:
    """Where the real tip is (N, 3), m: the joints give by the torque of the payload about each axis, in balance."""
    real = q + np.array(truth.zeros)
    bent = real
    for _ in range(4):
        tip, places, axes = placed(bent, truth.longer)
        force = np.stack([np.zeros(len(q)), np.zeros(len(q)), -GRAVITY * payload], axis=1)
        torque = np.einsum("nja,nja->nj", np.cross(tip[:, None] - places, force[:, None]), axes)
        bent = real + np.array(truth.compliance) * torque
    return placed(bent, truth.longer)[0]


def torques(q: Array, payload: Array, truth: Truth) -> Array:
    """What the payload's weight turns each joint by (N, 5), N*m, where the drives that give are in balance."""
    bent = real = q + np.array(truth.zeros)
    torque = np.zeros(q.shape)
    for _ in range(4):
        tip, places, axes = placed(bent, truth.longer)
        force = np.stack([np.zeros(len(q)), np.zeros(len(q)), -GRAVITY * payload], axis=1)
        torque = np.einsum("nja,nja->nj", np.cross(tip[:, None] - places, force[:, None]), axes)
        bent = real + np.array(truth.compliance) * torque
    return torque


def session(count: int, seed: int, repeats: int = 2, payloads: tuple[float, ...] = (0.0, 5.0)) -> tuple[Array, Array]:
    """Encoder readings (N, 5), rad, and payloads (N,), kg: random poses, each read some times in a row."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-0.9 * RANGE, 0.9 * RANGE, (count, 5)), repeats, axis=0)
    return q, np.repeat(rng.choice(payloads, count), repeats)


def read(q: Array, payload: Array, values: Array, **further: object) -> Recording:
    """What an instrument read, (N, W), as a recording."""
    return Recording(
        "r.csv", q, values, np.arange(1, len(q) + 1), time=15.0 * np.arange(len(q)), payload_mass=payload, **further
    )  # type: ignore[arg-type]


def degrees(value: float) -> float:
    return math.radians(value)
