"""Settling time: how long the tip swings after a motion stops, until it stays within a distance.

Before a stop the inertia of the motion bends the arm; then it swings freely. Taken: at each instant of a cycle the
motion may stop at once (a step from its acceleration to none), bent as that acceleration bends it at rest, in the pose
of the instant; the three modes count that move the tip most, each by the envelope of its decay, all in phase. A longer
ramp leaves less. The loss factor of a mode is that of its parts, each by its share of the strain energy (E. E. Ungar
and E. M. Kerwin, J. Acoust. Soc. Am. 34 (1962) 954-957, doi:10.1121/1.1918227): links by `damping` of their material,
the least of them; drives by `retardation` D/K, whose loss factor grows with the frequency. Whatever says nothing of its
damping has none, so that the time is rather too long. Drives hold their angle at the encoder.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.statics import run_out
from linkwright.core.arm.chain.vectors import ZERO, add
from linkwright.core.arm.effects.elastic.joint_compliance import drive_retardation, file_compliance
from linkwright.core.arm.figures.design import DesignExpressions, DesignValues
from linkwright.core.arm.figures.figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from linkwright.core.arm.limits.modes import (
    SegmentedArm,
    compliance_matrices,
    coordinate_masses,
    node_masses,
    segment_beams,
    segment_coordinates,
    segmented,
    symmetric,
    work_and_inertia,
)
from linkwright.core.arm.motion.cycle import cycles_of
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity

SETTLING = "settling_time"
_MODES = 3
_STEP = 1e-5
"""Of differences of places (rad, m)."""
_NONE = 1e-9
"""Of a mode's 1/omega^2 against the greatest: no mode."""
_HALVINGS = 60
_LEAST = 1e-6
"""s; what settles within less, or at once."""
_SMALL = 1e-30
_DAMPED = 0.8


@dataclass(frozen=True)
class Settled:
    """The longest settling time (s), the pose and acceleration of the instant that the motion stopped at, and the cut
    that holds it."""

    time: float
    q: tuple[float, ...]
    cut: Cut


@dataclass(frozen=True)
class Swinging:
    """The modes (k of them) that move the tip most after stops at N poses: their `size` at the tip (N, k) in m, decay
    (N, k) in 1/s, and shape (N, k, 3 s); the tip's inertial `acceleration` (N, 3 s) in m/s^2 and `slopes` (N, n, 3 s)
    of the nodes."""

    size: Array
    decay: Array
    shape: Array
    acceleration: Array
    slopes: Array


