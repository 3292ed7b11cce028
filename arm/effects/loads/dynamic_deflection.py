"""A moving arm's inertia loads its drives, and they give.

The inertia is that of slender links with their masses spread along them (as the taper of a link has it), joints and
payload as points: recursive Newton-Euler, velocities from the base out, inertial forces (-m a) back in.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.kinematics import carried_unturned
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, add, cross, dot, scale, subtract, times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, drive_motion, size
from linkwright.core.arm.effects.traits import DriveTraits

_BOOLE = (7.0 / 90.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0)
"""Boole's rule over the quarters of a link, exact for polynomials up to the fifth degree."""


@dataclass(frozen=True)
class _Moving:
    """A link in motion: accelerations (m/s^2) of its joint and far end, angular velocity and acceleration."""

    joint: Vector
    end: Vector
    turning: Vector
    spinning_up: Vector

    def relative(self, arm: Vector) -> Vector:
        """Acceleration of a point of the link against another that lies `arm` (m) before it."""
        return add(cross(self.spinning_up, arm), cross(self.turning, cross(self.turning, arm)))


def _motion(state: PoseState, velocities: tuple[Scalar, ...], accelerations: tuple[Scalar, ...]) -> list[_Moving]:
    links: list[_Moving] = []
    before = _Moving(ZERO, ZERO, ZERO, ZERO)
    for index, joint in enumerate(state.joints):
        start = add(before.end, before.relative(state.leads[index]))
        speed, rate = scale(velocities[index], joint.axis), scale(accelerations[index], joint.axis)
        turning, spinning_up = before.turning, before.spinning_up
        if not joint.revolute:
            start = add(start, add(rate, scale(2.0, cross(turning, speed))))
        elif state.absolute:
            turning, spinning_up = speed, rate
        else:
            spinning_up = add(spinning_up, add(rate, cross(turning, speed)))
            turning = add(turning, speed)
        at_rest = _Moving(start, start, turning, spinning_up)
        before = _Moving(start, add(start, at_rest.relative(state.links[index].vector)), turning, spinning_up)
        links.append(before)
    return links


def _spread(beam: Beam) -> float:
    """The second moment of a link's mass about its joint, over its mass and the square of its length."""
    if not beam.taper.density:
        return 1.0 / 3.0
    return sum(
        weight * share * (k / 4.0) ** 2
        for k, (weight, share) in enumerate(zip(_BOOLE, beam.taper.density, strict=True))
    )


def inertial_loads(
    state: PoseState, velocities: tuple[Scalar, ...], accelerations: tuple[Scalar, ...]
) -> tuple[Scalar, ...]:
    """The load of the arm's inertia on each drive, N*m (N for a slide), at joint velocities (rad/s, m/s) and
    accelerations (rad/s^2, m/s^2)."""
    moving = _motion(state, velocities, accelerations)
    force = scale(times(-1.0, state.payload_mass), add(moving[-1].end, moving[-1].relative(state.tool)))
    moment = cross(state.tool, force)
    loads: list[Scalar] = []
    at_axes: list[Vector] = [ZERO] * (len(moving) + 1)
    for index in range(len(moving) - 1, -1, -1):
        link, joint, here = state.links[index], state.joints[index], moving[index]
        beam = link.beam
        mass = times(beam.mass_per_length, beam.length)
        # Along a rigid rod the acceleration runs linearly from its joint to its end.
        moment = add(moment, cross(link.vector, force))
        balance, spread = beam.taper.balance, _spread(beam)
        mean = add(scale(balance - spread, here.joint), scale(spread, here.end))
        moment = subtract(moment, scale(mass, cross(link.vector, mean)))
        force = subtract(force, scale(mass, add(scale(1.0 - balance, here.joint), scale(balance, here.end))))
        if not (isinstance(beam.lumped_mass, float) and beam.lumped_mass == 0.0):
            arm = scale(beam.lumped_at, link.along)
            lumped = scale(times(-1.0, beam.lumped_mass), add(here.joint, here.relative(arm)))
            moment, force = add(moment, cross(arm, lumped)), add(force, lumped)
        inertia_force = scale(-joint.mass, here.joint)
        if not joint.revolute:
            loads.append(dot(joint.axis, add(force, inertia_force)))
        elif state.absolute:
            loads.append(dot(joint.axis, subtract(moment, at_axes[carried_unturned(state.arm.joints, index)])))
        else:
            loads.append(dot(joint.axis, moment))
        at_axes[index] = moment
        force = add(force, inertia_force)
        moment = add(moment, cross(state.leads[index], force))
    return tuple(reversed(loads))


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    compliance = settings.values.get("compliance", 0.0)
    velocities, accelerations = state.conditions.velocities, state.conditions.accelerations
    if compliance == 0.0 or velocities is None or accelerations is None:
        return
    for index, load in enumerate(inertial_loads(state, velocities, accelerations)):
        if settings.acts_at(index):
            yield from drive_motion(state, index, times(compliance, load))


DYNAMIC_DEFLECTION = Effect(
    id="dynamic_deflection",
    title="deflection of the drives under inertia",
    formula="-sum J_i c_i (M q'' + h(q, q'))_i",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="flexibility",
    needs="velocities and accelerations",
    aliases=("joint_compliance", "latency"),
    source="M. W. Spong, Modeling and Control of Elastic Joint Robots, ASME J. Dyn. Sys. 109 (1987), "
    "doi:10.1115/1.3143860",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-2, (2.5e-7, 1e-4)).means(
            "compliance of the drive under inertial loads", "the reciprocal of drives' stiffnesses"
        ),
    ),
    twists=_twists,
    requires=("velocities", "accelerations"),
    rank=310,
    linear=True,
)
