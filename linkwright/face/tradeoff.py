"""Trade-offs for programs: the designs of which none can be beaten in both of two figures."""

from __future__ import annotations

import io
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.figures import Figure
from linkwright.core.executors import Executor
from linkwright.core.optimize.tradeoff.front import Point
from linkwright.core.optimize.tradeoff.front import Tradeoff as Found
from linkwright.core.optimize.tradeoff.journal import JOURNAL, LOCK, Journal, journal_digest
from linkwright.core.optimize.tradeoff.question import Question, digest
from linkwright.core.optimize.tradeoff.trace import Progress as Traced
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.core.units.quantities import InputError
from linkwright.face.evaluation import Figured, Values
from linkwright.output.files import REPORT, RESULT, made_folder, refuse_strangers, write_file
from linkwright.output.table_file import WAYS, write_table
from linkwright.output.tradeoff_folder import (
    FILES,
    claim_tradeoff,
    made_by,
    tradeoff_csv,
    tradeoff_json,
    write_tradeoff,
)
from linkwright.report.charts.fronts import front_figure
from linkwright.results.figures_in_words import percent
from linkwright.results.tradeoff import describe

from .arm import Arm, catalogue_of
from .plain_input import File
from .problem import Problem
from .progress import Progress, interrupts, told
from .result import Field, Reported, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True)
class TradeoffDesign(Figured):
    """A design of a front: its number (from 1), the arm, and its figures; `values` holds them in SI by name."""

    number: int
    arm: Arm
    values: Mapping[str, Any]
    known: Mapping[str, Figure]

    def _designs(self) -> Mapping[str, Values]:
        return {"value": self.values}

    def _figured(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.arm.model, self.known


@dataclass(frozen=True, repr=False)
class Tradeoff(Reported):
    """The front between two figures; `found` holds everything in SI.

    `interrupted`: Ctrl-C ended the work, and these are the points that it had; none of them is wrong.
    """

    _command = "tradeoff"
    _describe = staticmethod(describe)

    problem: Problem
    found: Found

    @property
    def table(self) -> pd.DataFrame:
        """A row for each design, in the order of the file that `--csv` writes: figures with units, links."""
        import pandas as pd

        return pd.read_csv(io.StringIO(tradeoff_csv(self.found)))

    @property
    def designs(self) -> tuple[TradeoffDesign, ...]:
        """The designs in the order of `table`."""
        return tuple(self._design(point) for point in self.found.points)

    interrupted = Field[bool]("Whether Ctrl-C ended the work.")

    def _design(self, point: Point) -> TradeoffDesign:
        arm = Arm.of(point.arm, catalogue=self.problem.arm.catalogue)
        return TradeoffDesign(point.number, arm, point.figures, self.problem.model.figures)

    def plot(self) -> go.Figure:
        """The fronts, a line each."""
        return figure_of(front_figure(self.found))

    def _saved(self, place: Path, first: Mapping[str, str]) -> Sequence[Path]:
        """All that `tradeoff --out` writes but the journal."""
        if journal_digest(place / JOURNAL) is None:
            claim_tradeoff(place)
        catalogue = catalogue_of(self.problem.arm.catalogue)
        return write_tradeoff(self.found, place, self.to_json(), first[REPORT], catalogue)

    def save_table(self, file: File) -> None:
        """Write the points as `--csv` does: .csv, .parquet or .md. Raises `InputError`."""
        if Path(file).suffix.lower() in WAYS:
            write_table(self.table, file)
        else:
            write_file(Path(file), tradeoff_csv(self.found))

    def _content(self) -> Mapping[str, Any]:
        return tradeoff_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Designs": self.table}


@contextmanager
def journal_in(folder: File | None, asked: Question, accuracy: float, *, resume: bool) -> Generator[Journal]:
    """The journal in an output folder, which is made or taken again; without a folder, one that is not written. Raises
    `InputError`."""
    key = digest(asked, accuracy)
    if folder is None:
        if resume:
            raise InputError("", "resume", "needs --out DIR, where the journal of the earlier run is")
        yield Journal(None, key)
        return
    out = Path(folder)
    names = made_folder(out) - {LOCK}
    refuse_strangers(out, names, FILES)
    there = journal_digest(out / JOURNAL)
    if names and there is None:
        # A kill in the first instant leaves an empty journal, which is as good as none.
        if names != {JOURNAL} or (out / JOURNAL).stat().st_size > 0:
            would_do = "name a new or empty folder"
            raise InputError(out, "", f"holds files that are not of `linkwright tradeoff`; {would_do}")
    elif there == key and RESULT not in names and not resume:
        would_do = "--resume goes on with it, or name another folder"
        raise InputError(out, "", f"holds this trade-off, unfinished; {would_do}")
    with Journal(out / JOURNAL, key, resume=resume, made_by=made_by()) as journal:
        # Until the new result is there, none is: a folder with a journal alone is known for unfinished.
        (out / RESULT).unlink(missing_ok=True)
        yield journal


def points_kept(folder: File) -> int:
    """How many solved points the journal in an output folder holds."""
    try:
        return max((Path(folder) / JOURNAL).read_bytes().count(b"\n") - 1, 0)
    except OSError:
        return 0


def traced(
    given: Problem, asked: Question, accuracy: float, journal: Journal, progress: Progress | None, executor: Executor
) -> Tradeoff:
    """Trace the fronts of a question; Ctrl-C is heard between two points."""
    with told(progress) as tell, interrupts() as check:

        def heard(done: Traced) -> None:
            check()
            tell(_words(done, groups=asked.by is not None), done.share)

        return Tradeoff(given, trade_off(asked, accuracy=accuracy, journal=journal, told=heard, executor=executor))


def _words(done: Traced, *, groups: bool) -> str:
    """How far a front has come; `groups`: fronts have names of their own."""
    name = f"{done.front}: " if groups else ""
    off = "" if done.error is None else f", straight lines right within {percent(done.error)}"
    known = f" ({done.resumed} from the journal)" if done.resumed else ""
    return f"{name}{done.points} points{known}{off}: {done.doing}"
