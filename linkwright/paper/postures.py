"""How far a tip can be wrong at given points, in given directions: over every posture that holds the tip there.

The errors that deformation and play leave possible at one posture are a convex set: the deformation's vector, plus an
interval for each play, plus a disc for each clearance. Its support function is how far it reaches in a direction d:
h(d) = v.d + sum |I_k.d| + sum r_j |d - (n_j.d) n_j| (R. Schneider, Convex Bodies: The Brunn-Minkowski Theory, 1.7).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Unreachable, Workspace, pull
from linkwright.core.sections.numeric import Array

_HELD = 1e-7
"""How near (m) a posture's tip must be to its point."""
_NEAR = (0.2, 0.05, 0.01, 0.002)
"""How far (rad, m) the postures tried around the best ones lie from them, round after round."""


@dataclass(frozen=True)
class Postures:
    """The postures of an arm at points, and how far its error reaches there; play counts as worst.

    `count` postures are sought at each point, spread over the joint ranges; the best are refined. What is found is
    never more than the truth, and comes near it: postures are sampled, not enclosed.
    """

    arm: Arm
    count: int = 256

    @cached_property
    def search(self) -> WorstSearch:
        """The arm's model and its joint ranges; raises `PropertyNeeded` or `MissingProperty` where data lacks."""
        return WorstSearch(error_model(self.arm), Workspace())

    @cached_property
    def design(self) -> Array:
        """The arm's own rigidities and lengths."""
        return beam_values(beams_of(self.arm))

    def support(self, q: Array, directions: Array) -> Array:
        """How far the error reaches (m, N x D) at postures q (N, n) in unit directions (D, 3) or (N, D, 3)."""
        case = self.search.model.cases[0]
        arrays = case.arrays(np.ascontiguousarray(q), self.design)
        d = np.broadcast_to(directions, (len(q), *directions.shape[-2:]))
        reach = np.einsum("ni,nmi->nm", arrays.vector, d)
        reach += np.abs(np.einsum("nki,nmi->nkm", arrays.intervals, d)).sum(axis=1)
        for disc, radius in enumerate(case.radii):
            along = np.einsum("ni,nmi->nm", arrays.normals[:, disc], d)
            reach += radius * np.sqrt(np.maximum(1.0 - along * along, 0.0))
        return reach

    def farthest(self, points: Array, directions: Array) -> Array:
        """The support at each point (P, 3) in each direction (D, 3) over all postures found there, (P, D), m.

        Raises `Unreachable` for a point without any posture.
        """
        spread = self.search.poses(self.design, self.count)
        starts = np.tile(spread, (len(points), 1))
        q, owner = self._held(starts, points, np.repeat(np.arange(len(points)), len(spread)))
        for point in range(len(points)):
            if not np.any(owner == point):
                raise Unreachable(tuple(points[point, :2].tolist()), self._missing(starts, points[point]))
        best, at = self._best(q, owner, directions, len(points))
        random = np.random.default_rng(5)
        for near in _NEAR:
            # Near each direction's best posture there may be a better one: the arm has joints to spare.
            seeds = np.unique(at)
            moved = np.repeat(q[seeds], 12, axis=0)
            moved = moved + random.normal(0.0, near, moved.shape)
            tried, owners = self._held(moved, points, np.repeat(owner[seeds], 12))
            q, owner = np.vstack([q[seeds], tried]), np.concatenate([owner[seeds], owners])
            best, at = self._best(q, owner, directions, len(points))
        return best

    def _held(self, starts: Array, points: Array, owner: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
        """The starts moved so that their tips are at their points, those that can."""
        used = np.array([1.0, 1.0, 0.0 if self.search.model.planar else 1.0])
        lower, upper = self.search.lower, self.search.upper
        q, distance = pull(lambda at: self.search.motion(at, self.design), starts, points[owner], lower, upper, used)
        return q[distance < _HELD], owner[distance < _HELD]

    def _missing(self, starts: Array, point: Array) -> float:
        lower, upper = self.search.lower, self.search.upper
        targets = np.tile(point, (min(len(starts), 64), 1))
        used = np.array([1.0, 1.0, 0.0 if self.search.model.planar else 1.0])
        few = starts[: len(targets)]
        return float(pull(lambda at: self.search.motion(at, self.design), few, targets, lower, upper, used)[1].min())

    def _best(
        self, q: Array, owner: NDArray[np.intp], directions: Array, points: int
    ) -> tuple[Array, NDArray[np.intp]]:
        reach = self.support(q, directions)
        best = np.empty((points, len(directions)))
        at = np.empty((points, len(directions)), dtype=np.intp)
        for point in range(points):
            own = np.flatnonzero(owner == point)
            first = np.argmax(reach[own], axis=0)
            at[point] = own[first]
            best[point] = reach[at[point], np.arange(len(directions))]
        return best, at


def around(count: int) -> Array:
    """Unit vectors (count, 3) evenly around the x-y plane, an even count so that each has its opposite."""
    if count % 2:
        raise ValueError("a direction and its opposite make an even count")
    turn = np.arange(count) * (2.0 * np.pi / count)
    return np.column_stack([np.cos(turn), np.sin(turn), np.zeros(count)])
