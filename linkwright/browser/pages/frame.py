"""What every page has: its styles, the way to the other pages, and how errors and pictures are shown."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from importlib.resources import files

from nicegui import ui

PAGES = (
    ("Arm", "/"),
    ("Optimise", "/optimise"),
    ("Trade-off", "/tradeoff"),
    ("Diagnosis", "/diagnosis"),
    ("Catalogues", "/catalogues"),
    ("Results", "/results"),
)


def styles() -> str:
    """The pages' own styles; those of the reports hold within pictures only."""
    own = files("linkwright.browser.pages").joinpath("page.css").read_text(encoding="utf-8")
    report = files("linkwright.report").joinpath("style.css").read_text(encoding="utf-8")
    before, _, _ = report.partition("@page")
    return f"{own}\n.lw-picture {{\n{before.replace(':root', '&')}\n}}\n"


@contextmanager
def framed(title: str, lead: str = "") -> Generator[None]:
    """A page with its heading; what is made within stands below."""
    ui.page_title(f"{title} – Linkwright")
    ui.add_css(styles())
    ui.colors(primary="#1b62d1", negative="#b42318")
    with ui.element("nav").classes("lw-bar"):
        ui.label("Linkwright").tag = "strong"
        for name, address in PAGES:
            link = ui.link(name, address)
            if name == title:
                link.props("aria-current=page")
    with ui.element("main").classes("lw-page"):
        heading(title, 1)
        if lead:
            ui.label(lead).classes("lw-lead")
        yield


def heading(text: str, level: int = 2) -> ui.label:
    """A heading."""
    made = ui.label(text)
    made.tag = f"h{level}"
    return made


def stack() -> ui.element:
    """Things below each other."""
    return ui.element("div").classes("lw-stack")


def row() -> ui.element:
    """Things beside each other, as many as there is room for."""
    return ui.element("div").classes("lw-row")


def panel() -> ui.element:
    """A part with a border."""
    return ui.element("div").classes("lw-panel lw-stack")


def picture(svg: str = "") -> ui.html:
    """A picture of the reports; whatever could run in it is taken out, for it may come from a file."""
    return ui.html(svg, sanitize=True).classes("lw-picture")


class Problem:
    """The line that says what is wrong; not there while nothing is."""

    def __init__(self) -> None:
        self._label = ui.label().classes("lw-error").props("role=alert")
        self._label.visible = False

    def say(self, text: str) -> None:
        """Show a line; an empty one goes away."""
        self._label.text = text
        self._label.visible = bool(text)
