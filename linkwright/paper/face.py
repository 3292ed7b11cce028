"""The paper's tables and figures for programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.face.result import Result, figure_of
from linkwright.output.files import REPORT, RESULT
from linkwright.paper.printed import tally

from .extended import Extended
from .output.figures import Figure
from .output.pages import figure_csv, figures_json, tables_json
from .output.pictures import page
from .tables import Book
from .verdicts import Proof, Verdict

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

FIGURE_FILES = (RESULT, REPORT, *(f"figure-{number}.csv" for number in range(5, 10)))
"""What `figures --out` writes."""


@dataclass(frozen=True, repr=False)
class Tables(Result):
    """The paper's Tables III to VII, printed, reproduced and corrected, and those that it lacks; by key."""

    _command = "tables"

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
        marks = {"type": "scatter", "mode": "markers", "x": [x for x, _ in pairs], "y": [y for _, y in pairs]}
        axes = {"xaxis": {"title": {"text": "printed"}}, "yaxis": {"title": {"text": "reproduced"}}}
        return figure_of({"data": [marks], "layout": axes})

    def _line(self) -> str:
        counted = tally(self.book.tables)
        return f"{counted.met} of {counted.printed} printed figures reproduced"

    def _content(self) -> Mapping[str, Any]:
        further = [each.to_json() for each in self.extended]
        return {**tables_json(self.book, self.verdicts, self.proofs), "extended": further}

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        import pandas as pd

        found: dict[str, pd.DataFrame] = {}
        for table in self.book.tables:
            rows: list[dict[str, Any]] = []
            for row in table.rows:
                cells: dict[str, Any] = {"label": row.label}
                for name, values, factor in (
                    ("paper", [float(text) for text in row.printed], 1.0),
                    ("reproduced_mm2", row.reproduced, 1.0),
                    ("as_equations_read_mm", row.as_read, 1e3),
                    ("corrected_mm", row.corrected, 1e3),
                ):
                    cells.update({f"{name}_{k}": factor * value for k, value in enumerate(values, 1)})
                rows.append({**cells, "note": row.note})
            found[table.key] = pd.DataFrame(rows)
        return {**found, **{each.key: pd.DataFrame(each.rows) for each in self.extended}}


@dataclass(frozen=True, repr=False)
class Figures(Result):
    """The paper's Figures 5 to 9 as data, each by its conventions and in truth; by number."""

    _command = "figures"
    _own = FIGURE_FILES

    figures: tuple[Figure, ...]

    def __getitem__(self, number: int | str) -> pd.DataFrame:
        """A figure's columns by its number, NaN where a map has no pose; raises KeyError."""
        return self._tables()[str(number)]

    def plot(self) -> go.Figure:
        """The worst error as all links are lengthened: the figure that the paper misreads most."""
        longer = self["9"]
        line = {"type": "scatter", "mode": "lines", "x": longer["reach_mm"], "y": longer["corrected_mm"]}
        axes = {"xaxis": {"title": {"text": "reach in mm"}}, "yaxis": {"title": {"text": "worst error in mm"}}}
        return figure_of({"data": [line], "layout": axes})

    def _line(self) -> str:
        return f"{len(self.figures)} figures, {sum(len(each.columns) for each in self.figures)} columns"

    def _content(self) -> Mapping[str, Any]:
        return figures_json(self.figures)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        import pandas as pd

        return {each.number: pd.DataFrame(dict(each.columns)) for each in self.figures}

    def _files(self) -> Mapping[str, str]:
        return {REPORT: page(self.figures), **{f"figure-{each.number}.csv": figure_csv(each) for each in self.figures}}
