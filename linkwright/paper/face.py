"""The paper's tables and figures for programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.face.result import Reported, Result, drawn
from linkwright.output.files import REPORT, RESULT
from linkwright.output.table_file import frame
from linkwright.paper.extended import Extended
from linkwright.paper.tables import Proof, Verdict
from linkwright.report.described import page_of
from linkwright.report.page import pdf_of
from linkwright.results.document import Description

from .output import pages, pictures
from .output.figures import Figure
from .output.pages import figure_csv, figures_json, tables_json
from .tables import Book

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

FORMATS = ("svg", "pdf")
"""What figures can be drawn as beside the page."""
FIGURE_FILES = (RESULT, REPORT, *(f"figure-{n}.{kind}" for n in range(5, 10) for kind in ("csv", *FORMATS)))
"""What `figures --out` writes."""


@dataclass(frozen=True, repr=False)
class Tables(Reported):
    """The paper's Tables III to VII, printed, reproduced and corrected, and those that it lacks; by key."""

    _command = "tables"
    _folder_files = (RESULT, REPORT)

    book: Book
    verdicts: tuple[Verdict, ...]
    proofs: tuple[Proof, ...]
    extended: tuple[Extended, ...] = ()

    def __getitem__(self, key: str) -> pd.DataFrame:
        """A table by its key (`clearance`, ...); raises KeyError."""
        return self._tables()[key]

    def plot(self) -> go.Figure:
        """What was reproduced against what is printed, figure by figure."""
        pairs = [
            (float(printed), value)
            for table in self.book.tables
            for row in table.rows
            for printed, value in zip(row.printed, row.reproduced, strict=False)
        ]
        return drawn([x for x, _ in pairs], {"": [y for _, y in pairs]}, "printed", "reproduced")

    @property
    def description(self) -> Description:
        """All tables, the verdicts and the statements on reach."""
        return pages.describe(self.book, self.verdicts, self.proofs, self.extended)

    def _content(self) -> Mapping[str, Any]:
        further = [item.to_json() for item in self.extended]
        return {**tables_json(self.book, self.verdicts, self.proofs), "extended": further}

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        frames: dict[str, pd.DataFrame] = {}
        for table in self.book.tables:
            rows: list[dict[str, Any]] = []
            for row in table.rows:
                measures = {"paper": [float(text) for text in row.printed], **row.computed}
                cells = {f"{name}_{k}": x for name, values in measures.items() for k, x in enumerate(values, 1)}
                rows.append({"label": row.label, **cells, "note": row.note})
            frames[table.key] = frame(rows)
        return {**frames, **{item.key: frame([*item.rows]) for item in self.extended}}


@dataclass(frozen=True, repr=False)
class Figures(Result):
    """The paper's Figures 5 to 9 as data, each by its conventions and in truth; by number."""

    _command = "figures"
    _folder_files = FIGURE_FILES

    figures: tuple[Figure, ...]
    formats: tuple[str, ...] = ()

    def __getitem__(self, number: int | str) -> pd.DataFrame:
        """A figure's columns by its number, NaN where a map has no pose; raises KeyError."""
        return self._tables()[str(number)]

    def plot(self) -> go.Figure:
        """The worst error as all links are lengthened: the figure that the paper misreads most."""
        longer = self["9"]
        lines = {"": longer["corrected_mm"].to_list()}
        return drawn(longer["reach_mm"].to_list(), lines, "reach in mm", "worst error in mm", mode="lines")

    @property
    def description(self) -> Description:
        """Each figure with the truth beside it."""
        return pictures.describe(self.figures)

    def _content(self) -> Mapping[str, Any]:
        return figures_json(self.figures)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {figure.number: frame(dict(figure.columns)) for figure in self.figures}

    def _files(self) -> Mapping[str, str | bytes]:
        files: dict[str, str | bytes] = {REPORT: page_of(self.description)}
        for figure in self.figures:
            files[f"figure-{figure.number}.csv"] = figure_csv(figure)
            if "svg" in self.formats:
                files[f"figure-{figure.number}.svg"] = pictures.figure_svg(figure)
            if "pdf" in self.formats:
                files[f"figure-{figure.number}.pdf"] = pdf_of(pictures.figure_page(figure))
        return files
