"""The view of a result: headline, name and note, files, pictures to click, report."""

from __future__ import annotations

import html
from collections.abc import Awaitable, Callable
from pathlib import PurePosixPath

from nicegui import events, ui

from linkwright.browser.pages.edit.file_choice import SaveRow
from linkwright.browser.pages.frame import Problem, heading, panel, picture, row, stack
from linkwright.browser.server.answers import Answer, Desk, as_kept, left_behind, on_shelf
from linkwright.browser.server.asked import ASKED
from linkwright.browser.server.drawings import Design, Front, Pose, choices_from, front_from, poses_from
from linkwright.browser.server.jobs import Job, noun
from linkwright.browser.server.shelf import Kept
from linkwright.core.units.quantities import InputError

_OWN = ("poses.json", "front.json", "choices.json", ASKED)
"""Files that are for these pages alone."""
_NOT_PNG = ("zoom", "pan", "select", "lasso", "zoomin", "zoomout", "autoscale", "resetscale")
"""Buttons of a chart that save nothing."""
_LONGEST_NAME, _LONGEST_NOTE = 120, 4000
"""Letters that a result's name and its note may have."""


_GONE = "There is no result {}. The result may have been removed."


async def show_result(desk: Desk, number: int, gone: str = _GONE) -> None:
    """Show a result that is kept, or that it is `gone`."""
    try:
        result = await desk.looked_up(desk.shelf.find, number)
    except InputError as error:
        Problem().say(str(error))
        return
    if result is None:
        Problem().say(gone.format(number))
        return
    await _show(desk, result, on_shelf(desk.shelf, number))


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


async def _show(desk: Desk, result: Kept, answer: Answer) -> None:
    wrong: list[str] = []

    def read() -> tuple[list[str], list[Pose], Front | None, dict[str, Design]]:
        names = answer.names()
        poses: list[Pose] = []
        front: Front | None = None
        choices: dict[str, Design] = {}
        try:
            if (content := answer.file("poses.json")) is not None:
                poses = poses_from(content)
            if (content := answer.file("front.json")) is not None:
                front = front_from(content)
            if (content := answer.file("choices.json")) is not None:
                choices = choices_from(content)
        except InputError as error:
            wrong.append(str(error))
        return names, poses, front, choices

    names: list[str] = []
    poses: list[Pose] = []
    front: Front | None = None
    choices: dict[str, Design] = {}
    try:
        names, poses, front, choices = await desk.looked_up(read)
    except InputError as error:
        wrong.append(str(error))
    with panel():
        ui.label(result.head).classes("lw-done")
        if result.rest:
            ui.label(result.rest)
        ui.label(_origin(result)).classes("lw-note")
        with row():
            for name in (name for name in names if "/" not in name and name not in _OWN):
                ui.link(name, answer.address(name)).props["download"] = f"{answer.number}-{name}"
            if answer.place == "kept":
                ui.link("all files (zip)", answer.address("")).props["download"] = f"{answer.number}-linkwright.zip"
            if "report.html" in names:
                ui.link("report in its own window", answer.address("report.html") + "?view=1", new_tab=True)
        if answer.place == "kept":
            _named(desk, result)
        if "arm.yaml" in names:
            _keep_arm(desk, answer)
    for item in wrong:
        Problem().say(item)
    if poses:
        _poses(poses)
    if front is not None:
        _front(answer, front)
    if choices:
        _choices(answer, choices)
    if "report.html" in names:
        address = answer.address("report.html") + "?view=1"
        ui.element("iframe").props(
            f'src="{address}" sandbox="allow-scripts allow-downloads allow-modals" title="report"'
        ).classes("lw-report")


class Naming:
    """A dialog that asks how a result is to be called and what is to be noted; `named` is awaited afterwards."""

    def __init__(self, desk: Desk, named: Callable[[], Awaitable[None]]) -> None:
        self._desk, self._named, self._number = desk, named, 0
        with ui.dialog() as self._dialog, ui.card().classes("lw-dialog"):
            self._name = ui.input("Name").props(f"dense outlined autofocus maxlength={_LONGEST_NAME}")
            self._note = ui.textarea("Note").props(f"dense outlined autogrow maxlength={_LONGEST_NOTE}")
            self._problem = Problem()
            with row():
                ui.button("Keep", on_click=self._keep).props("dense no-caps")
                ui.button("Cancel", on_click=self._dialog.close).props("outline dense no-caps")

    def ask(self, kept: Kept) -> None:
        """Ask for one."""
        self._number, self._name.value, self._note.value = kept.id, kept.name, kept.note
        self._problem.say("")
        self._dialog.open()

    async def _keep(self) -> None:
        name, note = (str(item.value or "").strip() for item in (self._name, self._note))
        try:
            await self._desk.looked_up(self._desk.shelf.label, self._number, name, note)
        except InputError as error:
            self._problem.say(str(error))
            return
        self._dialog.close()
        await self._named()


