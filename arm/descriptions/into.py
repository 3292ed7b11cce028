"""What was found of an arm, written into the user's own URDF or MJCF: a few numbers, and not a byte beside them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.vectors import Rotation, to_roll_pitch_yaw
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE, drive_compliance
from linkwright.core.sections.numeric import Array
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import nearest

from .elements import Element, elements_in
from .exported import GEOMETRY, found_geometry, standing
from .file_frames import FileFrame, FileFrames, mjcf_frames, transform, urdf_frames
from .formats import Exported
from .imported import import_urdf
from .urdf import NO_STEP, onward

_SAME = 1e-6
"""m or rad: by so much a joint of the file may stand elsewhere than the arm file's, whose numbers are rounded."""
_CHANGED = 1e-11
"""m or rad: what changes by less is left as it is written."""
_DIGITS = 12
_TAG = re.compile(rb"""(<[^\s/>]+)(?:\s+[\w:.\-]+\s*=\s*(?:"[^"]*"|'[^']*'))*\s*/?>""")
_ATTRIBUTE = re.compile(rb"""\s+([\w:.\-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")


@dataclass(frozen=True)
class _Edit:
    """A place in a file's bytes that is written anew."""

    start: int
    end: int
    text: bytes


@dataclass(frozen=True)
class _Frames:
    """Frames (4, 4) at coordinate 0: each joint's in the base, and the step from the last to the tip."""

    joints: tuple[Array, ...]
    tool: Array


def into_file(arm: Arm, path: Path | str) -> Exported:
    """A URDF or MJCF file with what `effects` of an arm say of zeros, lengths and axes (of an MJCF's position servos
    their stiffness too), byte for byte as it was otherwise.

    Joints are those that the arm file names; without names, those on the only way of a URDF. Raises `InputError` where
    they are not in the file, or stand elsewhere than the arm file's own (before what was found).
    """
    file = Path(path)
    content = read_bytes(file)
    top = elements_in(content, file)
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(file, "", "is written in another encoding; save it as UTF-8") from None
    form = {"robot": "urdf", "mujoco": "mjcf"}.get(top.tag)
    if form is None:
        said = f"starts with <{top.tag}>; what was found goes into URDF (<robot>) and MJCF (<mujoco>)"
        raise InputError(file, "", said)
    if arm.branches:
        raise InputError("", "branches", "end in several tips; export the arm file of each by itself")
    names = _names(arm, top, form)
    there = urdf_frames(file, names) if form == "urdf" else mjcf_frames(top, names)
    if [each.name for each in there.joints] != list(names):
        raise InputError(file, "", f"has these joints in another order, or not on one way: {', '.join(names)}")
    before, after = _frames(arm), _frames(found_geometry(arm))
    to_arm = _base_of(arm, there, before, file)
    editor = _Editor(content, form)
    for index, file_frame in enumerate(there.joints):
        editor.move(file_frame, to_arm @ _correction(before, after, index) @ np.linalg.inv(to_arm))
        step = before.joints[0] if index == 0 else np.linalg.inv(before.joints[index - 1]) @ before.joints[index]
        to_arm = np.linalg.inv(file_frame.whole) @ to_arm @ step
    lost = list(_tip(there, before, after, to_arm, editor))
    lost += [
        f"{EFFECTS[entry.effect].title} (effect {entry.effect})"
        for entry in arm.effects
        if entry.effect not in (*GEOMETRY, *([JOINT_COMPLIANCE.id] if form == "mjcf" else []))
        or entry.parameters.get("stretch", 0.0)
    ]
    if form == "mjcf":
        lost += _servos(arm, names, top, editor)
    carried = tuple(editor.carried) or ("nothing: the arm file's effects name no zero, length or axis",)
    return Exported(arm, form, editor.text(), carried, tuple(dict.fromkeys(lost)), ())


def _names(arm: Arm, top: Element, form: str) -> tuple[str, ...]:
    """What the file calls the arm's joints."""
    there = [each.attributes.get("name", "") for each in _all(top, "joint")]
    named = [joint.name for joint in arm.joints]
    if not any(named) and form == "urdf":
        found = import_urdf(top.file).joint_names
        if len(found) == arm.size:
            return found
        said = f"has {len(found)} joints that move, the arm {arm.size}; name its joints (joint: name)"
        raise InputError(top.file, "", said)
    for index, name in enumerate(named):
        if name not in there:
            said = f"{shown(name)} is no joint of {top.file}{nearest(name, there)}" if name else "is missing"
            raise InputError("", f"{arm.entry(index)}.joint.name", f"{said}; write what the file calls it")
    return tuple(named)


def _all(element: Element, tag: str) -> list[Element]:
    found = [each for each in element.children if each.tag == tag]
    return found + [each for child in element.children for each in _all(child, tag)]


def _frames(arm: Arm) -> _Frames:
    """Where an arm's joints stand at coordinate 0 (their zeros in it), and its tip after the last."""
    here, frames = NO_STEP, []
    for joint, link in zip(arm.joints, arm.links, strict=True):
        here = onward(here, standing(joint))
        frames.append(transform(*here))
        x, y, z = (link.length * each for each in link.direction)
        here = onward(here, (link.end_rotation, (x, y, z)))
    tip = transform(*onward(here, ((NO_STEP[0]), arm.tool)))
    return _Frames(tuple(frames), np.linalg.inv(frames[-1]) @ tip)


def _correction(before: _Frames, after: _Frames, index: int) -> Array:
    """How a joint's frame moves against the one before it, in that one's axes."""
    first, second = (
        np.linalg.inv(each.joints[index - 1]) @ each.joints[index] if index else each.joints[0]
        for each in (before, after)
    )
    return second @ np.linalg.inv(first)


def _base_of(arm: Arm, there: FileFrames, before: _Frames, file: Path) -> Array:
    """The frame of the file in which the arm stands: that one in which all joints stand as in the arm file."""
    off = [_off(arm, there, before, base) for base in there.bases[::-1]]
    nearest_base = min(range(len(off)), key=lambda k: max(off[k]))
    if max(off[nearest_base]) <= _SAME:
        return there.bases[::-1][nearest_base]
    joint = next(k for k, each in enumerate(off[nearest_base]) if each > _SAME)
    said = f"{1e3 * off[nearest_base][joint]:.3g} mm (or mrad) from where the arm file has it"
    message = f"joint {shown(there.joints[joint].name)} stands {said}, before what was found; it is of another arm"
    raise InputError(file, "", message)


def _off(arm: Arm, there: FileFrames, before: _Frames, base: Array) -> list[float]:
    """How far each joint's axis lies from the arm's (m or rad)."""
    where, found = np.eye(4), list[float]()
    for joint, file_frame, local in zip(arm.joints, there.joints, before.joints, strict=True):
        assert file_frame.axis is not None
        assert file_frame.point is not None
        where, here = where @ file_frame.whole, base @ local
        axis = here[:3, :3] @ np.array(joint.axis)
        aside = where[:3, :3] @ file_frame.point + where[:3, 3] - here[:3, 3]
        aside = aside - axis * (axis @ aside)
        turned = float(np.linalg.norm(where[:3, :3] @ file_frame.axis - axis))
        other = file_frame.slides == joint.revolute
        found.append(math.inf if other else max(turned, 0.0 if file_frame.slides else float(np.linalg.norm(aside))))
    return found


class _Editor:
    """Numbers of a file's text in new places; what changes is kept as `edits`, and told in `carried`."""

    def __init__(self, content: bytes, form: str) -> None:
        self.content = content
        self.form = form
        self.edits: list[_Edit] = []
        self.carried: list[str] = []

    def move(self, file_frame: FileFrame, correction: Array) -> None:
        """Put a frame where it stands by a correction in the axes of the frame that the joint before moves."""
        local = np.linalg.inv(file_frame.before) @ correction @ file_frame.before @ file_frame.local
        shifted = np.abs(local[:3, 3] - file_frame.local[:3, 3]).max() > _CHANGED
        turned = np.abs(local[:3, :3] - file_frame.local[:3, :3]).max() > _CHANGED
        if self.form == "mjcf":
            if shifted:
                self._numbers(file_frame.name, file_frame.element, "pos", local[:3, 3], file_frame.local[:3, 3])
            if turned:
                self._orientation(file_frame, local[:3, :3])
            return
        origin = file_frame.element.one("origin")
        angles = [np.array(to_roll_pitch_yaw(_rotation(each))) for each in (local, file_frame.local)]
        if origin is None and (shifted or turned):
            made = f'<origin xyz="{_text(local[:3, 3])}" rpy="{_text(angles[0])}"/>'
            at = self._tag(file_frame.element).end()
            self.edits.append(_Edit(at, at, made.encode()))
            self.carried.append(f"{file_frame.element.tag} {file_frame.name}: {made}")
            return
        if origin is not None and shifted:
            self._numbers(file_frame.name, origin, "xyz", local[:3, 3], file_frame.local[:3, 3])
        if origin is not None and turned:
            written = np.array(origin.triple("rpy", (0.0, 0.0, 0.0)))
            self._numbers(file_frame.name, origin, "rpy", _alike(angles[0], written), written)

    def number(self, name: str, element: Element, attribute: str, value: float) -> None:
        """Write one number."""
        self._numbers(name, element, attribute, np.array([value]), np.array([math.nan]))

    def text(self) -> str:
        """The file with all edits in it."""
        parts, at = list[bytes](), 0
        for edit in sorted(self.edits, key=lambda each: each.start):
            parts += [self.content[at : edit.start], edit.text]
            at = edit.end
        return b"".join([*parts, self.content[at:]]).decode("utf-8")

    def _tag(self, element: Element) -> re.Match[bytes]:
        found = _TAG.match(self.content, element.at)
        if found is None:
            raise element.error("cannot be found in the file's text; save it as UTF-8")
        return found

    def _numbers(self, name: str, element: Element, attribute: str, values: Array, before: Array) -> None:
        """Write numbers in an attribute's place, those that stay with the digits that they have."""
        span = self._span(element, attribute)
        if span is None:
            at = self._tag(element).end(1)
            self.edits.append(_Edit(at, at, f' {attribute}="{_text(values)}"'.encode()))
            self.carried.append(f"{name}: {attribute} {_text(values)} (none before)")
            return
        old = self.content[span[0] : span[1]].decode("utf-8")
        words = re.split(r"(\s+)", old)
        places = [k for k, word in enumerate(words) if word.strip()]
        for place, value, was in zip(places, values, before, strict=True):
            if not abs(value - was) <= _CHANGED:
                words[place] = _text([value])
        self.edits.append(_Edit(*span, "".join(words).encode()))
        self.carried.append(f"{name}: {attribute} {old.strip()} is now {''.join(words).strip()}")

    def _orientation(self, file_frame: FileFrame, rotation: Array) -> None:
        """Write an MJCF orientation as a quaternion, whatever it was written as."""
        quaternion = _quaternion(rotation)
        for attribute in ("quat", "euler", "axisangle", "xyaxes", "zaxis"):
            span = self._span(file_frame.element, attribute, whole=True)
            if span is not None:
                old = self.content[span[0] : span[1]].decode("utf-8")
                made = f'quat="{_text(quaternion)}"'
                self.edits.append(_Edit(*span, made.encode()))
                self.carried.append(f"{file_frame.name}: {old} is now {made}")
                return
        self._numbers(file_frame.name, file_frame.element, "quat", quaternion, quaternion)

    def _span(self, element: Element, attribute: str, *, whole: bool = False) -> tuple[int, int] | None:
        """Where an attribute's value stands in the file; with `whole` its name too. None where it is not there."""
        tag = self._tag(element)
        for each in _ATTRIBUTE.finditer(self.content, tag.end(1), tag.end()):
            if each[1].decode("utf-8") == attribute:
                group = 2 if each[2] is not None else 3
                return (each.start(1), each.end()) if whole else each.span(group)
        return None


def _tip(there: FileFrames, before: _Frames, after: _Frames, to_arm: Array, editor: _Editor) -> tuple[str, ...]:
    """Move the frame at the arm's tip, where the last link's length or the tool changed; what could not be is told.
    `to_arm` leads from the last moving frame of the file to the arm's."""
    correction = to_arm @ after.tool @ np.linalg.inv(before.tool) @ np.linalg.inv(to_arm)
    if np.abs(correction - np.eye(4)).max() <= _CHANGED:
        return ()
    nominal = (to_arm @ before.tool)[:3, 3]
    for tip in there.tips:
        if np.linalg.norm(tip.whole[:3, 3] - nominal) <= _SAME:
            editor.move(tip, correction)
            return ()
    return ("where the tip stands on the last link: no frame that is fixed there stands at the arm's tip",)


def _servos(arm: Arm, names: Sequence[str], top: Element, editor: _Editor) -> tuple[str, ...]:
    """Write the stiffness of drives whose compliance was found into position servos; what has none is told."""
    lost: list[str] = []
    positions = {each.attributes.get("joint", ""): each for each in _all(top, "position")}
    for index, name in enumerate(names):
        found = any(e.effect == JOINT_COMPLIANCE.id and index + 1 in (e.at or (index + 1,)) for e in arm.effects)
        if found and name in positions:
            editor.number(name, positions[name], "kp", 1.0 / drive_compliance(arm, index))
        elif found:
            lost.append(f"stiffness of the drive of joint {index + 1}: {name} has no position servo")
    return tuple(lost)


def _rotation(matrix: Array) -> Rotation:
    x, y, z = ((float(row[0]), float(row[1]), float(row[2])) for row in matrix[:3])
    return x, y, z


def _alike(angles: Array, written: Array) -> Array:
    """Roll, pitch and yaw of the same turn, in the form nearest to those written."""
    roll, pitch, yaw = angles
    forms = [np.array([roll, pitch, yaw]), np.array([roll + math.pi, math.pi - pitch, yaw + math.pi])]
    forms = [each + 2.0 * math.pi * np.round((written - each) / (2.0 * math.pi)) for each in forms]
    return min(forms, key=lambda each: float(np.abs(each - written).sum()))


def _quaternion(rotation: Array) -> Array:
    """The unit quaternion (w, x, y, z) of a rotation, w not negative."""
    x, y, z, w = Turn.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z]) * (1.0 if w >= 0.0 else -1.0)


def _text(values: Sequence[float] | Array) -> str:
    return " ".join(f"{float(value) if abs(value) > _CHANGED else 0.0:.{_DIGITS}g}" for value in values)
