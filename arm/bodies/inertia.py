"""Loads of an arm that moves: what the accelerations of its masses add to their weights (d'Alembert), link by link.

The weight of a link's mass counts as if gravity were less by an acceleration. Along a link that grows linearly: its
part that goes with the place is held as 0.4 of it spread evenly and 0.15 of it, with a moment, at the far end, which
moves, turns and bends a uniform cantilever as the linear load does (deflection 11/120, slope 1/8, root moment 1/3).
Elastic links are slender: the turning inertia of their sections is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, ball, known_body, link_axes, rod, together
from linkwright.core.arm.chain.acting import Acting, Load, masses_on
from linkwright.core.arm.chain.beam import Beam, Taper
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import Frames, LinkFrame, turns_by_drives
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, add, cross, dot, minus, plus, scale, subtract, times
from linkwright.core.sections.numeric import Array

_EVEN, _MOMENT = 0.4, -1.0 / 60.0
"""Shares of a load that grows linearly along a link: spread evenly, and the moment at its far end (per length)."""


@dataclass(frozen=True)
class Moving:
    """A motion at an instant (floats) or at N of them (arrays): coordinates (rad, m) that stand in place of the pose
    that is asked for, with their velocities and accelerations. `time` (s) is when; `source` is the cycle it is of."""

    q: tuple[Scalar, ...]
    velocity: tuple[Scalar, ...]
    acceleration: tuple[Scalar, ...]
    time: Scalar = 0.0
    source: object = field(default=None, compare=False)

    def at(self, q: Sequence[Scalar]) -> list[Scalar]:
        """Its coordinates, as many of each as q has."""
        return [
            here + 0.0 * given if isinstance(given, np.ndarray) else here for here, given in zip(self.q, q, strict=True)
        ]


@dataclass(frozen=True)
class _Swing:
    """How a body turns: rates (rad/s) and their change (rad/s^2), in the base frame."""

    rate: Vector
    change: Vector

    def at(self, step: Vector) -> Vector:
        """By how much a point a step (m) away from another accelerates beyond that, m/s^2."""
        return add(cross(self.change, step), cross(self.rate, cross(self.rate, step)))


class Inertia(Acting):
    """What accelerations do to an arm's loads: `links`, `joints` and `tip` are to be taken off gravity (m/s^2) for the
    weights that the walk inward counts; the rest acts at links' ends."""

    def __init__(self, arm: Arm, placed: Frames, beams: Sequence[Beam], moving: Moving, payload: Scalar) -> None:
        """For an arm that is a single chain; `payload` in kg."""
        matrix = turns_by_drives(arm)
        rates, changes = (_by_joint(matrix, values) for values in (moving.velocity, moving.acceleration))
        self.links: list[Vector] = []
        self.joints: list[Vector] = []
        self._far: list[Load] = []
        self._near: list[Load] = []
        swing, rising, step = _Swing(ZERO, ZERO), ZERO, ZERO
        for index, (joint, frame, beam) in enumerate(zip(arm.joints, placed.links, beams, strict=True)):
            ridden = swing
            step, axis = add(step, placed.joints[index].lead), placed.joints[index].axis
            rising = add(rising, swing.at(step))
            turn, more = scale(rates[index], axis), scale(changes[index], axis)
            if joint.revolute:
                more = add(more, cross(swing.rate, turn))
                swing = _Swing(add(swing.rate, turn), add(swing.change, more))
            else:
                rising = add(rising, add(more, scale(2.0, cross(swing.rate, turn))))
            along = swing.at(frame.vector)
            self.joints.append(rising)
            self.links.append(add(rising, scale(_EVEN, along)))
            far, near = _ends(arm, index, beam, frame, swing)
            if joint.mass and index and joint.revolute:
                self._far[-1] = self._far[-1].turned(_of_ball(joint.mass, ridden))
            self._far.append(far)
            self._near.append(near if joint.revolute else near.turned(_of_ball(joint.mass, swing)))
            step = frame.vector
        self.tip = add(rising, swing.at(add(step, placed.tool)))
        self._far[-1] = self._far[-1].turned(_of_ball(payload, swing))

    def at_end(self, link: int, load: Load) -> Load:
        """With what hangs there, and the link's share."""
        return load.pushed(self._far[link].force).turned(self._far[link].moment)

    def at_joint(self, link: int, load: Load) -> Load:
        """With what hangs there, and the link's share."""
        return load.pushed(self._near[link].force).turned(self._near[link].moment)


