"""Four chains on which an effect is tried: two in the plane (relative and absolute angles), two in space (one with a
slide), each at a few poses with everything that a recording can hold. All numbers are drawn with a fixed seed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.kinematics import parts, symbols
from linkwright.core.arm.chain.statics import PoseState, solve

ROWS = 5
TOLERANCE = 1e-9
"""Of the greatest value: by so much two ways to one figure may differ, by rounding."""
_FAILURES = (ArithmeticError, AttributeError, LookupError, NotImplementedError, RuntimeError, TypeError, ValueError)
Tried = TypeVar("Tried")
_QUARTER = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Chain:
    """An arm with its beams, poses q (N, n) and what held at them."""

    arm: Arm
    beams: tuple[Beam, ...]
    q: NDArray[np.float64]
    held: Conditions

    def readings(self, without: str | None = None) -> PoseState:
        """The state at all poses, with all conditions or without one of them."""
        held = self.held if without is None else replace(self.held, **{without: None})
        return solve(self.arm, [self.q[:, k] for k in range(self.arm.size)], self.beams, conditions=held)

    def reading(self, row: int) -> PoseState:
        """The state at one pose, in floats."""
        held = Conditions(**{field.name: _at(getattr(self.held, field.name), row) for field in fields(Conditions)})
        return solve(self.arm, self.q[row].tolist(), self.beams, conditions=held)

    def design(self, row: int) -> PoseState:
        """One pose of a design, in floats: nothing is known but the pose."""
        return solve(self.arm, self.q[row].tolist(), self.beams)

    def symbolic(self) -> tuple[Any, PoseState]:
        """CasADi's symbols of the joint coordinates, and a design's state in them."""
        q = symbols(self.arm)
        return q, solve(self.arm, parts(q), self.beams)


def chains() -> tuple[Chain, ...]:
    """The four chains."""
    return (_planar(1, "relative"), _planar(2, "absolute"), _spatial(3, slide=True), _spatial(4, slide=False))


def _at(values: Any, row: int) -> Any:
    if isinstance(values, tuple):
        return tuple(float(value[row]) for value in values)
    return float(values[row]) if isinstance(values, np.ndarray) else None


def _planar(seed: int, angles: str) -> Chain:
    random = np.random.default_rng(seed)
    lengths = random.uniform(0.3, 0.9, 3).tolist()
    arm = Arm(
        "plane",
        tuple(Joint(stiffness=float(random.uniform(1e4, 1e5)), mass=2.0) for _ in lengths),
        tuple(Link(length) for length in lengths),
        angles="absolute" if angles == "absolute" else "relative",
        payload=LoadCase(3.0, (20.0, -10.0, 0.0)),
    )
    return _chain(arm, random.uniform(-2.5, 2.5, (ROWS, 3)), random)


def _spatial(seed: int, *, slide: bool) -> Chain:
    random = np.random.default_rng(seed)
    third = Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 0.5)) if slide else Joint(axis=(0.0, 1.0, 0.0))
    joints = (
        Joint(axis=(0.0, 0.0, 1.0), mass=4.0, stiffness=8e4, origin_translation=(0.05, -0.02, 0.3)),
        Joint(axis=(0.0, 1.0, 0.0), mass=3.0, stiffness=5e4, zero=0.3, origin_translation=(0.1, 0.0, 0.0)),
        replace(third, mass=1.5, stiffness=4e6 if slide else 6e4),
        Joint(axis=(0.6, 0.8, 0.0), mass=1.0, stiffness=2e4),
    )
    links = (Link(0.2), Link(0.6, end_rotation=_QUARTER), Link(0.3), Link(0.25))
    load = LoadCase(2.0, (15.0, -10.0, 5.0), (1.0, 2.0, -0.5))
    arm = Arm("space", joints, links, gravity=(0.5, -1.0, -9.6), payload=load, tool=(0.05, 0.02, -0.03))
    q = random.uniform(-1.5, 1.5, (ROWS, 4))
    if slide:
        q[:, 2] = random.uniform(0.1, 0.5, ROWS)
    return _chain(arm, q, random)


def _chain(arm: Arm, q: NDArray[np.float64], random: np.random.Generator) -> Chain:
    def each(low: float, high: float) -> tuple[NDArray[np.float64], ...]:
        return tuple(random.uniform(low, high, ROWS) for _ in range(arm.size))

    beams = tuple(
        Beam(
            length=link.length,
            mass_per_length=float(random.uniform(3.0, 20.0)),
            axial_rigidity=float(random.uniform(1e7, 3e8)),
            flexural_rigidity_height=float(random.uniform(1e4, 2e5)),
            flexural_rigidity_width=float(random.uniform(1e4, 2e5)),
            torsional_rigidity=float(random.uniform(1e4, 1e5)),
            shear_rigidity_height=float(random.uniform(1e6, 1e8)),
            shear_rigidity_width=float(random.uniform(1e6, 1e8)),
            thermal_expansion=12e-6,
        )
        for link in arm.links
    )
    sides = tuple(random.choice([-1.0, 1.0], ROWS) for _ in range(arm.size))
    time, loaded_for = np.sort(random.uniform(0.0, 2e4, ROWS)), random.uniform(1.0, 5e3, ROWS)
    held = Conditions(
        time=time,
        warming=each(-5.0, 20.0),
        sides=sides,
        velocities=each(-2.0, 2.0),
        accelerations=each(-9.0, 9.0),
        loaded_for=loaded_for,
        commanded=each(-1.0, 1.0),
        last_moves=each(-1.0, 1.0),
    )
    return Chain(arm, beams, q, held)


def faults_on(
    tried: Iterable[Tried], faults: Callable[[Tried], Iterable[str]], where: Callable[[Tried], str]
) -> list[str]:
    """What is wrong on any of what is tried, as phrases, each once; what is raised there is one of them."""
    results: dict[str, None] = {}
    for item in tried:
        try:
            results.update(dict.fromkeys(faults(item)))
        except _FAILURES as error:
            results[f"raises {type(error).__name__} ({error}) on {where(item)}"] = None
    return list(results)
