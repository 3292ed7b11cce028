"""The text of an XML file with other numbers in some of its places, and not a byte changed beside them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation as Turn

from linkwright.core.arm.chain.vectors import Rotation, to_roll_pitch_yaw
from linkwright.core.arm.descriptions.file_frames import FileFrame
from linkwright.core.arm.descriptions.identified_frames import alike
from linkwright.core.arm.descriptions.reading.elements import Element
from linkwright.core.sections.numeric import Array

CHANGED = 1e-11
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


class Editor:
    """Numbers of a file's text in new places; what changes is kept as `edits`, and told in `carried`."""

    def __init__(self, content: bytes, form: str) -> None:
        self.content = content
        self.form = form
        self.edits: list[_Edit] = []
        self.carried: list[str] = []

    def move(self, file_frame: FileFrame, correction: Array) -> None:
        """Put a frame where it stands by a correction in the axes of the frame that the joint before moves."""
        local = np.linalg.inv(file_frame.before) @ correction @ file_frame.before @ file_frame.local
        shifted = np.abs(local[:3, 3] - file_frame.local[:3, 3]).max() > CHANGED
        turned = np.abs(local[:3, :3] - file_frame.local[:3, :3]).max() > CHANGED
        if self.form == "mjcf":
            if shifted:
                self._numbers(file_frame.name, file_frame.element, "pos", local[:3, 3], file_frame.local[:3, 3])
            if turned:
                self._orientation(file_frame, local[:3, :3])
            return
        origin = file_frame.element.one("origin")
        angles = [np.array(to_roll_pitch_yaw(_rotation(item))) for item in (local, file_frame.local)]
        if origin is None and (shifted or turned):
            made = f'<origin xyz="{text_of(local[:3, 3])}" rpy="{text_of(angles[0])}"/>'
            self.insert(file_frame.name, file_frame.element, made)
            return
        if origin is not None and shifted:
            self._numbers(file_frame.name, origin, "xyz", local[:3, 3], file_frame.local[:3, 3])
        if origin is not None and turned:
            written = np.array(origin.triple("rpy", (0.0, 0.0, 0.0)))
            self._numbers(file_frame.name, origin, "rpy", alike(angles[0], written), written)

    def number(self, name: str, element: Element, attribute: str, value: float) -> None:
        """Write one number, where it is not there already."""
        if not abs(element.number(attribute, math.nan) - value) <= CHANGED:
            self._numbers(name, element, attribute, np.array([value]), np.array([math.nan]))

    def word(self, name: str, element: Element, attribute: str, value: str) -> None:
        """Write an attribute's text, where it is not there already."""
        span = self._span(element, attribute)
        if span is None:
            at = self._tag(element).end(1)
            self.edits.append(_Edit(at, at, f' {attribute}="{value}"'.encode()))
            self.carried.append(f"{name}: {attribute} {value} (none before)")
            return
        old = self.content[span[0] : span[1]].decode("utf-8")
        if old.split() != value.split():
            self.edits.append(_Edit(*span, value.encode()))
            self.carried.append(f"{name}: {attribute} {old.strip()} is now {value}")

    def remove(self, element: Element, attribute: str) -> None:
        """Take an attribute out."""
        if (span := self._span(element, attribute, whole=True)) is not None:
            self.edits.append(_Edit(*span, b""))

    def insert(self, name: str, element: Element, child: str) -> None:
        """Put a child into an element, before those that it has."""
        tag = self._tag(element)
        if tag[0].endswith(b"/>"):
            closed = f">{child}</{element.tag}>".encode()
            self.edits.append(_Edit(tag.end() - 2, tag.end(), closed))
        else:
            self.edits.append(_Edit(tag.end(), tag.end(), child.encode()))
        self.carried.append(f"{element.tag} {name}: {child}")

    def text(self) -> str:
        """The file with all edits in it."""
        parts, at = list[bytes](), 0
        for edit in sorted(self.edits, key=lambda item: item.start):
            parts += [self.content[at : edit.start], edit.text]
            at = edit.end
        return b"".join([*parts, self.content[at:]]).decode("utf-8")

    def _tag(self, element: Element) -> re.Match[bytes]:
        tag_match = _TAG.match(self.content, element.at)
        if tag_match is None:
            raise element.error("cannot be found in the file's text; save it as UTF-8")
        return tag_match

    def _numbers(self, name: str, element: Element, attribute: str, values: Array, before: Array) -> None:
        """Write numbers in an attribute's place, those that stay with the digits that they have."""
        span = self._span(element, attribute)
        if span is None:
            at = self._tag(element).end(1)
            self.edits.append(_Edit(at, at, f' {attribute}="{text_of(values)}"'.encode()))
            self.carried.append(f"{name}: {attribute} {text_of(values)} (none before)")
            return
        old = self.content[span[0] : span[1]].decode("utf-8")
        words = re.split(r"(\s+)", old)
        places = [k for k, word in enumerate(words) if word.strip()]
        for place, value, was in zip(places, values, before, strict=True):
            if not abs(value - was) <= CHANGED:
                words[place] = text_of([value])
        self.edits.append(_Edit(*span, "".join(words).encode()))
        self.carried.append(f"{name}: {attribute} {old.strip()} is now {''.join(words).strip()}")

    def _orientation(self, file_frame: FileFrame, rotation: Array) -> None:
        """Write an MJCF orientation as a quaternion, whatever it was written as."""
        quaternion = _quaternion(rotation)
        for attribute in ("quat", "euler", "axisangle", "xyaxes", "zaxis"):
            span = self._span(file_frame.element, attribute, whole=True)
            if span is not None:
                old = self.content[span[0] : span[1]].decode("utf-8")
                made = f'quat="{text_of(quaternion)}"'
                self.edits.append(_Edit(*span, made.encode()))
                self.carried.append(f"{file_frame.name}: {old} is now {made}")
                return
        self._numbers(file_frame.name, file_frame.element, "quat", quaternion, quaternion)

    def _span(self, element: Element, attribute: str, *, whole: bool = False) -> tuple[int, int] | None:
        """Where an attribute's value stands in the file; with `whole` its name too. None where it is not there."""
        tag = self._tag(element)
        for item in _ATTRIBUTE.finditer(self.content, tag.end(1), tag.end()):
            if item[1].decode("utf-8") == attribute:
                group = 2 if item[2] is not None else 3
                return (item.start(1), item.end()) if whole else item.span(group)
        return None


def _rotation(matrix: Array) -> Rotation:
    x, y, z = ((float(row[0]), float(row[1]), float(row[2])) for row in matrix[:3])
    return x, y, z


def _quaternion(rotation: Array) -> Array:
    """The unit quaternion (w, x, y, z) of a rotation, w not negative."""
    x, y, z, w = Turn.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z]) * (1.0 if w >= 0.0 else -1.0)


def text_of(values: Sequence[float] | Array) -> str:
    """Numbers as they are written into a file, apart by blanks."""
    return " ".join(f"{float(value) if abs(value) > CHANGED else 0.0:.{_DIGITS}g}" for value in values)
