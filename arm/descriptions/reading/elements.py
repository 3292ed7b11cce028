"""XML read as plain elements, each with its line. Documents with a DOCTYPE are refused, so that no entity is ever
expanded and nothing outside the file is ever opened."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown

_DEEPEST = 256
"""Elements within one another: libxml2's bound (xmlParserMaxDepth)."""


@dataclass(frozen=True)
class Element:
    """An element with its attributes, its children, the line on which it starts and where in the file (`at`, bytes);
    text between them is dropped."""

    tag: str
    attributes: dict[str, str]
    line: int
    file: Path
    children: list[Element] = field(default_factory=list["Element"])
    at: int = 0

    def all(self, tag: str) -> Iterator[Element]:
        """The children of that tag."""
        return (child for child in self.children if child.tag == tag)

    def one(self, tag: str) -> Element | None:
        """The only child of that tag, None where there is none. Raises `InputError` where there are several."""
        children = list(self.all(tag))
        if len(children) > 1:
            raise children[1].error(f"is the second <{tag}> of one <{self.tag}>; keep one")
        return children[0] if children else None

    def text(self, name: str, would_do: str) -> str:
        """An attribute that is due."""
        value = self.attributes.get(name, "").strip()
        if not value:
            raise self.error(f"has no {name}; write {would_do}")
        return value

    def number(self, name: str, default: float | None = None, *, finite: bool = True) -> float:
        """A number; due where there is no default."""
        raw = self.attributes.get(name)
        if raw is None and default is not None:
            return default
        numbers = self._numbers(name, raw, 1, f'{name}="1.5"', finite=finite)
        return numbers[0]

    def triple(self, name: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Three numbers apart by blanks."""
        raw = self.attributes.get(name)
        if raw is None:
            return default
        x, y, z = self._numbers(name, raw, 3, f'three numbers, {name}="0 0 1"', finite=True)
        return (x, y, z)

    def _numbers(self, name: str, raw: str | None, count: int, would_do: str, *, finite: bool) -> list[float]:
        if raw is None:
            raise self.error(f"has no {name}; write {would_do}")
        if "${" in raw or "$(" in raw:
            raise self.error(f"{name} is {shown(raw)}, a macro; expand it first: xacro FILE.xacro > arm.urdf")
        try:
            values = [float(word) for word in raw.split()]
        except ValueError:
            values = []
        good = all(math.isfinite(value) if finite else not math.isnan(value) for value in values)
        if len(values) != count or not good:
            raise self.error(f"{name} is {shown(raw)}; write {would_do}")
        return values

    def error(self, message: str) -> InputError:
        """What is wrong with this element, in a line that says where it stands."""
        name = self.attributes.get("name")
        words = f"line {self.line}: {self.tag}" + ("" if name is None else f" {shown(name)}")
        return InputError(self.file, words, message)


def read_elements(path: Path | str) -> Element:
    """The root element of an XML file. Raises `InputError`, one line, for anything that is no plain XML."""
    file = Path(path)
    return elements_in(read_bytes(file), file)


def elements_in(content: bytes, file: Path) -> Element:
    """The root element of XML that was read from a file. Raises `InputError`."""
    parser = expat.ParserCreate()
    roots: list[Element] = []
    open_elements: list[Element] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(open_elements) == _DEEPEST:
            message = f"holds elements more than {_DEEPEST} within one another"
            raise InputError(file, f"line {parser.CurrentLineNumber}", message)
        made = Element(tag, attributes, parser.CurrentLineNumber, file, at=parser.CurrentByteIndex)
        (open_elements[-1].children if open_elements else roots).append(made)
        open_elements.append(made)

    def end(_: str) -> None:
        open_elements.pop()

    def refuse(*_: object) -> NoReturn:
        message = "holds a DOCTYPE, whose entities are never read; take it out"
        raise InputError(file, f"line {parser.CurrentLineNumber}", message)

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise InputError(file, "", f"is no XML: {error}") from None
    return roots[0]
