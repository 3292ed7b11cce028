"""A plan described: what it will show beside poses at random, what it tells apart and what not, and its visits."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwright.core.diagnose.answer.sentences import name_of
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS
from linkwright.core.diagnose.plan.planned import Planned
from linkwright.core.diagnose.plan.promise import Shown
from linkwright.core.diagnose.result import HALF
from linkwright.core.units.quantities import format_quantity

from .document import Column, Description, Fact, Facts, Item, Lines, Value, count, length, number, section, table
from .figures_in_words import figure, mm, percent, pose

_FIRST = 12
_SMALLER = 1.005
"""Times; what is less reads as 1 in three figures."""


def describe(result: Planned) -> Description:
    """The plan: figures, what will be seen, what is distinguished from what, the visits."""
    request, promise = result.asked, result.promise
    facts = Facts(
        (
            Fact("visits", count(request.poses), f"{result.recording.size} readings, {_returns(result)}"),
            *_noise(result),
            Fact("causes seen", count(len(promise.shown)), f"{len(promise.unseen)} not at all"),
            Fact("smaller than at random", number(result.smaller, 3), "times, on average"),
            *_apart(result),
        )
    )
    seen = sorted(promise.shown, key=lambda item: item.smallest / item.usual)
    items: list[Item] = [facts]
    if seen:
        columns = (
            "cause",
            "smallest size seen",
            "at random",
            Column("usual, at most", detail=True),
            "told from others",
        )
        rows = [_row(result, item) for item in seen]
        more = max(0, len(rows) - _FIRST)
        items.append(
            section(
                "What it will show",
                table(columns, rows, first=_FIRST, rest=f"and {more} more causes" if more else ""),
                lead="With a probability of 90 %, as a diagnosis would find it. Told from others: from that size on.",
            )
        )
    if promise.torques:
        items.append(_torques(result))
    items.append(section("What it will not tell", Lines(_indistinguishable(seen, promise.unseen))))
    items.append(section("Visits", _visits(result), detail=True))
    items.append(Lines(_how(result)))
    headline = _headline(result)
    if result.interrupted:
        headline += "; stopped, so this is the best plan until then"
    name = f"{result.arm.name}, tip of {result.arm.tip}" if result.arm.branches else result.arm.name
    return Description(f"{name}: what to record", f"{headline}.", tuple(items), headline, f"{name}: ")


def _apart(planned: Planned) -> tuple[Fact, ...]:
    """Of what could be mistaken for something else how much is decided, and how much poses at random would decide; each
    of a different number of pairs, for causes that a plan does not see have none."""
    shown, pairs = planned.promise.separated, planned.promise.pairs
    by_chance, possible = planned.separated_at_random
    facts = [Fact("pairs told apart", count(shown), f"of {pairs}, at usual sizes, whichever of the two is there")]
    if possible:
        text = f"of the {possible} pairs of causes that such poses see, for comparison"
        facts.append(Fact("told apart at random", count(by_chance), text))
    return tuple(facts)


def _noise(planned: Planned) -> tuple[Fact, ...]:
    """What the numbers scatter by; of a camera depths and turns by themselves."""
    request, turns = planned.asked, [axis for axis in planned.axes if axis.startswith("turn")]
    if not turns:
        noise = Value(_scatter(planned)) if request.instrument == "tilt" else length(request.sigma, 3)
        return (Fact("noise", noise, f"each of {', '.join(planned.axes)}"),)
    deep, turned = request.camera_noise
    return (
        Fact("noise across", length(request.sigma, 3), "each of camera x, camera y"),
        Fact("noise in depth", length(deep, 3), "camera depth"),
        Fact("noise of turns", Value(format_quantity(turned, "angle", digits=3)), f"each of {', '.join(turns)}"),
    )


def _headline(planned: Planned) -> str:
    """What it tells apart and shows, and whether that is more than poses at random do."""
    promise, smaller = planned.promise, planned.smaller
    text = f"{planned.asked.poses} visits tell {promise.separated} of {promise.pairs} pairs of causes apart"
    if not planned.random:
        return text
    if smaller > _SMALLER:
        more = "" if planned.tells_more else ", no more than poses at random,"
        return f"{text}{more} and show sizes {figure(smaller, 3)} times smaller than poses at random"
    if planned.tells_more:
        return f"{text}, more than poses at random, and show sizes no smaller than those"
    return f"{text} and are no better than poses at random"


def _returns(planned: Planned) -> str:
    if not planned.returns:
        return "none to one pose"
    return f"{len(planned.returns)} of the visits to one pose ({', '.join(map(str, planned.returns))})"


def _torques(planned: Planned) -> Item:
    """What the drives' torques will tell, and what they would at random poses."""
    columns = ("drive", "links weigh", "at random", "payload weighs", "at random", "friction", "at random")
    rows: list[tuple[str | Value, ...]] = []
    for torque in planned.promise.torques:
        kind = "torque" if planned.arm.joints[torque.joint - 1].revolute else "force"
        cells: list[str | Value] = [count(torque.joint)]
        for name, of in (("links", ""), ("payload", ""), ("friction", kind)):
            value, random = getattr(torque, name), planned.torques_at_random(torque.joint, name)
            cells += [_within(value, of), _within(random, of)]
        rows.append(tuple(cells))
    lead = "95 % bounds: weights in percent of the model's, friction as the difference from its true value."
    if any(item.together for item in planned.promise.torques):
        lead += " The payload is always the same, and weighs with the links."
    return section("What torques will tell", table(columns, rows), lead=lead)


