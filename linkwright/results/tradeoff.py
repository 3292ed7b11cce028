"""A trade-off described: the front with its ends, knee, steps and price, and every point of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from linkwright.core.optimize.tradeoff.front import Front, Point, Tradeoff
from linkwright.core.optimize.tradeoff.question import Axis
from linkwright.report.charts import fronts
from linkwright.report.charts.fronts import picture_words, price_words, shown, slope_factor

from .combinations import names_words
from .design import settings
from .document import (
    Cell,
    Description,
    Fact,
    Facts,
    Item,
    Paragraph,
    Picture,
    Table,
    Value,
    count,
    number,
    section,
    table,
)
from .figures_in_words import lasted, load_case_words, percent, workspace_words

MOST_ROWS = 25
_KNEE = "the point farthest from the chord between the ends, both axes scaled from 0 to 1 as drawn"
_POINT = "Point at a design for its figures. Its number names its arm file. Names in the legend switch fronts off."


def describe(result: Tradeoff) -> Description:
    """The fronts and their envelope."""
    x, y = result.asked.x, result.asked.y
    name = result.asked.given.arm.name
    each = [_front_words(result, front) for front in result.fronts] if len(result.fronts) > 1 else []
    without = [f"{front}: {reason}" for front, reason in result.without]
    sentences = [*ends_words(result, result.envelope), *gap_words(result, result.envelope)]
    sentences += [knee_words(result, result.envelope)]
    price = (
        f"The slope of the front, from the multiplier of the limit on {x.title}: what one {x.unit or 'unit'} more does "
        f"to {y.title}. Its size is drawn."
    )
    ends = "Where the front ends, and where it jumps or rests."
    items: list[Item] = [
        Facts(_facts(result), detail=True),
        *(Paragraph(line, "under") for line in (*each, *without)),
        *([] if result.start is None else [Paragraph(result.start, "warning")]),
        *unreached_words(result),
        section("The front", Picture(lambda: fronts.front(result)), lead=_POINT, detail=True),
        section("Ends, steps and idle stretches", *(Paragraph(line, "under") for line in sentences), lead=ends),
        section("The price along the front", Picture(lambda: fronts.price(result)), lead=price, detail=True),
        section("Points", _points(result)),
        section("How it was found", Paragraph(effort_words(result))),
        section("The problem as solved", settings(_problem(result)), detail=True),
    ]
    headline = f"{y.title} against {x.title}"
    envelope = result.of(result.envelope)
    brief = f"{headline}, {len(envelope)} points"
    title = f"{name}: {headline}"
    return Description(title, picture_words(result), tuple(items), brief)


def _front_words(result: Tradeoff, front: Front) -> str:
    x, y = result.asked.x, result.asked.y
    points = result.of(front)
    reach = f"{shown(x, points[0].x)} to {shown(x, points[-1].x)}"
    span = f"{y.title} {shown(y, points[0].y)} to {shown(y, points[-1].y)}"
    return f"{front.name}: {len(points)} points, {x.title} {reach}, {span}"


def unreached_words(result: Tradeoff) -> list[Paragraph]:
    """What of a box or path designs of the front do not reach."""
    shares = [point.unreached_share for point in result.points if point.unreached_share > 0.0]
    if not shares:
        return []
    least, most = percent(min(shares)), percent(max(shares))
    part = least if least == most else f"{least} to {most}"
    who = "any point" if len(shares) == len(result.points) else f"{len(shares)} of {len(result.points)} points"
    kind = result.asked.given.workspace.kind
    text = f"{part} of the {kind} is not reached by {who}: the figures there, certified ones too, are of the rest"
    return [Paragraph(text, "warning")]


def _facts(result: Tradeoff) -> tuple[Fact, ...]:
    x, y = result.asked.x, result.asked.y
    points = result.of(result.envelope)
    first, last = points[0], points[-1]
    facts = [
        Fact(f"{_best(x)} {x.title}", Value(shown(x, first.x)), f"{y.title} {shown(y, first.y)}"),
        Fact(f"{_best(y)} {y.title}", Value(shown(y, last.y)), f"{x.title} {shown(x, last.x)}"),
    ]
    if result.envelope.knee is not None:
        knee = result.points[result.envelope.knee - 1]
        facts.append(Fact(f"knee (point {knee.number})", Value(shown(x, knee.x)), shown(y, knee.y)))
        price = Value(price_words(result, knee))
        facts.append(Fact("price at the knee", price, f"for one {x.unit or 'unit'} more"))
    return (*facts, Fact("points", count(len(result.points)), f"{len(points)} of them on the envelope"))


def _best(axis: Axis) -> str:
    return "most" if axis.more_is_better else "least"


def _points(result: Tradeoff) -> Table:
    """The points of the envelope, best in x first, and then those that only a front of its has."""
    x, y = result.asked.x, result.asked.y
    envelope = result.of(result.envelope)
    numbers = {point.number for point in envelope}
    points = [*envelope, *(point for point in result.points if point.number not in numbers)]
    grouped = len(result.fronts) > 1
    factor, unit = slope_factor(result)
    rows: list[list[Cell]] = []
    for point in points:
        mark = f"{point.number}{' knee' if point.number == result.envelope.knee else ''}"
        price = None if point.slope is None else factor * point.slope
        row: list[Cell] = [Value(mark), number(x.factor * point.x), number(y.factor * point.y), number(price, 3)]
        # What there is a front for each of stands under the front's name.
        row += [names_words(point.shapes)] if result.asked.by != "shape" else []
        row += [names_words(point.materials)] if result.asked.by != "material" else []
        rows.append([*row, *([point.front] if grouped else [])])
    headings = ["", x.heading, y.heading, f"price in {unit}" if unit else "price"]
    headings += [name for name, by in (("shapes", "shape"), ("materials", "material")) if by != result.asked.by]
    headings += ["front"] if grouped else []
    listed = {point.number for point in spread(envelope, MOST_ROWS, result.envelope.knee)}
    brief = tuple(k for k, point in enumerate(points) if point.number in listed)
    rest = f"{MOST_ROWS} of {len(envelope)} points; all of them are in the CSV and JSON files"
    more = rest if len(envelope) > MOST_ROWS else ""
    return table(headings, rows, title="the front", brief=brief if len(brief) < len(points) else None, rest=more)


def _problem(result: Tradeoff) -> list[tuple[str, str]]:
    given = result.asked.given
    rows = [("problem file", PurePath(given.file).name), ("workspace", workspace_words(given.arm, given.workspace))]
    rows += [(f"load case {k}", load_case_words(case)) for k, case in enumerate(given.load_cases, start=1)]
    rows += [("subject to" if k == 0 else "", limit.text) for k, limit in enumerate(given.limits)]
    for axis, name in ((result.asked.x, "x"), (result.asked.y, "y")):
        rows.append((name, f"{axis.title}; {'more' if axis.more_is_better else 'less'} is better"))
    return [*rows, ("knee", f"{_KNEE} (Das 1999, doi:10.1007/BF01195985)")]


def ends_words(result: Tradeoff, front: Front) -> list[str]:
    """Where the front ends, and why."""
    x, y = result.asked.x, result.asked.y
    points = result.of(front)
    first, last = points[0], points[-1]
    least, less, most = ("most", "more", "less") if x.more_is_better else ("least", "less", "more")
    further = "This is the lightest design found." if x.name == "mass" else f"No design found has {less} {x.title}."
    lines = [f"{least} {x.title}: {shown(x, first.x)}, with {y.title} {shown(y, first.y)}. {further}"]
    best = "most" if y.more_is_better else "least"
    why = (
        f"The problem allows no {most} {x.title}." if front.capped else f"{most.capitalize()} {x.title} does not help."
    )
    if len(points) > 1:
        lines.append(f"{best} {y.title}: {shown(y, last.y)}, with {x.title} {shown(x, last.x)}. {why}")
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
        f"idle: from {shown(x, start)} to {shown(x, end)} {more} {x.title} does not help" for start, end in front.idle
    ]
    lines += [f"not solved: at {shown(x, value)} the solver found no design" for value in front.failed]
    if not front.complete:
        lines.append("the refinement did not come to its end: some straight lines are further off")
    if front.undecided:
        points = "one point" if front.undecided == 1 else f"{front.undecided} points"
        lines.append(f"at {points} the solver failed on combinations that could be better there")
    elif not front.exhaustive and result.asked.given.sizes is not None:
        lines.append("not every combination could be ruled out: some points may be beaten a little")
    elif not front.exhaustive:
        lines.append("there are too many combinations to try all: the search went link by link")
    return lines


def knee_words(result: Tradeoff, front: Front) -> str:
    """Where the knee is."""
    if front.knee is None:
        return "no knee: no point lies on the better side of the chord between the ends"
    point = result.points[front.knee - 1]
    x, y = result.asked.x, result.asked.y
    return f"knee: point {point.number}, {x.title} {shown(x, point.x)}, {y.title} {shown(y, point.y)}"


def effort_words(result: Tradeoff) -> str:
    """How much was solved, how long it took, and how right the straight lines are."""
    lines = f"straight lines between points were right within {percent(result.envelope.error)} half-way"
    return f"{result.solved} points solved{lasted(result.seconds)}; {lines}"


def spread(points: Sequence[Point], most: int, always: int | None) -> list[Point]:
    """At most so many of the points, spread evenly, both ends and the point of number `always` among them."""
    if len(points) <= most:
        return list(points)
    chosen = {round(k * (len(points) - 1) / (most - 1)) for k in range(most)}
    near = [k for k, point in enumerate(points) if point.number == always]
    for k in near:
        chosen = (chosen - {min(chosen - {0, len(points) - 1}, key=lambda item: abs(item - k))}) | {k}
    return [points[k] for k in sorted(chosen)]
