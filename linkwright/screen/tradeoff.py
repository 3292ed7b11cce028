"""A trade-off on the screen: progress while it is traced, then the front, its ends, its knee and its steps."""

from __future__ import annotations

import time
from collections.abc import Sequence

from rich.console import Console
from rich.status import Status
from rich.table import Table

from linkwright.words import figure, percent
from optimize.tradeoff_question import Axis
from optimize.tradeoff_result import Front, Point, Tradeoff
from optimize.tradeoff_trace import Progress

from .console import console, table
from .optimization import names_words

MOST_ROWS = 25
_LINE_EVERY = 5.0
_PATIENCE = 2.0


class TracingProgress:
    """How far the front has come: a status line on a terminal, a line now and then elsewhere."""

    def __init__(self, out: Console, *, groups: bool) -> None:
        """`out` takes the lines where there is no terminal; `groups`: fronts have names of their own."""
        self._out, self._screen, self._groups = out, console(errors=True), groups
        self._began = self._said = time.monotonic()
        self._status: Status | None = None

    def __call__(self, progress: Progress) -> None:
        """Show it."""
        now = time.monotonic()
        if now - self._began < _PATIENCE:
            return
        if self._screen.is_terminal:
            if self._status is None:
                self._status = self._screen.status("")
                self._status.start()
            self._status.update(self._words(progress))
        elif now - self._said >= _LINE_EVERY:
            self._said = now
            self._out.print(self._words(progress), soft_wrap=True)

    def _words(self, progress: Progress) -> str:
        name = f"{progress.front}: " if self._groups else ""
        off = "" if progress.error is None else f", straight lines right within {percent(progress.error)}"
        known = f" ({progress.resumed} from the journal)" if progress.resumed else ""
        return f"{name}{progress.points} points{known}{off}: {progress.doing}"

    def close(self) -> None:
        """Take the line away."""
        if self._status is not None:
            self._status.stop()
            self._status = None


def shown(axis: Axis, value: float, digits: int = 4) -> str:
    """A value (SI) of an axis with its unit."""
    return f"{figure(axis.factor * value, digits)} {axis.unit}"


def slope_factor(result: Tradeoff) -> tuple[float, str]:
    """What one SI unit of the slope dy/dx is in the unit people read, and that unit."""
    x, y = result.asked.x, result.asked.y
    return y.factor / x.factor, f"{y.unit}/{x.unit}"


def ends_words(result: Tradeoff, front: Front) -> list[str]:
    """Where the front ends, and why."""
    x, y = result.asked.x, result.asked.y
    points = result.of(front)
    first, last = points[0], points[-1]
    least, most = ("most", "less") if x.more_is_better else ("least", "more")
    lines = [
        f"{least} {x.title}: {shown(x, first.x)}, with {y.title} {shown(y, first.y)}; no design found goes further",
    ]
    best = "most" if y.more_is_better else "least"
    why = f"the problem allows no {most} {x.title}" if front.capped else f"{most} {x.title} buys nothing"
    if len(points) > 1:
        lines.append(f"{best} {y.title}: {shown(y, last.y)}, with {x.title} {shown(x, last.x)}; {why}")
    else:
        lines.append("one design is best in both, so there is nothing to trade")
    return lines


def gap_words(result: Tradeoff, front: Front) -> list[str]:
    """Steps, idle stretches and failures in sentences."""
    x, y = result.asked.x, result.asked.y
    more = "less" if x.more_is_better else "more"
    lines: list[str] = []
    for left, right in front.steps:
        one, other = result.points[left - 1], result.points[right - 1]
        lines.append(
            f"step: between {shown(x, one.x, 5)} and {shown(x, other.x, 5)} {y.title} goes from {shown(y, one.y)} to "
            f"{shown(y, other.y)}"
        )
    lines += [
        f"idle: from {shown(x, start)} to {shown(x, end)} {more} {x.title} buys nothing" for start, end in front.idle
    ]
    lines += [f"not solved: at {shown(x, value)} the solver found no design" for value in front.failed]
    if not front.complete:
        lines.append("the refinement was given up at its limit of points: some straight lines are further off")
    if not front.exhaustive:
        lines.append("there are too many combinations to try all: the search went link by link")
    return lines


