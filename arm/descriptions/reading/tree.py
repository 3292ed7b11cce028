"""The tree of links and joints that a description of a robot is read into."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import FloatVector
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO, Rotation, about, add, compose, rotate
from linkwright.core.arm.descriptions.reading.elements import Element
from linkwright.core.sections.numeric import Array


def transform(rotation: Array | Sequence[Sequence[float]], translation: Sequence[float] | Array) -> Array:
    """A rotation (3, 3) and a shift as one matrix (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.asarray(rotation, dtype=float), np.asarray(translation, dtype=float)
    return matrix


def turned(axis: Array, angle: float) -> Array:
    """A turn (3, 3) about an axis."""
    x, y, z = (float(item) for item in axis / np.linalg.norm(axis))
    return np.array(about((x, y, z), math.cos(angle), math.sin(angle)), dtype=float)


def about_line(axis: Array, point: Array, angle: float) -> Array:
    """A turn (4, 4) about a line through a point."""
    rotation = turned(axis, angle)
    return transform(rotation, point - rotation @ point)


Kind = Literal["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "ball"]
Frame = tuple[Rotation, FloatVector]
"""A rotation and a translation (m): where a frame stands in another."""

NO_STEP: Frame = (IDENTITY, ZERO)


def onward(first: Frame, second: Frame) -> Frame:
    """Where a frame stands that stands at `second` in one that stands at `first`."""
    return compose(first[0], second[0]), add(first[1], rotate(first[0], second[1]))


@dataclass(frozen=True)
class Inertial:
    """A link's mass (kg) and its centre in the link's frame (m), with its `inertia` (3, 3; kg*m^2) about that centre
    along the link's axes; None where the file has none."""

    mass: float
    center: FloatVector
    inertia: Array | None


@dataclass(frozen=True)
class Shape:
    """What a link is drawn by: a `kind` (box, cylinder, sphere, capsule, mesh) with its `sizes` (m; of a mesh its
    scale), where it stands in the link's frame, and the `file` of a mesh as the robot names it. Of a mesh with `hulls`
    what is hollow between facets and its centre counts as full, as MuJoCo has it unless it is told otherwise."""

    kind: str
    sizes: tuple[float, ...]
    origin: Frame
    file: str = ""
    hulls: bool = False


@dataclass(frozen=True)
class TreeLink:
    """A link: its weight (None where the file says nothing of it), what it is drawn by, and the tags of what else
    stands in it. `weighed`: whether the file says what it weighs, be it nothing; None where formats leave that open.
    `unread` are the meshes without which nobody knows where its weight is, `unplaced` (kg) what of it that is."""

    inertial: Inertial | None
    shapes: tuple[Shape, ...]
    beside: tuple[str, ...]
    weighed: bool | None = None
    unread: tuple[str, ...] = ()
    unplaced: float = 0.0

    @property
    def mass(self) -> float:
        """The mass (kg) that the file gives it, 0 where it says nothing."""
        return self.unplaced + (0.0 if self.inertial is None else self.inertial.mass)


@dataclass(frozen=True)
class Limits:
    """A joint's least and greatest coordinate (rad or m), its greatest effort (N*m or N) and speed (rad/s or m/s); None
    where not said."""

    lower: float
    upper: float
    effort: float | None
    velocity: float | None


@dataclass(frozen=True)
class Mimic:
    """What a joint follows: its coordinate is `multiplier` times that of `joint`, plus `offset`."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class TreeJoint:
    """A joint between two links; `origin` is where it stands in the parent's frame, `axis` is a unit vector in its own.

    `friction` is in N*m or N, `damping` in N*m*s/rad or N*s/m, `armature` in kg*m^2 or kg; a spring of `stiffness`
    (N*m/rad or N/m) is slack at the coordinate `rest`.
    """

    name: str
    kind: Kind
    parent: str
    child: str
    origin: Frame
    axis: FloatVector
    limits: Limits | None
    mimic: Mimic | None
    friction: float
    damping: float
    element: Element
    armature: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0

    @property
    def moves(self) -> bool:
        """Whether it is a joint of one coordinate."""
        return self.kind in ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Robot:
    """A tree of links and joints, each by its name; `above` is the joint that carries a link."""

    name: str
    file: Path
    root: str
    links: Mapping[str, TreeLink]
    joints: Mapping[str, TreeJoint]
    above: Mapping[str, TreeJoint]
    below: Mapping[str, tuple[TreeJoint, ...]]
    gravity: FloatVector = (0.0, 0.0, -9.81)
    """m/s^2, in the frame of the root."""
    beside: tuple[str, ...] = ()
    """The tags of what else stands in the file beside links and joints, once each."""
