"""Physics that the library has no entry for, and which half of the proof each class belongs to.

The halves were drawn by `SPLIT` before anything of the diagnosis of motion was tuned; the tool gets no form of them.
A law remembers: it is a generator that is sent the state at each step and yields what it adds to the amount of friction
and to what the drive must push. `fixed` draws what is of the machine, `chance` what is of one log.
"""

# ruff: noqa: ARG001 (all are called alike)

from __future__ import annotations

import math
import random
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import STEP, Arm, Hung
from benchmarks.motion.generator.world import Law, State, World

SPLIT = 36_2026
Random = np.random.Generator


@dataclass(frozen=True)
class Unknown:
    """An unknown in an arm: its class, joints (from 1; empty: several), and about its share of the torque."""

    name: str
    joints: tuple[int, ...]
    size: float
    seed: int


@dataclass(frozen=True)
class About:
    """What sizes go by: RMS torque (n,), the greatest angles and speeds of the motions (n,), the shortest log, s."""

    arm: Arm
    torque: Array
    reach: Array
    speed: Array
    seconds: float


@dataclass(frozen=True)
class Place:
    """A joint (from 0), the amount of torque that fits it, and its usual torque, reach and speed."""

    joint: int
    amount: float
    torque: float
    reach: float
    speed: float
    seconds: float


Remembers = Callable[[Place, Random, Random], Generator[tuple[float, float], State]]


