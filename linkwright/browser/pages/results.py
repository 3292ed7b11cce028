"""The list of all results that are kept, and a page for each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from nicegui import ui

from linkwright.browser.server.answers import Desk, on_shelf
from linkwright.browser.server.asked import ASKED
from linkwright.browser.server.jobs import Job, noun
from linkwright.browser.server.shelf import NAME, Kept, Run
from linkwright.core.units.quantities import InputError

from .frame import ADDRESS_OF, Problem, framed, heading, row, stack
from .result_view import Naming, show_result, show_unkept
from .runs import Runs


class ResultsPage:
    """The list."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        with framed("Results", f"All that was computed here, kept in {NAME} in the folder."):
            Runs(desk.jobs, ended=self._ended)
            with row():
                self._size = ui.label().classes("lw-note grow")
                self._all = ui.button("Remove all", on_click=self._ask).props("outline dense no-caps color=negative")
            self._problem = Problem()
            self._unkept, self._listed = stack(), stack()
            nothing = "Nothing yet: evaluate an arm, optimise a problem, or diagnose a recording."
            self._nothing = ui.label(nothing).classes("lw-note")
            self._nothing.visible = False
            with ui.dialog() as self._sure, ui.card():
                self._question = ui.label()
                with row():
                    ui.button("Remove them", on_click=self._remove_all).props("dense no-caps color=negative")
                    ui.button("Leave them", on_click=self._sure.close).props("outline dense no-caps")
            self._naming = Naming(desk, self.begin)
        self._all.visible = False
        self._shown: dict[Kept | Run, ui.element] = {}

    async def begin(self) -> None:
        """Show what there is."""
        desk = self._desk
        self._unkept.clear()
        with self._unkept:
            for job in desk.jobs.unkept:
                await show_unkept(desk, job)
        try:
            results, cut = await desk.looked_up(lambda: (desk.shelf.all(), desk.jobs.cut_off()))
            size = await desk.looked_up(desk.shelf.size)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._problem.say("")
        count = f"{len(results)} result{'s' if len(results) > 1 else ''}"
        self._size.text = f"{count}, {size / 1024**2:.1f} MB on the disk" if results else ""
        self._question.text = f"Remove {count} with all files from the disk?"
        self._all.visible = bool(results)
        self._nothing.visible = not results and not cut
        self._list([*cut, *results])

    async def _ended(self, job: Job, late: bool) -> bool:
        del job, late
        await self.begin()
        return True

    def _list(self, items: Sequence[Kept | Run]) -> None:
        """Show these, one below the other. What is shown already stays, so that a click in the meantime is heard."""
        for gone in self._shown.keys() - items:
            self._shown.pop(gone).delete()
        with self._listed:
            for place, item in enumerate(items):
                if item not in self._shown:
                    made = self._show_cut(item) if isinstance(item, Run) else self._show_kept(item)
                    made.move(target_index=place)
                    self._shown[item] = made

    def _show_kept(self, result: Kept) -> ui.element:
        with ui.element("div").classes("lw-kept") as shown:
            ui.label(result.made).classes("lw-note")
            ui.label(noun(result.kind) if result.complete else f"{noun(result.kind)} (stopped)").classes("lw-note")
            with ui.element("p").classes("lw-found"):
                ui.link(result.name or result.head, f"/results/{result.id}")
                for more in (result.head if result.name else "", result.note, result.title):
                    if more:
                        ui.label(more).classes("lw-note")
            with ui.element("div").classes("lw-buttons"):
                _button("edit", f"name result {result.id}", partial(self._naming.ask, result))
                address = on_shelf(self._desk.shelf, result.id).address("")
                _button("download", f"download result {result.id}", lambda: ui.download(address))
                _button(
                    "delete",
                    f"remove result {result.id}",
                    lambda: self._done(lambda: self._desk.shelf.remove(result.id)),
                )
        return shown

    def _show_cut(self, run: Run) -> ui.element:
        with ui.element("div").classes("lw-kept") as shown:
            ui.label(run.began).classes("lw-note")
            ui.label(f"{noun(run.kind)} (cut off)").classes("lw-note")
            with ui.element("p").classes("lw-found"):
                ui.label("The server ended before this run did, so nothing is kept. Begin the run again.")
                ui.label(f"{run.title} (server: process {run.server})").classes("lw-note")
            _button("delete", f"forget run {run.id}", lambda: self._done(lambda: self._desk.shelf.end(run.id)))
        return shown

    async def _done(self, change: Callable[[], None]) -> None:
        try:
            await self._desk.looked_up(change)
        except InputError as error:
            self._problem.say(str(error))
            return
        await self.begin()

    def _ask(self) -> None:
        self._sure.open()

    async def _remove_all(self) -> None:
        self._sure.close()
        await self._done(self._desk.shelf.remove_all)


def _button(icon: str, label: str, clicked: Callable[[], object]) -> None:
    ui.button(icon=icon, on_click=clicked).props(f'flat dense aria-label="{label}" title="{label}"')


class ResultPage:
    """One of them."""

    def __init__(self, desk: Desk, number: int) -> None:
        self._desk, self._number = desk, number
        with framed("Results"):
            with row() as self._ways:
                ui.link("all results", "/results")
            heading(f"Result {number}")
            Runs(desk.jobs)
            self._shown = stack()

    async def begin(self) -> None:
        """Show it, and the way to the file that it is of."""
        with self._ways:
            await self._show_way()
        with self._shown:
            await show_result(self._desk, self._number)

    async def _show_way(self) -> None:
        desk, number = self._desk, self._number
        try:
            result, names = await desk.looked_up(lambda: (desk.shelf.find(number), desk.shelf.names(number)))
        except InputError:
            return  # said where the result is shown
        if result is not None and ASKED in names and result.kind in ADDRESS_OF:
            ui.link("open its file and ask again", f"{ADDRESS_OF[result.kind]}?result={number}")
