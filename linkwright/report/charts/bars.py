"""Bars below each other: the causes of an error budget, and the ladder of models of a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwright.core.diagnose.result import Diagnosis, Rung
from linkwright.report.pictures.svg import drawing, element, label, line, text
from linkwright.results.figures_in_words import mm

_TEXT = 13.0
_MOST_CAUSES = 10
_MOST_RUNGS = 6
_MOST_LETTERS = 48


def _bars(
    rows: Sequence[tuple[str, str, Sequence[tuple[float, str]]]],
    words: str,
    about: str,
    size: tuple[float, float, float],
    marks: Sequence[float] = (),
) -> str:
    """Rows with what stands to the left and to the right above them, and their bars (value, kind) to one scale; `size`
    is the width, and the heights of a row and of a bar; `marks` stand at their values, one in each row."""
    width, step, high = size
    largest = max((value for *_, bars in rows for value, _ in bars), default=0.0) or 1.0
    parts: list[str] = []
    for index, (title, told, bars) in enumerate(rows):
        top, gap = index * step, 5.0 if len(bars) > 1 else 6.0
        parts.append(label(0.0, top + 9.0 + gap, _TEXT, title, "start"))
        parts.append(label(width, top + 9.0 + gap, _TEXT, told, "end"))
        for row, (value, kind) in enumerate(bars):
            place = {"x": 0.0, "y": top + 14.0 + gap + row * (high + 1.0), "width": max(1.0, width * value / largest)}
            parts.append(element("rect", **place, height=high, rx=2.0, class_=f"fill {kind}"))
        if marks and math.isfinite(marks[index]):
            across, foot = width * marks[index] / largest, top + 23.0 + len(bars) * (high + 1.0) - 1.0
            parts.append(line((across, top + 17.0), (across, foot), "error-line", 2.0))
    picture = drawing(0.0, 0.0, width, len(rows) * step, f"{words} {about}", *parts)
    return element("figure", picture, element("figcaption", text(words)))


def causes_picture(causes: Sequence[tuple[str, float, float]]) -> str:
    """Two bars for each cause alone: what it is called, the error at the worst pose, and on average (m)."""
    shown = causes[:_MOST_CAUSES]
    words = "Each cause alone: at the worst pose (above), and on average over poses and arms (below)."
    about = "; ".join(f"{title}: {mm(at_worst, 3)}" for title, at_worst, _ in shown)
    rows = [
        (title, f"{mm(one, 3)}, {mm(other, 3)}", ((one, "before"), (other, "after"))) for title, one, other in shown
    ]
    return _bars(rows, words, about, (520.0, 44.0, 9.0))


def joints_picture(rows: Sequence[tuple[str, str, tuple[float, float, float], float]], words: str, about: str) -> str:
    """Three bars for each joint: what is left before, after and on motion held out; a mark stands at the floor. A row
    is what the joint is called, what stands to the right, the three, and the floor."""
    kinds = ("before", "after", "held")
    drawn = [(name, told, tuple(zip(bars, kinds, strict=True))) for name, told, bars, _ in rows]
    return _bars(drawn, words, about, (520.0, 52.0, 9.0), [floor for *_, floor in rows])


def ladder_picture(diagnosis: Diagnosis) -> str:
    """A bar for each model, with a mark at the noise floor; nothing where there is only the model as given."""
    rungs = _climbed(diagnosis)
    if len(rungs) < 2:
        return ""
    floor = diagnosis.noise_floor
    shown = floor is not None and 0.0 < floor <= (max(rung.rms for rung in rungs) or 1.0)
    rows = [
        (
            rung.label if len(rung.label) <= _MOST_LETTERS else f"{rung.label[: _MOST_LETTERS - 1]}…",
            mm(rung.rms, 3),
            ((rung.rms, "after" if index else "before"),),
        )
        for index, rung in enumerate(rungs)
    ]
    legend = f" The red marks are the noise floor, {mm(floor, 3)}." if shown else ""
    about = "; ".join(f"{rung.label}: {mm(rung.rms, 3)}" for rung in rungs)
    words = f"What each model leaves of the mismatch (RMS).{legend}"
    return _bars(rows, words, about, (400.0, 40.0, 14.0), [floor] * len(rows) if floor is not None and shown else ())


def _climbed(diagnosis: Diagnosis) -> list[Rung]:
    """The model as given and what was added to it step by step; the last rung stands for all that did not fit."""
    rungs = [item for item in diagnosis.ladder if not item.label.startswith("without ")]
    rungs = [rung for rung in rungs if math.isfinite(rung.rms)]
    if len(rungs) <= _MOST_RUNGS:
        return rungs
    last = rungs[-1]
    rest = Rung(f"+ {len(rungs) - _MOST_RUNGS + 1} more", last.rms, last.mean, last.largest, last.held_out)
    return [*rungs[: _MOST_RUNGS - 1], rest]
