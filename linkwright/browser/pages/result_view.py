"""Answers as they are shown: line, files, pictures to click, report; and the list of all that are kept."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from typing import Any

from nicegui import events, ui

from linkwright.browser.pages.file_choice import SaveRow
from linkwright.browser.pages.frame import Problem, framed, heading, panel, picture, row, stack
from linkwright.browser.pages.job_panel import JobPanel
from linkwright.browser.server.answers import Answer, Desk, as_kept, left_behind, on_shelf
from linkwright.browser.server.drawings import Design, Front, Pose, front_from, poses_from
from linkwright.browser.server.jobs import Job
from linkwright.browser.server.shelf import NAME, Kept, Run
from linkwright.core.units.quantities import InputError

_OWN = ("poses.json", "front.json")
"""Files that are for these pages alone."""


async def show_ended(desk: Desk, job: Job) -> None:
    """Show what a job found where this is called, kept or not."""
    if job.result is not None:
        await show_result(desk, job.result)
    else:
        await show_unkept(desk, job)


async def show_result(desk: Desk, number: int) -> None:
    """Show a result that is kept."""
    try:
        kept = await desk.looked_up(desk.shelf.find, number)
    except InputError as error:
        Problem().say(str(error))
        return
    if kept is None:
        Problem().say(f"There is no result {number}; it may have been removed.")
        return
    await _show(desk, kept, on_shelf(desk.shelf, number))


async def show_unkept(desk: Desk, job: Job) -> None:
    """Show an answer that could not be kept, why, and a button that tries it again."""
    with stack() as shown:
        problem = Problem()
        _say_unkept(problem, job)

        async def keep() -> None:
            await desk.jobs.keep(job)
            if job.result is None:
                _say_unkept(problem, job)
                return
            shown.clear()
            with shown:
                await show_result(desk, job.result)

        ui.button("Keep again", on_click=keep).props("outline dense no-caps")
        await _show(desk, as_kept(job), left_behind(job))


def _say_unkept(problem: Problem, job: Job) -> None:
    where = "" if job.left is None else f" Its files are in {job.left / 'out'}."
    problem.say(f"This answer is not kept: {job.message.rstrip('.')}.{where}")


async def _show(desk: Desk, kept: Kept, answer: Answer) -> None:
    wrong: list[str] = []

    def read() -> tuple[list[str], list[Pose], Front | None]:
        names = answer.names()
        poses: list[Pose] = []
        front: Front | None = None
        try:
            if (content := answer.file("poses.json")) is not None:
                poses = poses_from(content)
            if (content := answer.file("front.json")) is not None:
                front = front_from(content)
        except InputError as error:
            wrong.append(str(error))
        return names, poses, front

    names: list[str] = []
    poses: list[Pose] = []
    front: Front | None = None
    try:
        names, poses, front = await desk.looked_up(read)
    except InputError as error:
        wrong.append(str(error))
    with panel():
        ui.label(kept.line).classes("lw-done")
        ui.label(_origin(kept)).classes("lw-note")
        with row():
            for name in (name for name in names if "/" not in name and name not in _OWN):
                ui.link(name, answer.address(name)).props["download"] = f"{answer.number}-{name}"
            if "report.html" in names:
                ui.link("report in a window of its own", answer.address("report.html") + "?view=1", new_tab=True)
        if "arm.yaml" in names:
            _keep_arm(desk, answer)
    for each in wrong:
        Problem().say(each)
    if poses:
        _poses(poses)
    if front is not None:
        _front(answer, front)
    if "report.html" in names:
        address = answer.address("report.html") + "?view=1"
        ui.element("iframe").props(f'src="{address}" sandbox="allow-scripts" title="report"').classes("lw-report")


def _origin(kept: Kept) -> str:
    stopped = "" if kept.complete else "; stopped, so this is the best until then"
    return f"{kept.kind} of {kept.title}, {kept.made} UTC, {kept.seconds:.1f} s{stopped}"


def _keep_arm(desk: Desk, answer: Answer) -> None:
    """The arm file of a result, put into the folder under a name."""

    async def text() -> str:
        content = await desk.looked_up(answer.file, "arm.yaml")
        return (content or b"").decode(errors="replace")

    SaveRow(desk.folder, "Put the arm into the folder as", "Put", text).name = f"arm-{answer.number}.yaml"


def _poses(poses: list[Pose]) -> None:
    heading("Worst poses")
    with ui.element("div").classes("lw-poses"):
        for each in poses:
            with stack():
                picture(each["svg"])
                ui.label(each["words"]).classes("lw-note")


def _front(answer: Answer, front: Front) -> None:
    """The front, and beside it the design of the point that was clicked."""
    heading("The front: click on a point for its design")
    with ui.element("div").classes("lw-two"):
        figure = front["figure"]
        layout = {**figure["layout"], "paper_bgcolor": "rgba(0,0,0,0)", "plot_bgcolor": "rgba(0,0,0,0)"}
        drawn = ui.plotly({"data": figure["data"], "layout": layout, "config": {"displayModeBar": False}})
        drawn.classes("w-full").style("height: 420px").mark("front")
        beside = panel()

    def show(design: int) -> None:
        beside.clear()
        with beside:
            _design(answer, design, front["designs"][design])

    def clicked(event: events.GenericEventArguments) -> None:
        numbers = [point.get("customdata") for point in event.args.get("points", [])]
        chosen = next((each for each in numbers if isinstance(each, int) and each in front["designs"]), None)
        if chosen is not None:
            show(chosen)

    drawn.on("plotly_click", clicked)
    show(min(front["designs"]))


def _design(answer: Answer, design: int, told: Design) -> None:
    heading(f"Design {design}")
    picture(told["svg"])
    figures = [(each["figure"], each["value"]) for each in told["figures"]]
    links = [(str(each["link"]), each["length"], each["section"], each["material"]) for each in told["links"]]
    _table((), figures)
    _table(("link", "length", "section", "material"), links)
    link = ui.link(f"arm file of design {design}", answer.address(told["file"]))
    link.props["download"] = f"design-{design}.yaml"


def _table(headings: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    head = "".join(f"<th>{html.escape(each)}</th>" for each in headings)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in each) + "</tr>" for each in rows)
    with ui.element("div").classes("lw-scroll"):
        ui.html(f'<table class="lw-table"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>', sanitize=True)


class Asking:
    """A page that has work done: its panel, and below that what was found."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def _work(self) -> None:
        """Where the work is seen."""
        self._panel = JobPanel(self._ended)

    def _begin(self, kind: str, title: str, inputs: Mapping[str, bytes], asked: Mapping[str, Any]) -> None:
        """Begin it. Raises `InputError` where too much is at work."""
        job = self._desk.jobs.start(kind, title, inputs, asked)
        self._result.clear()
        self._panel.follow(job)

    def _answers(self) -> None:
        """Where it is shown what was found."""
        self._result = stack()

    async def _ended(self, job: Job) -> None:
        with self._result:
            await show_ended(self._desk, job)


