"""The ladder of models as a picture: what is left of the mismatch as one cause after another is modelled."""

from __future__ import annotations

import math

from linkwright.core.diagnose.result import Diagnosis, Rung
from linkwright.results.figures_in_words import mm

from .svg import drawing, element, label, line, text

_WIDTH, _STEP, _BAR, _TEXT = 400.0, 40.0, 14.0, 13.0
_MOST_RUNGS = 6
_MOST_LETTERS = 48


def ladder_picture(diagnosis: Diagnosis) -> str:
    """A bar for each model, with a mark at the noise floor; nothing where there is only the model as given."""
    rungs = _climbed(diagnosis)
    if len(rungs) < 2:
        return ""
    largest = max(each.rms for each in rungs) or 1.0
    floor = diagnosis.noise_floor
    shown = floor is not None and 0.0 < floor <= largest
    parts: list[str] = []
    for index, rung in enumerate(rungs):
        top = index * _STEP
        words = rung.label if len(rung.label) <= _MOST_LETTERS else f"{rung.label[: _MOST_LETTERS - 1]}…"
        parts.append(label(0.0, top + 15.0, _TEXT, words, "start"))
        parts.append(label(_WIDTH, top + 15.0, _TEXT, mm(rung.rms, 3), "end"))
        length = max(1.0, _WIDTH * rung.rms / largest)
        kind = "before" if index == 0 else "after"
        parts.append(element("rect", x=0.0, y=top + 20.0, width=length, height=_BAR, rx=2.0, class_=f"fill {kind}"))
        if shown:
            across = _WIDTH * (floor or 0.0) / largest
            parts.append(line((across, top + 17.0), (across, top + 23.0 + _BAR), "error-line", 2.0))
    told = f" The red marks are the noise floor, {mm(floor, 3)}." if shown else ""
    about = "; ".join(f"{each.label}: {mm(each.rms, 3)}" for each in rungs)
    words = f"What each model leaves of the mismatch (RMS).{told}"
    picture = drawing(0.0, 0.0, _WIDTH, len(rungs) * _STEP, f"{words} {about}", *parts)
    return element("figure", picture, element("figcaption", text(words)))


def _climbed(diagnosis: Diagnosis) -> list[Rung]:
    """The model as given and what was added to it step by step; the last rung stands for all that did not fit."""
    rungs = [each for each in diagnosis.ladder if not each.label.startswith("without ")]
    rungs = [each for each in rungs if math.isfinite(each.rms)]
    if len(rungs) <= _MOST_RUNGS:
        return rungs
    hidden = len(rungs) - _MOST_RUNGS + 1
    last = rungs[-1]
    rest = Rung(f"+ {hidden} more", last.rms, last.mean, last.largest, last.held_out)
    return [*rungs[: _MOST_RUNGS - 1], rest]
