"""An arm of six joints by plain matrices, and what a camera reads of it; of the library, the description alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array

CAMERA = slots_of("camera")[0]

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
LENGTHS = (0.15, 0.45, 0.1, 0.35, 0.08, 0.1)
RANGE, GRAVITY = 1.5, 9.80665


def six_joint_arm() -> Arm:
    """Six joints, rigid weightless links, gravity along -z."""
    joints = tuple(Joint(range=(-RANGE, RANGE), axis=axis) for axis in AXES)
    links = tuple(Link(length, mass=0.0) for length in LENGTHS)
    return Arm("six joints", joints, links, gravity=(0.0, 0.0, -GRAVITY), payload=LoadCase(mass=0.0))


@dataclass(frozen=True)
class Hand:
    """What is real: zeros (rad) and compliances (rad/(N*m)) by joint; where the fixed one of camera and target is in
    the base, and where the other sits on the last link (4 x 4)."""

    zeros: dict[int, float] = field(default_factory=dict)
    compliance: dict[int, float] = field(default_factory=dict)
    fixed: Array = field(default_factory=lambda: transform(1))
    carried: Array = field(default_factory=lambda: transform(2, reach=0.08))


def transform(seed: int, reach: float = 1.5) -> Array:
    """A rigid motion, turned anyhow."""
    rng = np.random.default_rng(seed)
    result = np.eye(4)
    result[:3, :3] = Rotation.random(rng=rng).as_matrix()
    result[:3, 3] = rng.uniform(-reach, reach, 3)
    return result


def flange(q: Array) -> Array:
    """Where the end of the last link is and how it is turned, (N, 4, 4), and joint by joint before it."""
    at = np.tile(np.eye(4), (len(q), 1, 1))
    for index, (axis, length) in enumerate(zip(AXES, LENGTHS, strict=True)):
        step = np.tile(np.eye(4), (len(q), 1, 1))
        step[:, :3, :3] = Rotation.from_rotvec(np.outer(q[:, index], axis)).as_matrix()
        step[:, :3, 3] = step[:, :3, 0] * length
        at = at @ step
    return at


def bent(q: Array, payload: Array, hand: Hand) -> Array:
    """The joints (N, 6) as they stand, where drives give by what the payload turns them, in balance."""
    real = q + np.array([hand.zeros.get(k + 1, 0.0) for k in range(6)])
    soft = np.array([hand.compliance.get(k + 1, 0.0) for k in range(6)])
    stands = real
    for _ in range(4):
        # The work of the weight: turning each joint by a little lifts the end by so much.
        step, torque = 1e-6, np.zeros(q.shape)
        for k in np.flatnonzero(soft).tolist():
            more, less = stands.copy(), stands.copy()
            more[:, k] += step
            less[:, k] -= step
            torque[:, k] = -GRAVITY * payload * (flange(more)[:, 2, 3] - flange(less)[:, 2, 3]) / (2.0 * step)
        stands = real + soft * torque
    return stands


def seen_by_camera(
    q: Array,
    payload: Array,
    hand: Hand,
    *,
    on_tool: bool,
    noise: tuple[float, float, float],
    print_scale: float = 0.0,
    focal: float = 0.0,
    seed: int = 5,
    **further: object,
) -> Recording:
    """The target's pose in the camera's frame at each reading: `noise` across (m), in depth (m) and of turns (rad)."""
    rng = np.random.default_rng(seed)
    carried = flange(bent(q, payload, hand)) @ hand.carried
    seen = np.linalg.inv(carried) @ hand.fixed if on_tool else np.linalg.inv(hand.fixed) @ carried
    place = seen[:, :3, 3] * (1.0 + print_scale) * np.array([1.0, 1.0, 1.0 + focal])
    place = place + rng.standard_normal(place.shape) * np.array([noise[0], noise[0], noise[1]])
    turns = Rotation.from_rotvec(noise[2] * rng.standard_normal(place.shape)).as_matrix() @ seen[:, :3, :3]
    return Recording(
        "camera.csv", q, place, np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)), payload_mass=payload,
        orientation=turns, seat="free", frame="free", tool="free",
        slots=np.tile([CAMERA, CAMERA + 1, CAMERA + 2], (len(q), 1)),
        instrument=Instrument(("camera",), camera="on_tool" if on_tool else "fixed"), **further,
    )  # type: ignore[arg-type] # fmt: skip


def session(count: int, seed: int, payloads: tuple[float, ...] = (0.0, 4.0)) -> tuple[Array, Array]:
    """Encoder readings (N, 6), each pose twice, and payloads (N,)."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-0.9 * RANGE, 0.9 * RANGE, (count, 6)), 2, axis=0)
    return q, np.repeat(rng.choice(payloads, count), 2)