def _within(error: float | None, kind: str) -> Value:
    if error is None or not math.isfinite(error):
        return Value("–")
    return Value(format_quantity(1.96 * error, kind, digits=3)) if kind else Value(f"{figure(196.0 * error, 3)} %")


def _row(planned: Planned, shown: Shown) -> tuple[str | Value, ...]:
    return (
        f"{name_of(shown.effect, shown.at)}, {shown.parameter}",
        _size(shown.smallest, shown.kind),
        _size(planned.at_random(shown), shown.kind),
        _size(shown.usual, shown.kind),
        _size(shown.resolved_size, shown.kind) if len(shown.inseparable) < len(shown.others) else Value("–"),
    )


def _size(value: float, kind: str) -> Value:
    return Value(format_quantity(value, kind, digits=3) if math.isfinite(value) else "–")


def _indistinguishable(seen: Sequence[Shown], unseen: Sequence[tuple[str, tuple[int, ...]]]) -> tuple[str, ...]:
    """Sentences on what stays open: pairs (once each), and what is not seen."""
    lines: list[str] = []
    for item in seen:
        if not item.inseparable:
            continue
        names = [name_of(rival.effect, rival.at) for rival in item.inseparable]
        shown = f"{', '.join(names[:4])}{f' and {len(names) - 4} more' if len(names) > 4 else ''}"
        lines.append(f"{name_of(item.effect, item.at)} is not told from {shown}.")
    if len(lines) > _FIRST:
        lines = [
            *lines[:_FIRST],
            f"And {len(lines) - _FIRST} more are not told from something (--json).",
        ]
    if unseen:
        lines.append(f"Not seen at any possible size: {', '.join(name_of(*each) for each in unseen)}.")
    if any(rival.likeness > 0.9999 for each in seen for rival in each.inseparable):
        lines.append(
            "What is alike at all poses of the plan only another sensor, or other poses, tell apart "
            "(`linkwright effects show`)."
        )
    if rare := [name_of(each.effect, each.at) for each in seen if each.smallest > each.usual]:
        lines.append(f"Seen only at sizes beyond what is usual: {', '.join(rare)}.")
    return tuple(lines) or ("Every cause is told from every other at usual sizes.",)


