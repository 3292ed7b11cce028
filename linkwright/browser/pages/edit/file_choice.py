"""Choosing a file of the folder and editing it; keeping a text under a name. Nothing of others is written over, and
nothing that is not saved is lost without a word."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from pathlib import PurePosixPath
from typing import cast

from nicegui import events, ui

from linkwright.browser.pages.edit.editor import YamlEditor
from linkwright.browser.pages.frame import Problem, dropped_or_chosen, panel, row, stack
from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.dropped import plain_name
from linkwright.browser.server.folder import Folder, Kind, Occupied, arm_of_urdf, is_description, templates
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
                ui.button(button, on_click=self.save).props("dense no-caps")
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

    async def save(self) -> bool:
        """Write it; whether it could be."""
        name, known = self.opened
        return await self._write(known if self.name == name else None)

    async def _save_over(self) -> None:
        await self._write(None, whatever=True)

    async def _write(self, known: str | None, *, whatever: bool = False) -> bool:
        name = self.name
        self._over.visible = False
        try:
            text = await self._text()
            await asyncio.to_thread(self._folder.write, name, text, known=known, whatever=whatever)
        except InputError as error:
            self._over.visible = isinstance(error, Occupied)
            self._problem.say(str(error))
            return False
        self._problem.say("")
        self.opened = (name, text)
        if self._saved is not None:
            await self._saved(name)
        ui.notify(f"saved as {name}", type="positive")
        return True


class NewArm:
    """A dialog that asks what a new arm begins as: a shipped one, or a URDF. `begun` is awaited with a name and a text;
    it gives whether they may be taken."""

    def __init__(self, begun: Callable[[str, str], Awaitable[bool]]) -> None:
        self._begun = begun
        self._dropped: tuple[str, Mapping[str, bytes]] = ("", {})
        texts = templates()
        with ui.dialog() as self._dialog, ui.card().classes("lw-dialog"):
            ui.label("A new arm begins as").classes("lw-done")
            self._like = ui.select(list(texts), label="One that is shipped", with_input=True).props("dense outlined")
            self._like.classes("w-full")
            self._like.on_value_change(lambda: self._copied(texts))
            self._upload = ui.upload(auto_upload=True, on_upload=self._urdf)
            self._upload.props('flat bordered accept=".urdf,.xml"').on("finish", self._upload.reset)
            dropped_or_chosen(self._upload, "or drop a URDF here", "Choose a URDF")
            with row() as self._tips:
                self._tip = ui.input("Link at the tip").props("dense outlined").classes("grow")
                ui.button("Take it", on_click=self._imported).props("dense no-caps")
            self._problem = Problem()

    def open(self) -> None:
        """Ask."""
        self._like.value = None
        self._tips.visible = False
        self._problem.say("")
        self._dialog.open()

    async def _copied(self, texts: Mapping[str, str]) -> None:
        if self._like.value is not None:
            self._dialog.close()
            await self._begun("new-arm", texts[str(self._like.value)])

    async def _urdf(self, event: events.UploadEventArguments) -> None:
        name = plain_name(event.file.name)
        await self.begin_from(name, {name: await event.file.read()})

    async def begin_from(self, name: str, files: Mapping[str, bytes]) -> None:
        """Begin an arm from a URDF or MJCF among files; ask for its tip where it has several."""
        self._dropped = (name, files)
        self._tip.value = ""
        await self._imported()

    async def _imported(self) -> None:
        name, files = self._dropped
        try:
            text, line = await asyncio.to_thread(arm_of_urdf, name, files, str(self._tip.value or "").strip())
        except InputError as error:
            self._dialog.open()
            self._tips.visible = True
            self._problem.say(str(error))
            return
        self._dialog.close()
        if await self._begun(PurePosixPath(name).stem, text):
            ui.notify(line, type="positive")


class FileChoice:
    """A list of the folder's files of one kind, and one of them under edit; `checked` is awaited with every new text.

    What is not saved is said, and asked about before another file or page takes its place.
    """

    def __init__(self, desk: Desk, kind: Kind, checked: Callable[[], Awaitable[None]]) -> None:
        self._desk, self._checked = desk, checked
        self._kind: Kind = kind
        with row():
            self._list = ui.select([], label=f"{kind.capitalize()} file", on_change=self._chosen)
            self._list.props("dense outlined").classes("grow min-w-40")
            if kind == "arm":
                ui.button("New arm", on_click=lambda: self._new.open()).props("outline dense no-caps")
            ui.button("Add the examples", on_click=self._examples).props("outline dense no-caps")
        self._problem = Problem()
        with panel() as self._edited:
            self.editor = YamlEditor(kind, self._changed)
            self._unsaved = ui.label("Changes are not saved.").classes("lw-unsaved").props("role=status")
            self._save = SaveRow(desk.folder, "Keep as", "Save", self._text, self._saved)
        self._unsaved.visible = self._edited.visible = False
        if kind == "arm":
            self._new = NewArm(self._begun)
        with ui.dialog().props("persistent") as self._ask, ui.card().classes("lw-dialog"):
            self._question = ui.label()
            with row():
                ui.button("Save", on_click=lambda: self._ask.submit("save")).props("dense no-caps")
                discard = ui.button("Discard them", on_click=lambda: self._ask.submit("discard"))
                discard.props("dense outline no-caps color=negative")
                ui.button("Stay here", on_click=lambda: self._ask.submit("stay")).props("dense outline no-caps")

    async def begin(self, asked: Asked | None = None) -> None:
        """Open the file that an answer is of, or its text where that file is gone; without one the first there is."""
        names = [name for name in await self._look() if not is_description(name)]
        if asked is not None and asked.file not in names:
            await self.open_as_it_was(asked)
        elif asked is not None or names:
            self._list.value = names[0] if asked is None else asked.file

    async def open_as_it_was(self, asked: Asked) -> None:
        """Open a file's text as an answer was given of it; it is not saved."""
        if not await self._may_go():
            return
        try:
            there = await asyncio.to_thread(self._desk.folder.read, asked.file)
        except InputError:
            there = ""
        await self._open(asked.file, asked.text, there)

    async def _look(self) -> list[str]:
        more: tuple[Kind, ...] = ("description",) if self._kind == "arm" else ()
        names = await asyncio.to_thread(self._desk.folder.names, self._kind, *more)
        self._list.set_options(names)
        begins = "; a URDF begins one" if names else ""
        if any(not is_description(name) for name in names):
            self._list.props(remove="hint")
        else:
            self._list.props(f'hint="The folder has no {self._kind} file{begins}."')
        return names

    async def _examples(self) -> None:
        try:
            added = await asyncio.to_thread(self._desk.folder.add_examples)
        except InputError as error:
            self._problem.say(str(error))
            return
        names = await self._look()
        self._list.value = next((name for name in added if name in names), None)

    async def _chosen(self, event: events.ValueChangeEventArguments[str | None]) -> None:
        name = event.value
        if not isinstance(name, str) or name == self.editor.name:
            return
        if is_description(name):
            self._as_before()
            await self._begin_from(name)
            return
        if not await self._may_go():
            self._as_before()
            return
        try:
            text = await asyncio.to_thread(self._desk.folder.read, name)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._problem.say("")
        await self._open(name, text)

    def _as_before(self) -> None:
        names = cast(list[str], self._list.options)
        self._list.value = self.editor.name if self.editor.name in names else None

    async def _begin_from(self, name: str) -> None:
        """Begin a new arm from a URDF or MJCF of the folder."""
        try:
            files = await asyncio.to_thread(self._desk.folder.arm, name)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._problem.say("")
        await self._new.begin_from(name, files)

    async def _may_go(self) -> bool:
        """Whether another text may take the place of this one: it is saved, or need not be."""
        if not self._unsaved.visible:
            return True
        self._question.text = f"The changes of {self._save.opened[0] or 'this text'} are not saved."
        choice = await self._ask
        return choice == "discard" or (choice == "save" and await self._save.save())

    async def _open(self, name: str, text: str, there: str | None = None) -> None:
        """Edit a text under a file's name; `there` is what the file holds, where that is another one."""
        self._save.opened = (name, text if there is None else there)
        self._save.name = name
        self._show(name, text)
        self._list.value = name if name in cast(list[str], self._list.options) else None
        await self._changed()

    async def _begun(self, name: str, text: str) -> bool:
        """Edit a text that is no file yet, under a name that none has; whether it may."""
        if not await self._may_go():
            return False
        names = await self._look()
        free = (f"{name}{number or ''}.yaml" for number in (0, *range(2, len(names) + 3)))
        self._list.value = None
        self._save.opened = ("", "")
        self._save.name = next(item for item in free if item not in names)
        self._show(self._save.name, text)
        await self._changed()
        return True

    def _show(self, name: str, text: str) -> None:
        self._edited.visible = True  # without a text it is an empty box
        self.editor.load(name, text)

    async def _changed(self) -> None:
        self._tell()
        await self._checked()

    def _tell(self) -> None:
        """Say whether something is not saved, here and to the browser, which asks before it leaves the page."""
        unsaved = self.editor.text != self._save.opened[1]
        if unsaved != self._unsaved.visible:
            self._unsaved.visible = unsaved
            ui.run_javascript(f"window.onbeforeunload = {'event => event.preventDefault()' if unsaved else 'null'}")

    async def _text(self) -> str:
        return self.editor.text

    async def _saved(self, name: str) -> None:
        self.editor.name = name
        self._tell()
        await self._look()
        self._list.value = name
