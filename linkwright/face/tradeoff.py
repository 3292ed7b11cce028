"""Trade-offs for programs: the designs of which none can be beaten in both of two figures."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.figures import Figure
from linkwright.core.executors.threads import one_thread
from linkwright.core.optimize.tradeoff.front import Point
from linkwright.core.optimize.tradeoff.front import Tradeoff as TradeoffResult
from linkwright.core.optimize.tradeoff.question import Question
from linkwright.core.optimize.tradeoff.trace import Progress as Traced
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.face.evaluation import Figured, Values
from linkwright.output.files import REPORT, write_file
from linkwright.output.table_file import WAYS, write_table
from linkwright.output.tradeoff_folder import claim_tradeoff, tradeoff_csv, tradeoff_json, write_tradeoff
from linkwright.report.charts.fronts import front_figure
from linkwright.results.figures_in_words import percent
from linkwright.results.tradeoff import describe

from .arm import Arm, catalogue_of
from .plain_input import File
from .problem import Problem
from .progress import Progress, interrupts, reporting
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

    def _arm_and_figures(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.arm.model, self.known


@dataclass(frozen=True, repr=False)
class Tradeoff(Reported):
    """The front between two figures; `found` holds everything in SI.

    `interrupted`: Ctrl-C ended the work, and these are the points that it had; none of them is wrong.
    """

    _command = "tradeoff"
    _describe = staticmethod(describe)

    problem: Problem
    found: TradeoffResult

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
        """All that `tradeoff --out` writes."""
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


def traced(given: Problem, asked: Question, accuracy: float, progress: Progress | None) -> Tradeoff:
    """Trace the fronts of a question; Ctrl-C is heard between two points."""
    with reporting(progress) as tell, interrupts() as check, one_thread():

        def heard(done: Traced) -> None:
            check()
            tell(_words(done, groups=asked.by is not None), done.share)

        return Tradeoff(given, trade_off(asked, accuracy=accuracy, notify=heard))


def _words(done: Traced, *, groups: bool) -> str:
    """How far a front has come; `groups`: fronts have names of their own."""
    name = f"{done.front}: " if groups else ""
    off = "" if done.error is None else f", accurate to {percent(done.error)}"
    return f"{name}{done.doing}, points so far {done.points}{off}"
