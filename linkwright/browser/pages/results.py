"""The results that are kept in the folder: listed, opened again, removed; what is at work above them."""

from __future__ import annotations

from nicegui import ui

from linkwright.browser.server.desk import Desk
from linkwright.browser.server.jobs import Job
from linkwright.browser.server.shelf import NAME

from .frame import framed, heading, row, stack
from .job_panel import JobPanel
from .result_view import show_result


def show_results(desk: Desk) -> None:
    """The list."""
    with framed("Results", f"All that was computed here; kept in {NAME} in the folder."):
        listed = stack()

        def show() -> None:
            listed.clear()
            with listed:
                _list(desk, show)

        def ended(job: Job) -> None:
            del job
            show()

        for job in desk.jobs.running:
            JobPanel(ended).follow(job)
        show()


def _list(desk: Desk, again: object) -> None:
    kept = desk.shelf.all()
    if not kept:
        ui.label("Nothing yet: evaluate an arm, optimise a problem, or diagnose a recording.").classes("lw-note")
    for each in kept:
        with ui.element("div").classes("lw-kept"):
            ui.label(each.made).classes("lw-note")
            ui.label(each.kind if each.complete else f"{each.kind} (stopped)").classes("lw-note")
            with ui.element("p").classes("lw-found"):
                ui.link(each.line, f"/results/{each.id}")
                ui.label(each.title).classes("lw-note")

            def remove(number: int = each.id) -> None:
                desk.shelf.remove(number)
                if callable(again):
                    again()

            ui.button(icon="delete", on_click=remove).props(f'flat dense aria-label="remove result {each.id}"')


def show_one(desk: Desk, number: int) -> None:
    """One of them."""
    with framed("Results"):
        with row():
            ui.link("all results", "/results")
        heading(f"Result {number}")
        with stack():
            show_result(desk, number)
