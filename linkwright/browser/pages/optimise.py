"""Optimising: a problem chosen and edited, progress live, a stop that keeps the best so far, the result."""

from __future__ import annotations

import asyncio
from typing import Any

from nicegui import ui

import linkwright as lw
from linkwright.browser.server.desk import Desk
from linkwright.browser.server.folder import staged
from linkwright.browser.server.jobs import Job
from linkwright.core.units.quantities import InputError

from .editor import YamlEditor
from .file_choice import FileChoice
from .frame import Problem, framed, panel, row, stack
from .job_panel import JobPanel
from .result_view import show_ended


class ProblemPage:
    """A problem under edit and what is asked of it; the pages of one visitor build on it."""

    def __init__(self, desk: Desk, title: str, lead: str) -> None:
        self._desk = desk
        with framed(title, lead):
            with ui.element("div").classes("lw-two"):
                with stack():
                    self._choice = FileChoice(desk, "problem", lambda: self._editor, self._check)
                    with panel():
                        self._editor = YamlEditor(self._check)
                        self._choice.save_row()
                with stack():
                    self._problem = Problem()
                    with panel():
                        self._line = ui.label().classes("lw-done")
                        self._asked()
                    self._panel = JobPanel(self._ended)
            self._result = stack()

    def _asked(self) -> None:
        """What stands under the problem: the question's own settings and its button."""
        with row():
            self._round = ui.select({"": "as computed", "stock": "to stock sizes", "1 mm": "to whole mm"}, value="")
            self._round.props('dense outlined label="Sizes"').classes("grow min-w-40")
            self._ask = ui.button("Optimise", on_click=self._start).props("no-caps")

    def _question(self) -> tuple[str, dict[str, Any]]:
        """The kind of work, and its settings."""
        return "optimize", {"round_to": self._round.value or None}

    async def begin(self) -> None:
        """Open the first problem."""
        await self._choice.begin()

    async def _check(self) -> None:
        try:
            found = await asyncio.to_thread(_read, self._desk, self._editor.name, self._editor.text)
        except InputError as error:
            self._problem.say(str(error))
            self._ask.enabled = False
            return
        self._problem.say("")
        self._ask.enabled = True
        self._line.text = repr(found)[1:-1]

    async def _start(self) -> None:
        name, text = self._editor.name, self._editor.text
        kind, settings = self._question()
        try:
            inputs = await asyncio.to_thread(self._desk.folder.with_arm, name, text)
            beside = [each for each in inputs if each != name]
            job = self._desk.jobs.start(kind, name, inputs, {**settings, "problem": name, "beside": beside})
        except InputError as error:
            self._panel.refuse(str(error))
            return
        self._result.clear()
        self._panel.follow(job)

    async def _ended(self, job: Job) -> None:
        with self._result:
            await show_ended(self._desk, job)


def _read(desk: Desk, name: str, text: str) -> Any:
    with staged(desk.folder.with_arm(name, text)) as root:
        return lw.read_problem(root / name)
