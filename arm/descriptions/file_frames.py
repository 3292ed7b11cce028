"""The frames of the joints in a URDF or MJCF file, and the elements of its text that state them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown

from .elements import Element
from .urdf import read_urdf
from .way import way_to

_AXES = MappingProxyType({"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)})


@dataclass(frozen=True)
class FileFrame:
    """A frame that a file gives: the `element` that says it, its `local` transform (4, 4), that `before` it (from the
    frame that the joint before moves, or the root) and that `after` it, to the frame that its joint moves at 0.

    `axis` and `point` (m) are the joint's, in the frame that it moves; a tip has none.
    """

    name: str
    element: Element
    before: Array
    local: Array
    after: Array
    slides: bool = False
    axis: Array | None = None
    point: Array | None = None

    @property
    def whole(self) -> Array:
        """From the frame that the joint before moves to the one that this joint moves, at 0."""
        return self.before @ self.local @ self.after


@dataclass(frozen=True)
class FileFrames:
    """The `joints` of one way through a file in their order, the frames of all links before the first one (`bases`, in
    the root), and the frames after the last one that may be the tip's."""

    joints: tuple[FileFrame, ...]
    bases: tuple[Array, ...]
    tips: tuple[FileFrame, ...]


def transform(rotation: Array | Sequence[Sequence[float]], translation: Sequence[float] | Array) -> Array:
    """A rotation (3, 3) and a shift as one matrix (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.asarray(rotation, dtype=float), np.asarray(translation, dtype=float)
    return matrix


def urdf_frames(file: Path, names: Sequence[str]) -> FileFrames:
    """Where the joints of these names, from the base out, stand in a URDF. Raises `InputError`."""
    robot = read_urdf(file)
    last = robot.joints[names[-1]]
    bases, before = [np.eye(4)], np.eye(4)
    found: list[FileFrame] = []
    for joint in way_to(robot, robot.root, last.child):
        local = transform(*joint.origin)
        if joint.name in names:
            slides = joint.kind == "prismatic"
            axis = np.array(joint.axis)
            found.append(FileFrame(joint.name, joint.element, before, local, np.eye(4), slides, axis, np.zeros(3)))
            before = np.eye(4)
            continue
        before = before @ local
        if not found:
            bases.append(before)
    tips: list[FileFrame] = []
    pending = [(last.child, np.eye(4))]
    while pending:
        link, here = pending.pop()
        for joint in robot.below[link]:
            if joint.kind == "fixed":
                tips.append(FileFrame(joint.child, joint.element, here, transform(*joint.origin), np.eye(4)))
                pending.append((joint.child, here @ transform(*joint.origin)))
    # A frame that others stand on moves with the first that does.
    first = {id(tip.element): tip for tip in tips}
    return FileFrames(tuple(found), tuple(bases), tuple(first.values()))


class Mjcf:
    """An MJCF file as far as frames go: bodies and their joints, with the defaults that hold for each."""

    def __init__(self, top: Element) -> None:
        compiler = top.one("compiler")
        said: Mapping[str, str] = {} if compiler is None else compiler.attributes
        self.to_radians = 1.0 if said.get("angle", "degree") == "radian" else math.pi / 180.0
        self.order = said.get("eulerseq", "xyz")
        if compiler is not None and (len(self.order) != 3 or not set(self.order.lower()) <= set(_AXES)):
            raise compiler.error(f"eulerseq is {shown(self.order)}; write three of x, y, z, X, Y and Z")
        self.defaults: dict[str, dict[str, dict[str, str]]] = {}
        for element in top.all("default"):
            self._read_defaults(element, {}, "main")
        self.top = top

    def _read_defaults(self, element: Element, above: Mapping[str, dict[str, str]], name: str) -> None:
        local = {tag: dict(values) for tag, values in above.items()}
        for child in element.children:
            if child.tag != "default":
                local[child.tag] = {**local.get(child.tag, {}), **child.attributes}
        self.defaults[element.attributes.get("class", name)] = local
        for child in element.all("default"):
            self._read_defaults(child, local, name)

    def attributes(self, element: Element, inherited: str) -> dict[str, str]:
        """An element's attributes over those of its class."""
        local = element.attributes.get("class", inherited)
        return {**self.defaults.get(local, {}).get(element.tag, {}), **element.attributes}

    def frame(self, element: Element) -> Array:
        """Where a body or site stands in the body that it is in."""
        said = element.attributes
        return transform(self._rotation(element), _numbers(element, said.get("pos", "0 0 0"), 3))

    def _rotation(self, element: Element) -> Array:
        said = element.attributes
        if "quat" in said:
            w, x, y, z = _direction(element, _numbers(element, said["quat"], 4))
            return Turn.from_quat([x, y, z, w]).as_matrix()
        if "axisangle" in said:
            *axis, angle = _numbers(element, said["axisangle"], 4)
            return turned(_direction(element, np.array(axis)), angle * self.to_radians)
        if "euler" in said:
            rotation = np.eye(3)
            for letter, angle in zip(self.order, _numbers(element, said["euler"], 3), strict=True):
                step = turned(np.array(_AXES[letter.lower()]), angle * self.to_radians)
                rotation = rotation @ step if letter.islower() else step @ rotation
            return rotation
        if "xyaxes" in said:
            numbers = _numbers(element, said["xyaxes"], 6)
            x = _direction(element, numbers[:3])
            y = _direction(element, numbers[3:] - x * (x @ numbers[3:]))
            return np.column_stack([x, y, np.cross(x, y)])
        if "zaxis" in said:
            z = _direction(element, _numbers(element, said["zaxis"], 3))
            across = np.cross((0.0, 0.0, 1.0), z)
            angle = math.atan2(float(np.linalg.norm(across)), float(z[2]))
            return turned(across if across.any() else np.array((1.0, 0.0, 0.0)), angle)
        return np.eye(3)


