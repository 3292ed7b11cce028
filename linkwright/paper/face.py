"""The paper's tables and figures for programs, and the seams that it speaks of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.branches import way_to
from linkwright.core.arm.worst.seam import SeamCheck, check_seam
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm, arm_of
from linkwright.face.given import File, Quantity, in_si
from linkwright.face.progress import Progress, told
from linkwright.face.result import Result, figure_of
from linkwright.output.files import REPORT, RESULT

from .extended.sensitivity import seam_table
from .extended.tables import make_extended
from .output.figures import Figure, make_figures
from .output.pages import extended_json, figure_csv, figures_json, tables_json
from .output.pictures import page
from .rows import ExtendedTable, tally
from .tables import Book, make_tables
from .verdicts import Proof, Verdict, proofs, verdicts

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

FIGURE_FILES = (RESULT, REPORT, *(f"figure-{number}.csv" for number in range(5, 10)))
"""What `figures --out` writes."""


@dataclass(frozen=True, repr=False)
class Tables(Result):
    """The paper's Tables III to VII, printed, reproduced and corrected, and the extended ones; by key."""

    _command = "tables"

    book: Book
    verdicts: tuple[Verdict, ...]
    proofs: tuple[Proof, ...]
    extended: tuple[ExtendedTable, ...]

    def __getitem__(self, key: str) -> pd.DataFrame:
        """A table by its key (`clearance`, ..., or an extended table's); raises KeyError."""
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
        return f"{counted.met} of {counted.printed} printed figures reproduced, {len(self.extended)} extended tables"

    def _content(self) -> Mapping[str, Any]:
        return tables_json(self.book, self.verdicts, self.proofs, self.extended)

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
        return found | {each.key: _frame(each) for each in self.extended}


def _frame(table: ExtendedTable) -> pd.DataFrame:
    import pandas as pd

    return pd.DataFrame(table.rows, columns=[column.heading for column in table.columns])


def tables(*, extended: bool = False, progress: Progress | None = None) -> Tables:
    """The paper's Tables III to VII: printed, reproduced by its conventions, and corrected; some seconds.

    `extended` adds the tables that the paper lacks, which take about a minute; `progress(text, share)` hears of each.

    >>> import linkwright as lw
    >>> paper = lw.tables()
    >>> list(paper["clearance"].columns)[:3]
    ['label', 'paper_1', 'paper_2']
    """
    with told(progress) as tell:
        tell("the paper's tables", 0.0)
        book = make_tables()
        further = make_extended(lambda done, total, text: tell(text, done / total)) if extended else ()
    return Tables(book, verdicts(book), proofs(book), further)


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


def figures() -> Figures:
    """The paper's Figures 5 to 9: what it plots by its own conventions, and the truth beside it; some seconds.

    >>> import linkwright as lw
    >>> drawn = lw.figures()
    >>> list(drawn[7].columns)[:2]
    ['clearance_mm', 'corrected_clearance_mm']
    """
    return Figures(make_figures())


@dataclass(frozen=True, repr=False)
class Seam(Result):
    """Whether a planar arm can follow a straight seam, and its worst error along and across it."""

    _command = "seam"

    arm: Arm
    check: SeamCheck
    errors: ExtendedTable

    @property
    def proved(self) -> bool:
        """Whether every point of it can be reached, proved; else poses were found everywhere."""
        return self.check.verdict == "reachable"

    @property
    def table(self) -> pd.DataFrame:
        """A row for each point looked at, and the worst of each column: tangential, normal and in all, mm."""
        return _frame(self.errors)

    def plot(self) -> go.Figure:
        """The errors along the seam."""
        table = self.table[:-1]
        across, *measures = table.columns
        lines = [
            {"type": "scatter", "name": name, "x": table[across].astype(float), "y": table[name]} for name in measures
        ]
        axes = {"xaxis": {"title": {"text": across}}, "yaxis": {"title": {"text": "worst error in mm"}}}
        return figure_of({"data": lines, "layout": axes})

    @property
    def headline(self) -> str:
        """Whether the arm can follow it, in a line."""
        proved = "every point can be reached, proved" if self.proved else "poses were found everywhere"
        return f"{self.arm.name}: {proved}"

    def _line(self) -> str:
        return self.headline

    def _content(self) -> Mapping[str, Any]:
        return {"reachable": self.check.verdict, "proved_to": self.check.proved_to, **extended_json(self.errors)}

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {self.errors.title: self.table}


def seam(arm: Arm | File, start: Sequence[Quantity], end: Sequence[Quantity], *, points: int = 9) -> Seam:
    """The worst error of a planar arm along a straight seam and across it, over every posture at each of `points`.

    `start` and `end` are points [x, y], text or m. Of several arms on one torso it is the tip that the arm was read
    for, whatever the others do meanwhile. Raises `InputError`, and `NoAnswer` with the first point that cannot be
    reached.

    >>> import linkwright as lw
    >>> lw.seam("examples/welding-arm/arm.yaml", ["600 mm", "500 mm"], ["-600 mm", "500 mm"], points=3)
    <Seam: cathode-bus welding arm: every point can be reached, proved>
    """
    given = arm_of(arm, tips="one")
    first, last = _point(start, "start"), _point(end, "end")
    if first == last:
        raise InputError("", "end", "is the same point as the start; a seam has a length")
    if points < 2:
        raise InputError("", "points", f"needs 2 or more, not {points}")
    if not given.model.planar():
        raise InputError("", "arm", f"{given.name} leaves the x-y plane; a seam's normal is one direction in it only")
    check = check_seam(way_to(given.model, given.model.tip).arm, first, last)
    if check.verdict == "unreachable" and check.first_unreachable is not None:
        raise Unreachable(check.first_unreachable, check.missing)
    return Seam(given, check, seam_table(given.model, first, last, points=points))


def _point(given: Sequence[Quantity], key: str) -> tuple[float, float]:
    if len(given) != 2:
        raise InputError("", key, f"needs two lengths, e.g. 600 mm, 500 mm, not {', '.join(map(str, given))}")
    x, y = (in_si(each, "length", key) for each in given)
    return x, y
