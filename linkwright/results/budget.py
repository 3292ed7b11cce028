"""An error budget described: how much, by what, and what to buy better first."""

from __future__ import annotations

from types import MappingProxyType

from linkwright.core.optimize.budget.parts import EACH_TIME, REPEATABILITY, TEMPERATURE
from linkwright.core.optimize.budget.result import Budget, Gain
from linkwright.report.charts.causes import causes_picture

from .document import (
    Description,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Value,
    amount,
    length,
    section,
    share,
    table,
)
from .figures_in_words import effect_title, mm, percent, pose

_TITLES = MappingProxyType(
    {
        REPEATABILITY: "repeatability of the tip",
        TEMPERATURE: "temperature",
        "size": "dimensions of the sections",
        "thickness": "walls of the sections",
    }
)


def cause_title(name: str) -> str:
    """What a cause is called."""
    plain = name.removesuffix(EACH_TIME)
    title = _TITLES.get(plain) or effect_title(plain)
    return f"{title}{EACH_TIME}" if plain != name else title


def describe(found: Budget) -> Description:
    """The budget: figures, causes, parts."""
    arm, sheet = found.arm, found.sheet
    kept = percent(sheet.share)
    upper = "" if found.worst_upper is None else f"with 95 % confidence {mm(found.worst_upper, 3)}"
    facts = Facts(
        (
            Fact(f"worst error, {kept} of arms", length(found.worst, 3), upper),
            Fact("worst error, half of arms", length(found.median, 3)),
            Fact("worst error as on paper", length(found.nominal, 3), "nothing off"),
            Fact("over arms and poses", length(found.average, 3), "root mean square"),
        )
    )
    items: list[Item] = [facts]
    where = pose(arm, found.pose)
    loads = f", load case {found.load_case}" if len(found.load_cases) > 1 else ""
    if tip := found.load_cases[found.load_case - 1].tip:
        loads = f" at {tip}'s tip{loads}"
    items.append(Paragraph(f"Most at {where}{loads}: {mm(found.at_worst, 3)} for {kept} of arms."))
    rows = [
        (cause_title(each.name), length(each.at_worst, 3), length(each.average, 3), share(each.share))
        for each in found.causes
    ]
    bars = Picture(lambda: causes_picture([(cause_title(x.name), x.at_worst, x.average) for x in found.causes]))
    columns = ("each cause alone", "at the worst pose", "average", "share of the square")
    items.append(section("Causes", bars, table(columns, rows)))
    if found.options:
        priced = [
            (each.name, _euro(each.price), length(each.worst, 3), length(each.average, 3), _per_euro(each))
            for each in found.options
        ]
        headings = ("better part", "price", "worst less by", "average less by", "mm per EUR")
        items.append(section("What to buy better first", table(headings, priced)))
    if found.halved:
        rows_ = [(each.name, length(each.worst, 3), length(each.average, 3)) for each in found.halved]
        lead = "All figures of one joint or link half as bad: stiffness twice, play and tolerances half."
        headings_ = ("twice as good", "worst less by", "average less by")
        items.append(section("What it would bring to make a part better", table(headings_, rows_), lead=lead))
    items.append(Lines(_rests_on(found)))
    headline = f"{kept} of arms err by {mm(found.worst, 3)} at most"
    largest = cause_title(found.causes[0].name)
    brief = f"{headline}; most: {largest}"
    name = f"{arm.name}, tip of {arm.tip}" if arm.tip and not arm.every_tip else arm.name
    return Description(f"{name}: error budget", brief, tuple(items), brief, f"{name}: ")


def _euro(price: float | None) -> Value:
    return amount(price, "EUR") if price is not None else amount(None)


def _per_euro(gain: Gain) -> Value:
    return amount(None if gain.per_euro is None else 1e3 * gain.per_euro, "", 3)


def _rests_on(found: Budget) -> tuple[str, ...]:
    sheet = found.sheet
    lines = [
        f"Sampled: {sheet.draws} arms (seed {sheet.seed}), each at {found.poses} poses; to first order; tolerances are "
        "uniform and independent.",
        f"Play counts as the arm file says: {found.arm.play}.",
    ]
    if found.room.avoid:
        lines.append(
            "Poses that put joints, links or the tip in what is to be avoided do not count here (in evaluate they do); "
            "of the others the worst is that of the poses tried."
        )
    if found.unwarmed:
        numbers = ", ".join(str(k + 1) for k in found.unwarmed)
        lines.append(f"How much link {numbers} grows with temperature is not known and not in it.")
    if not sheet.tolerances and sheet.uncertain is None and not sheet.repeatability:
        lines.append("Without a data sheet all arms are alike: give tolerances with --sheet.")
    return tuple(lines)
