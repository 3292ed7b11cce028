"""A file under edit and what is asked of it: an arm looked at and evaluated, a problem optimised or traded off."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from nicegui import ui

import linkwright as lw
from linkwright.browser.pages.asking import Asking
from linkwright.browser.pages.edit.file_choice import FileChoice
from linkwright.browser.pages.frame import Problem, explained, framed, panel, picture, row, sides
from linkwright.browser.pages.pose_view import PoseView
from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.drawings import at_pose, middle
from linkwright.browser.server.folder import Kind, arm_from_text, staged
from linkwright.core.units.quantities import InputError


class EditedPage(Asking):
    """The page of one visitor: a file of a `kind` on one side; on the other what it is, and what comes of it."""

    def __init__(self, desk: Desk, asks: str, kind: Kind, title: str, lead: str) -> None:
        super().__init__(desk, asks)
        self._known_as = ""
        """The file that the page tells of beside the fields."""
        with framed(title, lead), sides() as (left, right):
            with left:
                self._choice = FileChoice(desk, kind, self._check)
            with right:
                self._problem = Problem()
                with panel() as self._beginning:
                    explained("Where to begin", self._beginnings())
                with panel() as self._known:
                    self._line = ui.label().classes("lw-done")
                    self._asked()
                self._known.visible = False  # until a file is read
                self._answers()

    @abstractmethod
    def _beginnings(self) -> Sequence[tuple[str, str]]:
        """What a folder without such a file begins with, each with what it is."""

    @abstractmethod
    def _asked(self) -> None:
        """What stands under the file's line: a picture, the question's settings and its button."""

    @abstractmethod
    def _read(self, name: str, text: str) -> Any:
        """What a text says. Raises `InputError`."""

    @abstractmethod
    async def _look_at(self, read: Any) -> None:
        """Show what was read."""

    @abstractmethod
    def _question(self, name: str, text: str) -> tuple[str, Mapping[str, bytes], Mapping[str, Any]]:
        """The title, the files and the settings of the work. Raises `InputError`."""

    def _button(self, words: str) -> None:
        self._ask = ui.button(words, on_click=self._start).props("no-caps")
        self._ask.enabled = False  # until the file is read

    def _now(self) -> tuple[str, str]:
        return self._choice.editor.name, self._choice.editor.text

    async def _open(self, asked: Asked | None) -> None:
        await self._choice.begin(asked)

    async def _open_as_it_was(self, asked: Asked) -> None:
        await self._choice.open_as_it_was(asked)

    async def _check(self) -> None:
        await self._compare()
        self._beginning.visible = False
        wrong, read = None, None
        try:
            read = await asyncio.to_thread(self._read, *self._now())
        except InputError as error:
            wrong = error
        self._problem.say("" if wrong is None else str(wrong))
        self._choice.editor.mark(wrong)
        self._ask.enabled = wrong is None
        name = self._now()[0]
        self._known.visible = wrong is None or self._known_as == name  # what is known of one file is not another's
        self._known.classes(add="" if wrong is None else "lw-stale", remove="lw-stale" if wrong is None else "")
        if wrong is None:
            self._known_as = name
            self._line.text = repr(read)[1:-1]
            await self._look_at(read)

    async def _start(self) -> None:
        try:
            self._begin(*await asyncio.to_thread(self._question, *self._now()))
        except InputError as error:
            self._runs.refuse(str(error))


class ArmPage(EditedPage):
    """An arm, drawn while it is edited, in space at any pose with its error there, and evaluated."""

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, "evaluate", "arm", "Arm", "Edit an arm, look at it, and ask for its worst error.")

    def _beginnings(self) -> Sequence[tuple[str, str]]:
        return (
            ("Add the examples", "An arm of two joints, and a problem that asks for its best links."),
            ("New arm", "A copy of an arm that is shipped (two joints to six), or a URDF of your own."),
        )

    def _asked(self) -> None:
        self._arm: Any = None
        self._view = PoseView()
        self._button("Evaluate")

    def _read(self, name: str, text: str) -> Any:
        return arm_from_text(name, text)

    async def _look_at(self, read: Any) -> None:
        self._arm = read
        self._choice.editor.draw(read.model)
        await self._view.show(read.model)

    def _question(self, name: str, text: str) -> tuple[str, Mapping[str, bytes], Mapping[str, Any]]:
        self._desk.folder.place(name)
        return self._arm.name, {name: text.encode()}, {"arm": name}


class ProblemPage(EditedPage):
    """A problem, optimised with progress live and a stop that keeps the best so far."""

    def __init__(self, desk: Desk, asks: str, title: str, lead: str) -> None:
        super().__init__(desk, asks, "problem", title, lead)

    def _beginnings(self) -> Sequence[tuple[str, str]]:
        return (
            ("Add the examples", "An arm of two joints, and a problem that asks for its best links."),
            ("Your own problem", f"A file beside its arm in {self._desk.folder.root}."),
        )

    def _asked(self) -> None:
        self._picture = picture()
        with row():
            self._settings()

    def _settings(self) -> None:
        rounded = {"": "as computed", "stock": "to stock sizes", "1 mm": "to whole mm"}
        self._chosen = {"round_to": _choice(rounded, "", "Sizes")}
        self._button("Optimise")

    def _read(self, name: str, text: str) -> Any:
        with staged(self._desk.folder.with_named(name, text)) as root:
            return lw.read_problem(root / name)

    async def _look_at(self, read: Any) -> None:
        arm = read.model.arm
        self._choice.editor.draw(arm)
        self._picture.content = await asyncio.to_thread(at_pose, arm, middle(arm))

    def _question(self, name: str, text: str) -> tuple[str, Mapping[str, bytes], Mapping[str, Any]]:
        settings = {setting: field.value or None for setting, field in self._chosen.items()}
        return name, self._desk.folder.with_named(name, text), {**settings, "problem": name}


_ACCURACIES = MappingProxyType({0.3: "30 %: a first look", 0.1: "10 %", 0.03: "3 %", 0.01: "1 %: fine"})


class TradeoffPage(ProblemPage):
    """A problem, and two figures of its designs."""

    def __init__(self, desk: Desk) -> None:
        lead = "The designs that none beats in both of two figures. Stop leaves the points so far."
        super().__init__(desk, "tradeoff", "Trade-off", lead)

    def _settings(self) -> None:
        names = {name: name.replace("_", " ") for name in sorted(lw.limits) if lw.limits[name].traded}
        fronts = {"": "one front", "material": "each material", "shape": "each shape"}
        self._chosen = {
            "x": _choice(names, "mass", "To the right"),
            "y": _choice(names, "max_error", "Upwards"),
            "by": _choice(fronts, "", "A front for"),
            "accuracy": _choice(dict(_ACCURACIES), 0.1, "Accuracy"),
        }
        self._button("Trade-off")


def _choice(options: dict[Any, str], value: object, label: str) -> ui.select:
    return ui.select(options, value=value, label=label).props("dense outlined").classes("grow min-w-32")
