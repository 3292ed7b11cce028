"""The arm: drawn while it is edited, in space at any pose with its error there, and evaluated."""

from __future__ import annotations

import asyncio
from typing import Any

from nicegui import ui

from linkwright.browser.server.answers import Desk
from linkwright.browser.server.asked import Asked
from linkwright.browser.server.folder import arm_from_text
from linkwright.core.units.quantities import InputError

from .asking import Asking
from .edit.file_choice import FileChoice
from .frame import Problem, framed, panel, sides
from .pose_view import PoseView


class ArmPage(Asking):
    """The page of one visitor."""

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, "evaluate")
        self._arm: Any = None
        with framed("Arm", "Edit an arm, look at it, and ask for its worst error."), sides() as (left, right):
            with left:
                self._choice = FileChoice(desk, "arm", self._check)
            with right:
                self._problem = Problem()
                with panel():
                    self._line = ui.label().classes("lw-done")
                    self._view = PoseView()
                self._ask = ui.button("Evaluate", on_click=self._evaluate).props("no-caps")
                self._ask.enabled = False  # until the file is read
                self._answers()

    def _now(self) -> tuple[str, str]:
        return self._choice.editor.name, self._choice.editor.text

    async def _open(self, asked: Asked | None) -> None:
        await self._choice.begin(asked)

    async def _open_as_it_was(self, asked: Asked) -> None:
        await self._choice.open_as_it_was(asked)

    async def _check(self) -> None:
        name, text = self._choice.editor.name, self._choice.editor.text
        await self._compare()
        try:
            self._arm = await asyncio.to_thread(arm_from_text, name, text)
        except InputError as error:
            self._problem.say(str(error))
            self._choice.editor.mark(error)
            self._ask.enabled = False
            return
        self._problem.say("")
        self._choice.editor.mark(None)
        self._ask.enabled = True
        self._line.text = repr(self._arm)[1:-1]
        self._choice.editor.draw(self._arm.model)
        await self._view.show(self._arm.model)

    async def _evaluate(self) -> None:
        name = self._choice.editor.name
        try:
            self._desk.folder.place(name)
            self._begin(self._arm.name, {name: self._choice.editor.text.encode()}, {"arm": name})
        except InputError as error:
            self._runs.refuse(str(error))
