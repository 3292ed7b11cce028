"""The report of an error budget."""

from __future__ import annotations

from linkwright.core.optimize.budget.result import Budget
from linkwright.report.contents import Contents
from linkwright.report.pictures.svg import drawing, element, label, text
from linkwright.results.budget import cause_title, describe
from linkwright.results.figures_in_words import mm

_WIDTH, _STEP, _BAR, _TEXT = 520.0, 44.0, 9.0, 13.0
_MOST = 10


def budget_report(found: Budget) -> Contents:
    """What the report shows."""
    return Contents(describe(found), {"causes": causes_picture(found)})


def causes_picture(found: Budget) -> str:
    """Two bars for each cause alone: at the worst pose, and on average."""
    shown = found.causes[:_MOST]
    largest = max((each.at_worst for each in shown), default=0.0) or 1.0
    parts: list[str] = []
    for index, each in enumerate(shown):
        top = index * _STEP
        parts.append(label(0.0, top + 14.0, _TEXT, cause_title(each.name), "start"))
        parts.append(label(_WIDTH, top + 14.0, _TEXT, f"{mm(each.at_worst, 3)}, {mm(each.average, 3)}", "end"))
        for row, (value, kind) in enumerate(((each.at_worst, "before"), (each.average, "after"))):
            width = max(1.0, _WIDTH * value / largest)
            place = {"x": 0.0, "y": top + 19.0 + row * (_BAR + 1.0), "width": width, "height": _BAR}
            parts.append(element("rect", **place, rx=2.0, class_=f"fill {kind}"))
    words = "Each cause alone: at the worst pose (above), and on average over poses and arms (below)."
    about = "; ".join(f"{cause_title(each.name)}: {mm(each.at_worst, 3)}" for each in shown)
    picture = drawing(0.0, 0.0, _WIDTH, len(shown) * _STEP, f"{words} {about}", *parts)
    return element("figure", picture, element("figcaption", text(words)))
