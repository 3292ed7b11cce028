"""A watch described: what moved and when, each parameter, each recording, and what that rests on."""

from __future__ import annotations

import math
from pathlib import PurePath
from types import MappingProxyType

from linkwright.core.diagnose.answer.detectable import POWER
from linkwright.core.diagnose.watch.watch import LEFT, SOON, Moved, Watched
from linkwright.core.diagnose.watch.watch import Watch as WatchResult
from linkwright.core.units.lists import listed
from linkwright.report.charts.control import chart
from linkwright.report.pictures.svg import element
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
from linkwright.results.motion.words import torque

from .words import effect_words, probability, quantity

_WEEK, _YEAR = 7.0, 365.25
_LONG = 2.0 * _YEAR
_KINDS = MappingProxyType({"step": "moved", "once": "off once", "drift": "drifts"})


def days_of(result: WatchResult) -> list[str]:
    """The dates of the recordings."""
    return [recording.date.isoformat() for recording in result.recordings]


def title_of(each: Watched) -> str:
    """What a parameter is called: `compliance of the drives (joint 2): compliance`."""
    parameter = each.parameter
    if parameter.name == LEFT:
        return "what is left unexplained"
    title = effect_words(parameter.effect, parameter.at)
    name = parameter.name.replace("_", " ")
    return title if name in effect_title(parameter.effect).split() else f"{title}: {name}"


def amount_words(each: Watched, value: float, digits: int = 3, *, signed: bool = False) -> str:
    """A value of a parameter with its unit, the same unit for all values of the parameter."""
    words = quantity(value, each.parameter.kind, digits, _like(each))
    return f"+{words}" if signed and value > 0.0 and math.isfinite(value) else words


def _level(watched: Watched, value: float) -> str:
    """A level to a tenth of what one recording scatters by."""
    if not (math.isfinite(value) and value != 0.0 and watched.deviation > 0.0):
        return amount_words(watched, value)
    finer = math.floor(math.log10(abs(value))) - math.floor(math.log10(watched.deviation))
    return amount_words(watched, value, min(7, max(1, finer + 2)))


def _like(watched: Watched) -> float | None:
    known = [abs(float(value)) for value in watched.values if math.isfinite(value)]
    return max(known, default=0.0) or None


def _span(watched: Watched, ends: tuple[float, float]) -> str:
    low, high = (amount_words(watched, end) for end in ends)
    return f"{low.rpartition(' ')[0] if ' ' in low else low} to {high}"


def _pace(result: WatchResult) -> tuple[float, str]:
    days = (result.recordings[-1].date - result.recordings[0].date).days
    return (_YEAR, "a year") if days > _LONG else (_WEEK, "a week")


def when_words(result: WatchResult, change: Moved) -> str:
    """When a parameter changed: `between 2026-05-09 and 2026-05-16`."""
    days = days_of(result)
    if change.kind == "step":
        return f"between {days[change.last]} and {days[change.first]}"
    return f"on {days[change.first]} alone" if change.kind == "once" else f"since {days[change.first]}"


def before_change(change: Moved) -> int:
    """The recording before which nothing had changed yet."""
    return max(change.earliest - 1, 0) if change.kind == "step" else change.earliest


def change_words(result: WatchResult, each: Watched, change: Moved) -> str:
    """A change as a phrase."""
    if change.kind == "drift" and change.rate is not None:
        per, words = _pace(result)
        by = f"{amount_words(each, per * change.rate, signed=True)} {words}"
        return f"{title_of(each)} by {by} {when_words(result, change)}"
    by = f"{amount_words(each, change.size, signed=True)}{_relative(result, each, change)}"
    return f"{title_of(each)} by {by} {when_words(result, change)}"


def _relative(result: WatchResult, watched: Watched, change: Moved) -> str:
    """A step of what drives give as a share of what it was before: friction is a figure that has a zero."""
    before = float(watched.level[change.last])
    if not result.of_motion or change.kind != "step" or not abs(before) > 0.0:
        return ""
    share = change.size / abs(before)
    return f" ({'+' if share > 0.0 else ''}{percent(share)})"


def watch_sentence(result: WatchResult) -> str:
    """What moved and when, plainly."""
    verbs = {"step": "Moved", "drift": "Drifts", "once": "Off once"}
    parts: list[str] = []
    for kind, words in verbs.items():
        clauses = [change_words(result, e, c) for e in result.moved for c in e.changes if c.kind == kind]
        if clauses:
            parts.append(f"{words}: {'; '.join(clauses)}.")
    known = [parameter for parameter in result.parameters if _shown(parameter)]
    quiet = len(known) + int(_shown(result.left)) - len(result.moved)
    if not parts:
        days = days_of(result)
        of = f"{len(known)} parameters" if len(known) != 1 else "one parameter"
        return f"Nothing moved beyond chance: {of} over {len(days)} recordings, {days[0]} to {days[-1]}."
    if quiet:
        parts.append(f"Nothing else moved beyond chance ({quiet} watched).")
    return " ".join(parts)


