"""A YAML file under edit: as text, and as fields by joint and link; both are one text, whose comments stay."""

from __future__ import annotations

import asyncio
import copy
import re
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any, cast

from nicegui import ui

from linkwright.browser.pages.frame import Problem, heading, row, stack
from linkwright.browser.server.folder import Kind
from linkwright.browser.server.keys import Place, known_keys, meaning, to_choose
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import parse_yaml, yaml_line
from linkwright.face.plain_input import steps_of

_PAUSE = 0.35
"""Seconds without a further change after which a text is checked."""
_VALUE = "Value; empty takes it out"
_LONG = 20
"""Letters of a value that need a wide field."""


class YamlEditor:
    """Shows a text; `changed` is awaited with every new one."""

    def __init__(self, kind: Kind, changed: Callable[[], Awaitable[None]]) -> None:
        self.name, self.text = "", ""
        self._kind: Kind = kind
        self._changed, self._version = changed, 0
        self._shown: dict[Place, ui.input | ui.select] = {}
        with ui.tabs().props("dense align=left inline-label") as tabs:
            fields, text = ui.tab("Fields"), ui.tab("Text")
        with ui.tab_panels(tabs, value=fields, animated=False, on_change=self._turned).classes("w-full"):
            with ui.tab_panel(fields).classes("p-0"):
                self._fields = stack()
            with ui.tab_panel(text).classes("p-0"):
                self._area = ui.codemirror(language="YAML", line_wrapping=True, indent="  ", on_change=self._typed)
                self._area.classes("lw-text")
        self._problem = Problem()

    def load(self, name: str, text: str) -> None:
        """Show another file."""
        self.name, self.text = name, text
        self._area.value = text
        self._show_fields()

    def mark(self, wrong: InputError | None) -> None:
        """Say what is wrong with the text at the field that it is of, where it is of one."""
        place: Place = ()
        if wrong is not None and wrong.key:
            with suppress(InputError):
                place = _place_of(wrong.key, self.name)
        while place and place not in self._shown:
            place = place[:-1]
        for key, field in self._shown.items():
            field.error = wrong.message if wrong is not None and key == place else None

    async def _typed(self) -> None:
        if self._area.value == self.text:
            return
        self.text = self._area.value
        await self._told()

    async def _turned(self) -> None:
        self._show_fields()

    async def _told(self) -> None:
        """Tell of a change once there is no further one for a moment."""
        self._version += 1
        mine = self._version
        await asyncio.sleep(_PAUSE)
        if mine == self._version:
            await self._changed()

    def _show_fields(self) -> None:
        self._fields.clear()
        self._shown.clear()
        self._problem.say("")
        try:
            content = YamlText(self.text, file=self.name).data
        except InputError as error:
            self._problem.say(str(error))
            return
        with self._fields:
            groups: dict[str, list[tuple[Place, Any]]] = {}
            for place, value in _leaves(content, ()):
                groups.setdefault(_group(place), []).append((place, value))
            for name, leaves in groups.items():
                heading(name)
                with ui.element("div").classes("lw-fields"):
                    for place, value in leaves:
                        self._field(place, value, content)
            with row():
                if isinstance(content.get("chain"), list):
                    ui.button("Add a joint and link", on_click=self._add_link).props("outline dense no-caps")
                    ui.button("Take the last one out", on_click=self._drop_link).props("outline dense no-caps")
            chain = content.get("chain")
            keys = known_keys(self._kind, len(cast(list[Any], chain)) if isinstance(chain, list) else 0)
            with row():
                key = ui.select(keys, label="Any key", with_input=True, new_value_mode="add-unique")
                key.props("dense outlined use-input hide-selected fill-input").classes("grow min-w-40")
                beside = ui.element("div").classes("grow min-w-40")
                set_it = ui.button("Set").props("outline dense no-caps")
            note = ui.label().classes("lw-note")
            value: list[ui.input | ui.select] = []

            def chosen() -> None:
                beside.clear()
                place: Place = ()
                with suppress(InputError):
                    place = _place_of(str(key.value or ""), self.name)
                note.text = meaning(self._kind, place) if place else ""
                names = to_choose(place) if place else []
                with beside:
                    value[:] = [_input(_VALUE, [] if names and place[:1] == ("choose",) else "", names)]

            chosen()
            key.on_value_change(chosen)
            set_it.on_click(lambda: self._set_key(str(key.value or ""), value[0].value or ""))

    def _field(self, place: Place, value: Any, content: Any) -> None:
        below = place[3:] if place[0] == "chain" else place[1:] or place
        words, names = _shown(value), to_choose(place)
        listed: list[Any] = value if isinstance(value, list) else [value]
        label = ".".join(map(str, below))
        known = bool(names) and all(item in names for item in listed)
        field = _input(label, value, names) if known else _input(label, words, [])
        self._shown[place] = field
        beside = content
        for step in place[:-1]:
            beside = beside[step]
        if explanation := meaning(self._kind, place, str(beside.get("shape", "")) if isinstance(beside, dict) else ""):
            field.props["title"] = explanation
        if len(words) > _LONG:
            field.classes("lw-wide")

        async def commit() -> None:
            now: Any = "" if field.value is None else field.value
            await self._edit(lambda text: text.set(place, _meant(now, value)), place, _shown(now))

        if isinstance(field, ui.select):
            field.on_value_change(commit)
            return
        field.on("blur", commit)
        field.on("keydown.enter", commit)

    async def _edit(self, change: Callable[[YamlText], None], place: Place = (), shown: str | None = None) -> bool:
        """Change the text by what a field says; gives whether it changed."""
        try:
            text = YamlText(self.text, file=self.name)
            if shown is not None and _shown(text.get(place)) == shown:
                return False
            change(text)
            made = text.text
        except InputError as error:
            self._problem.say(str(error))
            return False
        self._problem.say("")
        self.text = made
        self._area.value = made
        await self._told()
        return True

    async def _add_link(self) -> None:
        def add(text: YamlText) -> None:
            text.append(["chain"], copy.deepcopy(text.get(["chain"])[-1]))

        if await self._edit(add):
            self._show_fields()

    async def _drop_link(self) -> None:
        def drop(text: YamlText) -> None:
            last = len(text.get(["chain"])) - 1
            if last < 1:
                raise InputError(self.name, "chain", "needs one joint and link at least")
            text.remove(["chain", last])

        if await self._edit(drop):
            self._show_fields()

    async def _set_key(self, key: str, value: Any) -> None:
        def change(text: YamlText) -> None:
            place = _place_of(key, self.name)
            if str(value).strip() not in ("", "[]"):
                text.set(place, _meant(value, text.get(place)))
            else:
                text.remove(place)

        if await self._edit(change):
            self._show_fields()


