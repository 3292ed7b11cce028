"""URDF, the Unified Robot Description Format, as links and joints (http://wiki.ros.org/urdf/XML).

Only what an arm is made of is read: frames, limits, mimics, masses, and which shapes a link is drawn by. Collisions and
transmissions are counted and passed over.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import cast, get_args

import numpy as np

from linkwright.core.arm.chain.chain import FloatVector
from linkwright.core.arm.chain.vectors import ZERO, from_roll_pitch_yaw, norm, unit
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

from .elements import Element, read_elements
from .tree import NO_STEP, Frame, Inertial, Kind, Limits, Mimic, Robot, Shape, TreeJoint, TreeLink

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
_KINDS = tuple(kind for kind in get_args(Kind) if kind != "ball")
_HELD = ("effort", "velocity")
_OF_A_LINK = ("inertial", "visual", "collision")
_OF_A_ROBOT = ("link", "joint", "material")


def read_urdf(path: Path | str) -> Robot:
    """The tree that a URDF file describes. Raises `InputError`, one line, for anything wrong."""
    return urdf_tree(read_elements(path))


def urdf_tree(top: Element) -> Robot:
    """The tree below the root element of a URDF. Raises `InputError`."""
    file = top.file
    if top.tag != "robot":
        kind = "is SDF" if top.tag == "sdf" else f"starts with <{top.tag}>"
        raise InputError(file, "", f"{kind}; URDF starts with <robot name=...>, MJCF with <mujoco>")
    for tag in ("xacro:include", "xacro:macro", "xacro:property", "include"):
        if (robot := next(top.all(tag), None)) is not None:
            raise robot.error("is a macro, not URDF; expand it first: xacro FILE.xacro > arm.urdf")
    links = _links(top)
    joints: dict[str, TreeJoint] = {}
    above: dict[str, TreeJoint] = {}
    below: dict[str, list[TreeJoint]] = {name: [] for name in links}
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
    return Robot(name, file, root, links, joints, above, tree, beside=_beside(top, _OF_A_ROBOT))


def _links(top: Element) -> dict[str, TreeLink]:
    links: dict[str, TreeLink] = {}
    for element in top.all("link"):
        name = element.text("name", 'name="forearm", say')
        if name in links:
            raise element.error("is there already; names are unique")
        links[name] = TreeLink(_inertial(element), _shapes(element), _beside(element, _OF_A_LINK))
    if not links:
        raise InputError(top.file, "", "holds no <link>")
    return links


def _root(file: Path, roots: list[str], below: Mapping[str, list[TreeJoint]]) -> str:
    """The only link that no joint carries, from which all others are reached."""
    if len(roots) != 1:
        reason = f"several roots ({', '.join(map(shown, roots[:6]))})" if roots else "no root: its joints form a ring"
        raise InputError(file, "", f"has {reason}; an arm's links form one tree")
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
    moments = {name: tensor.number(name, 0.0) for name in _MOMENTS}
    held = np.array(
        [
            [moments["ixx"], moments["ixy"], moments["ixz"]],
            [moments["ixy"], moments["iyy"], moments["iyz"]],
            [moments["ixz"], moments["iyz"], moments["izz"]],
        ]
    )
    axes = np.array(turn, dtype=float)
    return Inertial(value, center, axes @ held @ axes.T)


def _shapes(link: Element) -> tuple[Shape, ...]:
    """What a link is drawn by: its visuals, or its collisions where it has none."""
    for tag in ("visual", "collision"):
        shapes: list[Shape] = []
        for drawn in link.all(tag):
            if (geometry := drawn.one("geometry")) is not None:
                origin = _frame(drawn.one("origin"))
                shapes += [_shape(form, origin) for form in geometry.children if form.tag in _SIZES]
        if shapes:
            return tuple(shapes)
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


def _joint(element: Element, links: list[str]) -> TreeJoint:
    name = element.text("name", 'name="elbow", say')
    kind = element.text("type", 'type="revolute", say')
    if kind not in _KINDS:
        raise element.error(f"type {shown(kind)} is none of {', '.join(_KINDS)}")
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
    return TreeJoint(
        name,
        cast(Kind, kind),
        ends[0],
        ends[1],
        _frame(next(element.all("origin"), None)),
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
    # One that is left out is 0; where both are, efforts and speeds are all that was to be said.
    ends = {"lower": -math.inf, "upper": math.inf}
    said = any(name in element.attributes for name in ends)
    lower, upper = (element.number(name, 0.0 if said else end, finite=False) for name, end in ends.items())
    if lower > upper:
        raise element.error("lower is above upper; turn them round")
    held = [element.number(name, finite=False) if name in element.attributes else None for name in _HELD]
    return Limits(lower, upper, held[0], held[1])
