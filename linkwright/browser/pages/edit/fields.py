"""Fields of a form: a number with its unit, words, a name of a list; values of YAML as they show them."""

from __future__ import annotations

import re
from collections.abc import Awaitable, Callable, Sequence
from typing import Any, TypeAlias, cast

from nicegui import ui

from linkwright.browser.server.parts import Parts, Place
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml, yaml_line
from linkwright.face.plain_input import steps_of


def shown(value: Any) -> str:
    """A value as a field for words has it."""
    return value if isinstance(value, str) else "" if value is None else yaml_line(value)


def meant(value: Any, before: Any) -> Any:
    """What a field says as YAML has it: words stay words, lists are lists, numbers what they were."""
    if isinstance(value, list):
        return cast(list[Any], value)
    words = str(value).strip()
    if words.startswith(("[", "{")) or not isinstance(before, str | None):
        try:
            parsed = parse_yaml(f"[{words}]", file="the field")
        except InputError:
            return words
        entries = cast(list[Any], parsed) if isinstance(parsed, list) else []
        return entries[0] if len(entries) == 1 else entries if isinstance(before, list) else words
    if before is None and re.fullmatch(r"true|false|-?[0-9]+(\.[0-9]+)?", words):
        return cast(list[Any], parse_yaml(f"[{words}]", file="the field"))[0]
    return words


def place_of(key: str, file: str) -> Place:
    """A key such as chain[1].joint.backlash as a place; lists count from 1."""
    steps = steps_of(key.strip(), file)
    if 0 in steps:
        raise InputError(file, key.strip(), "is no key; write e.g. 'chain[1].link.length' (lists count from 1)")
    return tuple(step - 1 if isinstance(step, int) else step for step in steps)


Heard = Callable[[Any], Awaitable[None]]
"""Hears a field's value as a file has it."""
_AXES = ("x", "y", "z")


class QuantityField:
    """Numbers that share a unit, each in a field, the unit beside them; what is typed with another unit changes it."""

    def __init__(self, label: str, parts: Parts, title: str, heard: Heard) -> None:
        self._parts, self._notify = parts, heard
        count = len(parts.numbers)
        names = [label] if count == 1 else [f"{label} from", "to"] if count == 2 else _numbered(label, count)
        with ui.element("div").classes("lw-quantity" + " lw-several" * (count > 1)) as place:
            place.props["title"] = title
            if parts.relation:
                self._relation = ui.select(["<=", "==", ">="], value=parts.relation, on_change=self._related)
                self._relation.props(f'dense outlined aria-label="relation of {label}"').classes("lw-unit")
            self._numbers = [self._number(k, name, parts.numbers[k]) for k, name in enumerate(names)]
            self._unit = ui.select(parts.units, value=parts.unit or None, on_change=self._in_unit)
            self._unit.props(f'dense outlined options-dense aria-label="unit of {label}"').classes("lw-unit")
            self._unit.visible = bool(parts.units)

    @property
    def error(self) -> str | None:
        """What is wrong with it."""
        return self._numbers[0].error

    @error.setter
    def error(self, text: str | None) -> None:
        self._numbers[0].error = text

    def _number(self, place: int, name: str, number: str) -> ui.input:
        field = ui.input(name, value=number).props('dense outlined inputmode="decimal"')

        async def commit() -> None:
            await self._became(self._parts.typed(place, str(field.value or "")))

        field.on("blur", commit)
        field.on("keydown.enter", commit)
        return field

    async def _related(self) -> None:
        parts = self._parts
        await self._became(Parts(str(self._relation.value), parts.numbers, parts.unit, parts.listed))

    async def _in_unit(self) -> None:
        parts = self._parts
        await self._became(Parts(parts.relation, parts.numbers, str(self._unit.value or ""), parts.listed))

    async def _became(self, parts: Parts) -> None:
        if parts == self._parts:
            return
        self._parts = parts
        for field, number in zip(self._numbers, parts.numbers, strict=True):
            field.value = number
        if parts.unit != (self._unit.value or ""):
            self._unit.set_options(parts.units or [parts.unit], value=parts.unit or None)
        await self._notify(parts.value())


def words_field(label: str, value: str, heard: Heard, title: str = "") -> ui.input:
    """A field for words; `heard` gets them once it is left."""
    field = ui.input(label, value=value).props("dense outlined").classes("w-full")
    field.props["title"] = title

    async def commit() -> None:
        await heard(str(field.value or ""))

    field.on("blur", commit)
    field.on("keydown.enter", commit)
    return field


def names_field(label: str, value: Any, names: Sequence[str], heard: Heard, title: str = "") -> ui.select:
    """A field for one of `names` (for several, where the value is a list), sought by a part of it."""
    field = select_of(label, value, names)
    field.props["title"] = title

    async def commit() -> None:
        await heard(field.value)

    field.on_value_change(commit)
    return field


def select_of(label: str, value: Any, names: Sequence[str]) -> ui.select:
    """A list of names of which one, or of a list several, are chosen by a part of them."""
    several = isinstance(value, list)
    chosen = ui.select(list(names), label=label, value=value or None, with_input=True, multiple=several)
    return chosen.props("dense outlined options-dense" + " use-chips" * several).classes("w-full lw-names")


def _numbered(label: str, count: int) -> list[str]:
    marks = _AXES if count == 3 else tuple(str(k) for k in range(1, count + 1))
    return [f"{label} {mark}" for mark in marks]


Field: TypeAlias = "QuantityField | ui.input | ui.select"
"""What can say that it is wrong, by its `error`."""
