"""URDF, the Unified Robot Description Format, as links and joints (http://wiki.ros.org/urdf/XML).

Only what an arm is made of is read: frames, limits, mimics, masses, and which shapes a link is drawn by. Collisions and
transmissions are counted and passed over.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal, cast, get_args

import numpy as np

from linkwright.core.arm.chain.chain import FloatVector
from linkwright.core.arm.chain.vectors import (
    IDENTITY,
    ZERO,
    Rotation,
    add,
    compose,
    from_roll_pitch_yaw,
    norm,
    rotate,
    unit,
)
from linkwright.core.sections.numeric import Array
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

from .elements import Element, read_elements

Kind = Literal["revolute", "continuous", "prismatic", "fixed", "floating", "planar"]
Frame = tuple[Rotation, FloatVector]
"""A rotation and a translation (m): where a frame stands in another."""

NO_STEP: Frame = (IDENTITY, ZERO)


def onward(first: Frame, second: Frame) -> Frame:
    """Where a frame stands that stands at `second` in one that stands at `first`."""
    return compose(first[0], second[0]), add(first[1], rotate(first[0], second[1]))


_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SIZES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "box": ("size",),
        "cylinder": ("radius", "length"),
        "capsule": ("radius", "length"),
        "sphere": ("radius",),
        "mesh": ("filename", "scale"),
    }
)
"""The shapes that a link can be drawn by, with the attributes of each."""
_HELD = ("effort", "velocity")
_OF_A_LINK = ("inertial", "visual", "collision")
_OF_A_ROBOT = ("link", "joint", "material")


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
    scale), where it stands in the link's frame, and the `file` of a mesh as the URDF names it."""

    kind: str
    sizes: tuple[float, ...]
    origin: Frame
    file: str = ""


