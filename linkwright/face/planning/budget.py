"""What an arm is to be expected to err by, from data sheets and tolerances: how much, by what, what to buy better."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.optimize.budget.parts import EACH_TIME, REPEATABILITY, TEMPERATURE
from linkwright.core.optimize.budget.result import Budget as BudgetResult
from linkwright.core.optimize.budget.result import Gain
from linkwright.core.optimize.budget.sheet import Sheet, read_sheet
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_yaml
from linkwright.face.arm import Arm
from linkwright.face.plain_input import File, plain
from linkwright.face.result import Field, Reported, drawn
from linkwright.json.fields import fields, in_joint_unit, in_mm
from linkwright.output.files import REPORT, RESULT
from linkwright.output.table_file import frame
from linkwright.results.document import (
    BARS,
    Bars,
    Description,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Value,
    amount,
    length,
    section,
    share,
    table,
)
from linkwright.results.figures_in_words import effect_title, mm, percent, pose, unless_nothing

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_TITLES = MappingProxyType(
    {
        REPEATABILITY: "repeatability of the tip",
        TEMPERATURE: "temperature",
        "size": "dimensions of the sections",
        "thickness": "walls of the sections",
    }
)


def cause_title(name: str) -> str:
    """What a cause is called."""
    plain = name.removesuffix(EACH_TIME)
    title = _TITLES.get(plain) or effect_title(plain)
    return f"{title}{EACH_TIME}" if plain != name else title


def describe(result: BudgetResult) -> Description:
    """The budget: figures, causes, parts."""
    arm, sheet = result.arm, result.sheet
    kept = percent(sheet.share)
    upper = "" if result.worst_upper is None else f"with 95 % confidence {mm(result.worst_upper, 3)}"
    facts = Facts(
        (
            Fact(f"worst error, {kept} of arms", length(result.worst, 3), upper),
            Fact("worst error, half of arms", length(result.median, 3)),
            Fact("worst error as on paper", length(result.nominal, 3), "nothing off"),
            Fact("over arms and poses", length(result.average, 3), "root mean square"),
        )
    )
    items: list[Item] = [facts]
    where = pose(arm, result.pose)
    loads = f", load case {result.load_case}" if len(result.load_cases) > 1 else ""
    if tip := result.load_cases[result.load_case - 1].tip:
        loads = f" at {tip}'s tip{loads}"
    items.append(Paragraph(f"Most at {where}{loads}: {mm(result.at_worst, 3)} for {kept} of arms."))
    largest = max((size for cause in result.causes for size in (cause.at_worst, cause.average)), default=0.0) or 1.0
    rows = [
        (
            cause_title(cause.name),
            length(unless_nothing(cause.at_worst, result.at_worst), 3),
            length(unless_nothing(cause.average, result.average), 3),
            share(unless_nothing(cause.share, 1.0)),
            Bars((("before", cause.at_worst / largest), ("after", cause.average / largest))),
        )
        for cause in result.causes
    ]
    columns = ("each cause alone", "at the worst pose", "average", "share of the square", BARS)
    lead = "Bars: at the worst pose (grey), and on average over poses and arms (blue)."
    items.append(section("Causes", table(columns, rows), lead=lead))
    if result.options:
        priced = [
            (option.name, _euro(option.price), length(option.worst, 3), length(option.average, 3), _per_euro(option))
            for option in result.options
        ]
        headings = ("better part", "price", "worst less by", "average less by", "mm per EUR")
        items.append(section("What to buy better first", table(headings, priced)))
    if result.halved:
        rows_ = [(item.name, length(item.worst, 3), length(item.average, 3)) for item in result.halved]
        lead = "All figures of one joint or link half as bad: stiffness twice, play and tolerances half."
        headings_ = ("twice as good", "worst less by", "average less by")
        items.append(section("What it would bring to make a part better", table(headings_, rows_), lead=lead))
    items.append(Lines(_rests_on(result)))
    headline = f"{kept} of arms err by {mm(result.worst, 3)} at most"
    brief = f"{headline}; most: {cause_title(result.causes[0].name)}"
    name = f"{arm.name}, tip of {arm.tip}" if arm.tip and not arm.every_tip else arm.name
    return Description(f"{name}: error budget", brief, tuple(items), brief, f"{name}: ")


def _euro(price: float | None) -> Value:
    return amount(price, "EUR") if price is not None else amount(None)


def _per_euro(gain: Gain) -> Value:
    return amount(None if gain.per_euro is None else 1e3 * gain.per_euro, "", 3)


def _rests_on(result: BudgetResult) -> tuple[str, ...]:
    sheet = result.sheet
    lines = [
        f"Sampled: {sheet.draws} arms (seed {sheet.seed}), each at {result.poses} poses, linearised. Tolerances "
        "are uniform and independent.",
        f"Play counts as the arm file says: {result.arm.play}.",
    ]
    if result.room.avoid:
        lines.append(
            "Poses that put joints, links or the tip in what is to be avoided do not count here (in evaluate they do). "
            "The worst of the others is that of the poses tried."
        )
    if result.unwarmed:
        numbers = ", ".join(str(k + 1) for k in result.unwarmed)
        lines.append(f"How much link {numbers} grows with temperature is not known and not in it.")
    if not sheet.tolerances and sheet.uncertain is None and not sheet.repeatability:
        lines.append("Without a data sheet all arms are alike: give tolerances with --sheet.")
    return tuple(lines)


@dataclass(frozen=True, repr=False)
class Budget(Reported):
    """The error of an arm by cause, over arms drawn from their tolerances, and what better parts would bring; `found`
    in SI."""

    _command = "budget"
    _folder_files = (RESULT, REPORT)
    _describe = staticmethod(describe)

    arm: Arm
    found: BudgetResult

    worst_mm = Field[float]("The worst error over the poses that the sheet's share of arms keeps, mm.")
    average_mm = Field[float]("The root mean square error over arms and poses, mm.")

    @property
    def causes(self) -> pd.DataFrame:
        """Each cause alone: `at_worst_mm`, `average_mm`, `share` of the mean square."""
        return frame(self._content()["causes"])

    @property
    def better(self) -> pd.DataFrame:
        """The parts that could be bought, those that bring most for a euro first."""
        return frame(self._content()["better"])

    @property
    def twice_as_good(self) -> pd.DataFrame:
        """What each joint or link would bring if it were twice as good."""
        return frame(self._content()["twice_as_good"])

    def plot(self) -> go.Figure:
        """Each cause alone, at the worst pose and on average, mm."""
        causes = self.causes
        names = [cause_title(name) for name in causes["cause"]]
        bars = {"at the worst pose": causes["at_worst_mm"], "average": causes["average_mm"]}
        return drawn(names, {name: values.tolist() for name, values in bars.items()}, "", "mm", mode="bar")

    def _content(self) -> Mapping[str, Any]:
        result, arm = self.found, self.found.arm
        tip = result.load_cases[result.load_case - 1].tip or arm.tip
        figures = ("worst_mm", "worst_upper_mm", "median_mm", "average_mm", "nominal_mm")
        return {
            **fields(result, "arm=arm.name", "share=sheet.share", *figures),
            "worst_pose": {
                "q": [in_joint_unit(arm, index, value) for index, value in enumerate(result.pose)],
                "load_case": result.load_case,
                **({"tip": tip} if tip else {}),
                "error_mm": in_mm(result.at_worst),
            },
            "causes": [fields(cause, "cause=name", "at_worst_mm", "average_mm", "share") for cause in result.causes],
            "twice_as_good": [_gain(item) for item in result.halved],
            "better": [_gain(option) for option in result.options],
            **fields(result, "play=arm.play", "poses", "draws=sheet.draws", "seed=sheet.seed"),
            "links_of_unknown_growth": [k + 1 for k in result.unwarmed],
            "samples_mm": in_mm(result.samples),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        tables = {"Causes": self.causes, "Better parts": self.better, "Twice as good": self.twice_as_good}
        return {name: table for name, table in tables.items() if len(table)}


def _gain(gain: Gain) -> dict[str, Any]:
    row = fields(gain, "part=name", "worst_less_mm=worst", "average_less_mm=average")
    if gain.owner is None:
        row |= {"price_EUR": gain.price, "mm_per_EUR": in_mm(gain.per_euro)}
    return row


def sheet_of(given: Arm, sheet: Mapping[str, object] | File | None) -> Sheet:
    """What a sheet says of an arm. Raises `InputError`."""
    where = "sheet" if sheet is None or isinstance(sheet, Mapping) else Path(sheet)

    def changed(keys: Iterable[tuple[str, object]]) -> Model:
        made = given
        for key, value in keys:
            try:
                made = made.replace(key, value)
            except InputError as error:
                raise InputError(where, f"better: {error.key or key}", error.message) from None
        return made.model

    if sheet is None:
        return Sheet()
    reader = Reader(plain(sheet), file="sheet") if isinstance(sheet, Mapping) else load_yaml(sheet)
    return read_sheet(reader, given.model, changed)
