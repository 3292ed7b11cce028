"""An arm that moves under its controller, with what acts on it: MuJoCo's own terms, and torques in the loop.

Friction that opposes motion goes into MuJoCo's constraint of friction loss, whatever its law says of its amount, so
that a joint sticks and slips without chatter; all else is a torque at the joint. The controller sends the torque that
the nominal arm needs for the reference, and corrects by proportion and speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import STEP, Arm, Elastic, Hung, Rigid, mjcf
from benchmarks.motion.generator.moved import Moved

SMOOTH = 5
"""Steps between two at which the torque of the reference is computed."""


FAR = 0.5  # rad, m


class UnstableError(ValueError):
    """The arm did not follow its reference."""


@dataclass
class State:
    """What a law sees, and where it adds: `loss` is friction's amount, `demand` what the drive must push beside."""

    time: float
    q: Array
    velocity: Array
    drive: Array
    loss: Array
    demand: Array
    data: mujoco.MjData
    dofs: Array
    rotors: Array
    last: int  # the last link's body

    def load(self, joint: int) -> float:
        """What a gear carries to its link, by the step before: all that acts at the joint, less its rotor's share."""
        at, data = self.dofs[joint], self.data
        whole = data.qfrc_applied[at] + data.qfrc_constraint[at] + data.qfrc_passive[at]
        return float(whole - self.rotors[joint] * data.qacc[at])


Law = Callable[[State], None]


@dataclass
class World:
    """An arm as it really is: `arm` the true bodies and drives, the rest what acts beside. Laws are made anew for each
    log, since they remember."""

    arm: Arm
    gravity: Array
    gain: Array
    offset: Array
    zero: Array
    delay: Array
    limit: Array
    laws: list[Callable[[], Law]] = field(default_factory=list[Callable[[], Law]])
    elastic: dict[int, Elastic] = field(default_factory=dict[int, Elastic])
    springs: dict[int, float] = field(default_factory=dict[int, float])
    hung: Hung | None = None
    rocking: bool = False


def world_of(arm: Arm) -> World:
    """The arm as its file says."""
    n, down = arm.count, np.array([0.0, 0.0, -9.81])
    return World(arm, down, np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n), np.full(n, np.inf))


@dataclass(frozen=True)
class Track:
    """What happened, at the controller's steps: `q` and `velocity` by the encoders, `drive` the torque that the drives
    believe they give."""

    time: Array
    q: Array
    velocity: Array
    drive: Array


def declared_torque(arm: Arm, reference: Moved) -> Array:
    """(N, n) that the nominal arm needs, its friction with it."""
    v = reference.velocity
    coulomb, viscous, armature = arm.drives
    part = slice(None, None, SMOOTH)
    coarse = Rigid.of(arm).torque(reference.q[part], v[part], reference.acceleration[part])
    bodies = CubicSpline(reference.time[part], coarse)(reference.time)
    return bodies + armature * reference.acceleration + viscous * v + coulomb * np.tanh(v / 0.02)


def simulate(world: World, nominal: Arm, reference: Moved, forward: Array, stiffness: float = 30.0) -> Track:
    """Follows the reference from its start; `forward` (N, n) is fed forward, `stiffness` (rad/s) is that of the loop.
    Raises UnstableError."""
    text = mjcf(world.arm, elastic=world.elastic, springs=world.springs, hung=world.hung, rocking=world.rocking)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.gravity[:] = world.gravity
    data = mujoco.MjData(model)
    n = world.arm.count
    at = np.array([model.joint(f"q{i + 1}").dofadr[0] for i in range(n)])
    start = reference.q[0] - world.zero
    data.qpos[at], data.qvel[at] = start, reference.velocity[0]
    kp, kd = _gains(world, nominal, reference, stiffness)
    declared, _, rotors = world.arm.drives
    q, v, out, force = data.qpos, data.qvel, data.qfrc_applied, model.dof_frictionloss
    saturates = bool(np.isfinite(world.limit).any())
    state = State(
        0.0,
        start,
        reference.velocity[0],
        forward[0],
        declared.copy(),
        np.zeros(n),
        data,
        at,
        rotors,
        model.body(f"link{n}").id,
    )
    laws = [make() for make in world.laws]
    seen, speed, drive = (np.zeros((len(reference.time), n)) for _ in range(3))
    for k, time in enumerate(reference.time):
        state.time, state.q, state.velocity = time, q[at], v[at]
        read = state.q + world.zero
        if k % 50 == 0 and not float(np.abs(read - reference.q[k]).max()) < FAR:
            raise UnstableError(f"{world.arm.family}: lost its reference after {time:.3g} s")
        asked = forward[k] + kp * (reference.q[k] - read) + kd * (reference.velocity[k] - state.velocity)
        given = (asked - world.offset) / world.gain
        if saturates:
            given = np.clip(given, -world.limit, world.limit)
        if laws:
            state.drive, state.loss[:], state.demand[:] = given, declared, 0.0
            for law in laws:
                law(state)
            given = given - state.demand
            force[at] = np.maximum(state.loss, 0.0)
        out[at] = given
        seen[k], speed[k], drive[k] = read, state.velocity, asked
        mujoco.mj_step(model, data)
    if not float(np.abs(seen - reference.q).max()) < FAR:
        raise UnstableError(f"{world.arm.family}: lost its reference at the end")
    # MuJoCo steps speeds before positions: an acceleration is that between two speeds, at the position between them.
    speed = np.concatenate([(speed[1:] + speed[:-1]) / 2.0, speed[-1:]])
    return Track(reference.time, seen, speed, drive)


def _gains(world: World, nominal: Arm, reference: Moved, stiffness: float) -> tuple[Array, Array]:
    """Proportional and speed gains, from the mass matrix half way."""
    inertia = np.diag(Rigid.of(nominal).inertia(reference.q[len(reference.q) // 2])) + nominal.drives[2]
    least = np.maximum(world.arm.drives[2], 0.02)
    inertia = np.maximum(inertia, least)
    for i in world.elastic:
        inertia[i] = least[i]
    return inertia * stiffness**2, inertia * 2.0 * stiffness


def consistent_acceleration(track: Track) -> Array:
    """(N, n), of the second difference of the positions, which is exact of this way of stepping."""
    q = track.q
    inner = (q[2:] - 2.0 * q[1:-1] + q[:-2]) / STEP**2
    return np.concatenate([inner[:1], inner, inner[-1:]])
