"""An arm watched over dated recordings: what moved, and when."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.recording import Recording as Read
from linkwright.core.diagnose.watch.watch import LEFT, Moved, Watched, dates_of
from linkwright.core.diagnose.watch.watch import Watch as WatchResult
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.diagnosis import each_with_settings
from linkwright.face.motion.log import Log
from linkwright.face.plain_input import File
from linkwright.face.recording import Recording
from linkwright.face.result import Reported, figure_of
from linkwright.json.fields import fields
from linkwright.json.motion import OBSERVES
from linkwright.json.parameters import in_unit, unit_of
from linkwright.output.files import REPORT, RESULT
from linkwright.output.table_file import frame
from linkwright.results.diagnoses.watched import before_change, days_of, describe, title_of, watch_sentence

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_FEWEST = 3


@dataclass(frozen=True, repr=False)
class Watch(Reported):
    """The parameters of an arm over dated recordings, what moved and when; `found` holds everything in SI."""

    _command = "watch"
    _folder_files = (RESULT, REPORT)
    _describe = staticmethod(describe)

    arm: Arm
    found: WatchResult
    recordings: tuple[Recording | Log, ...]

    @property
    def settings_read(self) -> list[Path]:
        """The settings that the recordings were read with."""
        return [Path(recording.found.settings) for recording in self.recordings if recording.found.settings]

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
        columns = ["effect", "at", "parameter", "kind", "from", "to", "earliest", "latest", "change", "low", "high"]
        rows = [
            {**item, "low": item["ci95"][0], "high": item["ci95"][1], "at": tuple(item["at"])}
            for item in self._content()["alarms"]
        ]
        return frame(rows, [*columns, "unit", "per_day", "told", "p_value"])

    @property
    def values(self) -> pd.DataFrame:
        """A row for each parameter at each date, in `unit`: value, 95 % interval, level, a quiet one's limits."""
        rows: list[dict[str, Any]] = []
        for parameter in (*self.found.parameters, self.found.left):
            quantity, kind = parameter.parameter, parameter.parameter.kind
            for k, one in enumerate(self.found.recordings):
                figures = (parameter.values[k], *parameter.intervals[k], parameter.level[k], *parameter.limits[k])
                names = ("value", "low", "high", "level", "limit_low", "limit_high")
                shown = {n: in_unit(float(v), kind) for n, v in zip(names, figures, strict=True)}
                what = {"effect": quantity.effect, "at": quantity.at, "parameter": quantity.name}
                rows.append({"date": np.datetime64(one.date, "ns"), **what, **shown, "unit": unit_of(kind)})
        return frame(rows)

    def plot(self) -> go.Figure:
        """How far each parameter is from where it began, in standard deviations of a quiet recording."""
        data: list[dict[str, Any]] = []
        for parameter in (*self.found.parameters, self.found.left):
            began = 0.5 * (parameter.limits[:, 0] + parameter.limits[:, 1])
            far = (parameter.values - began) / parameter.deviation
            shown = [float(value) if np.isfinite(value) else None for value in far]
            trace = {"type": "scatter", "mode": "lines+markers", "x": days_of(self.found), "y": shown}
            data.append({**trace, "name": title_of(parameter), **({} if parameter.moved else {"opacity": 0.35})})
        return figure_of({"data": data, "layout": {"yaxis": {"title": {"text": "standard deviations"}}}})

    def _content(self) -> Mapping[str, Any]:
        result = self.found
        rms, says = ("rms_left=rms", dict(OBSERVES)) if result.of_motion else ("rms_left_mm=rms", {})
        recordings = [
            {
                "date": recording.date.isoformat(),
                "file": PurePath(recording.file).name,
                **fields(recording, "name", "rows", "rows_left_out=left_out", rms),
            }
            for recording in result.recordings
        ]
        return {
            "arm": result.arm.name,
            **says,
            "sentence": self.sentence,
            "recordings": recordings,
            "alarms": [_alarm(result, item, change) for item in result.moved for change in item.changes],
            "parameters": [_watched(result, parameter) for parameter in result.parameters],
            "left": _watched(result, result.left),
            "not_watched": [fields(item, "effect", "at", "why") for item in result.unwatched],
            "verdict": None if result.together is None else result.together.verdict,
            "diagnosed_together": [days_of(result)[k] for k in result.searched],
            "false_alarm": fields(result.rules, "chance=false_alarm", "over_recordings=over"),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"What moved": self.alarms} if self.moved else {}


def _named(watched: Watched) -> dict[str, Any]:
    quantity = watched.parameter
    effect = None if quantity.name == LEFT else quantity.effect
    return {"effect": effect, "at": list(quantity.at), "parameter": quantity.name, "unit": unit_of(quantity.kind)}


