"""Trade-offs for programs: the designs of which none can be beaten in both of two figures."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.executors import Executor
from linkwright.core.optimize.limits import Figure
from linkwright.core.optimize.tradeoff.front import Point
from linkwright.core.optimize.tradeoff.front import Tradeoff as Found
from linkwright.core.optimize.tradeoff.journal import Journal
from linkwright.core.optimize.tradeoff.question import Question, question
from linkwright.core.optimize.tradeoff.trace import Progress as Traced
from linkwright.core.optimize.tradeoff.tradeoff import ACCURACY, trade_off
from linkwright.json.tradeoff import tradeoff_csv, tradeoff_json
from linkwright.output.tradeoff_folder import claim_tradeoff, write_tradeoff
from linkwright.report.charts.fronts import front_figure
from linkwright.report.origin import origin_of

from .arm import Arm, catalogue_of
from .figures import Figured, Values
from .given import File
from .problem import Problem, problem_of
from .progress import Progress, interrupts, told
from .result import Reported, figure_of
from .workers import at_work

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

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the work."""
        return self.found.interrupted

    def _design(self, point: Point) -> TradeoffDesign:
        arm = Arm.of(point.arm, catalogue=self.problem.arm.catalogue)
        return TradeoffDesign(point.number, arm, point.figures, self.problem.model.figures)

    def plot(self) -> go.Figure:
        """The fronts, a line each."""
        return figure_of(front_figure(self.found))

    def save(self, folder: File, *, made_from: Iterable[File] = (), author: str = "", comment: str = "") -> None:
        """Write what `tradeoff --out` does but the journal. Raises `InputError` for a folder with other files."""
        place = Path(folder)
        claim_tradeoff(place)
        origin = origin_of(map(Path, made_from), author=author, comment=comment)
        write_tradeoff(self.found, place, origin, catalogue_of(self.problem.arm.catalogue))

    def _content(self) -> Mapping[str, Any]:
        return tradeoff_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Designs": self.table}


def tradeoff(
    problem: Problem | File,
    *,
    x: str = "mass",
    y: str = "max_error",
    by: Literal["material", "shape"] | None = None,
    reach: Literal["long", "short"] = "long",
    accuracy: float = ACCURACY,
    progress: Progress | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
) -> Tradeoff:
    """The Pareto front between two figures of a problem's designs.

    `x` and `y` are two of `lw.limits`, all but those not `traded`. `by` asks for a front of each material or shape;
    `reach` says which reach is the better one. `accuracy` is the relative error that straight lines between points may
    have. `progress(text, share)` hears of each point; the share is that of the first points, then an estimate. What
    takes long is done by so many `workers`, processes of this machine (one a core), or by an `executor`
    (`lw.Processes`, `lw.Cluster`). Ctrl-C ends it with the points so far, marked `interrupted`. Raises `InputError`,
    and `NoAnswer` where no design keeps the limits.

    >>> import linkwright as lw
    >>> problem = lw.Problem(
    ...     arm="examples/welding-arm/arm.yaml",
    ...     workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
    ...     subject_to={"mass": "<= 26 kg", "max_error": "<= 0.5 mm", "section_size": ["40 mm", "120 mm"]},
    ...     choose={"section": ["circle"], "same": ["size"]},
    ... )
    >>> front = lw.tradeoff(problem, x="mass", y="max_error", accuracy=0.2)
    >>> heavier = front.table["mass_kg"].is_monotonic_increasing
    >>> bool(heavier), front.designs[0].arm
    (True, <Arm: cathode-bus welding arm, 3 joints, reach 1240 mm>)
    """
    given = problem_of(problem)
    asked = question(given.model, x, y, by=by, reach=reach)
    with told(progress) as tell, at_work(executor, workers) as crew:

        def heard(traced: Traced) -> None:
            tell(f"{traced.front}: {traced.points} points, {traced.doing}", traced.share)

        return traced_front(given, asked, accuracy, Journal(None, ""), heard, crew)


def traced_front(
    given: Problem,
    asked: Question,
    accuracy: float,
    book: Journal,
    heard: Callable[[Traced], None],
    executor: Executor | None = None,
) -> Tradeoff:
    """Trace the fronts of a question, with a journal that may know some points already."""
    with interrupts() as check:

        def told_of(traced: Traced) -> None:
            check()
            heard(traced)

        return Tradeoff(given, trade_off(asked, accuracy=accuracy, journal=book, told=told_of, executor=executor))
