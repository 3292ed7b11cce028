"""Control charts of a watch, one for each parameter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import timedelta

import numpy as np

from linkwright.core.diagnose.watch.watch import Watch, Watched
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity
from linkwright.report.pictures.svg import Plot, course, dots, element, label, line, path, spanned, text
from linkwright.results.diagnoses.words import whole_sentence

_TEXT = 12.0
_LARGE, _SMALL = (760.0, 240.0), (300.0, 150.0)
_TICKS = 5


def chart(result: Watch, each: Watched, title: str, changes: Sequence[str], *, large: bool) -> str:
    """A control chart: what each recording says with its interval, the level, the band of quiet recordings, and red
    where it changed; `title` says of what, `changes` what changed."""
    days = [one.date for one in result.recordings]
    when = np.array([float((day - days[0]).days) for day in days])
    factor, unit = _unit(each)
    shown = np.isfinite(each.values)
    low, high = factor * each.limits[:, 0], factor * each.limits[:, 1]
    value, level = factor * each.values, factor * each.level
    # An interval that is far wider than all others shall not flatten the picture.
    reach = factor * np.clip(each.intervals, np.nanmin(each.values) - 3.0 * _width(each), None)
    every = np.concatenate([value, low, high, level])
    span = float(when[-1] - when[0])
    plot = Plot(*(_LARGE if large else _SMALL), (-0.03 * span, 1.03 * span), spanned(every), left=66.0, right=34.0)
    parts: list[str] = []
    if np.isfinite(low).any():
        place = np.flatnonzero(np.isfinite(low))
        x = plot.x(when[place])
        ring = [*zip(x, plot.y(high[place]), strict=True), *zip(x[::-1], plot.y(low[place])[::-1], strict=True)]
        parts.append(path([ring], "band"))
    foot = plot.top + plot.height
    step = max(1, math.ceil(span / _TICKS))
    for tick in range(0, int(span) + 1, step):
        x_ = float(plot.x(np.array(float(tick))))
        parts.append(line((x_, plot.top), (x_, foot), "axis", 1.0))
        parts.append(label(x_, foot + 15.0, _TEXT, _day(result, tick)))
    for change in each.changes:
        time = when[change.first] if change.kind != "step" else 0.5 * (when[change.last] + when[change.first])
        early = when[max(change.earliest - 1, 0)] if change.kind == "step" else when[change.earliest]
        ends = [float(plot.x(np.array(v))) for v in (early, when[change.latest])]
        x_ = float(plot.x(np.array(time)))
        parts.append(line((x_, plot.top), (x_, foot), "error-line", 1.6))
        parts.append(line((ends[0], foot - 4.0), (ends[1], foot - 4.0), "error-line", 5.0))
    for k in np.flatnonzero(shown).tolist():
        x_ = float(plot.x(when[k : k + 1])[0])
        top, bottom = (float(np.clip(y, plot.top, foot)) for y in plot.y(reach[k, ::-1]))
        parts.append(line((x_, top), (x_, bottom), "rule", 1.0))
    parts += [course(*_drawn(plot, each, level, when), "after")]
    outside = shown & ~((value >= low) & (value <= high))
    parts.append(dots(plot.x(when[shown & ~outside]), plot.y(value[shown & ~outside]), "before"))
    parts += [
        element("circle", cx=float(a), cy=float(b), r=3.2, class_="tip")
        for a, b in zip(plot.x(when[outside]), plot.y(value[outside]), strict=True)
    ]
    said = "; ".join(changes)
    names = ("", f"in {unit}" if unit else "")
    about = f"{title} over the recordings" + (f": {said}" if said else ": nothing but noise")
    drawn = plot.drawn(about, names, *parts, ticks=())
    caption = element("figcaption", element("strong", text(whole_sentence(title)[:-1])), text(_after(title, said)))
    return element("figure", caption, drawn)


def _after(title: str, said: str) -> str:
    return "" if not said else f": {said.removeprefix(title).replace('; ' + title, '; ').strip()}"


def _width(watched: Watched) -> float:
    return (
        float(np.nanmax(watched.limits[:, 1] - watched.limits[:, 0])) if np.isfinite(watched.limits).any() else math.inf
    )


def _drawn(plot: Plot, watched: Watched, level: Array, when: Array) -> tuple[Array, Array]:
    """The level as a line, upright where it steps."""
    known = np.flatnonzero(np.isfinite(level))
    jumps = {change.first for change in watched.changes if change.kind == "step"}
    x: list[float] = []
    y: list[float] = []
    for before, k in zip([-1, *known[:-1].tolist()], known.tolist(), strict=True):
        if k in jumps and before >= 0:
            x += [0.5 * float(when[before] + when[k])] * 2
            y += [float(level[before]), float(level[k])]
        x.append(float(when[k]))
        y.append(float(level[k]))
    return plot.x(np.array(x)), plot.y(np.array(y))


def _day(result: Watch, days: int) -> str:
    return (result.recordings[0].date + timedelta(days=days)).isoformat()


def _unit(watched: Watched) -> tuple[float, str]:
    """What turns SI into the unit of the chart, and the unit."""
    like = float(np.nanmax(np.abs(watched.values))) or 1.0
    unit = format_quantity(like, watched.parameter.kind).partition(" ")[2]
    one = format_quantity(1.0, watched.parameter.kind, unit or None, 12).partition(" ")[0]
    return float(one), unit.replace("*", "·").replace("^2", "²")