def _visits(planned: Planned) -> Item:
    visits = planned.visits
    rows: list[tuple[str | Value, ...]] = []
    for row in range(visits.size):
        sides = "" if visits.sides is None else " ".join("+" if side > 0 else "-" for side in visits.sides[row])
        mass = 0.0 if visits.payload_mass is None else float(visits.payload_mass[row])
        at = () if visits.touches is None else (visits.instrument.labels[int(visits.touches[row])],)
        rows.append((count(row + 1), pose(planned.arm, visits.q[row].tolist()), sides, Value(f"{mass:g} kg"), *at))
    touches = () if visits.touches is None else ("touches",)
    return table(("visit", "pose", "each joint comes upwards or downwards", "payload", *touches), rows)


def _reading(planned: Planned) -> tuple[str, ...]:
    """What is read, where that is not the tip's place."""
    if planned.touched:
        return _touching(planned)
    reads = planned.asked.reads
    said = INSTRUMENTS[reads.kinds[0]].said(reads, anchor_free=planned.asked.anchor_free)
    return (said,) if said else ()


def _touching(planned: Planned) -> tuple[str, ...]:
    """What is touched, and about where that is."""
    what = {"same_point": "point"}.get(planned.asked.instrument, planned.asked.instrument)
    near = ", ".join(f"{item.label} at ({', '.join(mm(value) for value in item.at)})" for item in planned.touched)
    normals = [
        f"{item.label} ({', '.join(f'{value:.2f}' for value in item.normal)})"
        for item in planned.touched
        if item.normal
    ]
    across = f"; normals {', '.join(normals)}" if normals else ""
    ways = [f"{item.label} ({', '.join(f'{value:.2f}' for value in item.way)})" for item in planned.touched if item.way]
    if ways:
        what, across = "bar", f"; along it {', '.join(ways)}"
    return (
        f"Each visit touches the {what} that it names: {near}{across}. An approximate place is enough.",
        "Its joint coordinates are about where that is: write over them what the encoders read at each touch.",
    )


def _compared(planned: Planned) -> str:
    if not planned.random:
        return "It was stopped before poses at random were tried, so nothing is compared with them."
    return f"At random: the middle of {len(planned.random)} plans of the same kind."


def _placed(planned: Planned) -> str:
    request = planned.asked
    return "" if request.instrument == "tilt" else f", frame {request.frame}, tool {request.tool}"


def _scatter(planned: Planned) -> str:
    request = planned.asked
    return format_quantity(request.sigma, "angle", digits=3) if request.instrument == "tilt" else mm(request.sigma, 3)


def _kept_to(planned: Planned) -> str:
    """Where the arm may be put, and what nobody looked at."""
    room, where = planned.asked.room, "at each visit and where it is come from, not on the ways between visits"
    if room.avoid:
        return f"What is to be avoided is kept clear of by joints, links and tip, {where}. Nothing else is checked."
    if room.within is not None:
        return (
            "No `avoid` regions are given, so at each visit every joint stays inside its recorded range. The tip and "
            f"the joints' places stay inside the recorded box {where}. They are not checked for collisions."
        )
    return (
        "Poses are taken from the whole of the joint ranges, and not checked for collisions. Write what to keep clear "
        "of (`avoid` in the arm file, or --avoid 'below z 0 mm')."
    )


def _how(planned: Planned) -> tuple[str, ...]:
    request = planned.asked
    # Beyond it half of what a joint does may be drift.
    apart = "drift is told from place" if planned.with_time**2 < HALF else "drift is hardly told from place"
    lines = [
        "Come to each visit from some degrees before (dirN 1) or beyond (-1) in every joint, farther than any play.",
        f"Time goes with no joint or side by more than a correlation of {percent(planned.with_time)}: {apart}.",
        *_reading(planned),
        f"Rests on a sound arm simulated at the plan's readings (noise {_scatter(planned)}{_placed(planned)}) "
        f"and the diagnosis' own test. The choice is the best found of {planned.tried} visits tried, not "
        f"proven best. {_compared(planned)}",
    ]
    lines.append(_kept_to(planned))
    if planned.after is not None:
        lines.append(f"With what {planned.after.file} shows already. Sizes are those of both recordings together.")
        if not request.effects:
            lines.append("That recording leaves no names open, so this plan is for everything.")
    return tuple(lines)
