"""Choosing a file of the folder to edit, and keeping a text under a name; nothing of others is written over."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from nicegui import ui

from linkwright.browser.pages.editor import YamlEditor
from linkwright.browser.pages.frame import Problem, row, stack
from linkwright.browser.server.answers import Desk
from linkwright.browser.server.folder import Folder, Kind, Occupied
from linkwright.core.units.quantities import InputError


class SaveRow:
    """A name, a button, and a second one once the file of that name is another than the one that was opened.

    `text` is awaited for what is to be written, `saved` with the name once it is. `name` is the one in the field,
    `opened` the name and the text of the file as it was read or written here last.
    """

    def __init__(
        self,
        folder: Folder,
        label: str,
        button: str,
        text: Callable[[], Awaitable[str]],
        saved: Callable[[str], Awaitable[None]] | None = None,
    ) -> None:
        self._folder, self._text, self._saved = folder, text, saved
        self.opened: tuple[str, str] = ("", "")
        with stack():
            with row():
                self._name = ui.input(label, on_change=self._renamed).props("dense outlined").classes("grow min-w-40")
                ui.button(button, on_click=self._save).props("dense no-caps")
                self._over = ui.button("Write over it", on_click=self._save_over)
                self._over.props("dense outline no-caps color=negative").set_visibility(False)
            self._problem = Problem()

    @property
    def name(self) -> str:
        """The name in the field."""
        return self._name.value or ""

    @name.setter
    def name(self, name: str) -> None:
        self._name.value = name

    def _renamed(self) -> None:
        self._over.visible = False
        self._problem.say("")

    async def _save(self) -> None:
        name, known = self.opened
        await self._write(known if self.name == name else None)

    async def _save_over(self) -> None:
        await self._write(None, whatever=True)

    async def _write(self, known: str | None, *, whatever: bool = False) -> None:
        name = self.name
        self._over.visible = False
        try:
            text = await self._text()
            await asyncio.to_thread(self._folder.write, name, text, known=known, whatever=whatever)
        except InputError as error:
            self._over.visible = isinstance(error, Occupied)
            self._problem.say(str(error))
            return
        self._problem.say("")
        self.opened = (name, text)
        if self._saved is not None:
            await self._saved(name)
        ui.notify(f"saved as {name}", type="positive")


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
