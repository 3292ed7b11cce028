"""A result that is kept, as it is shown: its line, its files, pictures to click, its report."""

from __future__ import annotations

import asyncio
import html
import json
from typing import Any

from nicegui import events, ui

from linkwright.browser.server.desk import Desk
from linkwright.browser.server.shelf import Kept
from units.quantities import InputError

from .frame import Problem, heading, panel, picture, row, stack

_OWN = ("poses.json", "front.json")
"""Files that are for these pages alone."""


def show_result(desk: Desk, number: int) -> None:
    """Show a result where this is called."""
    kept = desk.shelf.find(number)
    if kept is None:
        ui.label(f"There is no result {number}; it may have been removed.").classes("lw-error")
        return
    with panel():
        ui.label(kept.line).classes("lw-done")
        ui.label(_origin(kept)).classes("lw-note")
        names = [name for name in desk.shelf.names(number) if name not in _OWN]
        with row():
            for name in (name for name in names if "/" not in name):
                ui.link(name, f"/kept/{number}/{name}").props(f'download="{number}-{name}"')
            if "report.html" in names:
                ui.link("report in a window of its own", f"/kept/{number}/report.html?view=1", new_tab=True)
        if "arm.yaml" in names:
            _keep_arm(desk, number, "arm.yaml")
    for name, show in (("poses.json", _poses), ("front.json", _front)):
        content = desk.shelf.file(number, name)
        if content is not None:
            show(desk, number, json.loads(content))
    if "report.html" in names:
        address = f"/kept/{number}/report.html?view=1"
        ui.element("iframe").props(f'src="{address}" sandbox="allow-scripts" title="report"').classes("lw-report")


def _origin(kept: Kept) -> str:
    stopped = "" if kept.complete else "; stopped, so this is the best until then"
    return f"{kept.kind} of {kept.title}, {kept.made} UTC, {kept.seconds:.1f} s{stopped}"


def _keep_arm(desk: Desk, number: int, name: str) -> None:
    """The arm file of a result, put into the folder under a name."""
    problem = Problem()
    with row():
        target = ui.input("Put the arm into the folder as", value=f"arm-{number}.yaml").props("dense outlined")
        target.classes("grow min-w-40")

        async def put() -> None:
            content = desk.shelf.file(number, name) or b""
            try:
                await asyncio.to_thread(desk.folder.write, target.value or "", content.decode())
            except InputError as error:
                problem.say(str(error))
                return
            problem.say("")
            ui.notify(f"saved as {target.value}", type="positive")

        ui.button("Put", on_click=put).props("outline dense no-caps")


def _poses(desk: Desk, number: int, poses: list[dict[str, str]]) -> None:
    del desk, number
    heading("Worst poses")
    with ui.element("div").classes("lw-poses"):
        for each in poses:
            with stack():
                picture(each["svg"])
                ui.label(each["words"]).classes("lw-note")


def _front(desk: Desk, number: int, front: dict[str, Any]) -> None:
    """The front, and beside it the design of the point that was clicked."""
    del desk
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
            _design(number, design, front["designs"][str(design)])

    def clicked(event: events.GenericEventArguments) -> None:
        numbers = [point.get("customdata") for point in event.args.get("points", [])]
        chosen = next((each for each in numbers if str(each) in front["designs"]), None)
        if chosen is not None:
            show(int(chosen))

    drawn.on("plotly_click", clicked)
    show(min(map(int, front["designs"])))


def _design(number: int, design: int, told: dict[str, Any]) -> None:
    heading(f"Design {design}")
    picture(told["svg"])
    figures = [(each["figure"], each["value"]) for each in told["figures"]]
    links = [(str(each["link"]), each["length"], each["section"], each["material"]) for each in told["links"]]
    _table((), figures)
    _table(("link", "length", "section", "material"), links)
    ui.link(f"arm file of design {design}", f"/kept/{number}/{told['file']}").props(f'download="design-{design}.yaml"')


def _table(headings: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    head = "".join(f"<th>{html.escape(each)}</th>" for each in headings)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in each) + "</tr>" for each in rows)
    with ui.element("div").classes("lw-scroll"):
        ui.html(f'<table class="lw-table"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>', sanitize=False)
