"""A YAML file under edit: as text, and as a form; both are one text, whose comments stay."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from contextlib import suppress

from nicegui import ui

from linkwright.browser.pages.edit.fields import place_of
from linkwright.browser.pages.frame import Problem
from linkwright.browser.server.folder import Kind
from linkwright.browser.server.parts import Place
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.quantities import InputError

from .form import Form

_PAUSE = 0.35
"""Seconds without a further change after which a text is checked."""


class YamlEditor:
    """Shows a text; `changed` is awaited with every new one."""

    def __init__(self, kind: Kind, changed: Callable[[], Awaitable[None]]) -> None:
        self.name, self.text = "", ""
        self._changed, self._version = changed, 0
        with ui.tabs().props("dense align=left inline-label no-caps") as tabs:
            fields, text = ui.tab("Fields"), ui.tab("Text")
        with ui.tab_panels(tabs, value=fields, animated=False, on_change=self._show_fields).classes("w-full"):
            with ui.tab_panel(fields).classes("p-0"):
                self._form = Form(kind, self._edit)
            with ui.tab_panel(text).classes("p-0"):
                self._area = ui.codemirror(language="YAML", line_wrapping=True, indent="  ", on_change=self._typed)
                self._area.classes("lw-text")
        self._problem = Problem()

    def load(self, name: str, text: str) -> None:
        """Show another file."""
        self.name, self.text = name, text
        self._area.value = text
        self._form.draw(None)
        self._show_fields()

    def draw(self, arm: Arm) -> None:
        """Draw the sections of the arm that the text is of."""
        self._form.draw(arm)

    def mark(self, wrong: InputError | None) -> None:
        """Say what is wrong with the text at the field that it is of, where it is of one."""
        place: Place = ()
        if wrong is not None and wrong.key:
            with suppress(InputError):
                place = place_of(wrong.key, self.name)
        self._form.mark(place, None if wrong is None else wrong.message)

    async def _typed(self) -> None:
        if self._area.value == self.text:
            return
        self.text = self._area.value
        await self._notify()

    async def _notify(self) -> None:
        """Tell of a change once there is no further one for a moment."""
        self._version += 1
        mine = self._version
        await asyncio.sleep(_PAUSE)
        if mine == self._version:
            await self._changed()

    def _show_fields(self) -> None:
        self._problem.say("")
        try:
            content = YamlText(self.text, file=self.name).data
        except InputError as error:
            self._form.clear()
            self._problem.say(str(error))
            return
        self._form.show(content, self.name)

    async def _edit(self, change: Callable[[YamlText], None], again: bool) -> bool:
        """Change the text by what a field says, and make the form anew where `again`; gives whether it changed."""
        try:
            text = YamlText(self.text, file=self.name)
            before = json.dumps(text.data)
            change(text)
            if json.dumps(text.data) == before:
                return False
            made = text.text
        except InputError as error:
            self._problem.say(str(error))
            return False
        self._problem.say("")
        self.text = made
        self._area.value = made
        with self._area:  # the field that was changed goes when the form is made anew
            if again:
                self._show_fields()
            await self._notify()
        return True