class ResultsPage:
    """The list."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        with framed("Results", f"All that was computed here; kept in {NAME} in the folder."):
            for job in desk.jobs.running:
                JobPanel(self._ended).follow(job)
            with row():
                self._size = ui.label().classes("lw-note grow")
                self._all = ui.button("Remove all", on_click=self._ask).props("outline dense no-caps color=negative")
            self._problem = Problem()
            self._unkept, self._listed = stack(), stack()
            with ui.dialog() as self._sure, ui.card():
                self._question = ui.label()
                with row():
                    ui.button("Remove them", on_click=self._remove_all).props("dense no-caps color=negative")
                    ui.button("Leave them", on_click=self._sure.close).props("outline dense no-caps")
        self._all.visible = False

    async def begin(self) -> None:
        """Show what there is."""
        desk = self._desk
        self._unkept.clear()
        with self._unkept:
            for job in desk.jobs.unkept:
                await show_unkept(desk, job)
        try:
            kept, cut = await desk.looked_up(lambda: (desk.shelf.all(), desk.jobs.cut_off()))
            size = await desk.looked_up(desk.shelf.size)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._problem.say("")
        self._size.text = f"{len(kept)} results, {size / 1024**2:.1f} MB on the disk" if kept else ""
        self._question.text = f"Remove all {len(kept)} results and their files from the disk?"
        self._all.visible = bool(kept)
        self._listed.clear()
        with self._listed:
            for run in cut:
                self._show_cut(run)
            for each in kept:
                self._show_kept(each)
            if not kept and not cut:
                nothing = ui.label("Nothing yet: evaluate an arm, optimise a problem, or diagnose a recording.")
                nothing.classes("lw-note")

    async def _ended(self, job: Job) -> None:
        del job
        await self.begin()

    def _show_kept(self, each: Kept) -> None:
        with ui.element("div").classes("lw-kept"):
            ui.label(each.made).classes("lw-note")
            ui.label(each.kind if each.complete else f"{each.kind} (stopped)").classes("lw-note")
            with ui.element("p").classes("lw-found"):
                ui.link(each.line, f"/results/{each.id}")
                ui.label(each.title).classes("lw-note")
            self._remove(f"remove result {each.id}", lambda: self._desk.shelf.remove(each.id))

    def _show_cut(self, run: Run) -> None:
        with ui.element("div").classes("lw-kept"):
            ui.label(run.began).classes("lw-note")
            ui.label(f"{run.kind} (cut off)").classes("lw-note")
            with ui.element("p").classes("lw-found"):
                ui.label("Its server ended before it did, so nothing of it is kept; begin it again.")
                ui.label(f"{run.title} (server: process {run.server})").classes("lw-note")
            self._remove(f"forget run {run.id}", lambda: self._desk.shelf.end(run.id))

    def _remove(self, label: str, remove: Callable[[], None]) -> None:
        ui.button(icon="delete", on_click=lambda: self._done(remove)).props(f'flat dense aria-label="{label}"')

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


class ResultPage:
    """One of them."""

    def __init__(self, desk: Desk, number: int) -> None:
        self._desk, self._number = desk, number
        with framed("Results"):
            with row():
                ui.link("all results", "/results")
            heading(f"Result {number}")
            self._shown = stack()

    async def begin(self) -> None:
        """Show it."""
        with self._shown:
            await show_result(self._desk, self._number)