@dataclass(frozen=True)
class UrdfLink:
    """A link: its weight (None where the file says nothing of it), what it is drawn by, and the tags of what else
    stands in it."""

    inertial: Inertial | None
    shapes: tuple[Shape, ...]
    beside: tuple[str, ...]

    @property
    def mass(self) -> float:
        """The mass (kg) that the file gives it, 0 where it says nothing."""
        return 0.0 if self.inertial is None else self.inertial.mass


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
class UrdfJoint:
    """A joint between two links; `origin` is where it stands in the parent's frame, `axis` is a unit vector in its own.

    `friction` is in N*m or N, `damping` in N*m*s/rad or N*s/m.
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
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]
    above: Mapping[str, UrdfJoint]
    below: Mapping[str, tuple[UrdfJoint, ...]]
    beside: tuple[str, ...] = ()
    """The tags of what else stands in the file beside links and joints, once each."""


def read_urdf(path: Path | str) -> Robot:
    """The tree that a URDF file describes. Raises `InputError`, one line, for anything wrong."""
    top = read_elements(path)
    file = top.file
    if top.tag != "robot":
        known = {"mujoco": "MJCF", "sdf": "SDF"}.get(top.tag)
        told = f"is {known}" if known else f"starts with <{top.tag}>"
        raise InputError(file, "", f"{told}, no URDF; URDF starts with <robot name=...>")
    for tag in ("xacro:include", "xacro:macro", "xacro:property", "include"):
        if (found := next(top.all(tag), None)) is not None:
            raise found.error("is a macro, not URDF; expand it first: xacro FILE.xacro > arm.urdf")
    links = _links(top)
    joints: dict[str, UrdfJoint] = {}
    above: dict[str, UrdfJoint] = {}
    below: dict[str, list[UrdfJoint]] = {name: [] for name in links}
    for element in top.all("joint"):
        joint = _joint(element, list(links))
        if joint.name in joints:
            raise element.error("is there already; names are unique")
        if joint.child in above:
            message = f"carries link {shown(joint.child)}, which joint {shown(above[joint.child].name)} carries already"
            raise element.error(f"{message}; an arm's links form a tree")
        joints[joint.name] = above[joint.child] = joint
        below[joint.parent].append(joint)
    for joint in joints.values():
        if joint.mimic is not None and joint.mimic.joint not in joints:
            message = f"mimics {shown(joint.mimic.joint)}, which is no joint{nearest(joint.mimic.joint, list(joints))}"
            raise joint.element.error(message)
    root = _root(file, [name for name in links if name not in above], below)
    name = " ".join(top.attributes.get("name", "").split()) or file.stem
    tree = {key: tuple(value) for key, value in below.items()}
    return Robot(name, file, root, links, joints, above, tree, _beside(top, _OF_A_ROBOT))


def _links(top: Element) -> dict[str, UrdfLink]:
    links: dict[str, UrdfLink] = {}
    for element in top.all("link"):
        name = element.text("name", 'name="forearm", say')
        if name in links:
            raise element.error("is there already; names are unique")
        links[name] = UrdfLink(_inertial(element), _shapes(element), _beside(element, _OF_A_LINK))
    if not links:
        raise InputError(top.file, "", "holds no <link>")
    return links


def _root(file: Path, roots: list[str], below: Mapping[str, list[UrdfJoint]]) -> str:
    """The only link that no joint carries, from which all others are reached."""
    if len(roots) != 1:
        told = f"several roots ({', '.join(map(shown, roots[:6]))})" if roots else "no root: its joints form a ring"
        raise InputError(file, "", f"has {told}; an arm's links form one tree")
    reached, pending = 0, [roots[0]]
    while pending:
        reached += 1
        pending += [joint.child for joint in below[pending.pop()]]
    if reached < len(below):
        raise InputError(file, "", "has joints that form a ring; an arm's links form one tree")
    return roots[0]


def _beside(element: Element, read: tuple[str, ...]) -> tuple[str, ...]:
    """The tags of children that are not read, once each, in their order."""
    return tuple(dict.fromkeys(child.tag for child in element.children if child.tag not in read))


def _frame(element: Element | None) -> Frame:
    if element is None:
        return NO_STEP
    return from_roll_pitch_yaw(*element.triple("rpy", ZERO)), element.triple("xyz", ZERO)


def _inertial(link: Element) -> Inertial | None:
    element = link.one("inertial")
    if element is None:
        return None
    mass = element.one("mass")
    if mass is None:
        raise element.error('has no <mass>; write <mass value="1.2"/> (kg)')
    value = mass.number("value")
    if value < 0.0:
        raise mass.error("cannot be negative")
    turn, center = _frame(element.one("origin"))
    tensor = element.one("inertia")
    if tensor is None:
        return Inertial(value, center, None)
    own = {name: tensor.number(name, 0.0) for name in _MOMENTS}
    held = np.array(
        [
            [own["ixx"], own["ixy"], own["ixz"]],
            [own["ixy"], own["iyy"], own["iyz"]],
            [own["ixz"], own["iyz"], own["izz"]],
        ]
    )
    axes = np.array(turn, dtype=float)
    return Inertial(value, center, axes @ held @ axes.T)


def _shapes(link: Element) -> tuple[Shape, ...]:
    """What a link is drawn by: its visuals, or its collisions where it has none."""
    for tag in ("visual", "collision"):
        found: list[Shape] = []
        for drawn in link.all(tag):
            if (geometry := drawn.one("geometry")) is not None:
                origin = _frame(drawn.one("origin"))
                found += [_shape(form, origin) for form in geometry.children if form.tag in _SIZES]
        if found:
            return tuple(found)
    return ()


def _shape(form: Element, origin: Frame) -> Shape:
    """A shape; without sizes where they cannot be read, for no arm depends on them."""
    file = form.attributes.get("filename", "")
    try:
        if form.tag == "box":
            return Shape("box", form.triple("size", ZERO), origin)
        if form.tag == "mesh":
            return Shape("mesh", form.triple("scale", (1.0, 1.0, 1.0)), origin, file)
        return Shape(form.tag, tuple(form.number(name, 0.0) for name in _SIZES[form.tag]), origin)
    except InputError:
        return Shape(form.tag, (), origin, file)


def _joint(element: Element, links: list[str]) -> UrdfJoint:
    name = element.text("name", 'name="elbow", say')
    kind = element.text("type", 'type="revolute", say')
    if kind not in get_args(Kind):
        raise element.error(f"type {shown(kind)} is none of {', '.join(get_args(Kind))}")
    ends: list[str] = []
    for tag in ("parent", "child"):
        end = element.one(tag)
        if end is None:
            raise element.error(f'has no <{tag}>; write <{tag} link="base"/>')
        ends.append(end.text("link", 'link="base", say'))
        if ends[-1] not in links:
            raise end.error(f"link {shown(ends[-1])} is not in the file{nearest(ends[-1], links)}")
    axis: FloatVector = (1.0, 0.0, 0.0)
    if (turned := element.one("axis")) is not None:
        axis = turned.triple("xyz", axis)
        if norm(axis) == 0.0 and kind not in ("fixed", "floating"):
            raise turned.error('has no direction; write xyz="0 0 1", say')
    friction = damping = 0.0
    if (dynamics := element.one("dynamics")) is not None:
        friction, damping = dynamics.number("friction", 0.0), dynamics.number("damping", 0.0)
    mimic = None
    if (copied := element.one("mimic")) is not None:
        leader = copied.text("joint", 'joint="elbow", say')
        mimic = Mimic(leader, copied.number("multiplier", 1.0), copied.number("offset", 0.0))
    return UrdfJoint(
        name,
        cast(Kind, kind),
        ends[0],
        ends[1],
        _frame(element.one("origin")),
        axis if norm(axis) == 0.0 else unit(axis),
        _limits(element, kind),
        mimic,
        friction,
        damping,
        element,
    )


def _limits(joint: Element, kind: str) -> Limits | None:
    element = joint.one("limit")
    if kind not in ("revolute", "prismatic", "continuous"):
        return None
    if element is None:
        if kind == "continuous":
            return None
        would_do = '<limit lower="-1.57" upper="1.57" .../>'
        also = ', or type="continuous"' if kind == "revolute" else ""
        raise joint.error(f"has no <limit>; write {would_do}{also}")
    lower, upper = (element.number(name, 0.0, finite=False) for name in ("lower", "upper"))
    if lower > upper:
        raise element.error("lower is above upper; turn them round")
    held = [element.number(name, finite=False) if name in element.attributes else None for name in _HELD]
    return Limits(lower, upper, held[0], held[1])
