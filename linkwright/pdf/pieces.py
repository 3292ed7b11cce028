"""The pictures of a page, HTML with SVG inside, taken apart for paper: headings, drawings, captions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from html.parser import HTMLParser
from importlib.resources import files

from linkwright.pdf.plots import plotted
from linkwright.report.pictures.plots import Figure, whole_figure

FONT = "Libertinus Serif"
"""What Typst brings along, so that a document is the same on every machine."""
_DRAWING = re.compile(r"<svg\b.*?</svg>", re.DOTALL)
_VIEW = re.compile(r'viewBox="(\S+) (\S+) (\S+) (\S+)"')
_VARIABLE = re.compile(r"--([a-z]+):\s*([^;}]+)")
_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_FEW_WORDS = 2
_DRAWN = ("fill", "stroke", "opacity")


@dataclass(frozen=True)
class Piece:
    """A drawing (SVG, or empty) with the words over and under it; `aspect` is its width over height,
    `wide` says that it holds words which a third of a page is too small for."""

    drawing: str
    aspect: float = 1.0
    wide: bool = False
    heading: str = ""
    caption: str = ""


def pieces_of(picture: str, figures: Mapping[str, Figure]) -> list[Piece]:
    """What a picture of a page shows, piece by piece; what scripts would draw is drawn from `figures`."""
    drawings = _DRAWING.findall(picture)
    reader = _Reader(drawings, figures)
    reader.feed(_DRAWING.sub("<img>", picture))
    reader.close()
    return reader.finished()


class _Reader(HTMLParser):
    def __init__(self, drawings: list[str], figures: Mapping[str, Figure]) -> None:
        super().__init__(convert_charrefs=True)
        self._left, self._figures = list(drawings), figures
        self._pieces: list[Piece] = []
        self._heading, self._words, self._inside = "", "", ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """A drawing, or the beginning of words."""
        name = dict(attrs).get("data-figure")
        if tag == "img":
            self._add(self._left.pop(0))
        elif name is not None and name in self._figures:
            self._add(plotted(whole_figure(self._figures, name), str(dict(attrs).get("aria-label") or "")))
        elif tag in ("h3", "h4", "figcaption", "p"):
            self._inside, self._words = tag, ""
        elif tag == "br":
            self._words += ", "

    def handle_data(self, data: str) -> None:
        """Words."""
        if self._inside:
            self._words += data

    def handle_endtag(self, tag: str) -> None:
        """A heading stands over the next drawing, a caption under the last one."""
        if tag != self._inside:
            return
        words, self._inside = " ".join(self._words.split()), ""
        if tag in ("h3", "h4"):
            self._heading = words
        elif self._pieces and not self._heading:
            last = self._pieces[-1]
            joined = f"{last.caption} {words}".strip()
            self._pieces[-1] = replace(last, caption=joined)
        elif words:
            self._pieces.append(Piece("", heading=self._heading, caption=words))
            self._heading = ""

    def _add(self, drawing: str) -> None:
        view = _VIEW.search(drawing)
        wide, high = (float(view[3]), float(view[4])) if view else (1.0, 1.0)
        plot = drawing.count("<text") > _FEW_WORDS
        self._pieces.append(Piece(styled(drawing), wide / max(high, 1e-9), plot, self._heading))
        self._heading = ""

    def finished(self) -> list[Piece]:
        """The pieces, a heading without a drawing left out."""
        return self._pieces


def styled(drawing: str) -> str:
    """A drawing that stands on its own: with the page's rules for lines and fills inside, in its light colours."""
    opening, _, rest = drawing.partition(">")
    if "xmlns=" not in opening:
        opening = opening.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"', 1)
    return f"{opening}><style>{_rules()}</style>{rest}"


@cache
def _rules() -> str:
    source = files("linkwright.report").joinpath("style.css").read_text(encoding="utf-8")
    source = source.partition("@media print")[0]
    colours = dict(_VARIABLE.findall(source.partition("}")[0]))
    kept: list[str] = [f'text {{ font-family: "{FONT}"; fill: {colours["ink"]}; }}']
    for selector, body in _RULE.findall(source):
        told = [each.strip() for each in body.split(";") if each.strip().startswith(_DRAWN)]
        if told and "--" not in selector and "@" not in selector and ":" not in selector:
            said = re.sub(r"var\(--([a-z]+)\)", lambda found: colours[found[1]], "; ".join(told))
            kept.append(f"{selector.strip()} {{ {said} }}")
    return " ".join(kept)
