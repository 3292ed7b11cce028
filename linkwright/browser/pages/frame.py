"""What every page has: its styles, the way to the other pages, and how errors and pictures are shown."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from importlib.resources import files
from types import MappingProxyType

from nicegui import ui

PAGES = (
    ("Arm", "/"),
    ("Optimise", "/optimise"),
    ("Trade-off", "/tradeoff"),
    ("Diagnosis", "/diagnosis"),
    ("Catalogues", "/catalogues"),
    ("Results", "/results"),
)


ADDRESS_OF: Mapping[str, str] = MappingProxyType(
    {"evaluate": "/", "optimize": "/optimise", "tradeoff": "/tradeoff", "diagnose": "/diagnosis"}
)
"""The page that asks for each kind of job."""


def styles() -> str:
    """The pages' styles; those of the reports hold within pictures only."""
    css = files("linkwright.browser.pages").joinpath("page.css").read_text(encoding="utf-8")
    report = files("linkwright.report").joinpath("style.css").read_text(encoding="utf-8")
    before, _, _ = report.partition("@page")
    return f"{css}\n.lw-picture {{\n{before.replace(':root', '&')}\n}}\n"


@contextmanager
def framed(title: str, lead: str = "") -> Generator[None]:
    """A page with its heading; what is made within stands below."""
    ui.page_title(f"{title} – Linkwright")
    ui.add_css(styles())
    drawing = files("linkwright.report").joinpath("picture.js").read_text(encoding="utf-8")
    ui.add_head_html(f"<script>{drawing}</script>")
    ui.colors(primary="#1b62d1", negative="#b42318")
    with ui.element("nav").classes("lw-bar"):
        ui.label("Linkwright").tag = "strong"
        for name, address in PAGES:
            link = ui.link(name, address)
            if name == title:
                link.props("aria-current=page")
    with ui.element("main").classes("lw-page"):
        with ui.element("header").classes("lw-head"):
            heading(title, 1)
            if lead:
                ui.label(lead).classes("lw-lead")
        yield


@contextmanager
def sides(kind: str = "") -> Generator[tuple[ui.element, ui.element]]:
    """Two columns, a form and what comes of it; on a narrow screen the one below the other, or in the order that the
    style of a `kind` of page gives them."""
    with ui.element("div").classes(f"lw-two {kind}"):
        yield stack(), stack().classes("lw-right")


def dropped_or_chosen(upload: ui.upload, text: str, button: str) -> None:
    """What a place for files says, and its button, which a keyboard reaches and a screen reader names."""
    upload.add_slot(
        "header",
        f"""<div class="lw-drop">
        <span>{text}</span>
        <q-btn outline dense no-caps label="{button}" @click="props.pickFiles"><q-uploader-add-trigger /></q-btn>
        </div>""",
    )


def heading(text: str, level: int = 2) -> ui.label:
    """A heading."""
    made = ui.label(text)
    made.tag = f"h{level}"
    return made


def explained(title: str, kinds: Sequence[tuple[str, str]], lead: str = "") -> None:
    """What a page begins with, while it has nothing to show: kinds of it, each with what it is."""
    heading(title)
    if lead:
        ui.label(lead).classes("lw-note")
    for kind, words in kinds:
        ui.label(kind).classes("lw-done")
        ui.label(words).classes("lw-note")


def stack() -> ui.element:
    """Things below each other."""
    return ui.element("div").classes("lw-stack")


def row() -> ui.element:
    """Things beside each other, as many as there is room for."""
    return ui.element("div").classes("lw-row")


def panel() -> ui.element:
    """A part with a border."""
    return ui.element("div").classes("lw-panel lw-stack")


def bring_into_view(element: ui.element) -> None:
    """Scroll to the first thing in an element where it is not in view."""
    ui.run_javascript(f"getHtmlElement({element.id}).firstElementChild.scrollIntoView({{block: 'nearest'}})")


def picture(svg: str = "", *, save: bool = True) -> ui.html:
    """A picture of the reports, with buttons that save it as PNG, SVG or PDF unless `save` is false. Whatever could run
    in it is taken out, for it may come from a file."""
    made = ui.html(svg, sanitize=True).classes("lw-picture")
    if save:
        with ui.row().classes("self-end gap-0"):
            for name in ("PNG", "SVG", "PDF"):
                saved = f"() => savePicture(getHtmlElement({made.id}).querySelector('svg'), '{name.lower()}')"
                button = ui.button(name).props(f'flat dense no-caps size=sm aria-label="{name} of this drawing"')
                button.on("click", js_handler=saved)
    return made


class Problem:
    """The line that says what is wrong; not there while nothing is."""

    def __init__(self) -> None:
        self._label = ui.label().classes("lw-error").props("role=alert")
        self._label.visible = False

    def say(self, text: str) -> None:
        """Show a line; an empty one goes away."""
        self._label.text = text
        self._label.visible = bool(text)
