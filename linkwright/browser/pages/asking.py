"""A page that asks: what is at work, and the last answer, which never stands beside another arm unsaid."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

from nicegui import ui

from linkwright.browser.server.answers import Desk, on_shelf
from linkwright.browser.server.asked import ASKED, Asked, asked_from
from linkwright.browser.server.jobs import Job
from linkwright.core.units.quantities import InputError

from .frame import bring_into_view, row, stack
from .result_view import show_result, show_unkept
from .runs import Runs


class Asking(ABC):
    """A page that runs jobs of one kind: those at work, and below them the last answer. An answer of another file, or
    of this one before it was changed, is grey and says so."""

    def __init__(self, desk: Desk, kind: str) -> None:
        self._desk, self._kind = desk, kind
        self._shown: Asked | None = None
        """What the answer is of that the page shows."""
        self._started: set[int] = set()
        """The jobs that were begun here."""

    _edits = True
    """Whether the page can show another text than the file's."""

    @abstractmethod
    def _now(self) -> tuple[str, str]:
        """The name and the text of the file that the page shows; empty while it is not read."""

    @abstractmethod
    async def _open(self, asked: Asked | None) -> None:
        """Open the file that an answer is of, or the first where there is none."""

    @abstractmethod
    async def _open_as_it_was(self, asked: Asked) -> None:
        """Open the text that an answer is of."""

    def _answers(self) -> None:
        self._runs = Runs(self._desk.jobs, self._kind, self._ended)
        with row().classes("lw-of").props("role=status") as self._other:
            self._why = ui.label().classes("grow")
            self._back = ui.button(on_click=self._reopen).props("outline dense no-caps")
        self._other.visible = False
        self._result = stack().classes("lw-answer")

    async def begin(self, number: int | None = None) -> None:
        """Open the file that the last answer is of and show that answer; or those of a kept result."""
        if number is None:
            await self._open(await self._asked_last())
            await self._runs.begin()
            return
        try:
            content = await self._desk.looked_up(on_shelf(self._desk.shelf, number).file, ASKED)
        except InputError as error:
            self._runs.refuse(str(error))
            content = None
        asked = asked_from(content)
        await self._open(asked)
        await self._show_kept(number, asked)

    async def _asked_last(self) -> Asked | None:
        """What the last answer is of, where that and its file are still there."""
        last, desk = self._runs.last, self._desk
        if last is None or last.asked is None or last.state == "refused":
            return None
        try:
            await asyncio.to_thread(desk.folder.read, last.asked.file)
            there = last.result is None or await desk.looked_up(desk.shelf.find, last.result) is not None
        except InputError:
            return None
        return last.asked if there else None

    def _begin(self, title: str, inputs: Mapping[str, bytes], request: Mapping[str, Any]) -> None:
        """Begin it. Raises `InputError` where too much is at work."""
        self._started.add(self._desk.jobs.start(self._kind, title, inputs, request).number)
        self._runs.refuse("")
        self._clear()

    def _clear(self) -> None:
        self._result.clear()
        self._shown = None
        self._other.visible = False

    async def _ended(self, job: Job, late: bool) -> bool:
        if not late and job.number not in self._started and await self._differs(job.asked):
            return False
        if job.result is not None:
            await self._show_kept(job.result, job.asked, "" if late else "It was removed meanwhile.")
        else:
            self._result.clear()
            with self._result:
                await show_unkept(self._desk, job)
            self._shown = job.asked
            await self._compare()
        if not late:
            bring_into_view(self._result)
        return True

    async def _show_kept(self, number: int, asked: Asked | None, gone: str | None = None) -> None:
        self._result.clear()
        with self._result:
            await (show_result(self._desk, number) if gone is None else show_result(self._desk, number, gone))
        self._shown = asked
        await self._compare()

    async def _differs(self, asked: Asked | None) -> str:
        name, text = self._now()
        if asked is None or not name:
            return ""
        return await asyncio.to_thread(asked.differs, name, text, self._desk.folder)

    async def _compare(self) -> None:
        """Grey the answer where it is not of what the page shows now."""
        shown = self._shown
        why = await self._differs(shown)
        self._why.text = why
        self._other.visible = bool(why)
        if shown is not None:
            same = self._now()[0] == shown.file
            self._back.text = "Open it as it was" if same else f"Open {shown.file}"
            self._back.visible = self._edits or not same
        self._result.classes(add="lw-stale" if why else "", remove="" if why else "lw-stale")

    async def _reopen(self) -> None:
        if (shown := self._shown) is None:
            return
        if self._now()[0] == shown.file:
            await self._open_as_it_was(shown)
        else:
            await self._open(shown)
