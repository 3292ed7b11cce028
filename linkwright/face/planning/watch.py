"""An arm watched over dated recordings: what moved, and when."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.diagnose.recording import Recording as Read
from linkwright.core.diagnose.watch.watch import Watch as Found
from linkwright.core.diagnose.watch.watch import dates_of
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.diagnosis import recording_of
from linkwright.face.given import File
from linkwright.face.recording import Recording
from linkwright.face.result import Reported, figure_of
from linkwright.json.diagnosis import in_unit, unit_of
from linkwright.json.watch import watch_json
from linkwright.output.files import REPORT, RESULT
from linkwright.results.diagnoses.watch import title_of, watch_sentence

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_FEWEST = 3


@dataclass(frozen=True, repr=False)
class Watch(Reported):
    """The parameters of an arm over dated recordings, what moved and when; `found` holds everything in SI."""

    _command = "watch"
    _own = (RESULT, REPORT)

    arm: Arm
    found: Found
    recordings: tuple[Recording, ...]

    @property
    def settings_read(self) -> list[Path]:
        """The settings that the recordings were read with."""
        return [Path(each.found.settings) for each in self.recordings if each.found.settings]

    @property
    def sentence(self) -> str:
        """What moved and when, plainly."""
        return watch_sentence(self.found)

    @property
    def moved(self) -> bool:
        """Whether anything moved beyond chance."""
        return bool(self.found.moved)

    @property
    def alarms(self) -> pd.DataFrame:
        """A row for each change: what, which `kind` (`step`, `drift`, `once`), `from` and `to` which date, by how much
        in `unit` with its 95 % interval, the date on which it was `told`."""
        import pandas as pd

        columns = ["effect", "at", "parameter", "kind", "from", "to", "earliest", "latest", "change", "low", "high"]
        rows = [
            {**each, "low": each["ci95"][0], "high": each["ci95"][1], "at": tuple(each["at"])}
            for each in self._content()["alarms"]
        ]
        return pd.DataFrame(rows, columns=[*columns, "unit", "per_day", "told", "p_value"])

    @property
    def values(self) -> pd.DataFrame:
        """A row for each parameter at each date, in `unit`: value, 95 % interval, level, a quiet one's limits."""
        import pandas as pd

        rows: list[dict[str, Any]] = []
        for each in (*self.found.parameters, self.found.left):
            own, kind = each.parameter, each.parameter.kind
            for k, one in enumerate(self.found.recordings):
                figures = (each.values[k], *each.intervals[k], each.level[k], *each.limits[k])
                names = ("value", "low", "high", "level", "limit_low", "limit_high")
                shown = {n: in_unit(float(v), kind) for n, v in zip(names, figures, strict=True)}
                what = {"effect": own.effect, "at": own.at, "parameter": own.name}
                rows.append({"date": pd.Timestamp(one.date), **what, **shown, "unit": unit_of(kind)})
        return pd.DataFrame(rows)

    def plot(self) -> go.Figure:
        """How far each parameter is from where it began, in standard deviations of a quiet recording."""
        days = [each.date.isoformat() for each in self.found.recordings]
        data: list[dict[str, Any]] = []
        for each in (*self.found.parameters, self.found.left):
            began = 0.5 * (each.limits[:, 0] + each.limits[:, 1])
            far = (each.values - began) / each.deviation
            shown = [float(value) if np.isfinite(value) else None for value in far]
            trace = {"type": "scatter", "mode": "lines+markers", "x": days, "y": shown, "name": title_of(each)}
            data.append(trace if each.moved else {**trace, "opacity": 0.35})
        return figure_of({"data": data, "layout": {"yaxis": {"title": {"text": "standard deviations"}}}})

    def _content(self) -> Mapping[str, Any]:
        return watch_json(self.found, self.sentence)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"What moved": self.alarms} if self.moved else {}


def read_dated(
    recordings: Sequence[Recording | File | pd.DataFrame], arm: Arm, settings: File | Sequence[File] | None = None
) -> list[Recording]:
    """Recordings of one arm, at least three, each with a date of its own. Raises `InputError`."""
    own = list(settings) if isinstance(settings, list | tuple) else [settings]
    if len(recordings) < _FEWEST:
        message = f"a watch needs {_FEWEST} recordings or more, not {len(recordings)}; `compare` takes two"
        raise InputError("", "recordings", message)
    if len(own) not in (1, len(recordings)):
        said = f"there are {len(own)} for {len(recordings)} recordings; give one for all, or one each"
        raise InputError("", "settings", said)
    each = own * len(recordings) if len(own) == 1 else own
    read = [recording_of(one, arm, held) for one, held in zip(recordings, each, strict=True)]  # pyright: ignore[reportArgumentType]
    _check([one.found for one in read])
    return read


def _check(read: Sequence[Read]) -> None:
    widths = sorted({one.q.shape[1] for one in read})
    if len(widths) > 1:
        raise InputError("", "recordings", f"are of arms with {' and '.join(map(str, widths))} joints; watch one arm")
    for one in read:
        if not one.date:
            beside = str(Path(one.file).with_suffix(".yaml")) if one.file else "recording.yaml"
            said = "is missing; a watch needs to know when it was made, e.g. `date: 2026-05-16`"
            raise InputError(one.settings or beside, "date", said)
    units = sorted({one.unit for one in read if one.unit})
    if len(units) > 1:
        said = (
            f"are of different arms ({' and '.join(units[:3])}, by `unit` in recording.yaml); watch one arm at a time"
        )
        raise InputError("", "recordings", said)
    days = dates_of(read)
    for k, (one, day) in enumerate(zip(read, days, strict=True)):
        if day in days[:k]:
            other = PurePath(read[days.index(day)].file).name
            named = [PurePath(one.file).name or "a recording", other or "another"]
            said = (
                f"{named[0]} and {named[1]} are both of {day.isoformat()}; give each a date of its own, or one of them"
            )
            raise InputError(one.settings or "", "date", said)
    for k, one in enumerate(read):
        for other in read[:k]:
            if np.array_equal(one.q, other.q) and np.array_equal(one.tip, other.tip, equal_nan=True):
                names = [PurePath(each.file).name or "a recording" for each in (one, other)]
                said = f"hold the same readings twice ({names[1]} and {names[0]}), as no instrument reads; name one"
                raise InputError(one.file, "", said)
