"""Arms, poses and conditions for the tests of the effects, and planar formulas written without the project's code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.tip import carried_to_tip
from linkwright.core.sections.numeric import Array

Z = (0.0, 0.0, 1.0)
GRAVITY = 9.81
ROWS = 7


def conditions(size: int, rows: int = ROWS, seed: int = 5) -> Conditions:
    """Everything that a recording can know, at random."""
    rng = np.random.default_rng(seed)

    def each(low: float, high: float) -> tuple[Array, ...]:
        return tuple(rng.uniform(low, high, rows) for _ in range(size))

    return Conditions(
        time=np.sort(rng.uniform(0.0, 2e4, rows)),
        warming=each(-5.0, 20.0),
        sides=tuple(rng.choice([-1.0, 1.0], rows) for _ in range(size)),
        velocities=each(-2.0, 2.0),
        accelerations=each(-9.0, 9.0),
        loaded_for=rng.uniform(0.0, 5e3, rows),
        commanded=each(-1.0, 1.0),
        last_moves=each(-1.5, 1.5),
    )


def beam_of(rng: np.random.Generator, length: float) -> Beam:
    """A beam whose height and width are given differently."""
    return Beam(
        length=length,
        mass_per_length=float(rng.uniform(3.0, 20.0)),
        axial_rigidity=float(rng.uniform(1e7, 3e8)),
        flexural_rigidity_height=float(rng.uniform(1e4, 2e5)),
        flexural_rigidity_width=float(rng.uniform(1e4, 2e5)),
        torsional_rigidity=float(rng.uniform(1e4, 1e5)),
        shear_rigidity_height=float(rng.uniform(1e6, 1e8)),
        shear_rigidity_width=float(rng.uniform(1e6, 1e8)),
        thermal_expansion=12e-6,
    )


@dataclass(frozen=True)
class Posed:
    """An arm with its beams, poses q (N, n) and conditions."""

    arm: Arm
    beams: tuple[Beam, ...]
    q: Array
    held: Conditions

    @property
    def state(self) -> PoseState:
        return self.solved()

    def solved(self, arm: Arm | None = None, beams: tuple[Beam, ...] | None = None) -> PoseState:
        columns = [self.q[:, index] for index in range(self.arm.size)]
        return solve(arm or self.arm, columns, beams or self.beams, conditions=self.held)

    def row(self, number: int) -> PoseState:
        """One reading on its own."""

        def at(values: object) -> tuple[float, ...]:
            assert isinstance(values, tuple)
            return tuple(float(value[number]) for value in values)

        held, loaded_for, time = self.held, self.held.loaded_for, self.held.time
        assert loaded_for is not None
        assert time is not None
        one = Conditions(
            time=float(time[number]),
            warming=at(held.warming),
            sides=at(held.sides),
            velocities=at(held.velocities),
            accelerations=at(held.accelerations),
            loaded_for=float(loaded_for[number]),
            commanded=at(held.commanded),
            last_moves=at(held.last_moves),
        )
        return solve(self.arm, self.q[number].tolist(), self.beams, conditions=one)


def planar(seed: int = 1, *, size: int = 3, absolute: bool = False, payload: LoadCase | None = None) -> Posed:
    """A planar arm of `size` turning joints with stiff drives and joint masses, at random poses."""
    rng = np.random.default_rng(seed)
    lengths = [float(length) for length in rng.uniform(0.3, 0.9, size)]
    arm = Arm(
        "plane",
        tuple(Joint(stiffness=float(rng.uniform(1e4, 1e5)), mass=float(rng.uniform(0.0, 8.0))) for _ in lengths),
        tuple(Link(length) for length in lengths),
        angles="absolute" if absolute else "relative",
        payload=payload or LoadCase(3.0, (20.0, -10.0, 0.0)),
    )
    beams = tuple(beam_of(rng, length) for length in lengths)
    return Posed(arm, beams, rng.uniform(-2.5, 2.5, (ROWS, size)), conditions(size, seed=seed))


def spatial(seed: int = 1, *, slide: bool = True) -> Posed:
    """An arm in space with offsets, a bent link, a tool and (joint 3) a slide."""
    rng = np.random.default_rng(seed)
    quarter = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
    third = (
        Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 0.5), mass=1.5) if slide else Joint(axis=(0.0, 1.0, 0.0), mass=1.5)
    )
    joints = (
        Joint(axis=Z, mass=4.0, stiffness=8e4, origin_translation=(0.05, -0.02, 0.3)),
        Joint(axis=(0.0, 1.0, 0.0), mass=3.0, stiffness=5e4, zero=0.3, origin_translation=(0.1, 0.0, 0.0)),
        replace(third, mass=1.5, stiffness=4e6 if slide else 6e4),
        Joint(axis=(0.6, 0.8, 0.0), mass=1.0, stiffness=2e4),
    )
    lengths = (0.2, 0.6, 0.3, 0.25)
    links = tuple(
        Link(length, end_rotation=quarter) if index == 1 else Link(length) for index, length in enumerate(lengths)
    )
    arm = Arm(
        "space",
        joints,
        links,
        gravity=(0.5, -1.0, -9.6),
        payload=LoadCase(2.0, (15.0, -10.0, 5.0), (1.0, 2.0, -0.5)),
        tool=(0.05, 0.02, -0.03),
    )
    beams = tuple(beam_of(rng, length) for length in lengths)
    q = rng.uniform(-1.5, 1.5, (ROWS, 4))
    if slide:
        q[:, 2] = rng.uniform(0.0, 0.5, ROWS)
    return Posed(arm, beams, q, conditions(4, seed=seed))


def moved(state: PoseState, effect: str, values: Mapping[str, float], at: tuple[int, ...] = ()) -> Array:
    """What an effect moves the tip by: its twists and the seat of its play, as rows (N, 3)."""
    settings = Settings(at, MappingProxyType(dict(values)))
    result = EFFECTS[effect]
    tip = carried_to_tip(state, [*result.twists(state, settings), *result.play.seated(state, settings)])
    rows = np.broadcast_shapes(*(np.shape(item) for item in (*tip, state.joints[0].coordinate)))
    return np.stack([np.broadcast_to(np.asarray(item, dtype=float), rows) for item in tip], axis=-1)


def exact_change(change: Callable[[float], tuple[Arm, Array]], step: float = 1e-5) -> Array:
    """The derivative at 0 of the exact tip of `change(h)`, an arm at coordinates (N, n), by a central difference."""
    ends = [tip_position(*change(sign * step)) for sign in (1.0, -1.0)]
    return (ends[0] - ends[1]) / (2.0 * step)


@dataclass(frozen=True)
class Plane:
    """phi_i, u_i, n_i, o_i, p, J_i and tau_i of a planar arm with relative angles, each from its definition."""

    posed: Posed

    @property
    def phi(self) -> Array:
        return np.cumsum(self.posed.q, axis=1)

    @property
    def lengths(self) -> Array:
        return np.array(self.posed.arm.lengths)

    def u(self, i: int) -> Array:
        return np.stack([np.cos(self.phi[:, i]), np.sin(self.phi[:, i])], axis=1)

    def n(self, i: int) -> Array:
        return np.stack([-np.sin(self.phi[:, i]), np.cos(self.phi[:, i])], axis=1)

    def o(self, i: int) -> Array:
        """Joint i; o(n) is the tip."""
        return sum((self.lengths[k] * self.u(k) for k in range(i)), np.zeros((len(self.phi), 2)))

    @property
    def p(self) -> Array:
        return self.o(len(self.lengths))

    def j(self, i: int) -> Array:
        return turned(self.p - self.o(i))

    def tau(self, i: int) -> Array:
        """Torque about joint i of all that lies beyond it."""
        arm, beams = self.posed.arm, self.posed.beams
        force = np.array(arm.payload.force[:2])

        def weight(mass: float, place: Array) -> Array:
            return -GRAVITY * mass * (place - self.o(i))[:, 0]

        lever = self.p - self.o(i)
        total = weight(arm.payload.mass, self.p) + lever[:, 0] * force[1] - lever[:, 1] * force[0]
        for k in range(i, arm.size):
            total += weight(float(beams[k].mass_per_length) * self.lengths[k], 0.5 * (self.o(k) + self.o(k + 1)))
            if k > i:
                total += weight(arm.joints[k].mass, self.o(k))
        return total


def turned(vector: Array) -> Array:
    """z x v in the plane."""
    return np.stack([-vector[:, 1], vector[:, 0]], axis=1)


def in_space(vector: Array) -> Array:
    """A planar vector with its z, which is 0."""
    return np.column_stack([vector, np.zeros(len(vector))])