def mjcf_frames(top: Element, names: Sequence[str]) -> FileFrames:
    """Where the joints of these names, from the base out, stand in an MJCF file. Raises `InputError`."""
    read = Mjcf(top)
    if (included := next(_everywhere(top, "include"), None)) is not None:
        raise included.error("is another file's part; name the file that holds the bodies")
    way = _way_in_bodies(top, names)
    bases, before = [np.eye(4)], np.eye(4)
    found: list[FileFrame] = []
    for body, inherited in way:
        local = read.frame(body)
        joint = next((each for each in body.all("joint") if each.attributes.get("name") in names), None)
        if joint is None:
            before = before @ local
            if not found:
                bases.append(before)
            continue
        said = read.attributes(joint, inherited)
        slides = said.get("type", "hinge") == "slide"
        axis = _direction(joint, _numbers(joint, said.get("axis", "0 0 1"), 3))
        point = _numbers(joint, said.get("pos", "0 0 0"), 3)
        ref = _numbers(joint, said.get("ref", "0"), 1)[0] * (1.0 if slides else read.to_radians)
        back = transform(np.eye(3), -ref * axis) if slides else about_line(axis, point, -ref)
        found.append(FileFrame(joint.attributes["name"], body, before, local, back, slides, axis, point))
        before = np.eye(4)
    last = way[-1][0]
    tips = [
        FileFrame(each.attributes.get("name", each.tag), each, np.eye(4), read.frame(each), np.eye(4))
        for each in last.children
        if each.tag in ("body", "site") and not any(each.all("joint"))
    ]
    return FileFrames(tuple(found), tuple(bases), tuple(tips))


def _way_in_bodies(top: Element, names: Sequence[str]) -> list[tuple[Element, str]]:
    """The bodies from the world to that of the last joint, each with the class that its joints inherit."""
    pending = [
        ([(body, body.attributes.get("childclass", "main"))])
        for world in top.all("worldbody")
        for body in world.all("body")
    ]
    while pending:
        way = pending.pop()
        body, inherited = way[-1]
        if any(joint.attributes.get("name") == names[-1] for joint in body.all("joint")):
            return way
        pending += [[*way, (each, each.attributes.get("childclass", inherited))] for each in body.all("body")]
    raise InputError(top.file, "", f"has no joint '{names[-1]}'")


def _everywhere(element: Element, tag: str) -> Iterator[Element]:
    for child in element.children:
        if child.tag == tag:
            yield child
        yield from _everywhere(child, tag)


def turned(axis: Array, angle: float) -> Array:
    """A turn (3, 3) about an axis."""
    return Turn.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()


def about_line(axis: Array, point: Array, angle: float) -> Array:
    """A turn (4, 4) about a line through a point."""
    rotation = turned(axis, angle)
    return transform(rotation, point - rotation @ point)


def _direction(element: Element, vector: Array) -> Array:
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(vector))
    if not 0.0 < length < math.inf:
        raise element.error("has a direction without a length, or with one beyond all numbers")
    return vector / length


def _numbers(element: Element, text: str, count: int) -> Array:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.zeros(0)
    if len(values) != count or not np.all(np.isfinite(values)):
        due = "a number is" if count == 1 else f"{count} numbers are"
        raise element.error(f"has {shown(text)} where {due} due")
    return values