def _named(desk: Desk, result: Kept) -> None:

    def show(kept: Kept) -> None:
        place.clear()
        with place:
            if kept.name:
                heading(kept.name)
            if kept.note:
                ui.label(kept.note).classes("lw-note whitespace-pre-line")
            button = ui.button("Name and note", icon="edit", on_click=lambda: naming.ask(kept))
            button.props("flat dense no-caps size=sm").classes("self-start")

    async def named() -> None:
        outcome = await desk.looked_up(desk.shelf.find, result.id)
        if outcome is not None:
            show(outcome)

    place, naming = stack(), Naming(desk, named)
    show(result)


def _origin(result: Kept) -> str:
    stopped = "" if result.complete else "; stopped, so this is the best so far"
    return f"{noun(result.kind)} of {result.title}, {result.made} UTC, {result.seconds:.1f} s{stopped}"


def _keep_arm(desk: Desk, answer: Answer) -> None:
    """The arm file of a result, put into the folder under a name."""

    async def text() -> str:
        content = await desk.looked_up(answer.file, "arm.yaml")
        return (content or b"").decode(errors="replace")

    SaveRow(desk.folder, "Put the arm into the folder as", "Put", text).name = f"arm-{answer.number}.yaml"


def _poses(poses: list[Pose]) -> None:
    heading("Worst poses")
    with ui.element("div").classes("lw-poses"):
        for pose in poses:
            with stack():
                picture(pose["svg"])
                ui.label(pose["words"]).classes("lw-note")


def _choices(answer: Answer, choices: dict[str, Design]) -> None:
    """The best design and its near ties, and beside them the one that was chosen."""
    heading("Combinations within 3 % of the best: choose one for its design")
    with ui.element("div").classes("lw-front"):
        chosen = ui.radio(list(choices), value=next(iter(choices)), on_change=lambda: show(str(chosen.value)))
        beside = panel()

    def show(name: str) -> None:
        beside.clear()
        with beside:
            _design(answer, name.partition(":")[0].capitalize(), choices[name])

    show(next(iter(choices)))


def _front(answer: Answer, front: Front) -> None:
    """The front, and beside it the design of the point that was clicked."""
    heading("The front: click on a point for its design")
    with ui.element("div").classes("lw-front"):
        figure = front["figure"]
        clear = "rgba(0,0,0,0)"
        ground = {"paper_bgcolor": clear, "plot_bgcolor": clear, "modebar": {"bgcolor": clear}}
        layout = {**figure["layout"], **ground}
        # Plotly writes into `modeBarButtons`, which Vue would take for a change, without end.
        only_png = {"displaylogo": False, "displayModeBar": True, "modeBarButtonsToRemove": [*_NOT_PNG]}
        drawn = ui.plotly({"data": figure["data"], "layout": layout, "config": only_png})
        drawn.classes("w-full").style("height: 420px").mark("front")
        beside = panel()

    def show(design: int) -> None:
        beside.clear()
        with beside:
            _design(answer, f"Design {design}", front["designs"][design])

    def clicked(event: events.GenericEventArguments) -> None:
        numbers = [point.get("customdata") for point in event.args.get("points", [])]
        chosen = next((number for number in numbers if isinstance(number, int) and number in front["designs"]), None)
        if chosen is not None:
            show(chosen)

    drawn.on("plotly_click", clicked)
    show(min(front["designs"]))


def _design(answer: Answer, name: str, shown: Design) -> None:
    heading(name)
    picture(shown["svg"])
    figures = [(item["figure"], item["value"]) for item in shown["figures"]]
    links = [(str(item["link"]), item["length"], item["section"], item["material"]) for item in shown["links"]]
    _table((), figures)
    _table(("link", "length", "section", "material"), links)
    link = ui.link(f"arm file of {name[:1].lower()}{name[1:]}", answer.address(shown["file"]))
    link.props["download"] = PurePosixPath(shown["file"]).name


def _table(headings: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    head = "".join(f"<th>{html.escape(item)}</th>" for item in headings)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in item) + "</tr>" for item in rows)
    with ui.element("div").classes("lw-scroll"):
        ui.html(f'<table class="lw-table"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>', sanitize=True)
