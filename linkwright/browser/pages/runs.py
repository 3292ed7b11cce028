"""The view of running jobs: all on the server, whoever began them, with progress and a button that stops each."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from nicegui import ui

from linkwright.browser.server.jobs import Job, Jobs

from .frame import Problem, panel, row, stack

_LOOK = 0.25
"""Seconds between two looks."""


class Runs:
    """All jobs on the server, in every tab alike. `ended` is awaited with each job of a `kind` (any, where empty) that
    has a result, and at first with the last one that ended before the page was opened (`late`); it gives whether the
    page shows the result. All other jobs leave a link.
    """

    def __init__(self, jobs: Jobs, kind: str = "", ended: Callable[[Job, bool], Awaitable[bool]] | None = None) -> None:
        self._jobs, self._kind, self._ended = jobs, kind, ended
        self._rows: dict[int, _Row] = {}
        self._seen = {job.number for job in jobs.ended}
        self._problem = Problem()
        self._place = stack()
        ui.timer(_LOOK, self._look)

    @property
    def last(self) -> Job | None:
        """What ended last of the kind."""
        return next((job for job in reversed(self._jobs.ended) if job.kind == self._kind), None)

    async def begin(self) -> None:
        """Show what ended last."""
        if (last := self.last) is not None:
            await self._show(last, late=True)

    def refuse(self, why: str) -> None:
        """Say why nothing was begun; empty: something was."""
        self._problem.say(why)

    async def _look(self) -> None:
        for job in self._jobs.running:
            if job.number not in self._rows:
                with self._place:
                    self._rows[job.number] = _Row(job)
            self._rows[job.number].show()
        for job in self._jobs.ended:
            if job.number not in self._seen:
                self._seen.add(job.number)
                if (line := self._rows.pop(job.number, None)) is not None:
                    line.delete()
                await self._show(job, late=False)

    async def _show(self, job: Job, *, late: bool) -> None:
        if self._ended is not None and self._kind in (job.kind, ""):
            self._problem.say(job.message if job.state == "refused" else "")
            if job.state == "refused" or await self._ended(job, late):
                return
        with self._place, panel():
            if job.result is not None:
                ui.link(job.answer, f"/results/{job.result}")
            else:
                ui.label(job.message).classes("lw-note")
            if job.name not in job.message:
                ui.label(job.name + ("" if job.complete else ", stopped: the best so far")).classes("lw-note")


class _Row:
    """One job at work."""

    def __init__(self, job: Job) -> None:
        self._job, self._lines = job, 0
        with panel() as self._box:
            with row():
                self._text = ui.label().classes("grow").props("role=status")
                self._stop = ui.button("Stop", on_click=job.stop).props("dense no-caps color=negative")
            self._bar = ui.linear_progress(0.0, show_value=False, size="8px").props("instant-feedback")
            self._log = ui.label().classes("lw-log")

    def show(self) -> None:
        """How far it is."""
        job = self._job
        self._text.text = f"{job.name}: {job.text} ({job.seconds:.0f} s)"
        self._stop.text = "Stop at once" if job.stopping else "Stop"
        self._bar.value = job.share
        self._bar.props(remove="indeterminate") if job.share > 0.0 else self._bar.props("indeterminate")
        if len(job.lines) != self._lines:
            self._lines = len(job.lines)
            self._log.text = "\n".join(job.lines)
        self._log.visible = bool(job.lines)

    def delete(self) -> None:
        """It is at its end."""
        self._box.delete()