def _by_joint(matrix: Array, values: Sequence[Scalar]) -> list[Scalar]:
    results: list[Scalar] = []
    for row in matrix.tolist():
        total: Scalar = 0.0
        for factor, value in zip(row, values, strict=True):
            total = plus(total, times(factor, value))
        results.append(total)
    return results


def _of_ball(mass: Scalar, swing: _Swing) -> Vector:
    """The moment (N*m) of a ball of steel that turns."""
    if isinstance(mass, float | int) and mass == 0.0:
        return ZERO
    return scale(-float(ball(1.0, ZERO).inertia[0, 0]) * mass ** (5.0 / 3.0), swing.change)


def _ends(arm: Arm, index: int, beam: Beam, frame: LinkFrame, swing: _Swing) -> tuple[Load, Load]:
    """What acts at the far and at the near end of a link beyond the weights that the walk counts."""
    link = arm.links[index]
    along = swing.at(frame.vector)
    even = scale(_EVEN, along)
    far, near = Load(), Load()
    if link.elastic:
        spread = _spread(beam.taper)
        at_far = minus(minus(spread, times(_EVEN, beam.taper.balance)), _MOMENT)
        at_near = minus(minus(beam.taper.balance, _EVEN), at_far)
        mass = times(beam.mass_per_length, beam.length)
        far = far.pushed(scale(times(-1.0, times(at_far, mass)), along))
        far = far.turned(scale(times(-_MOMENT, mass), cross(frame.vector, along)))
        near = near.pushed(scale(times(-1.0, times(at_near, mass)), along))
    else:
        place = scale(beam.lumped_at, frame.along)
        near = near.pushed(scale(times(-1.0, beam.lumped_mass), subtract(swing.at(place), even)), place)
        near = near.turned(_of_body(arm, index, beam, frame, swing))
    for mass in masses_on(link.masses, beam):
        a, height, width = mass.at
        place = add(add(scale(a, frame.along), scale(height, frame.height)), scale(width, frame.width))
        from_joint = place if mass.on == "joint" else add(frame.vector, place)
        force = scale(times(-1.0, mass.mass), subtract(swing.at(from_joint), even))
        turned = ZERO if link.inertia is not None and mass.motor_of is None else _of_ball(mass.mass, swing)
        if mass.on == "joint":
            near = near.pushed(force, place).turned(turned)
        else:
            far = far.pushed(force, place).turned(turned)
    return far, near


def _spread(taper: Taper) -> Scalar:
    """The mean square of the share of a link's length at which its mass stands."""
    if not taper.stations:
        return 1.0 / 3.0
    total: Scalar = 0.0
    for one, other in zip(taper.stations[:-1], taper.stations[1:], strict=True):
        step = other.share - one.share
        total = plus(total, step * (one.share * one.weight_beyond + other.share * other.weight_beyond))
    return total


def _of_body(arm: Arm, index: int, beam: Beam, frame: LinkFrame, swing: _Swing) -> Vector:
    """The moment (N*m) of a rigid link's inertia about its masses' places, in the base frame."""
    link, axes = arm.links[index], link_axes(arm.joints[index], arm.links[index])
    plain = Beam(length=link.length, lumped_mass=beam.lumped_mass, lumped_at=beam.lumped_at)
    known = known_body(link, plain, axes)
    tensor = rod(link, plain, axes, None).inertia
    if known is not None:
        points = [Mass(float(beam.lumped_mass), float(beam.lumped_at) * axes[:, 0], np.zeros((3, 3)))]
        for mass in link.masses:
            if mass.motor_of is None:
                end = link.length * axes[:, 0] if mass.on == "end" else np.zeros(3)
                points.append(Mass(mass.mass, axes @ np.array(mass.at) + end, np.zeros((3, 3))))
        whole = together(points)
        tensor = known.inertia - (np.zeros((3, 3)) if whole is None else whole.inertia)
    rows = (axes.T @ tensor @ axes).tolist()
    basis = (frame.along, frame.height, frame.width)

    def applied(vector: Vector) -> Vector:
        parts = tuple(dot(axis, vector) for axis in basis)
        result: Vector = ZERO
        for row, axis in zip(rows, basis, strict=True):
            result = add(result, scale(dot((row[0], row[1], row[2]), (parts[0], parts[1], parts[2])), axis))
        return result

    return scale(-1.0, add(applied(swing.change), cross(swing.rate, applied(swing.rate))))
