"""Keeping a text in the folder under a name; a file that somebody else wrote is not written over without a word."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from nicegui import ui

from linkwright.browser.server.folder import Folder, Occupied
from linkwright.core.units.quantities import InputError

from .frame import Problem, row, stack


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
