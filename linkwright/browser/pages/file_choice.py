"""Choosing a file of the folder to edit, and keeping it under a name."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from nicegui import ui

from linkwright.browser.server.desk import Desk
from linkwright.browser.server.folder import Kind
from linkwright.core.units.quantities import InputError

from .editor import YamlEditor
from .frame import Problem, row
from .save_row import SaveRow


class FileChoice:
    """A list of the folder's files of one kind; `opened` is awaited once one is in the editor."""

    def __init__(
        self, desk: Desk, kind: Kind, editor: Callable[[], YamlEditor], opened: Callable[[], Awaitable[None]]
    ) -> None:
        self._desk, self._editor, self._opened = desk, editor, opened
        self._kind: Kind = kind
        with row():
            self._list = ui.select([], label=f"{kind.capitalize()} file", on_change=self._chosen)
            self._list.props("dense outlined").classes("grow min-w-40")
            self._add = ui.button("Add the examples", on_click=self._examples).props("outline dense no-caps")
        self._problem = Problem()

    def save_row(self) -> None:
        """Where the edited text is kept."""
        self._save = SaveRow(self._desk.folder, "Keep as", "Save", self._text, self._saved)

    async def begin(self) -> None:
        """Open the first file there is."""
        names = await self._look()
        if names:
            self._list.value = names[0]

    async def _look(self) -> list[str]:
        names = await asyncio.to_thread(self._desk.folder.names, self._kind)
        self._list.set_options(names)
        return names

    async def _examples(self) -> None:
        try:
            added = await asyncio.to_thread(self._desk.folder.add_examples)
        except InputError as error:
            self._problem.say(str(error))
            return
        names = await self._look()
        self._list.value = next((name for name in added if name in names), None)

    async def _chosen(self) -> None:
        name = self._list.value
        if not isinstance(name, str):
            return
        try:
            text = await asyncio.to_thread(self._desk.folder.read, name)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._problem.say("")
        self._editor().load(name, text)
        self._save.opened = (name, text)
        self._save.name = name
        await self._opened()

    async def _text(self) -> str:
        return self._editor().text

    async def _saved(self, name: str) -> None:
        self._editor().name = name
        await self._look()
