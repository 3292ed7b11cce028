"""The bars of an error budget."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.report.pictures.svg import drawing, element, label, text
from linkwright.results.figures_in_words import mm

_WIDTH, _STEP, _BAR, _TEXT = 520.0, 44.0, 9.0, 13.0
_MOST = 10


def causes_picture(causes: Sequence[tuple[str, float, float]]) -> str:
    """Two bars for each cause alone: what it is called, the error at the worst pose, and on average (m)."""
    shown = causes[:_MOST]
    largest = max((at_worst for _, at_worst, _ in shown), default=0.0) or 1.0
    parts: list[str] = []
    for index, (title, at_worst, average) in enumerate(shown):
        top = index * _STEP
        parts.append(label(0.0, top + 14.0, _TEXT, title, "start"))
        parts.append(label(_WIDTH, top + 14.0, _TEXT, f"{mm(at_worst, 3)}, {mm(average, 3)}", "end"))
        for row, (value, kind) in enumerate(((at_worst, "before"), (average, "after"))):
            width = max(1.0, _WIDTH * value / largest)
            place = {"x": 0.0, "y": top + 19.0 + row * (_BAR + 1.0), "width": width, "height": _BAR}
            parts.append(element("rect", **place, rx=2.0, class_=f"fill {kind}"))
    words = "Each cause alone: at the worst pose (above), and on average over poses and arms (below)."
    about = "; ".join(f"{title}: {mm(at_worst, 3)}" for title, at_worst, _ in shown)
    picture = drawing(0.0, 0.0, _WIDTH, len(shown) * _STEP, f"{words} {about}", *parts)
    return element("figure", picture, element("figcaption", text(words)))
