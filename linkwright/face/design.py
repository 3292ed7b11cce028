"""Designing for programs: the best design of a problem, and the designs with and without what a diagnosis found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.evaluation import Evaluation as Evaluated
from linkwright.core.arm.figures import Figure
from linkwright.core.executors import Executor
from linkwright.core.optimize.result import Iteration, OptimizationResult
from linkwright.core.optimize.rounding.options import Rounding, read_rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.face.evaluation import LOWER, ROBUST, Figured, Values, values_of
from linkwright.json.design import objective_unit, optimization_json
from linkwright.json.fields import fields, in_mm
from linkwright.output.files import DESIGN, ReadBack
from linkwright.output.table_file import frame
from linkwright.redesigning import Redesign as RedesignResult
from linkwright.redesigning import describe, redesign_json, redesign_sentences
from linkwright.report.pictures.plots import exchange_figure
from linkwright.results import optimization

from .arm import Arm, links_table
from .evaluation import Evaluation
from .plain_input import Quantity
from .problem import Problem
from .progress import Progress, interrupts, reporting
from .result import Field, Reported, Result, drawn, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Optimization(Figured, Reported):
    """The best design of a problem, with the arm as given for comparison; `found` holds everything in SI.

    `interrupted`: Ctrl-C ended the search, and this is the best design that it had.
    """

    _command = "optimize"
    _describe = staticmethod(optimization.describe)

    problem: Problem
    found: OptimizationResult

    @property
    def arm(self) -> Arm:
        """The new design; the rounded one where sizes were rounded."""
        return Arm.of(self.found.built, catalogue=self.problem.arm.catalogue)

    @property
    def before(self) -> Evaluation:
        """The arm as given."""
        return Evaluation(self.problem.arm, self.found.before)

    @property
    def after(self) -> Evaluation:
        """The new design, before any rounding."""
        return Evaluation(Arm.of(self.found.arm, catalogue=self.problem.arm.catalogue), self.found.after)

    def _designs(self) -> Mapping[str, Values]:
        result = self.found
        bound = result.lower_bound if result.minimize == "max_error" else None
        robust = None if result.robust is None else result.robust.design.value
        known = result.figures
        designs = {
            "before": values_of(result.before, known=known),
            "after": values_of(result.after, {LOWER: bound, ROBUST: robust}, known),
        }
        if result.rounded is not None:
            designs["rounded"] = values_of(result.rounded.evaluation, {LOWER: bound}, known)
        return designs

    def _arm_and_figures(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.found.built, self.found.figures

    interrupted = Field[bool]("Whether Ctrl-C ended the search.")

    @property
    def log(self) -> pd.DataFrame:
        """A row for each round of the exchange: objective (mm, kg or EUR), design change and violation (relative)."""
        factor, unit = objective_unit(self.found.minimize, self.found.figures)
        keys = ("design_change", "poses", "worst_violation", "certified")
        return frame(
            [
                {
                    "number": iteration.number,
                    f"objective_{unit}": factor * iteration.objective,
                    **fields(iteration, *keys),
                }
                for iteration in self.found.iterations
            ]
        )

    @property
    def links(self) -> pd.DataFrame:
        """The links of the new design: length (mm), section, material, mass (kg)."""
        return links_table(self.found.arm).assign(mass_kg=list(self.found.after.link_masses))

    @property
    def binding(self) -> pd.DataFrame:
        """Each limit that holds, with what one unit more of it would change of the objective."""
        keys = ("limit=text", "value", "unit", "price", "price_unit")
        return frame([fields(item, *keys) for item in self.found.binding], [key.partition("=")[0] for key in keys])

    def plot(self) -> go.Figure:
        """The objective round by round: where what the program believes and what is found meet, the exchange ends."""
        return figure_of(exchange_figure(self.found.iterations, self.found.minimised))

    def _content(self) -> Mapping[str, Any]:
        return optimization_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Links": self.links, "What binds": self.binding}

    def _files(self) -> Mapping[str, str | ReadBack]:
        result = self.found
        promised = result.after if result.rounded is None else result.rounded.evaluation
        return {DESIGN: self.arm.to_file(promised)}


def rounding_of(to: str | None, length: Quantity | None) -> Rounding | None:
    """What sizes are rounded to. Raises `InputError`."""
    if to is None:
        if length is not None:
            raise InputError("", "round_length", "goes with `round_to`; write 'stock' there, or '0.5 mm'")
        return None
    if length is None or isinstance(length, str):
        return read_rounding(to, length)
    return read_rounding(to, format_quantity(float(length), "length"))


def optimized(
    problem: Problem,
    rounding: Rounding | None,
    progress: Progress | None,
    log: Callable[[Iteration], None] | None,
    out_of_reach: Callable[[str], None] | None,
    begun: Callable[[Evaluation], None] | None,
    executor: Executor,
) -> Optimization:
    """The best design, and whoever wants to hear told on the way; Ctrl-C is heard between two steps."""
    with reporting(progress) as tell, interrupts() as check:

        def tries(done: int, total: int, text: str) -> None:
            check()
            tell(f"{text}, {done:.0f} of {total:.0f} done", done / max(total, 1))

        def heard(iteration: Iteration) -> None:
            check()
            if log is not None:
                log(iteration)

        def starts(before: Evaluated) -> None:
            if begun is not None:
                begun(Evaluation(problem.arm, before))

        settings: Any = {"log": heard, "progress": tries, "notify": out_of_reach, "begun": starts}
        settings["executor"] = executor
        if rounding is not None:
            return Optimization(problem, optimise_rounded(problem.model, rounding, **settings))
        return Optimization(problem, optimise(problem.model, **settings))


@dataclass(frozen=True, repr=False)
class Redesign(Figured, Result):
    """A problem solved with an arm as given and as a diagnosis corrected it; `found` holds everything in SI."""

    _command = "redesign"
    _signed = False
    _describe = staticmethod(describe)

    problem: Problem
    found: RedesignResult

    @property
    def old(self) -> Optimization:
        """The best design with the arm as given."""
        return Optimization(self.problem, self.found.old)

    @property
    def new(self) -> Optimization:
        """The best design with the corrected physics."""
        return Optimization(self.problem, self.found.new)

    @property
    def arm(self) -> Arm:
        """The new design with the corrected physics."""
        return self.new.arm

    def _designs(self) -> Mapping[str, Values]:
        new = self.new._designs()  # pyright: ignore[reportPrivateUsage] - the same of one of the designs
        return {"old": values_of(self.found.old.after, known=self.found.old.figures), "new": [*new.values()][-1]}

    def _arm_and_figures(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.found.new.built, self.found.new.figures

    @property
    def sentences(self) -> tuple[str, ...]:
        """What it means, in plain sentences."""
        return tuple(redesign_sentences(self.found))

    @property
    def table(self) -> pd.DataFrame:
        """What the old optimum was promised and really has, and what the new one has, mm."""
        errors = in_mm((self.found.promised, self.found.had, self.found.has))
        return frame({"design": ["old, promised", "old, really", "new"], "max_error_mm": errors})

    def plot(self) -> go.Figure:
        """The three errors as bars."""
        table = self.table
        return drawn(list(table["design"]), {"": list(table["max_error_mm"])}, "", "worst error in mm", mode="bar")

    def _content(self) -> Mapping[str, Any]:
        return redesign_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Worst error": self.table}

    def _files(self) -> Mapping[str, str | ReadBack]:
        return {DESIGN: self.arm.to_file(self.found.new.after)}
