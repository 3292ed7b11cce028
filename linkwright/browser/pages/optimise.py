"""A problem chosen and edited, optimised or traded off: progress live, a stop that keeps the best so far."""

from __future__ import annotations

import asyncio
from types import MappingProxyType
from typing import Any

from nicegui import ui

import linkwright as lw
from linkwright.browser.pages.asking import Asking
from linkwright.browser.pages.edit.file_choice import FileChoice
from linkwright.browser.pages.frame import Problem, framed, panel, picture, row, sides
from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.drawings import at_pose, middle
from linkwright.browser.server.folder import staged
from linkwright.core.units.quantities import InputError


class ProblemPage(Asking):
    """A problem under edit and what is asked of it; the pages of one visitor build on it."""

    def __init__(self, desk: Desk, kind: str, title: str, lead: str) -> None:
        super().__init__(desk, kind)
        with framed(title, lead), sides() as (left, right):
            with left:
                self._choice = FileChoice(desk, "problem", self._check)
            with right:
                self._problem = Problem()
                with panel():
                    self._line = ui.label().classes("lw-done")
                    self._picture = picture()
                    self._asked()
                self._answers()

    def _asked(self) -> None:
        """What stands under the problem: the question's own settings and its button."""
        with row():
            self._round = ui.select({"": "as computed", "stock": "to stock sizes", "1 mm": "to whole mm"}, value="")
            self._round.props('dense outlined label="Sizes"').classes("grow min-w-40")
            self._ask = ui.button("Optimise", on_click=self._start).props("no-caps")
            self._ask.enabled = False  # until the file is read

    def _question(self) -> dict[str, Any]:
        """The settings of the work."""
        return {"round_to": self._round.value or None}

    def _now(self) -> tuple[str, str]:
        return self._choice.editor.name, self._choice.editor.text

    async def _open(self, asked: Asked | None) -> None:
        await self._choice.begin(asked)

    async def _open_as_it_was(self, asked: Asked) -> None:
        await self._choice.open_as_it_was(asked)

    async def _check(self) -> None:
        await self._compare()
        try:
            checked = await asyncio.to_thread(_read, self._desk, self._choice.editor.name, self._choice.editor.text)
        except InputError as error:
            self._problem.say(str(error))
            self._choice.editor.mark(error)
            self._ask.enabled = False
            return
        self._problem.say("")
        self._choice.editor.mark(None)
        self._ask.enabled = True
        self._line.text = repr(checked)[1:-1]
        arm = checked.model.arm
        self._picture.content = await asyncio.to_thread(at_pose, arm, middle(arm))

    async def _start(self) -> None:
        name, text = self._choice.editor.name, self._choice.editor.text
        try:
            inputs = await asyncio.to_thread(self._desk.folder.with_named, name, text)
            self._begin(name, inputs, {**self._question(), "problem": name})
        except InputError as error:
            self._runs.refuse(str(error))


def _read(desk: Desk, name: str, text: str) -> Any:
    with staged(desk.folder.with_named(name, text)) as root:
        return lw.read_problem(root / name)


_ACCURACIES = MappingProxyType({0.3: "30 %: a first look", 0.1: "10 %", 0.03: "3 %", 0.01: "1 %: fine"})


class TradeoffPage(ProblemPage):
    """A problem, and two figures of its designs."""

    def __init__(self, desk: Desk) -> None:
        lead = "The designs that none beats in both of two figures. Stop leaves the points so far."
        super().__init__(desk, "tradeoff", "Trade-off", lead)

    def _asked(self) -> None:
        traded = sorted(name for name in lw.limits if lw.limits[name].traded)
        names = {name: name.replace("_", " ") for name in traded}
        with row():
            self._x = _choice(names, "mass", "To the right")
            self._y = _choice(names, "max_error", "Upwards")
            self._by = _choice({"": "one front", "material": "each material", "shape": "each shape"}, "", "A front for")
            self._accuracy = _choice(dict(_ACCURACIES), 0.1, "Accuracy")
            self._ask = ui.button("Trade-off", on_click=self._start).props("no-caps")
            self._ask.enabled = False  # until the file is read

    def _question(self) -> dict[str, Any]:
        return {"x": self._x.value, "y": self._y.value, "by": self._by.value, "accuracy": self._accuracy.value}


def _choice(options: dict[Any, str], value: object, label: str) -> ui.select:
    return ui.select(options, value=value, label=label).props("dense outlined").classes("grow min-w-32")
