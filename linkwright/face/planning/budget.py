"""What an arm is to be expected to err by, from data sheets and tolerances."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.optimize.budget.result import Budget as Found
from linkwright.core.optimize.budget.sheet import Sheet, read_sheet
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_yaml
from linkwright.face.arm import Arm
from linkwright.face.given import File, plain
from linkwright.face.result import Reported, figure_of
from linkwright.json.budget import budget_json
from linkwright.output.files import REPORT, RESULT
from linkwright.results.budget import cause_title

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Budget(Reported):
    """The error of an arm by cause, over arms drawn from their tolerances, and what better parts would bring; `found`
    in SI."""

    _command = "budget"
    _own = (RESULT, REPORT)

    arm: Arm
    found: Found

    @property
    def worst_mm(self) -> float:
        """The worst error over the poses that the sheet's share of arms keeps, mm."""
        return 1e3 * self.found.worst

    @property
    def average_mm(self) -> float:
        """The root mean square error over arms and poses, mm."""
        return 1e3 * self.found.average

    @property
    def causes(self) -> pd.DataFrame:
        """Each cause alone: `at_worst_mm`, `average_mm`, `share` of the mean square."""
        import pandas as pd

        return pd.DataFrame(self._content()["causes"])

    @property
    def better(self) -> pd.DataFrame:
        """The parts that could be bought, those that bring most for a euro first."""
        import pandas as pd

        return pd.DataFrame(self._content()["better"])

    @property
    def twice_as_good(self) -> pd.DataFrame:
        """What each joint or link would bring if it were twice as good."""
        import pandas as pd

        return pd.DataFrame(self._content()["twice_as_good"])

    def plot(self) -> go.Figure:
        """Each cause alone, at the worst pose and on average, mm."""
        found = self.found.causes
        names = [cause_title(each.name) for each in found]
        bars = [
            {"type": "bar", "name": "at the worst pose", "x": names, "y": [1e3 * each.at_worst for each in found]},
            {"type": "bar", "name": "average", "x": names, "y": [1e3 * each.average for each in found]},
        ]
        return figure_of({"data": bars, "layout": {"yaxis": {"title": {"text": "mm"}}}})

    def _content(self) -> Mapping[str, Any]:
        return budget_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        tables = {"Causes": self.causes, "Better parts": self.better, "Twice as good": self.twice_as_good}
        return {name: table for name, table in tables.items() if len(table)}


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
