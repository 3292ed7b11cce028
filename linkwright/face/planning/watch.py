"""An arm watched over dated recordings: what moved, and when."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.diagnose.recording import Recording as Read
from linkwright.core.diagnose.watch.watch import LEFT, Moved, Watched, dates_of
from linkwright.core.diagnose.watch.watch import Watch as Found
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.diagnosis import each_with_settings
from linkwright.face.plain_input import File
from linkwright.face.recording import Recording
from linkwright.face.result import Reported, figure_of
from linkwright.json.diagnosis import in_unit, unit_of
from linkwright.json.fields import fields
from linkwright.output.files import REPORT, RESULT
from linkwright.output.table_file import frame
from linkwright.report.charts.control import chart
from linkwright.report.pictures.svg import element
from linkwright.results.diagnoses.words import effect_words, listed, probability, quantity
from linkwright.results.document import (
    Cell,
    Column,
    Description,
    Item,
    Lines,
    Picture,
    Table,
    Value,
    count,
    length,
    section,
    table,
)
from linkwright.results.figures_in_words import effect_title, percent

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_FEWEST = 3
_WEEK, _YEAR = 7.0, 365.25
_LONG = 2.0 * _YEAR
_KINDS = MappingProxyType({"step": "moved", "once": "off once", "drift": "drifts"})


def _days(found: Found) -> list[str]:
    return [each.date.isoformat() for each in found.recordings]


def title_of(each: Watched) -> str:
    """What a parameter is called: `compliance of the drives (joint 2): compliance`."""
    own = each.parameter
    if own.name == LEFT:
        return "what is left unexplained"
    title = effect_words(own.effect, own.at)
    name = own.name.replace("_", " ")
    return title if name in effect_title(own.effect).split() else f"{title}: {name}"


def amount_words(each: Watched, value: float, digits: int = 3, *, signed: bool = False) -> str:
    """A value of a parameter with its unit, the same unit for all values of the parameter."""
    words = quantity(value, each.parameter.kind, digits, _like(each))
    return f"+{words}" if signed and value > 0.0 and math.isfinite(value) else words


def _level(each: Watched, value: float) -> str:
    """A level to a tenth of what one recording scatters by."""
    if not (math.isfinite(value) and value != 0.0 and each.deviation > 0.0):
        return amount_words(each, value)
    finer = math.floor(math.log10(abs(value))) - math.floor(math.log10(each.deviation))
    return amount_words(each, value, min(7, max(1, finer + 2)))


def _like(each: Watched) -> float | None:
    known = [abs(float(value)) for value in each.values if math.isfinite(value)]
    return max(known, default=0.0) or None


def _span(each: Watched, ends: tuple[float, float]) -> str:
    low, high = (amount_words(each, end) for end in ends)
    return f"{low.rpartition(' ')[0] if ' ' in low else low} to {high}"


def _pace(found: Found) -> tuple[float, str]:
    days = (found.recordings[-1].date - found.recordings[0].date).days
    return (_YEAR, "a year") if days > _LONG else (_WEEK, "a week")


def when_words(found: Found, change: Moved) -> str:
    """When a parameter changed: `between 2026-05-09 and 2026-05-16`."""
    days = _days(found)
    if change.kind == "step":
        return f"between {days[change.last]} and {days[change.first]}"
    return f"on {days[change.first]} alone" if change.kind == "once" else f"since {days[change.first]}"


def _early(change: Moved) -> int:
    """The recording before which nothing had changed yet."""
    return max(change.earliest - 1, 0) if change.kind == "step" else change.earliest


def change_words(found: Found, each: Watched, change: Moved) -> str:
    """A change as a phrase."""
    if change.kind == "drift" and change.rate is not None:
        per, words = _pace(found)
        by = f"{amount_words(each, per * change.rate, signed=True)} {words}"
        return f"{title_of(each)} by {by} {when_words(found, change)}"
    return f"{title_of(each)} by {amount_words(each, change.size, signed=True)} {when_words(found, change)}"


def watch_sentence(found: Found) -> str:
    """What moved and when, plainly."""
    told = {"step": "Moved", "drift": "Drifts", "once": "Off once"}
    parts: list[str] = []
    for kind, words in told.items():
        own = [change_words(found, e, c) for e in found.moved for c in e.changes if c.kind == kind]
        if own:
            parts.append(f"{words}: {'; '.join(own)}.")
    known = [each for each in found.parameters if _shown(each)]
    quiet = len(known) + int(_shown(found.left)) - len(found.moved)
    if not parts:
        days = _days(found)
        of = f"{len(known)} parameters" if len(known) != 1 else "one parameter"
        return f"Nothing moved beyond chance: {of} over {len(days)} recordings, {days[0]} to {days[-1]}."
    if quiet:
        parts.append(f"Nothing else moved beyond chance ({quiet} watched).")
    return " ".join(parts)


def describe(found: Found) -> Description:
    """The watch: what moved, each parameter, each recording."""
    sentence = watch_sentence(found)
    items: list[Item] = []
    if found.moved:
        lead = (
            "Dots are what each recording says, with its 95 % interval; the line is the level; the band is where one "
            "recording lies as long as the parameter stays as it began; red: when it changed, and between which dates."
        )
        moved = Picture(lambda: "".join(_chart(found, each) for each in found.moved))
        items.append(section("What moved", moved, _moves(found), lead=lead))
    items.append(section("Each parameter", _parameters(found), Picture(lambda: _quiet(found))))
    items.append(section("Recordings", _recordings(found), detail=True))
    items.append(section("Values", *(_values(found, each) for each in (*found.parameters, found.left)), detail=True))
    items.append(section("What it rests on", Lines(_rests_on(found))))
    name = found.arm.name
    brief = sentence.split(". ")[0].rstrip(".")
    return Description(f"{name}: watched over {len(found.recordings)} recordings", sentence, tuple(items), brief)


def _chart(found: Found, each: Watched) -> str:
    changes = [change_words(found, each, change) for change in each.changes]
    return chart(found, each, title_of(each), changes, large=each.moved)


def _quiet(found: Found) -> str:
    """Small charts of what did not move, as far as a recording shows it."""
    known = [x for x in (*found.parameters, found.left) if not x.moved and any(map(math.isfinite, x.values))]
    return element("div", *(_chart(found, each) for each in known), class_="multiples") if known else ""


def _shown(each: Watched) -> bool:
    """Whether any of the recordings shows a parameter: of others nobody knows whether they moved."""
    return any(math.isfinite(value) for value in each.level)


def _moves(found: Found) -> Table:
    days = _days(found)
    rows: list[tuple[Cell, ...]] = []
    for each in found.moved:
        for change in each.changes:
            sure = "" if change.kind == "once" else f"{days[_early(change)]} to {days[change.latest]}"
            by, ends = change.size, change.interval
            unit = ""
            if change.kind == "drift" and change.rate is not None and change.rate_interval is not None:
                per, unit = _pace(found)
                by, ends = per * change.rate, (per * change.rate_interval[0], per * change.rate_interval[1])
                unit = f" {unit}"
            rows.append(
                (
                    title_of(each),
                    _KINDS[change.kind],
                    when_words(found, change),
                    Value(f"{amount_words(each, by, signed=True)}{unit}"),
                    Value(_span(each, ends)),
                    sure,
                    days[change.told],
                    probability(change.p_value),
                )
            )
    headings = ("what", "", "when", "by", "95 % interval", Column("date, 95 %", detail=True), "told on", "p")
    return table(headings, rows)


def _parameters(found: Found) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for each in (*found.parameters, found.left):
        level = [float(value) for value in each.level if math.isfinite(value)]
        ends = (level[0], level[-1]) if level else (math.nan, math.nan)
        kinds = sorted({change.kind for change in each.changes})
        said = listed([_KINDS[kind] for kind in kinds])
        rows.append(
            (
                title_of(each),
                Value(_level(each, ends[0])),
                Value(_level(each, ends[1])),
                Value(amount_words(each, each.deviation, 2)),
                Value(amount_words(each, each.between, 2)),
                Value(amount_words(each, each.smallest_step, 2)),
                said or ("noise" if level else "not shown"),
            )
        )
    beyond = Column("of it between recordings", detail=True)
    headings = ("what", "level, first", "last", "one recording scatters by", beyond, "step told soon", "")
    return table(headings, rows)


def _recordings(found: Found) -> Table:
    rows = [
        (each.date.isoformat(), PurePath(each.file).name, count(each.rows), count(each.left_out), length(each.rms, 3))
        for each in found.recordings
    ]
    return table(("date", "file", "readings", "left out", "left unexplained, RMS"), rows)


def _values(found: Found, each: Watched) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for k, one in enumerate(found.recordings):
        figures = (each.values[k], *each.intervals[k], each.level[k], *each.limits[k])
        rows.append((one.date.isoformat(), *(Value(amount_words(each, float(value), 4)) for value in figures)))
    headings = ("date", "value", "95 % from", "to", "level", "limits from", "to")
    return table(headings, rows, title=title_of(each), folded=True)


def _rests_on(found: Found) -> tuple[str, ...]:
    rules = found.rules
    lines = [
        f"{percent(rules.false_alarm)} chance of any false alarm over {rules.over} quiet recordings, all parameters "
        "together and looked at after each of them.",
        f"A step told soon is the least that {rules.soon} further recordings would tell "
        f"(power {percent(rules.power)}).",
    ]
    if found.searched and len(found.searched) < len(found.recordings):
        days = listed([found.recordings[k].date.isoformat() for k in found.searched])
        lines.append(f"What there is to watch was found in the recordings of {days} together.")
    if found.together is not None and found.together.verdict == "unknown":
        lines.append("Together they hold a mismatch that nothing explains; it is in what is left of each.")
    for why in dict.fromkeys(each.why for each in found.unwatched):
        named = [effect_words(each.effect, each.at) for each in found.unwatched if each.why == why]
        lines.append(f"Not watched: {listed(named)}: {why}.")
    return tuple(lines)


@dataclass(frozen=True, repr=False)
class Watch(Reported):
    """The parameters of an arm over dated recordings, what moved and when; `found` holds everything in SI."""

    _command = "watch"
    _own = (RESULT, REPORT)
    _describe = staticmethod(describe)

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
        columns = ["effect", "at", "parameter", "kind", "from", "to", "earliest", "latest", "change", "low", "high"]
        rows = [
            {**each, "low": each["ci95"][0], "high": each["ci95"][1], "at": tuple(each["at"])}
            for each in self._content()["alarms"]
        ]
        return frame(rows, [*columns, "unit", "per_day", "told", "p_value"])

    @property
    def values(self) -> pd.DataFrame:
        """A row for each parameter at each date, in `unit`: value, 95 % interval, level, a quiet one's limits."""
        rows: list[dict[str, Any]] = []
        for each in (*self.found.parameters, self.found.left):
            own, kind = each.parameter, each.parameter.kind
            for k, one in enumerate(self.found.recordings):
                figures = (each.values[k], *each.intervals[k], each.level[k], *each.limits[k])
                names = ("value", "low", "high", "level", "limit_low", "limit_high")
                shown = {n: in_unit(float(v), kind) for n, v in zip(names, figures, strict=True)}
                what = {"effect": own.effect, "at": own.at, "parameter": own.name}
                rows.append({"date": np.datetime64(one.date, "ns"), **what, **shown, "unit": unit_of(kind)})
        return frame(rows)

    def plot(self) -> go.Figure:
        """How far each parameter is from where it began, in standard deviations of a quiet recording."""
        data: list[dict[str, Any]] = []
        for each in (*self.found.parameters, self.found.left):
            began = 0.5 * (each.limits[:, 0] + each.limits[:, 1])
            far = (each.values - began) / each.deviation
            shown = [float(value) if np.isfinite(value) else None for value in far]
            trace = {"type": "scatter", "mode": "lines+markers", "x": _days(self.found), "y": shown}
            data.append({**trace, "name": title_of(each), **({} if each.moved else {"opacity": 0.35})})
        return figure_of({"data": data, "layout": {"yaxis": {"title": {"text": "standard deviations"}}}})

    def _content(self) -> Mapping[str, Any]:
        found = self.found
        recordings = [
            {
                "date": each.date.isoformat(),
                "file": PurePath(each.file).name,
                **fields(each, "name", "rows", "rows_left_out=left_out", "rms_left_mm=rms"),
            }
            for each in found.recordings
        ]
        return {
            "arm": found.arm.name,
            "sentence": self.sentence,
            "recordings": recordings,
            "alarms": [_alarm(found, each, change) for each in found.moved for change in each.changes],
            "parameters": [_watched(found, each) for each in found.parameters],
            "left": _watched(found, found.left),
            "not_watched": [fields(each, "effect", "at", "why") for each in found.unwatched],
            "verdict": None if found.together is None else found.together.verdict,
            "diagnosed_together": [_days(found)[k] for k in found.searched],
            "false_alarm": fields(found.rules, "chance=false_alarm", "over_recordings=over"),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"What moved": self.alarms} if self.moved else {}


