"""Which poses, payloads and sides are worth recording, and what they will show."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.instruments.instrument import LABELS
from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.written import ALONG_BAR, READ, plan_text, read_plan
from linkwright.core.diagnose.reading.read_back import unlike
from linkwright.core.diagnose.reading.write import settings_text
from linkwright.face.arm import Arm
from linkwright.face.given import File
from linkwright.face.recording import recording_columns, settings_beside
from linkwright.face.result import Result, figure_of
from linkwright.json.planning import plan_json
from linkwright.output.files import write_file
from linkwright.output.read_back import ReadBack
from linkwright.results.planning import cause

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """Readings to take, in their order, and what they will show; `found` holds everything in SI."""

    _command = "plan"

    arm: Arm
    found: Planned

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended the choice; this is the best plan until then."""
        return self.found.interrupted

    @property
    def visits(self) -> pd.DataFrame:
        """A row for each visit by the columns of a recording: `q1_deg`, `dir1`, `payload_kg`, ..."""
        import pandas as pd

        visits = self.found.visits
        columns: dict[str, Any] = {
            name: values for name, values, _ in recording_columns(visits, self.arm.model) if name not in READ
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, visits.size + 1, name="visit"))

    @property
    def shown(self) -> pd.DataFrame:
        """The smallest size of each cause that will be seen, in `unit`, and what poses at random show (nan: nothing);
        from which size on it is told from other causes, and how many it is not told from."""
        import pandas as pd

        keys = ("effect", "at", "parameter", "unit", "usual", "smallest", "random", "told_from", "not_told")
        rows = [{**{key: each[key] for key in keys[:-1]}, "not_told": len(each["not_told"])} for each in self._shown]
        return pd.DataFrame(rows, columns=list(keys))

    @property
    def _shown(self) -> list[dict[str, Any]]:
        return self._content()["shown"]

    def text(self) -> str:
        """The plan as CSV: a recording whose tip is still blank."""
        held = bool(self.found.asked.torque_noise)
        return plan_text(self.found.recording, self.arm.model, self.found.axes, torques=held)

    @property
    def settings(self) -> str | None:
        """What stands beside a plan as recording.yaml: of heights or distances what reads them, of several arms on one
        torso whose tip it is; None where it need not."""
        return settings_text(self.found.recording) if self.found.asked.slots or self.arm.model.branches else None

    def save(self, folder: File) -> Sequence[Path]:
        """Write the plan as CSV, and beside it what it reads where that is no place, as `plan --out` does; gives which
        files. Raises `InputError`, also where settings of another's stand beside it."""
        place, settings = Path(folder), self.settings
        beside = None if settings is None else settings_beside(place)
        if beside is not None and settings is not None:
            write_file(beside, settings)
        write_file(place, ReadBack(self.text(), self._unlike))
        return [place] if beside is None else [place, beside]

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the plan that is read from a file says otherwise; what it leaves blank says nothing."""
        back = read_plan(path, self.arm.model)
        return unlike(self.found.recording, back, self.arm.model, without=(*READ, *LABELS.values(), ALONG_BAR))

    def plot(self) -> go.Figure:
        """The smallest size of each cause over what is usual at most: this plan, and poses at random."""
        found = self.found.promise.shown
        names = [cause(each.effect, each.at) for each in found]
        random = [self.found.at_random(each) for each in found]
        bars = [
            {"type": "bar", "name": "planned", "x": names, "y": [each.smallest / each.usual for each in found]},
            {
                "type": "bar",
                "name": "at random",
                "x": names,
                "y": [
                    size / each.usual if math.isfinite(size) else None for size, each in zip(random, found, strict=True)
                ],
            },
        ]
        axis = {"title": {"text": "smallest size over what is usual"}, "type": "log"}
        return figure_of({"data": bars, "layout": {"yaxis": axis}})

    def _content(self) -> Mapping[str, Any]:
        return plan_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Shown": self.shown, "Visits": self.visits}
