"""What a tip can reach: rings without joint limits, balls around poses with them, and straight seams between points.

Without joint limits a planar chain of turning joints reaches the ring between max(0, 2 max(l) - sum(l)) and sum(l)
around its first joint (a chain closes when its longest link is no longer than the rest together). With limits nothing
so short is true. There each pose q proves a ball: with J the tip's Jacobian over some of the joints, P its right
inverse and L a Lipschitz constant of J, y -> tip(q + P y) - tip(q) differs from y by at most L |P|^2 |y|^2 / 2, and
that difference contracts, so that every point within rho - L |P|^2 rho^2 / 2 has a pose, as long as L |P|^2 rho <= 1
and no joint leaves its range (Newton and Kantorovich; Ortega & Rheinboldt, Iterative Solution of Nonlinear Equations,
section 12.6).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import turns_by_coordinates
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.vectors import norm
from linkwright.core.sections.numeric import Array

from .inverse import damped
from .workspace import Workspace, climbing_bounds, joint_box, spread, wrapped


@dataclass(frozen=True)
class Ring:
    """The points of the plane between two radii (m) around a center (m)."""

    center: tuple[float, float]
    inner: float
    outer: float

    def missing(self, point: Sequence[float]) -> float:
        """How far a point (m) lies outside the ring; 0 on it."""
        radius = math.hypot(point[0] - self.center[0], point[1] - self.center[1])
        return max(radius - self.outer, self.inner - radius, 0.0)

    def first_outside(self, start: Sequence[float], end: Sequence[float]) -> float | None:
        """The share (0 to 1) of the segment at which it first leaves the ring, exactly; None where it never does."""
        size = self.outer or 1.0
        if self.missing(start) > 1e-12 * size:
            return 0.0
        ahead = (end[0] - start[0], end[1] - start[1])
        away = (start[0] - self.center[0], start[1] - self.center[1])
        square = ahead[0] ** 2 + ahead[1] ** 2
        if square == 0.0:
            return None
        half = (away[0] * ahead[0] + away[1] * ahead[1]) / square
        leaves: list[float] = []
        for radius, outwards in ((self.outer, 1.0), (self.inner, -1.0)):
            inside = half * half - (away[0] ** 2 + away[1] ** 2 - radius * radius) / square
            if inside > 1e-14 and radius > 0.0:
                leaves.append(-half + outwards * math.sqrt(inside))
        beyond = [share for share in leaves if -1e-12 <= share < 1.0 - 1e-12]
        return max(0.0, min(beyond)) if beyond else None


def ring_of(lengths: Sequence[float], center: tuple[float, float] = (0.0, 0.0)) -> Ring:
    """The ring that a planar chain of turning joints without limits reaches; lengths in m."""
    total = float(sum(lengths))
    return Ring(center, max(0.0, 2.0 * float(max(lengths)) - total), total)


def free_ring(arm: Arm) -> Ring | None:
    """The ring that an arm reaches, exactly; None unless it is planar and all its joints turn full circle."""
    flat = arm.flat and all(joint.revolute and joint.follows is None for joint in arm.joints)
    if not flat or any(high - low < 2.0 * math.pi - 1e-12 for low, high in (joint.range for joint in arm.joints)):
        return None
    frames = place(arm, [0.0] * arm.size)
    steps = [frame.vector for frame in frames.links]
    leads = [joint.lead for joint in frames.joints]
    arms = [
        [a + b for a, b in zip(steps[index], leads[index + 1] if index + 1 < arm.size else frames.tool, strict=True)]
        for index in range(arm.size)
    ]
    if arm.angles == "absolute" and (any(map(any, leads)) or any(frames.tool)):
        return None
    return ring_of([float(norm((x, y, z))) for x, y, z in arms], (float(leads[0][0]), float(leads[0][1])))


@dataclass(frozen=True)
class ProvenBall:
    """Every point within `radius` (m) of the tip at pose `q` has a pose near q within the joint ranges."""

    q: tuple[float, ...]
    radius: float


@dataclass(frozen=True)
class Reach:
    """What an arm's tip reaches within its joint ranges, by search and, around given poses, by proof."""

    arm: Arm

    @property
    def dimensions(self) -> int:
        """2 for an arm that moves in the x-y plane, else 3."""
        return 2 if self.arm.flat else 3

    @cached_property
    def _box(self) -> tuple[Array, Array]:
        return joint_box(self.arm, Workspace())

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return climbing_bounds(self.arm, *self._box)

    @cached_property
    def bending(self) -> float:
        """A Lipschitz constant of the tip's Jacobian (m per rad^2 in the mixed units of the joints), over all poses.

        A second derivative is at most the reach beyond the later of its two joints, 1 where that one slides and an
        earlier one turns, and 0 where the earlier one slides; the constant is the Frobenius norm of these bounds.
        """
        arm, beyond = self.arm, self._beyond()
        plain = all(joint.revolute and not any(joint.origin_translation) for joint in arm.joints)
        if arm.angles == "absolute" and plain and not any(arm.tool):
            return math.hypot(*arm.lengths)  # each joint turns its link and no other
        square = 0.0
        for i, j in itertools.product(range(arm.size), repeat=2):
            first, later = min(i, j), max(i, j)
            if not arm.joints[first].revolute or (i == j and not arm.joints[i].revolute):
                continue
            square += (beyond[later] if arm.joints[later].revolute else 1.0) ** 2
        # Where joints follow others, second derivatives in the coordinates are those in the joints' turns, H, as
        # C' H C.
        return math.sqrt(square) * float(np.linalg.norm(turns_by_coordinates(arm), 2)) ** 2

    def _beyond(self) -> list[float]:
        """For each joint, the most that can lie between its axis' origin and the tip, m."""
        total = float(norm(self.arm.tool))
        beyond = [0.0] * self.arm.size
        for index in range(self.arm.size - 1, -1, -1):
            link, joint = self.arm.links[index], self.arm.joints[index]
            total += link.length
            if not joint.revolute:
                total += max(abs(end + joint.zero) for end in joint.range)
            beyond[index] = total
            total += float(norm(joint.origin_translation))
        return beyond

    def tip(self, q: Array) -> Array:
        """Tips (N, 2 or 3) at poses (N, n), m."""
        return tip_position(self.arm, q)[:, : self.dimensions]

    def nearest(self, points: Array, seeds: int = 48, starts: Array | None = None) -> tuple[Array, Array]:
        """Poses whose tips come nearest to points (N, 2 or 3), and the distances missing (m), by search.

        Returns (N, s, n) and (N, s): every seed's outcome. `starts` (s, n) replaces the seeds. A distance is an upper
        bound of the true one.
        """
        lower, upper = self._box
        rows = spread(lower, upper, seeds) if starts is None else starts
        goals = np.zeros((len(points), 3))
        goals[:, : points.shape[1]] = points
        q, miss = damped(
            self.arm, np.tile(rows, (len(points), 1)), np.repeat(goals, len(rows), axis=0), None, self._bounds
        )
        distance = np.sqrt((miss * miss).sum(axis=1)).reshape(len(points), len(rows))
        return wrapped(self.arm, q, lower, upper).reshape(len(points), len(rows), -1), distance

    def ball(self, q: Array) -> ProvenBall:
        """The largest ball that the pose q (n,) proves, over all choices of which joints move."""
        size = self.dimensions
        slope = jacobian(self.arm, q[None])[0].T[:size]
        lower, upper = self._bounds
        room = np.minimum(q - lower, upper - q)
        best = 0.0
        movable = [index for index in range(self.arm.size) if room[index] > 0.0]
        for count in range(size, len(movable) + 1):
            for chosen in itertools.combinations(movable, count):
                best = max(best, self._covered(slope[:, chosen], room[list(chosen)]))
        return ProvenBall(tuple(q.tolist()), best)

    def _covered(self, slope: Array, room: Array) -> float:
        left, values, right = np.linalg.svd(slope, full_matrices=False)
        if values[-1] <= 1e-9 * max(values[0], 1e-9):
            return 0.0
        inverse = right.T @ (left / values).T
        curving = self.bending / float(values[-1]) ** 2
        steps = np.sqrt((inverse * inverse).sum(axis=1))
        most = float(np.min(room / np.maximum(steps, 1e-300)))
        far = most if curving == 0.0 else min(1.0 / curving, most)
        return far - 0.5 * curving * far * far if math.isfinite(far) else 0.0