def _stick_slip(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """Contacts that age while they rest and are renewed by sliding (A. Ruina, J. Geophys. Res. 88 (1983), 10359)."""
    age, way = 1.0, float(fixed.uniform(0.05, 0.25))
    while True:
        state = yield at.amount * math.log1p(max(age, 0.0) / 0.02), 0.0
        age += STEP * (1.0 - abs(float(state.velocity[at.joint])) * age / way)


def _snag(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A cable that catches on the way up, is stretched, and comes free with a jump."""
    start, free, before, pull = float(fixed.uniform(-0.3, 0.3)) * at.reach, -math.inf, math.inf, 0.0
    while True:
        state = yield 0.0, pull
        q = float(state.q[at.joint])
        if before < start <= q:
            free = start + float(chance.uniform(0.2, 0.7)) * at.reach
        if q >= free or q < start:
            free = -math.inf
        pull = 6.0 * at.amount * (q - start) / at.reach if free > q else 0.0
        before = q


def _brake(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A brake that drags now and then."""
    until, drags = 2.0, False
    while True:
        state = yield 2.0 * at.amount * drags, 0.0
        if state.time > until:
            drags = not drags
            until = state.time + float(chance.uniform(1.0, 3.0) if drags else chance.uniform(2.0, 6.0))


def _tooth(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A damaged tooth, felt once a turn of its wheel, one way."""
    turns, phase, push = int(fixed.integers(3, 8)), float(fixed.uniform(0.0, 1.0)), 0.0
    while True:
        state = yield 0.0, push
        place = (float(state.q[at.joint]) * turns / (2.0 * math.pi) + phase) % 1.0
        bad = place < 0.12 and state.velocity[at.joint] > 0.0
        push = 6.0 * at.amount * math.sin(math.pi * place / 0.12) if bad else 0.0


def _hydraulic(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """Quadratic in the speed beyond a dead band."""
    dead, push = float(fixed.uniform(0.5, 0.7)) * at.speed, 0.0
    while True:
        v = float((yield 0.0, push).velocity[at.joint])
        push = math.copysign(8.0 * at.amount * (max(abs(v) - dead, 0.0) / (at.speed - dead)) ** 2, v)


def _runaway(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """Friction that grows with the heat that it makes."""
    late, heat = float(fixed.uniform(0.25, 0.4)) * at.seconds * at.torque * at.speed / 3.0, 0.0
    while True:
        state = yield 0.3 * at.amount * math.expm1(min(heat, 4.0)), 0.0
        heat += STEP * abs(float(state.drive[at.joint] * state.velocity[at.joint])) / late


def _step(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """Something slips once, and pulls from then on."""
    pull = 1.6 * float(fixed.choice([-1.0, 1.0])) * at.amount
    since, now = float(chance.uniform(0.3, 0.7)) * at.seconds, 0.0
    while True:
        now = (yield 0.0, pull * (now > since)).time


def _hysteresis(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A bundle of cables whose strands slide on each other over a wide range (R. Bouc 1967, Y. K. Wen 1976)."""
    way, bent = float(fixed.uniform(0.25, 0.5)) * at.reach, 0.0
    while True:
        v = float((yield 0.0, 1.5 * at.amount * (bent + 0.5 * bent**3)).velocity[at.joint])
        bent += STEP * (v - (0.6 * abs(v) * bent * abs(bent) + 0.4 * v * bent * bent)) / way


def _cogging(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A ripple that goes with the current."""
    order, phase, push = int(fixed.integers(3, 9)), float(fixed.uniform(0.0, 6.0)), 0.0
    while True:
        state = yield 0.0, push
        wave = math.sin(order * float(state.q[at.joint]) + phase)
        push = 1.4 * at.amount / at.torque * float(state.drive[at.joint]) * wave


def _hose(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A hose that is led over two joints and pulls by how far both have bent it."""
    phase, share, push = float(fixed.uniform(0.0, 6.0)), float(fixed.uniform(0.6, 1.2)), 0.0
    while True:
        state = yield 0.0, push
        other = at.joint - 1 if at.joint else 1
        bent = float(state.q[at.joint]) / at.reach + share * math.sin(2.0 * float(state.q[other]))
        push = 1.4 * at.amount * math.sin(2.5 * bent + phase)


def _sag(at: Place, fixed: Random, chance: Random) -> Generator[tuple[float, float], State]:
    """A supply that gives way when all joints draw."""
    push, usual = 0.0, 0.0
    while True:
        state = yield 0.0, push
        power = float(np.sum(np.maximum(state.drive * state.velocity, 0.0)))
        usual = max(usual, power)
        push = 2.5 * at.amount / at.torque * float(state.drive[at.joint]) * power / max(usual, 1e-9)


def _remembered(law: Remembers) -> Callable[[Unknown, World, About], None]:
    """A law at the unknown's joint; its amount is a share of the joint's torque."""

    def install(unknown: Unknown, world: World, about: About) -> None:
        j, logs = unknown.joints[0] - 1, iter(range(100))
        torque, reach, speed = (float(item[j]) for item in (about.torque, about.reach, about.speed))
        at = Place(j, unknown.size * torque, torque, reach, speed, about.seconds)

        def make() -> Law:
            fixed, chance = np.random.default_rng(unknown.seed), np.random.default_rng((unknown.seed, next(logs)))
            running = law(at, fixed, chance)
            next(running)

            def act(state: State) -> None:
                loss, demand = running.send(state)
                state.loss[j] += loss
                state.demand[j] += demand

            return act

        world.laws.append(make)

    return install


def _saturates(unknown: Unknown, world: World, about: About) -> None:
    """The log has what the controller asks, the drive gives no more than it can."""
    joint = unknown.joints[0] - 1
    world.limit[joint] = max(2.4 - 2.0 * unknown.size, 0.8) * about.torque[joint]


def _wind(unknown: Unknown, world: World, about: About) -> None:
    """Gusts on the last link."""
    way, logs = np.random.default_rng(unknown.seed).normal(size=3) * (1.0, 1.0, 0.3), iter(range(100))
    scale = 3.0 * unknown.size * float(about.torque[0]) / about.arm.reach * way / np.linalg.norm(way)

    def make() -> Law:
        chance, gust = np.random.default_rng((unknown.seed, next(logs))), 0.0

        def act(state: State) -> None:
            nonlocal gust
            gust += STEP / 0.7 * (0.3 - gust) + math.sqrt(2.0 * STEP / 0.7) * float(chance.normal())
            state.data.xfrc_applied[state.last, :3] = scale * gust

        return act

    world.laws.append(make)


def _spindle(unknown: Unknown, world: World, about: About) -> None:
    """A spindle in the last link, whose speed ripples: it resists being turned (a gyroscope: moment H x omega) and
    pushes back as it speeds up."""
    rng = np.random.default_rng(unknown.seed)
    way, ripple, rate = rng.normal(size=3), 0.15, 2.0 * np.pi / 2.5
    momentum = 2.0 * unknown.size * float(about.torque.mean() / about.speed.mean()) * way / np.linalg.norm(way)

    def act(state: State) -> None:
        along = state.data.ximat[state.last].reshape(3, 3) @ momentum
        spins = along * (1.0 + ripple * np.sin(rate * state.time))
        speeds_up = along * ripple * rate * np.cos(rate * state.time)
        state.data.xfrc_applied[state.last, 3:] = -np.cross(state.data.cvel[state.last, :3], spins) - speeds_up

    world.laws.append(lambda: act)


def _loose_base(unknown: Unknown, world: World, about: About) -> None:
    """A base that rocks: bolts with play, then stiff."""
    world.rocking = True
    stiffness = sum(body.mass for body in about.arm.bodies) * 1500.0 / unknown.size
    play = 0.05 * unknown.size

    def act(state: State) -> None:
        for k in (0, 1):
            x, v = float(state.data.qpos[k]), float(state.data.qvel[k])
            beyond = x - min(max(x, -play), play)
            state.data.qfrc_applied[k] = -stiffness * (beyond + 0.01 * v)

    world.laws.append(lambda: act)


def _swings(unknown: Unknown, world: World, about: About) -> None:
    """A weight on a string at the tip."""
    mass = 2.0 * unknown.size * sum(body.mass for body in about.arm.bodies[3:])
    length = float(np.random.default_rng(unknown.seed).uniform(0.15, 0.4))
    world.hung = Hung(mass, length, 0.02 * mass * length**2)


@dataclass(frozen=True)
class Class:
    """A class of unknowns: how it acts, and whether it is of one joint, of one that turns."""

    install: Callable[[Unknown, World, About], None]
    of_joint: bool = True
    turning: bool = False


CLASSES: Mapping[str, Class] = MappingProxyType(
    {
        "stick_slip_with_memory": Class(_remembered(_stick_slip)),
        "cable_that_snags": Class(_remembered(_snag)),
        "brake_that_drags": Class(_remembered(_brake)),
        "damaged_tooth": Class(_remembered(_tooth), turning=True),
        "controller_saturates": Class(_saturates),
        "hydraulic": Class(_remembered(_hydraulic)),
        "thermal_runaway": Class(_remembered(_runaway)),
        "loose_base": Class(_loose_base, of_joint=False),
        "wind": Class(_wind, of_joint=False),
        "payload_that_swings": Class(_swings, of_joint=False),
        "step_in_time": Class(_remembered(_step)),
        "cable_hysteresis": Class(_remembered(_hysteresis)),
        "cogging_with_current": Class(_remembered(_cogging), turning=True),
        "hose_over_two_joints": Class(_remembered(_hose)),
        "sagging_supply": Class(_remembered(_sag)),
        "spinning_tool": Class(_spindle, of_joint=False),
    }
)


SINCE: Mapping[str, str] = MappingProxyType({"worm_gear": "hose_over_two_joints", "soft_contact": "spinning_tool"})
"""Classes that the library has got an effect for since they were drawn, and which ones stand in their place."""


def drawn_split() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The classes of the development and of the proof half; one that came for another is of that one's half."""
    names = sorted(set(CLASSES) - set(SINCE.values()) | set(SINCE))
    random.Random(SPLIT).shuffle(names)
    names = [SINCE.get(name, name) for name in names]
    return tuple(sorted(names[::2])), tuple(sorted(names[1::2]))


DEVELOPMENT, PROOF = drawn_split()


def draw_unknown(name: str, arm: Arm, size: float, rng: Random) -> Unknown:
    """One of the class at a joint of the arm where it can be."""
    each = CLASSES[name]
    joints = [i for i in range(arm.count) if not (each.turning and arm.axes[i].slide)]
    at = (int(rng.choice(joints)) + 1,) if each.of_joint else ()
    return Unknown(name, at, size, int(rng.integers(1 << 30)))


def install(unknown: Unknown, world: World, about: About) -> None:
    """Puts it into a world."""
    CLASSES[unknown.name].install(unknown, world, about)
