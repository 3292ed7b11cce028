"""A cycle of motion as a load: its samples, what they take of the drives, and those at which the arm bears most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from linkwright.core.arm.bodies.inertia import Moving
from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import PoseArrays, beams_of
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.arm.files.poses import numbers, pose_columns, poses_of
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .motion import Motion

_CLOCKS = ("time_s", "t_s")
_PAYLOAD = "payload_kg"
_ROUND = 1e-9
"""A cycle whose ends differ by less (rad, m) closes."""


@dataclass(frozen=True, eq=False)
class Cycle:
    """A motion that an arm does over and over: N instants, ascending.

    Attributes:
        file: where it stands.
        load: what acts at the tip all the while.
        time: (N,) s.
        q: (N, n) rad (m for slides).
        velocity: (N, n) rad/s (m/s).
        acceleration: (N, n) rad/s^2 (m/s^2).
        payload: (N,) kg.
    """

    file: str
    load: LoadCase
    time: Array
    q: Array
    velocity: Array
    acceleration: Array
    payload: Array

    def motion(self, arm: Arm) -> Motion:
        """The cycle as a motion of an arm, its forces and payloads at the tip."""
        loaded = replace(arm, payload=replace(self.load, moving=None))
        return Motion(loaded, self.time, self.q, self.velocity, self.acceleration, payload_mass=self.payload)

    def sample(self, k: int) -> LoadCase:
        """What acts at one of its instants (from 0)."""
        q, velocity, acceleration = (tuple(rows[k].tolist()) for rows in (self.q, self.velocity, self.acceleration))
        moving = Moving(q, velocity, acceleration, float(self.time[k]), self)
        return replace(self.load, mass=float(self.payload[k]), moving=moving)


def read_cycle(path: Path, arm: Arm, load: LoadCase) -> Cycle:
    """The cycle that a table holds: `time_s`, `q1_deg` ..., and `payload_kg` where the payload changes.

    Velocities and accelerations are those of the cubic spline through the samples; where the cycle ends where it began
    they are alike there. Raises `InputError`.
    """
    content = pose_columns(path)
    clock = next((name for name in _CLOCKS if name in content), None)
    if clock is None:
        raise InputError(path, _CLOCKS[0], f"is missing; a motion has a clock; the file has {', '.join(content)}")
    time, q = numbers(content[clock]), poses_of(content, path, arm)
    if len(time) < 4 or not bool((np.diff(time) > 0.0).all()):
        raise InputError(path, clock, "does not ascend; a motion has four instants or more, each later")
    payload = np.full(len(time), load.mass)
    if _PAYLOAD in content:
        payload = numbers(content[_PAYLOAD])
        if not bool((payload >= 0.0).all()):
            raise InputError(path, _PAYLOAD, "holds cells that are no masses")
    velocity, acceleration = _rates(time, q)
    return Cycle(str(path), load, time, q, velocity, acceleration, payload)


def _rates(time: Array, q: Array) -> tuple[Array, Array]:
    """Velocities and accelerations (N, n) of the cubic spline through coordinates (N, n)."""
    from scipy.interpolate import CubicSpline  # here, as few problems have a cycle

    closed = float(np.abs(q[-1] - q[0]).max()) < _ROUND
    values = np.vstack([q[:-1], q[:1]]) if closed else q
    spline: Any = CubicSpline(time, values, bc_type="periodic" if closed else "not-a-knot")
    return np.asarray(spline(time, 1)), np.asarray(spline(time, 2))


def cycles_of(cases: Sequence[LoadCase]) -> tuple[Cycle, ...]:
    """The cycles that load cases are instants of."""
    sources = (case.moving.source for case in cases if case.moving is not None)
    return tuple(dict.fromkeys(source for source in sources if isinstance(source, Cycle)))


def worst_samples(arm: Arm, cycle: Cycle) -> tuple[int, ...]:
    """The instants (from 0) at which the tip errs most, or a link bears most at its joint or its far end."""
    state = _state(arm, cycle)
    rows = len(cycle.time)
    badness = [errors_along(arm, cycle, state)]
    for link in state.links:
        badness += [_size(vector, rows) for vector in (link.base_moment, link.force, link.moment)]
        badness.append(np.abs(np.einsum("ni,ni->n", columns(link.moment, rows), columns(link.along, rows))))
    return tuple(sorted({int(np.argmax(item)) for item in badness if item.any()} or {0}))


def errors_along(arm: Arm, cycle: Cycle, state: PoseState | None = None) -> Array:
    """The tip's error (N,) at each instant of a cycle, m, to first order, play as the arm counts it."""
    state = _state(arm, cycle) if state is None else state
    error, rows = tip_error(state, active_effects(arm)), len(cycle.time)

    def stacked(vectors: Sequence[Any]) -> Array:
        parts = [columns(vector, rows) for vector in vectors]
        return np.stack(parts, axis=1) if parts else np.zeros((rows, 0, 3))

    seating = [np.broadcast_to(np.asarray(item.seating, dtype=float), (rows,)) for item in error.intervals]
    scale = sum((_size(link.force, rows) + _size(link.weight, rows) for link in state.links), np.zeros(rows))
    arrays = PoseArrays(
        columns(error.vector, rows),
        stacked([item.vector for item in error.intervals]),
        np.stack(seating, axis=1) if seating else np.zeros((rows, 0)),
        stacked([disc.normal for disc in error.discs]),
        stacked([disc.seating for disc in error.discs]),
        scale,
    )
    radii = np.array([disc.radius for disc in error.discs])
    return played(arrays, radii, arm.play, planar=state.planar, statistics=arm.statistics).error


def _state(arm: Arm, cycle: Cycle) -> PoseState:
    """The arm at all instants at once."""
    q, velocity, acceleration = (tuple(rows.T) for rows in (cycle.q, cycle.velocity, cycle.acceleration))
    moving = Moving(q, velocity, acceleration, cycle.time, cycle)
    case = replace(cycle.load, moving=moving)
    beams = beams_of(arm, (cycle.load,))
    return solve(arm, list(cycle.q.T), beams, case, payload_mass=cycle.payload)


def _size(vector: Any, rows: int) -> Array:
    return np.linalg.norm(columns(vector, rows), axis=1)
