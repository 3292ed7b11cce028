"""The frame of a report page: one file with its styles, its script and the plotting library inside.

As a PDF it is printed by a browser of the machine in the page's style for paper.
"""

from __future__ import annotations

import base64
import gzip
import json
import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

from plotly.offline import get_plotlyjs

from linkwright.core.units.quantities import InputError
from linkwright.output.files import strict
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import element, text


def figure_place(name: str, label: str, caption: str = "") -> str:
    """Where the script draws the figure called `name`; `label` says in words what it shows."""
    place = element("div", class_="plot", id=f"plot-{name}", data_figure=name, role="img", aria_label=label)
    words = element("figcaption", caption) if caption else ""
    return element("figure", place, words)


def side_by_side(*parts: str) -> str:
    """Parts beside each other where there is room, below each other on a phone."""
    return element("div", *parts, class_=f"columns-{min(len(parts), 2)}")


def separate_place(name: str, when: str, label: str) -> str:
    """Where the figure called `name` stands in its colours."""
    heading = element("h3", text(f"{when.capitalize()}, in its own colours".removeprefix(", ").capitalize()))
    return element("div", heading, figure_place(f"{name}-own", f"{label} In its own colours."))


def only_on_paper(parts: Sequence[str]) -> str:
    """Parts beside each other that a screen does not show, since there buttons do."""
    return element("div", side_by_side(*parts), class_="paper") if parts else ""


def _unbroken(words: str) -> str:
    """Figures kept on one line with their units."""
    return re.sub(r"(\d) (?=[a-zA-Z])", "\\1\u00a0", words)


_SAFE = bytes.maketrans(b"<&", b".,")
"""Two letters of base 85 that a page could take for markup, and what stands for them."""


def packed(source: str) -> str:
    """Text as base 85 of gzip, as the page's script unpacks it: a third of a script's size, and the same bytes for the
    same source. The alphabet is RFC 1924's with `.` and `,` for `<` and `&`."""
    return base64.b85encode(gzip.compress(source.encode(), 9, mtime=0)).translate(_SAFE).decode()


def page(title: str, summary: str, body: Sequence[str], figures: Mapping[str, Figure], without: str) -> str:
    """The whole page. It loads nothing: styles, script, figures and plotly stand in the file,
    the last only where figures need it.

    `without` says what a reader misses whose browser runs no scripts.
    """
    folder = files("linkwright.report")
    styles = folder.joinpath("style.css").read_text(encoding="utf-8")
    script = "".join(folder.joinpath(name).read_text(encoding="utf-8") for name in ("picture.js", "script.js"))
    data = packed(json.dumps(strict(figures), allow_nan=False, separators=(",", ":")))
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{text(title)}</title><style>{styles}</style>"
    )
    library = packed(get_plotlyjs()) if figures else ""
    scripts = (
        f'<script type="application/gzip" id="figures">{data}</script>'
        f'<script type="application/gzip" id="plotly">{library}</script><script>{script}</script>'
    )
    missing = element("noscript", element("p", without, class_="lead")) if figures else ""
    title_text = _unbroken(summary[:1].upper() + summary[1:])
    opening = element("header", element("h1", text(title)), element("p", text(title_text), class_="headline"), missing)
    main = element("main", opening, *body)
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{main}{scripts}</body></html>\n'


_BROWSERS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "microsoft-edge",
    "chrome",
    "msedge",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
)
_PATIENCE = 120.0
"""How long (s) a browser may take."""


def need_browser() -> str:
    """Path of a browser that prints without a window. Raises `InputError`, one line, where none is installed: before
    anything is computed."""
    path_of_browser = next((path for name in _BROWSERS if (path := shutil.which(name))), None)
    if path_of_browser is None:
        message = "a PDF needs Chromium, Chrome or Edge, and none is installed; open the report of --out and print it"
        raise InputError("", "--pdf", message)
    return path_of_browser


def pdf_of(page: str) -> bytes:
    """A page as the PDF that a browser prints, A4. Raises `InputError` where there is no browser, or it fails."""
    browser = need_browser()
    with TemporaryDirectory(prefix="linkwright-") as folder:
        source, target = Path(folder) / "report.html", Path(folder) / "report.pdf"
        source.write_text(page, encoding="utf-8")
        # A browser refuses its sandbox to root. The virtual time lets the page's script unpack and draw its figures.
        sandbox = ["--no-sandbox"] if getattr(os, "geteuid", lambda: 1)() == 0 else []
        options = ["--headless", "--disable-gpu", "--no-pdf-header-footer", "--virtual-time-budget=20000", *sandbox]
        arguments = [f"--user-data-dir={folder}/profile", f"--print-to-pdf={target}", source.as_uri()]
        try:
            subprocess.run([browser, *options, *arguments], check=True, capture_output=True, timeout=_PATIENCE)
            return target.read_bytes()
        except (OSError, subprocess.SubprocessError) as error:
            raise InputError("", "--pdf", f"{browser} could not print the report: {type(error).__name__}") from None