def _input(label: str, value: Any, names: Sequence[str]) -> ui.input | ui.select:
    """A field for words, or for one of `names` (for several, where the value is a list), sought by a part of it."""
    if not names:
        return ui.input(label, value=value).props("dense outlined").classes("w-full")
    several = isinstance(value, list)
    chosen = ui.select(list(names), label=label, value=value or None, with_input=True, multiple=several)
    return chosen.props("dense outlined" + " use-chips" * several).classes("w-full lw-names")


def _leaves(content: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """What a field can show: words, numbers, lists of them."""
    if isinstance(content, dict):
        for key, value in cast(dict[str, Any], content).items():
            yield from _leaves(value, (*place, str(key)))
    elif isinstance(content, list) and any(isinstance(item, dict) for item in cast(list[Any], content)):
        for number, value in enumerate(cast(list[Any], content)):
            yield from _leaves(value, (*place, number))
    elif place:
        yield place, content


def _group(place: Place) -> str:
    if place[0] == "chain" and len(place) > 2 and isinstance(place[1], int):
        return f"{str(place[2]).capitalize()} {place[1] + 1}"
    return str(place[0]).replace("_", " ").capitalize() if len(place) > 1 else "General"


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else "" if value is None else yaml_line(value)


def _meant(value: Any, before: Any) -> Any:
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


def _place_of(key: str, file: str) -> Place:
    """A key such as chain[1].joint.backlash as a place; lists count from 1."""
    steps = steps_of(key.strip(), file)
    if 0 in steps:
        raise InputError(file, key.strip(), "is no key; write e.g. 'chain[1].link.length' (lists count from 1)")
    return tuple(step - 1 if isinstance(step, int) else step for step in steps)