def _named(each: Watched) -> dict[str, Any]:
    own = each.parameter
    effect = None if own.name == LEFT else own.effect
    return {"effect": effect, "at": list(own.at), "parameter": own.name, "unit": unit_of(own.kind)}


def _alarm(found: Found, each: Watched, change: Moved) -> dict[str, Any]:
    kind, days = each.parameter.kind, _days(found)
    last = change.last if change.kind == "step" else change.first
    until = len(days) - 1 if change.kind == "drift" else change.first
    rates = change.rate_interval
    return {
        **_named(each),
        "kind": change.kind,
        "from": days[last],
        "to": days[until],
        "earliest": days[_early(change)],
        "latest": days[change.latest],
        "change": in_unit(change.size, kind),
        "ci95": [in_unit(end, kind) for end in change.interval],
        "per_day": None if change.rate is None else in_unit(change.rate, kind),
        "per_day_ci95": None if rates is None else [in_unit(end, kind) for end in rates],
        "told": days[change.told],
        "p_value": change.p_value,
    }


def _watched(found: Found, each: Watched) -> dict[str, Any]:
    def told(value: float) -> float | None:
        return in_unit(float(value), each.parameter.kind)

    values = [
        {
            "date": day,
            "value": told(each.values[k]),
            "standard_error": told(each.errors[k]),
            "ci95": [told(end) for end in each.intervals[k]],
            "level": told(each.level[k]),
            "limits": [told(end) for end in each.limits[k]],
        }
        for k, day in enumerate(_days(found))
    ]
    return {
        **_named(each),
        "found": each.parameter.found,
        "moved": each.moved,
        "values": values,
        "standard_deviation": told(each.deviation),
        "between_recordings": told(each.between),
        "smallest_step": told(each.smallest_step),
    }


def read_dated(
    recordings: Sequence[Recording | File | pd.DataFrame], arm: Arm, settings: File | Sequence[File] | None = None
) -> list[Recording]:
    """Recordings of one arm, at least three, each with a date of its own. Raises `InputError`."""
    if len(recordings) < _FEWEST:
        message = f"a watch needs {_FEWEST} recordings or more, not {len(recordings)}; `compare` takes two"
        raise InputError("", "recordings", message)
    read = each_with_settings(recordings, arm, settings)
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
