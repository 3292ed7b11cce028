"""Where the links' bodies stand in space, and from where all pictures look at them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.branches import ways
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.sections.numeric import Array

_NO_SIDE = 1e-6
"""Below this sine of the angle between a link and the vertical the link is upright, and none of its sides is up."""


@dataclass(frozen=True)
class View:
    """A view of an arm: unit vectors across and up the page, in the base frame."""

    across: Array
    up: Array

    @property
    def towards(self) -> Array:
        """The unit vector from the page to who looks at it."""
        return np.cross(self.across, self.up)

    def project(self, points: Array) -> Array:
        """Points (.., 3) as places (.., 2) across and up the page, in the same unit."""
        return np.asarray(points, dtype=float) @ np.column_stack((self.across, self.up))


def upwards(arm: Arm) -> Array:
    """The unit vector against gravity; along z where an arm has none."""
    gravity = np.array(arm.gravity, dtype=float)
    size = float(np.linalg.norm(gravity))
    return -gravity / size if size else np.array([0.0, 0.0, 1.0])


def view_of(arm: Arm, tip: Array) -> View:
    """The view onto the plane in which a planar arm moves, x across; else onto the upright plane through a tip (m)."""
    if arm.flat:
        return View(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    up = upwards(arm)
    level = tip - (tip @ up) * up
    if np.linalg.norm(level) < 1e-6:
        level = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [1.0, 0.0, 0.0])
    return View(level / np.linalg.norm(level), up)


def from_above(arm: Arm, tip: Array) -> View:
    """The view down along gravity, the tip (m) to the right of the base: a SCARA's reach is seen at its true length."""
    side = view_of(arm, tip)
    return View(side.across, np.cross(side.up, side.across))


@dataclass(frozen=True)
class Side:
    """A link seen from its side with all joints at zero: across the page runs the link, `up` is up the page."""

    stand: Stand
    view: View

    @property
    def end(self) -> View:
        """The view along the link, from its joint to its far end; up is what is up in the view of the side."""
        return View(self.view.towards, self.view.up)

    def section(self, points: Array) -> Array:
        """Points (N, 2) of the section, across and along its height, as places (N, 2) on the view along the link."""
        return np.asarray(points, dtype=float) @ self.end.project(np.stack((self.stand.width, self.stand.height)))


def sides(arm: Arm) -> tuple[Side, ...]:
    """The side of each link. A planar arm is seen as its plane is; in space a link is seen from where up is up the
    page, or, where it stands upright, from where the arm is seen."""
    whole = view_of(arm, np.array(place(arm, [0.0] * arm.size).tip(), dtype=float))
    views: list[Side] = []
    for body in stands(arm):
        towards, aside = whole.towards, np.cross(body.along, whole.up)
        if not arm.flat and np.linalg.norm(aside) > _NO_SIDE:
            towards = aside
        up = np.cross(towards, body.along)
        views.append(Side(body, View(body.along, up / np.linalg.norm(up))))
    return tuple(views)


@dataclass(frozen=True)
class Stand:
    """Where a link stands (m, unit vectors, in the base frame): where what is `before` its joint ends, the joint with
    its `axis`, and where the link ends; along it and along its section's width and height; its length, of one that
    runs out of a sleeve what has run out."""

    before: Array
    joint: Array
    axis: Array
    end: Array
    along: Array
    width: Array
    height: Array
    length: float

    def at(self, share: float, points: Array) -> Array:
        """Points (N, 2) of the section, across and along its height (m, from its centroid), at a share of the length:
        (N, 3), m in the base frame."""
        across, high = np.asarray(points, dtype=float).T
        return (
            self.joint + share * self.length * self.along + np.outer(across, self.width) + np.outer(high, self.height)
        )


def stands(arm: Arm, q: Sequence[float] | None = None) -> tuple[Stand, ...]:
    """Where each link stands at joint coordinates (rad, m; None: all at zero); of several arms on one torso each link
    on the way to its tip."""
    return walked(arm, [0.0] * arm.size if q is None else q)[0]


def walked(arm: Arm, q: Sequence[float]) -> tuple[tuple[Stand, ...], list[tuple[Array, Array]]]:
    """Where each link stands at joint coordinates (rad, m), and from where to where (m) each tool runs."""
    stands_by_link: dict[int, Stand] = {}
    tools: list[tuple[Array, Array]] = []
    for way in ways(arm):
        frames, here = place(way.arm, [q[joint] for joint in way.joints]), np.zeros(3)
        for number, joint, link in zip(way.joints, frames.joints, frames.links, strict=True):
            lead, axis, vector, along, width, height = (
                np.array(item, dtype=float)
                for item in (joint.lead, joint.axis, link.vector, link.along, link.width, link.height)
            )
            before, start, here = here, here + lead, here + lead + vector
            stands_by_link[number] = Stand(before, start, axis, here, along, width, height, float(vector @ along))
        tools.append((here, here + np.array(frames.tool, dtype=float)))
    return tuple(stands_by_link[number] for number in range(arm.size)), tools
