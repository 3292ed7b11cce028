"""An arm that is looked at pose by pose: its links as solids in space, the shape that its loads bend it to, and the
error of its tip there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.unknown_mass import unknown_taken_out
from linkwright.core.arm.placed.views import upwards, walked
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.search import WorstPose, WorstSearch
from linkwright.core.arm.worst.workspace import Workspace, joint_box, spread
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.report.pictures.loads import bent_shape
from linkwright.report.pictures.svg import nice_below

Outline: TypeAlias = list[tuple[float, float]]
_REACHED = 400
_SHARE = 0.12
"""What of the arm's size an error is drawn as."""
_TAPER_PIECES = 6


@dataclass(frozen=True)
class Piece:
    """A piece of a link: its outer outline (m, against its width and along its height, which with the link's course are
    right-handed), and the shares of the link's length that it goes from and to."""

    outline: Outline
    begin: float
    end: float


@dataclass(frozen=True)
class Placed:
    """A link at a pose: where it begins (m), the columns of its rotation (against its width, along its height,
    along the link), its length (m)."""

    start: Array
    rotation: Array
    length: float


@dataclass(frozen=True)
class Look:
    """An arm at a pose, m: its links, its joints with their axes, the straight stretches between the links, the tip,
    the bent course (N, 3) with its displacements (None where a mass is not known), and the worst error there."""

    links: tuple[Placed, ...]
    joints: tuple[tuple[Array, Array], ...]
    leads: tuple[tuple[Array, Array], ...]
    tip: Array
    bent: tuple[Array, Array] | None
    worst: WorstPose | None


class Posed:
    """An arm as a page looks at it; what its poses share is worked out once."""

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.up = np.array([0.0, 1.0, 0.0]) if arm.planar() else upwards(arm)
        self.pieces = tuple(() if link.section is None else _pieces(link.section) for link in arm.links)

    @cached_property
    def size(self) -> float:
        """The farthest that a tip gets from the base, m."""
        q = spread(*joint_box(self.arm, Workspace()), _REACHED)
        tips = [branch.name for branch in self.arm.branches] or [""]
        far = max(float(np.linalg.norm(tip_position(self.arm.on(tip), q), axis=1).max()) for tip in tips)
        return max(far, 0.25 * sum(self.arm.lengths), 1e-3)

    def at(self, q: Sequence[float]) -> Look:
        """The arm at a pose (rad, m)."""
        bodies, leads = walked(self.arm, q)
        links = tuple(
            Placed(body.joint, np.column_stack((-body.width, body.height, body.along)), body.length) for body in bodies
        )
        joints = tuple((body.joint, body.axis) for body in bodies)
        for body, link in zip(bodies, self.arm.links, strict=True):
            leads += [(body.before, body.joint), *([] if link.section is not None else [(body.joint, body.end)])]
        tip = np.array(place(self.arm, list(q)).tip(), dtype=float)
        seen = tuple((a, b) for a, b in leads if float(np.linalg.norm(b - a)) > 1e-6 * self.size)
        return Look(links, joints, seen, tip, self._bent(q), self._worst(q))

    def scale(self, look: Look) -> float:
        """By how much errors and displacements of a pose are drawn larger: a round number."""
        sizes = [] if look.bent is None else [float(np.linalg.norm(look.bent[1], axis=1).max())]
        sizes += [] if look.worst is None else [look.worst.error]
        return max(1.0, nice_below(_SHARE * self.size / max(sizes))) if max(sizes, default=0.0) > 0.0 else 1.0

    def _bent(self, q: Sequence[float]) -> tuple[Array, Array] | None:
        case = self.arm.cases[0]
        arm = self.arm.on(case.tip or self.arm.tip)
        try:
            return bent_shape(arm, solve(arm, list(q), beams_of(arm, (case,)), case))
        except (InputError, MissingProperty):
            return None

    def _worst(self, q: Sequence[float]) -> WorstPose | None:
        """The worst error at a pose over the load cases; None where the arm's data cannot tell it."""
        try:
            search, p = self._search
            return max(
                (pose for case in range(len(search.model.cases)) for pose in search.worst_poses_at(_row(q), p, case)),
                key=lambda pose: pose.error,
            )
        except (InputError, MissingProperty, NoAnswer):
            return None

    @cached_property
    def _search(self) -> tuple[WorstSearch, Array]:
        arm = unknown_taken_out(self.arm, self.arm.cases)
        p = beam_values(beams_of(arm, self.arm.cases))
        return worst_search(error_model(arm, self.arm.cases), Workspace()), p


def _row(q: Sequence[float]) -> Array:
    return np.array([q], dtype=float)


def _pieces(section: Section) -> tuple[Piece, ...]:
    """The outer edge of a section, of a tapered one from piece to piece."""
    if not isinstance(section, Tapered):
        return (Piece(_edge(section), 0.0, 1.0),)
    near, far = (np.asarray(end.outline()[0], dtype=float) for end in (section.near, section.far))
    if near.shape != far.shape:
        return (Piece(_edge(section.near), 0.0, 1.0),)
    shares = np.linspace(0.0, 1.0, _TAPER_PIECES + 1)
    return tuple(Piece(_points(near + 0.5 * (a + b) * (far - near)), float(a), float(b)) for a, b in pairwise(shares))


def _edge(section: Section) -> Outline:
    return _points(np.asarray(section.outline()[0], dtype=float))


def _points(ring: Array) -> Outline:
    return [(-float(x), float(y)) for x, y in ring]