def _alarm(result: WatchResult, watched: Watched, change: Moved) -> dict[str, Any]:
    kind, days = watched.parameter.kind, days_of(result)
    last = change.last if change.kind == "step" else change.first
    until = len(days) - 1 if change.kind == "drift" else change.first
    rates = change.rate_interval
    return {
        **_named(watched),
        "kind": change.kind,
        "from": days[last],
        "to": days[until],
        "earliest": days[before_change(change)],
        "latest": days[change.latest],
        "change": in_unit(change.size, kind),
        "ci95": [in_unit(end, kind) for end in change.interval],
        "per_day": None if change.rate is None else in_unit(change.rate, kind),
        "per_day_ci95": None if rates is None else [in_unit(end, kind) for end in rates],
        "told": days[change.detected],
        "p_value": change.p_value,
    }


def _watched(result: WatchResult, watched: Watched) -> dict[str, Any]:
    def in_its_unit(value: float) -> float | None:
        return in_unit(float(value), watched.parameter.kind)

    values = [
        {
            "date": day,
            "value": in_its_unit(watched.values[k]),
            "standard_error": in_its_unit(watched.errors[k]),
            "ci95": [in_its_unit(end) for end in watched.intervals[k]],
            "level": in_its_unit(watched.level[k]),
            "limits": [in_its_unit(end) for end in watched.limits[k]],
        }
        for k, day in enumerate(days_of(result))
    ]
    return {
        **_named(watched),
        "found": watched.parameter.identified,
        "moved": watched.moved,
        "values": values,
        "standard_deviation": in_its_unit(watched.deviation),
        "between_recordings": in_its_unit(watched.between),
        "smallest_step": in_its_unit(watched.smallest_step),
    }


def read_dated(
    recordings: Sequence[Recording | Log | File | pd.DataFrame], arm: Arm, settings: File | Sequence[File] | None = None
) -> list[Recording]:
    """Recordings of one arm, at least three, each with a separate date. Raises `InputError`."""
    _enough(recordings)
    read = each_with_settings(recordings, arm, settings)
    _check([one.found for one in read])
    return read


def read_dated_logs(logs: Sequence[Log]) -> None:
    """Refuse motion logs that are not of one arm, fewer than three, or without a separate date. Raises
    `InputError`."""
    _enough(logs)
    _check([one.found for one in logs])


def _enough(recordings: Sequence[object]) -> None:
    if len(recordings) < _FEWEST:
        message = f"a watch needs {_FEWEST} recordings or more, not {len(recordings)}; `compare` takes two"
        raise InputError("", "recordings", message)


def _read(one: Read | MotionLog) -> Array:
    return one.torque if isinstance(one, MotionLog) else one.tip


def _check(read: Sequence[Read | MotionLog]) -> None:
    _of_one_arm(read)
    _dated(read)
    for k, one in enumerate(read):
        for other in read[:k]:
            if np.array_equal(one.q, other.q) and np.array_equal(_read(one), _read(other), equal_nan=True):
                names = [PurePath(item.file).name or "a recording" for item in (one, other)]
                message = f"hold the same readings twice ({names[1]} and {names[0]}), as no instrument reads; name one"
                raise InputError(one.file, "", message)


def _of_one_arm(read: Sequence[Read | MotionLog]) -> None:
    widths = sorted({one.q.shape[1] for one in read})
    if len(widths) > 1:
        raise InputError("", "recordings", f"are of arms with {' and '.join(map(str, widths))} joints; watch one arm")
    units = sorted({one.unit for one in read if one.unit})
    if len(units) > 1:
        arms = " and ".join(units[:3])
        message = f"are of different arms ({arms}, by `unit` in recording.yaml); watch one arm at a time"
        raise InputError("", "recordings", message)


def _dated(read: Sequence[Read | MotionLog]) -> None:
    """Each recording needs a date, and no two the same."""
    for one in read:
        if not one.date:
            beside = str(Path(one.file).with_suffix(".yaml")) if one.file else "recording.yaml"
            message = "is missing; a watch needs to know when it was made, e.g. `date: 2026-05-16`"
            raise InputError(one.settings or beside, "date", message)
    days = dates_of(read)
    for k, (one, day) in enumerate(zip(read, days, strict=True)):
        if day in days[:k]:
            other = PurePath(read[days.index(day)].file).name
            pair = f"{PurePath(one.file).name or 'a recording'} and {other or 'another'}"
            message = f"{pair} are both of {day.isoformat()}; give each a date of its own, or one of them"
            raise InputError(one.settings or "", "date", message)
