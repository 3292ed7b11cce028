"""A watch over dated recordings described: what moved and when, in a sentence first."""

from __future__ import annotations

import math
from pathlib import PurePath

from linkwright.core.diagnose.watch.watch import LEFT, Moved, Watch, Watched
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

from .words import effect_words, listed, place_words, probability, quantity

_WEEK, _YEAR = 7.0, 365.25
_LONG = 2.0 * _YEAR


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


def _pace(found: Watch) -> tuple[float, str]:
    days = (found.recordings[-1].date - found.recordings[0].date).days
    return (_YEAR, "a year") if days > _LONG else (_WEEK, "a week")


def when_words(found: Watch, change: Moved) -> str:
    """When a parameter changed: `between 2026-05-09 and 2026-05-16`."""
    days = [each.date.isoformat() for each in found.recordings]
    if change.kind == "step":
        return f"between {days[change.last]} and {days[change.first]}"
    return f"on {days[change.first]} alone" if change.kind == "once" else f"since {days[change.first]}"


def change_words(found: Watch, each: Watched, change: Moved) -> str:
    """A change as a phrase."""
    if change.kind == "drift" and change.rate is not None:
        per, words = _pace(found)
        by = f"{amount_words(each, per * change.rate, signed=True)} {words}"
        return f"{title_of(each)} by {by} {when_words(found, change)}"
    return f"{title_of(each)} by {amount_words(each, change.size, signed=True)} {when_words(found, change)}"


def watch_sentence(found: Watch) -> str:
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
        days = [each.date.isoformat() for each in found.recordings]
        of = f"{len(known)} parameters" if len(known) != 1 else "one parameter"
        return f"Nothing moved beyond chance: {of} over {len(days)} recordings, {days[0]} to {days[-1]}."
    if quiet:
        parts.append(f"Nothing else moved beyond chance ({quiet} watched).")
    return " ".join(parts)


def describe(found: Watch) -> Description:
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


def _chart(found: Watch, each: Watched) -> str:
    changes = [change_words(found, each, change) for change in each.changes]
    return chart(found, each, title_of(each), changes, large=each.moved)


def _quiet(found: Watch) -> str:
    """Small charts of what did not move, as far as a recording shows it."""
    known = [x for x in (*found.parameters, found.left) if not x.moved and any(map(math.isfinite, x.values))]
    return element("div", *(_chart(found, each) for each in known), class_="multiples") if known else ""


def _shown(each: Watched) -> bool:
    """Whether any of the recordings shows a parameter: of others nobody knows whether they moved."""
    return any(math.isfinite(value) for value in each.level)


def _moves(found: Watch) -> Table:
    days = [each.date.isoformat() for each in found.recordings]
    rows: list[tuple[Cell, ...]] = []
    for each in found.moved:
        for change in each.changes:
            early = days[max(change.earliest - 1, 0) if change.kind == "step" else change.earliest]
            sure = "" if change.kind == "once" else f"{early} to {days[change.latest]}"
            by, ends = change.size, change.interval
            unit = ""
            if change.kind == "drift" and change.rate is not None and change.rate_interval is not None:
                per, unit = _pace(found)
                by, ends = per * change.rate, (per * change.rate_interval[0], per * change.rate_interval[1])
                unit = f" {unit}"
            rows.append(
                (
                    title_of(each),
                    {"step": "moved", "once": "off once", "drift": "drifts"}[change.kind],
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


def _parameters(found: Watch) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for each in (*found.parameters, found.left):
        level = [float(value) for value in each.level if math.isfinite(value)]
        ends = (level[0], level[-1]) if level else (math.nan, math.nan)
        kinds = sorted({change.kind for change in each.changes})
        said = listed([{"step": "moved", "once": "off once", "drift": "drifts"}[kind] for kind in kinds])
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


def _recordings(found: Watch) -> Table:
    rows = [
        (each.date.isoformat(), PurePath(each.file).name, count(each.rows), count(each.left_out), length(each.rms, 3))
        for each in found.recordings
    ]
    return table(("date", "file", "readings", "left out", "left unexplained, RMS"), rows)


def _values(found: Watch, each: Watched) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for k, one in enumerate(found.recordings):
        figures = (each.values[k], *each.intervals[k], each.level[k], *each.limits[k])
        rows.append((one.date.isoformat(), *(Value(amount_words(each, float(value), 4)) for value in figures)))
    headings = ("date", "value", "95 % from", "to", "level", "limits from", "to")
    return table(headings, rows, title=title_of(each), folded=True)


def _rests_on(found: Watch) -> tuple[str, ...]:
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
        own = [each for each in found.unwatched if each.why == why]
        named = [effect_title(each.effect) + _place(each.effect, each.at) for each in own]
        lines.append(f"Not watched: {listed(named)}: {why}.")
    return tuple(lines)


def _place(effect: str, at: tuple[int, ...]) -> str:
    place = place_words(effect, at)
    return f" ({place})" if place else ""