def describe(result: WatchResult) -> Description:
    """The watch: what moved, each parameter, each recording."""
    sentence = watch_sentence(result)
    items: list[Item] = []
    if result.moved:
        lead = (
            "Dots are what each recording says, with its 95 % interval. The line is the level. The band is where one "
            "recording lies as long as the parameter stays as it began. Red: the change, and the dates between which "
            "the parameter changed."
        )
        moved = Picture(lambda: "".join(_chart(result, item) for item in result.moved))
        items.append(section("What moved", moved, _moves(result), lead=lead))
    items.append(section("Each parameter", _parameters(result), Picture(lambda: _quiet(result))))
    items.append(section("Recordings", _recordings(result), detail=True))
    items.append(
        section("Values", *(_values(result, parameter) for parameter in (*result.parameters, result.left)), detail=True)
    )
    items.append(section("What it rests on", Lines(_rests_on(result))))
    name = result.arm.name
    brief = sentence.split(". ")[0].rstrip(".")
    return Description(f"{name}: watched over {len(result.recordings)} recordings", sentence, tuple(items), brief)


def _chart(result: WatchResult, watched: Watched) -> str:
    changes = [change_words(result, watched, change) for change in watched.changes]
    return chart(result, watched, title_of(watched), changes, large=watched.moved)


def _quiet(result: WatchResult) -> str:
    """Small charts of what did not move, as far as a recording shows it."""
    known = [x for x in (*result.parameters, result.left) if not x.moved and any(map(math.isfinite, x.values))]
    return element("div", *(_chart(result, item) for item in known), class_="multiples") if known else ""


def _shown(watched: Watched) -> bool:
    """Whether any of the recordings shows a parameter: of others nobody knows whether they moved."""
    return any(math.isfinite(value) for value in watched.level)


def _moves(result: WatchResult) -> Table:
    days = days_of(result)
    rows: list[tuple[Cell, ...]] = []
    for item in result.moved:
        for change in item.changes:
            sure = "" if change.kind == "once" else f"{days[before_change(change)]} to {days[change.latest]}"
            by, ends = change.size, change.interval
            unit = ""
            if change.kind == "drift" and change.rate is not None and change.rate_interval is not None:
                per, unit = _pace(result)
                by, ends = per * change.rate, (per * change.rate_interval[0], per * change.rate_interval[1])
                unit = f" {unit}"
            rows.append(
                (
                    title_of(item),
                    _KINDS[change.kind],
                    when_words(result, change),
                    Value(f"{amount_words(item, by, signed=True)}{unit}"),
                    Value(_span(item, ends)),
                    sure,
                    days[change.detected],
                    probability(change.p_value),
                )
            )
    headings = ("what", "", "when", "by", "95 % interval", Column("date, 95 %", detail=True), "told on", "p")
    return table(headings, rows)


def _parameters(result: WatchResult) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for parameter in (*result.parameters, result.left):
        level = [float(value) for value in parameter.level if math.isfinite(value)]
        ends = (level[0], level[-1]) if level else (math.nan, math.nan)
        kinds = sorted({change.kind for change in parameter.changes})
        text = listed([_KINDS[kind] for kind in kinds])
        rows.append(
            (
                title_of(parameter),
                Value(_level(parameter, ends[0])),
                Value(_level(parameter, ends[1])),
                Value(amount_words(parameter, parameter.deviation, 2)),
                Value(amount_words(parameter, parameter.between, 2)),
                Value(amount_words(parameter, parameter.smallest_step, 2)),
                text or ("noise" if level else "not shown"),
            )
        )
    beyond = Column("of it between recordings", detail=True)
    headings = ("what", "level, first", "last", "one recording scatters by", beyond, "step told soon", "")
    return table(headings, rows)


def _recordings(result: WatchResult) -> Table:
    rows = [
        (
            recording.date.isoformat(),
            PurePath(recording.file).name,
            count(recording.rows),
            count(recording.left_out),
            torque(recording.rms) if result.of_motion else length(recording.rms, 3),
        )
        for recording in result.recordings
    ]
    return table(("date", "file", "readings", "set aside", "left unexplained, RMS"), rows)


def _values(result: WatchResult, watched: Watched) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for k, one in enumerate(result.recordings):
        figures = (watched.values[k], *watched.intervals[k], watched.level[k], *watched.limits[k])
        rows.append((one.date.isoformat(), *(Value(amount_words(watched, float(value), 4)) for value in figures)))
    headings = ("date", "value", "95 % from", "to", "level", "limits from", "to")
    return table(headings, rows, title=title_of(watched), folded=True)


def _rests_on(result: WatchResult) -> tuple[str, ...]:
    rules = result.rules
    lines = [
        f"{percent(rules.false_alarm)} chance of any false alarm over {rules.over} quiet recordings, all parameters "
        "together and looked at after each of them.",
        f"A step told soon is the least that {SOON} further recordings would tell (power {percent(POWER)}).",
    ]
    if result.searched and len(result.searched) < len(result.recordings):
        days = listed([result.recordings[k].date.isoformat() for k in result.searched])
        lines.append(f"What there is to watch was found in the recordings of {days} together.")
    if result.together is not None and result.together.verdict == "unknown":
        lines.append(
            "Together the recordings hold a mismatch that nothing explains. The mismatch is in the remainder of each."
        )
    for why in dict.fromkeys(item.why for item in result.unwatched):
        named = [effect_words(item.effect, item.at) for item in result.unwatched if item.why == why]
        lines.append(f"Not watched: {listed(named)}: {why}.")
    return tuple(lines)
