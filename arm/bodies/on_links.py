"""What moves with each link of an arm: the link itself, what hangs on it, and the joints that ride on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.vectors import ZERO, add, rotate, scale
from linkwright.core.sections.numeric import Array

from .bodies import Mass, ball, known_body, rod, together


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
