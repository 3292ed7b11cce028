"""Masses with their centres and inertias, put together: what moves with each link, and what other
programs ask of a body."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.vectors import ZERO, Vector, add, rotate, scale
from linkwright.core.materials.material import MaterialValues
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import Tapered

_NODES = 12
"""Gauss points along a taper, whose second moments are smooth."""
_ROUNDING = 1e-6
"""Of the greatest moment: by so much tensors are off that are written with six digits."""
_STEEL = 7850.0
"""kg/m^3, of the balls that stand for masses of unknown shape."""


@dataclass(frozen=True)
class Mass:
    """A mass (kg), its centre (m) and its inertia about the centre (3, 3; kg*m^2), in a body's frame."""

    mass: float
    center: Array
    inertia: Array

    @property
    def moments(self) -> Array:
        """The principal moments of inertia (3; kg*m^2), least first."""
        return principal_moments(self.inertia)

    def moved(self, step: Vector) -> Mass:
        """The same in a frame whose origin is a `step` (m) further."""
        return Mass(self.mass, self.center - np.array(step, dtype=float), self.inertia)


def principal_moments(inertia: Array) -> Array:
    """The principal moments (3; kg*m^2) of a tensor (3, 3), least first."""
    return np.asarray(np.linalg.eigvalsh(inertia), dtype=float)


def ball(mass: float, center: Vector | Array) -> Mass:
    """A solid ball of steel."""
    radius = (3.0 * mass / (4.0 * math.pi * _STEEL)) ** (1.0 / 3.0)
    return Mass(mass, np.array(center, dtype=float), 0.4 * mass * radius**2 * np.eye(3))


def together(parts: Iterable[Mass]) -> Mass | None:
    """Several masses as one (parallel axes); None where there is none."""
    held = [part for part in parts if part.mass > 0.0]
    if not held:
        return None
    total = sum(part.mass for part in held)
    center = sum((part.mass * part.center for part in held), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for part in held:
        away = part.center - center
        inertia += part.inertia + part.mass * (away @ away * np.eye(3) - np.outer(away, away))
    return Mass(total, center, inertia)


def rod(link: Link, beam: Beam, axes: Array, material: MaterialValues | None) -> Mass:
    """A link by itself, in the frame of its joint; `axes` are its directions along, height and width, as columns.

    An elastic link has its section's second moments; a rigid one is taken for a slender rod of its mass that has its
    centre where the file says.
    """
    along = axes[:, 0]
    length = float(beam.length)
    if not link.elastic or material is None:
        if length == 0.0:
            return ball(float(beam.lumped_mass), float(beam.lumped_at) * along)
        mass, center = float(beam.lumped_mass), float(beam.lumped_at)
        spread = mass * length**2 / 12.0
        solid = ball(mass, center * along).inertia
        return Mass(mass, center * along, solid + spread * (np.eye(3) - np.outer(along, along)))
    mass = float(beam.mass)
    assert link.section is not None  # an elastic link has one
    balance = beam.taper.balance
    spread, (about_width, about_height) = _along(link.section)
    about = material.need("density") * length * np.array([about_width, about_height])
    slender = mass * length**2 * (spread - balance**2)
    # Second moments about the width (which resists bending along the height) and about the height.
    inertia = np.diag([about[0] + about[1], slender + about[1], slender + about[0]])
    return Mass(mass, balance * length * along, axes @ inertia @ axes.T)


def known_body(link: Link, beam: Beam, axes: Array) -> Mass | None:
    """All that weighs on a rigid link whose tensor is known (but motors of joints), in the frame of its joint; None for
    other links, and for a tensor that no simulator takes."""
    if link.inertia is None or negative_moment(link) is not None:
        return None
    point = np.zeros((3, 3))
    parts = [Mass(float(beam.lumped_mass), float(beam.lumped_at) * axes[:, 0], point)]
    for mass in link.masses:
        if mass.motor_of is None:
            from_joint = axes @ np.array(mass.at)
            end = link.length * axes[:, 0] if mass.on == "end" else 0.0
            parts.append(Mass(mass.mass, from_joint + end, point))
    whole = together(parts)
    if whole is None:
        return None
    return Mass(whole.mass, whole.center, _tensor(link))


def negative_moment(link: Link) -> float | None:
    """A principal moment (kg*m^2) of a link's tensor that is below zero, as no body has it; None where all are not."""
    if link.inertia is None:
        return None
    moments = np.linalg.eigvalsh(_tensor(link))
    return float(moments[0]) if moments[0] < -_ROUNDING * moments[2] else None


def _tensor(link: Link) -> Array:
    assert link.inertia is not None
    xx, yy, zz, xy, xz, yz = link.inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _along(section: Section) -> tuple[float, Array]:
    """The mean square of the share of the length at which a link's mass stands, and its mean second moments of area
    (m^4): that about the width and that about the height."""
    points, weights = leggauss(_NODES)
    share, weights = 0.5 * (points + 1.0), 0.5 * weights
    cuts = section.along(share, 0.3) if isinstance(section, Tapered) else section.properties(0.3)
    area, *second = (
        np.broadcast_to(np.asarray(item, dtype=float), share.shape)
        for item in (cuts.area, cuts.second_moment_y, cuts.second_moment_z)
    )
    return float(weights @ (area * share**2) / (weights @ area)), np.array([weights @ item for item in second])


@dataclass(frozen=True)
class OnLink:
    """What moves with a link, in the frame of its joint: the link's own `body`, what is fixed to its joint's side and
    what to its far end."""

    body: Mass
    at_joint: tuple[Mass, ...]
    at_end: tuple[Mass, ...]

    @property
    def whole(self) -> Mass | None:
        """All of it as one mass; None where nothing weighs."""
        return together([*self.at_joint, self.body, *self.at_end])


def link_axes(joint: Joint, link: Link) -> Array:
    """The directions along a link and along its section's height and width, as columns (3, 3), in its frame."""
    height, width = section_directions(link, joint)
    return np.array([link.direction, height, width], dtype=float).T


def masses_on_link(arm: Arm, index: int, beam: Beam) -> OnLink:
    """What moves with a link (from 0) that is this beam; masses without a shape are taken for balls of steel."""
    link, joint = arm.links[index], arm.joints[index]
    axes, vector = link_axes(joint, link), scale(link.length, link.direction)
    material = None if link.material is None else link.material.at(arm.temperature)
    known = known_body(link, beam, axes)
    at_joint: list[Mass] = []
    at_end: list[Mass] = []
    for mass in link.masses:
        if known is not None and mass.motor_of is None:
            continue
        place = axes @ np.array(mass.at)
        if mass.on == "joint":
            at_joint.append(ball(mass.mass, place))
        else:
            at_end.append(ball(mass.mass, place + np.array(vector)))
    if not joint.revolute:
        at_joint.append(ball(joint.mass, ZERO))
    for other in (arm.joints[k] for k, before in enumerate(link_before(arm)) if before == index):
        if other.revolute:
            place = add(vector, rotate(link.end_rotation, other.origin_translation))
            at_end.append(ball(other.mass, place))
    return OnLink(known or rod(link, beam, axes, material), tuple(at_joint), tuple(at_end))


def link_before(arm: Arm) -> list[int | None]:
    """The link (from 0) on which each joint stands; none for the first."""
    firsts = {branch.first for branch in arm.branches}
    foot = arm.branches[0].first - 1 if arm.branches else 0
    return [None if index == 0 else foot if index in firsts else index - 1 for index in range(arm.size)]