def knee_words(result: Tradeoff, front: Front) -> str:
    """Where the knee is."""
    if front.knee is None:
        return "no knee: no point lies on the better side of the chord between the ends"
    point = result.points[front.knee - 1]
    x, y = result.asked.x, result.asked.y
    return f"knee: point {point.number}, {x.title} {shown(x, point.x)}, {y.title} {shown(y, point.y)}"


def price_words(result: Tradeoff, point: Point) -> str:
    """The price at a point: what one unit more of x does to y."""
    if point.slope is None:
        return "–"
    factor, unit = slope_factor(result)
    return f"{figure(factor * point.slope, 3)} {unit}"


def show_tradeoff(out: Console, result: Tradeoff) -> None:
    """Print a trade-off."""
    x, y = result.asked.x, result.asked.y
    out.print()
    out.print(f"{result.asked.given.arm.name}: {y.title} against {x.title}", style="bold")
    for front in result.fronts if len(result.fronts) > 1 else ():
        points = result.of(front)
        reach = f"{shown(x, points[0].x)} to {shown(x, points[-1].x)}"
        span = f"{y.title} {shown(y, points[0].y)} to {shown(y, points[-1].y)}"
        out.print(f"  {front.name}: {len(points)} points, {x.title} {reach}, {span}", soft_wrap=True)
    for name, reason in result.without:
        out.print(f"  {name}: {reason}", soft_wrap=True)
    for line in [*ends_words(result, result.envelope), *gap_words(result, result.envelope)]:
        out.print(f"  {line}", soft_wrap=True)
    out.print(f"  {knee_words(result, result.envelope)}", soft_wrap=True)
    out.print()
    out.print(_points(result))
    out.print()
    out.print(effort_words(result), soft_wrap=True)


def effort_words(result: Tradeoff) -> str:
    """How much was solved, how long it took, and how right the straight lines are."""
    known = f", {result.resumed} of them from the journal" if result.resumed else ""
    count = result.solved + result.resumed
    lines = f"straight lines between points were right within {percent(result.envelope.error)} half-way"
    return f"{count} points solved{known} in {figure(result.seconds, 3)} s; {lines}"


def _points(result: Tradeoff) -> Table:
    x, y = result.asked.x, result.asked.y
    points = result.of(result.envelope)
    names = len(result.fronts) > 1
    factor, unit = slope_factor(result)
    heads = ["", f"{x.title} in {x.unit}", f"{y.title} in {y.unit}", f"price in {unit}"]
    # What there is a front for each of stands under the front's name.
    heads += [name for name, by in (("shapes", "shape"), ("materials", "material")) if by != result.asked.by]
    made = table(*heads, *(("front",) if names else ()), numbers=(0, 1, 2, 3), title="the front")
    for point in spread(points, MOST_ROWS, result.envelope.knee):
        mark = f"{point.number}{' knee' if point.number == result.envelope.knee else ''}"
        price = None if point.slope is None else factor * point.slope
        cells = [mark, figure(x.factor * point.x), figure(y.factor * point.y), figure(price, 3)]
        cells += [names_words(point.shapes)] if result.asked.by != "shape" else []
        cells += [names_words(point.materials)] if result.asked.by != "material" else []
        made.add_row(*cells, *((point.front,) if names else ()))
    if len(points) > MOST_ROWS:
        made.caption = f"{MOST_ROWS} of {len(points)} points; all of them are in the CSV and JSON files"
        made.caption_justify = "left"
    return made


def spread(points: Sequence[Point], most: int, always: int | None) -> list[Point]:
    """At most so many of the points, spread evenly, both ends and the point of number `always` among them."""
    if len(points) <= most:
        return list(points)
    chosen = {round(k * (len(points) - 1) / (most - 1)) for k in range(most)}
    near = [k for k, point in enumerate(points) if point.number == always]
    for k in near:
        chosen = (chosen - {min(chosen - {0, len(points) - 1}, key=lambda each: abs(each - k))}) | {k}
    return [points[k] for k in sorted(chosen)]