class Settling(PoseFamily[Settled]):
    """The settling time to a distance of the tip, of the cycles of a problem."""

    needs: frozenset[str] = frozenset({"masses"})
    bounds_many: ClassVar[bool] = False

    def __init__(self, distance: float) -> None:
        """`distance`: m."""
        self.distance = distance
        self.name = self.called = f"{SETTLING} to {format_quantity(distance, 'length')}"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Settling) and self.distance == other.distance

    def __hash__(self) -> int:
        return hash(self.name)

    def prepare(self, problem: Asked) -> tuple[Arm, SegmentedArm]:
        """The arm in segments. Raises `InputError` where nothing moves, or nothing is known that damps."""
        if not cycles_of(problem.load_cases):
            raise InputError("", f"subject_to.{SETTLING}", "needs a motion: load_cases: [{motion: cycle.csv}]")
        if not _damped(problem.arm):
            raise InputError("", f"subject_to.{SETTLING}", _UNDAMPED)
        return problem.arm, segmented(problem.arm)

    def groups(self, problem: Asked) -> int:
        """One: a cut says what is carried."""
        del problem
        return 1

    def more(self, prepared: tuple[Arm, SegmentedArm]) -> int:
        """The payload, the time, the links' loss factor, and for each coordinate of a node its acceleration, its
        slopes and the shapes; which of these count."""
        arm, segments = prepared
        return 3 + _MODES + 3 * len(segments.owner) * (1 + arm.size + _MODES)

    def rows(
        self,
        prepared: tuple[Arm, SegmentedArm],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """The time by a Newton step from that of the design that the cut is of, with the shapes that it has there."""
        del group
        arm, segments = prepared
        q, more = [pose[0][k] for k in range(arm.size)], [pose[1][k] for k in range(self.more(prepared))]
        (payload, time, loss), counts, rest = more[:3], more[3 : 3 + _MODES], more[3 + _MODES :]
        nodes = 3 * len(segments.owner)
        acceleration, slopes, shapes = rest[:nodes], rest[nodes : (1 + arm.size) * nodes], rest[-_MODES * nodes :]
        masses = [ca.SX(mass) for mass in node_masses(arm, segments, design.beams, [payload])]
        left, losing = ca.SX(_SMALL), ca.SX(_SMALL)
        for number, count in enumerate(counts):
            shape = shapes[number * nodes : (number + 1) * nodes]
            work, inertia = map(ca.SX, work_and_inertia(arm, segments, q, design.beams, [payload], shape))
            forces = [masses[k // 3] * shape[k] for k in range(nodes)]
            pushed = sum((force * x for force, x in zip(forces, acceleration, strict=True)), ca.SX(0.0))
            at_tip = ca.sqrt(sum((x * x for x in shape[-3:]), ca.SX(_SMALL)))
            size = count * at_tip * work / inertia**2 * ca.sqrt(pushed**2 + _SMALL)
            omega = ca.sqrt(inertia / work)
            lost = loss
            for joint in range(arm.size):
                column = slopes[joint * nodes : (joint + 1) * nodes]
                torque = sum((x * force for x, force in zip(column, forces, strict=True)), ca.SX(0.0))
                share = file_compliance(arm, joint) * torque**2 / work
                lost = lost + share * ((drive_retardation(arm, joint) or 0.0) * omega - loss)
            rate, rise = _envelope(0.5 * lost, ca)
            size, decay = size * rise, rate * omega
            left = left + size * ca.exp(-decay * time)
            losing = losing + decay * size * ca.exp(-decay * time)
        settled = time + ca.log(left / self.distance) * left / losing
        for number, value, slack in held.on(self.name):
            yield number, settled / value - ca.exp(slack)

    def evaluate(self, design: DesignValues) -> Settled | None:
        """The longest over the instants of all cycles; None where nothing moves, or nothing is known that damps."""
        if not cycles_of(design.load_cases) or not _damped(design.arm):
            return None
        arm, loss = design.arm, _links_loss(design.arm)
        best: Settled | None = None
        for cycle in cycles_of(design.load_cases):
            for payload in np.unique(cycle.payload):
                rows = cycle.payload == payload
                q = cycle.q[rows]
                swinging = swung(arm, design.beams, float(payload), q, cycle.acceleration[rows])
                times = settled(swinging, self.distance)
                k = int(np.argmax(times))
                if best is None or times[k] > best.time:
                    parts = (swinging.acceleration[k], swinging.slopes[k].ravel(), swinging.shape[k].ravel())
                    counts = (swinging.size[k] > 0.0).astype(float)
                    numbers = np.concatenate([[float(payload), times[k], loss], counts, *parts])
                    pose = tuple(q[k].tolist())
                    best = Settled(float(times[k]), pose, Cut(pose, 0, tuple(numbers.tolist())))
        return best

    def values(self, result: Settled) -> Mapping[str, float | None]:
        """The settling time."""
        return {self.name: result.time}

    def unknown(self, result: Settled | None) -> Mapping[str, str]:
        """Why there is none."""
        return {} if result else {self.called: f"nothing moves, or the arm {_UNDAMPED}"}

    def worst(self, prepared: tuple[Arm, SegmentedArm], problem: Asked, design: DesignValues) -> list[Worst]:
        """The longest."""
        del prepared, problem
        result = self.evaluate(design)
        return [] if result is None else [Worst(self.name, result.time, result.cut)]


_UNDAMPED = (
    "says nothing of damping: give drives a retardation (effects: [{effect: joint_compliance, compliance: 0 rad/(N*m), "
    "retardation: 5 ms}]), or links a material with `damping`"
)


def _links_loss(arm: Arm) -> float:
    """The least loss factor of the links' materials; 0 where one has none."""
    return min((link.material.at(arm.temperature).damping or 0.0 for link in arm.links if link.material), default=0.0)


def _damped(arm: Arm) -> bool:
    return _links_loss(arm) > 0.0 or any(drive_retardation(arm, joint) for joint in range(arm.size))


def _envelope(ratio: Any, of: Any) -> tuple[Any, Any]:
    """Of a mode let go at rest, by its damping ratio: the rate of its envelope over omega, and how far that begins
    above the mode, `of` numpy or CasADi. Beyond 0.8 of critical damping no mode is taken to settle faster."""
    rate = of.fmin(_DAMPED, ratio - of.sqrt(of.fmax(ratio**2 - 1.0, _SMALL)))
    return rate, 1.0 / of.sqrt(1.0 - of.fmin(_DAMPED, ratio) ** 2)


def swung(arm: Arm, beams: Any, payload: float, q: Array, acceleration: Array) -> Swinging:
    """How an arm with a payload (kg) swings after accelerations (N, n) of its joints end at poses q (N, n)."""
    segments = segmented(arm)
    root = np.sqrt(coordinate_masses(arm, segments, beams, (payload,)))
    compliance = compliance_matrices(segments, beams, q)
    values, vectors = np.linalg.eigh(symmetric(compliance, root))
    real = values > _NONE * values[:, -1:]
    values = np.where(real, values, 1.0)
    # u = M^(1/2) phi of unit length, and phi = F M phi / lambda, which holds where a mass is zero too.
    shapes = np.einsum("nij,njk->nki", compliance * root[None, None, :], vectors) / values[:, :, None]
    slopes = _slopes(segments, beams, q)
    accelerated = np.einsum("nk,nki->ni", acceleration, slopes)
    size = np.abs(np.einsum("ni,nik->nk", accelerated * root, vectors)) * values * real
    size = size * np.linalg.norm(shapes[:, :, -3:], axis=2)
    torques = np.einsum("nji,i,nik->nkj", slopes, root, vectors)
    gives = np.array([file_compliance(arm, joint) for joint in range(arm.size)])
    delays = np.array([drive_retardation(arm, joint) or 0.0 for joint in range(arm.size)])
    share = gives * torques**2 / values[:, :, None]
    loss = _links_loss(arm)
    omega = 1.0 / np.sqrt(values)
    rate, rise = _envelope(0.5 * (loss + (share * (delays * omega[:, :, None] - loss)).sum(axis=2)), np)
    size, decay = size * rise, rate * omega
    most = np.argsort(-size, axis=1)[:, :_MODES]
    taken = np.take_along_axis(shapes, most[:, :, None], axis=1)
    # The greatest alone where there are fewer modes: its shape again, which does not count.
    few = np.take_along_axis(size, most, axis=1)
    taken = np.where((few > 0.0)[:, :, None], taken, taken[:, :1])
    return Swinging(few, np.take_along_axis(decay, most, axis=1), taken, accelerated, slopes)


def settled(swinging: Swinging, distance: float) -> Array:
    """The times (N,) in s after which what swings stays within a distance (m): by bisection of the envelope."""

    def left(time: Array) -> Array:
        return (swinging.size * np.exp(-swinging.decay * time[:, None])).sum(axis=1)

    rows = len(swinging.size)
    slow = np.where(swinging.size > 0.0, swinging.decay, np.inf).min(axis=1)
    more = left(np.zeros(rows)) / distance
    low, high = np.zeros(rows), np.log(np.maximum(more, 1.0)) / np.maximum(slow, _SMALL)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        within = left(middle) <= distance
        low, high = np.where(within, low, middle), np.where(within, middle, high)
    return np.maximum(np.where(more > 1.0, high, 0.0), _LEAST)


def _slopes(segments: SegmentedArm, beams: Any, q: Array) -> Array:
    """How the segments' far ends move with each joint (N, n, 3 s), m/rad (m/m)."""

    def places(at: Array) -> Array:
        coordinates = [at[:, j] for j in range(at.shape[1])]
        pieces = segment_beams(segments, run_out(segments.whole, beams, coordinates))
        lengths = [beam.length for beam in pieces]
        frames, here, ends = place(segments.ways[0].arm, segment_coordinates(segments, coordinates), lengths), ZERO, []
        for joint, link in zip(frames.joints, frames.links, strict=True):
            here = add(add(here, joint.lead), link.vector)
            ends.append(columns(here, len(at)))
        return np.concatenate(ends, axis=1)

    steps = _STEP * np.eye(q.shape[1])
    return np.stack([(places(q + step) - places(q - step)) / (2.0 * _STEP) for step in steps], axis=1)


def settling_time(distance: float) -> Figure:
    """The settling time to a distance (m)."""
    words = format_quantity(distance, "length")
    return Figure(
        name=f"{SETTLING} to {words}",
        title=f"settling time to {words}",
        senses=("<=",),
        key=f"{SETTLING}_to_{words.replace(' ', '_')}_s",
        follows=ThroughPoses(Settling(distance)),
        kind="time",
        unit="s",
        note="longest, stopped at once at any instant of a motion",
        where=lambda result: result.q,
        traded=False,
        everywhere=False,
    )


__all__ = ["SETTLING", "Settled", "Settling", "Swinging", "settled", "settling_time", "swung"]
