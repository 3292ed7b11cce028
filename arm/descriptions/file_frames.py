"""The frames of the joints in a URDF or MJCF file, and the elements of its text that state them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.descriptions.reading.tree import about_line, transform
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .reading.elements import Element
from .reading.mjcf_words import Mjcf, direction, numbers
from .reading.urdf import read_urdf
from .way import way_to


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


def urdf_frames(file: Path, names: Sequence[str]) -> FileFrames:
    """Where the joints of these names, from the base out, stand in a URDF. Raises `InputError`."""
    robot = read_urdf(file)
    last = robot.joints[names[-1]]
    bases, before = [np.eye(4)], np.eye(4)
    frames: list[FileFrame] = []
    for joint in way_to(robot, robot.root, last.child):
        local = transform(*joint.origin)
        if joint.name in names:
            slides = joint.kind == "prismatic"
            axis = np.array(joint.axis)
            frames.append(FileFrame(joint.name, joint.element, before, local, np.eye(4), slides, axis, np.zeros(3)))
            before = np.eye(4)
            continue
        before = before @ local
        if not frames:
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
    return FileFrames(tuple(frames), tuple(bases), tuple(first.values()))


def mjcf_frames(top: Element, names: Sequence[str]) -> FileFrames:
    """Where the joints of these names, from the base out, stand in an MJCF file. Raises `InputError`."""
    read = Mjcf(top)
    if (included := next(_everywhere(top, "include"), None)) is not None:
        raise included.error("is another file's part; name the file that holds the bodies")
    way = _way_in_bodies(read, names)
    bases, before = [np.eye(4)], np.eye(4)
    frames: list[FileFrame] = []
    for body, inherited, step in way:
        before, local = before @ step, read.frame(body)
        moving = (item for item in read.inside(body, inherited, np.eye(4)) if item[0].tag == "joint")
        joint = next((item for item in moving if item[0].attributes.get("name") in names), None)
        if joint is None:
            before = before @ local
            if not frames:
                bases.append(before)
            continue
        element, class_, placed = joint
        attributes = read.attributes(element, class_)
        slides = attributes.get("type", "hinge") == "slide"
        axis = placed[:3, :3] @ direction(element, numbers(element, attributes.get("axis", "0 0 1"), 3))
        point = placed[:3, :3] @ numbers(element, attributes.get("pos", "0 0 0"), 3) + placed[:3, 3]
        ref = numbers(element, attributes.get("ref", "0"), 1)[0] * (1.0 if slides else read.to_radians)
        back = transform(np.eye(3), -ref * axis) if slides else about_line(axis, point, -ref)
        frames.append(FileFrame(element.attributes["name"], body, before, local, back, slides, axis, point))
        before = np.eye(4)
    last, inherited, _ = way[-1]
    tips = [
        FileFrame(item.attributes.get("name", item.tag), item, step, read.frame(item), np.eye(4))
        for item, class_, step in read.inside(last, inherited, np.eye(4))
        if item.tag == "site" or (item.tag == "body" and not _moves(read, item, class_))
    ]
    return FileFrames(tuple(frames), tuple(bases), tuple(tips))


def _moves(read: Mjcf, body: Element, inherited: str) -> bool:
    return any(item.tag == "joint" for item, _, _ in read.inside(body, inherited, np.eye(4)))


def _way_in_bodies(read: Mjcf, names: Sequence[str]) -> list[tuple[Element, str, Array]]:
    """The bodies from the world to that of the last joint, each with the class that what is in it inherits and where
    the `<frame>`s about it stand in the body before."""
    pending = [([], world, "main") for world in read.top.all("worldbody")]
    while pending:
        way, inside, inherited = pending.pop()
        for item, class_, step in read.inside(inside, inherited, np.eye(4)):
            if item.tag == "joint" and item.attributes.get("name") == names[-1]:
                return way
            if item.tag == "body":
                child_class = item.attributes.get("childclass", class_)
                pending.append(([*way, (item, child_class, step)], item, child_class))
    raise InputError(read.top.file, "", f"has no joint '{names[-1]}'")


def _everywhere(element: Element, tag: str) -> Iterator[Element]:
    for child in element.children:
        if child.tag == tag:
            yield child
        yield from _everywhere(child, tag)
