"""Work as it is seen: what is being done, how far it is, a button that stops it with the best so far."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from nicegui import ui

from linkwright.browser.server.jobs import Job

from .frame import Problem, panel, row

_LOOK = 0.25
"""Seconds between two looks."""


class JobPanel:
    """Follows a job; `ended` is awaited with one that found something."""

    def __init__(self, ended: Callable[[Job], Awaitable[None]]) -> None:
        self._ended = ended
        self._job: Job | None = None
        self._lines = 0
        with panel() as self._box:
            with row():
                self._text = ui.label().classes("grow").props("role=status")
                self._stop = ui.button("Stop", on_click=self._stopped).props("dense no-caps color=negative")
            self._bar = ui.linear_progress(0.0, show_value=False, size="8px").props("instant-feedback")
            self._log = ui.label().classes("lw-log")
        self._box.visible = False
        self._problem = Problem()
        self._timer = ui.timer(_LOOK, self._look, active=False)

    def follow(self, job: Job) -> None:
        """Show this one."""
        self._job, self._lines = job, 0
        self._problem.say("")
        self._log.text = ""
        self._stop.text = "Stop"
        self._box.visible = True
        self._timer.active = True
        self._show(job)

    def refuse(self, why: str) -> None:
        """Say why there is nothing to follow."""
        self._problem.say(why)

    def _stopped(self) -> None:
        if self._job is not None:
            self._job.stop()
            self._stop.text = "Stop at once"

    def _show(self, job: Job) -> None:
        self._text.text = f"{job.title}: {job.text} ({job.seconds:.0f} s)"
        self._bar.value = job.share
        self._bar.props(remove="indeterminate") if job.share > 0.0 else self._bar.props("indeterminate")
        if len(job.lines) != self._lines:
            self._lines = len(job.lines)
            self._log.text = "\n".join(job.lines)
        self._log.visible = bool(job.lines)

    async def _look(self) -> None:
        job = self._job
        if job is None:
            return
        self._show(job)
        if job.state == "running":
            return
        self._timer.active = False
        self._box.visible = False
        self._job = None
        if job.state == "refused":
            self._problem.say(job.message)
        else:
            await self._ended(job)
