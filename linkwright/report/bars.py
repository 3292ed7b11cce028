"""What each effect adds at the worst pose, as a table with bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwright.words import effect_title, mm

from .svg import element, text

_NOTHING = 1e-9


def effect_bars(parts: Sequence[tuple[str, Mapping[str, float]]]) -> str:
    """Bars to one scale; `parts` are (before or after, error by effect in m)."""
    largest = max((value for _, by_effect in parts for value in by_effect.values()), default=0.0)
    names = {name for _, by_effect in parts for name in by_effect}
    order = sorted(names, key=lambda name: -max(by_effect.get(name, 0.0) for _, by_effect in parts))
    rows = [_row(name, parts, largest) for name in order]
    headings = ("effect", "error alone, at the worst pose")
    head = element("tr", *(element("th", text(words), scope="col") for words in headings))
    return element("table", element("thead", head), element("tbody", *rows), class_="bars")


def _row(name: str, parts: Sequence[tuple[str, Mapping[str, float]]], largest: float) -> str:
    bars = [_bar(when, by_effect.get(name), largest) for when, by_effect in parts]
    return element("tr", element("th", text(effect_title(name)), scope="row"), element("td", *bars))


def _bar(when: str, value: float | None, largest: float) -> str:
    shown = value if value is not None and value > _NOTHING * largest else 0.0
    share = 100.0 * shown / largest if largest > 0.0 else 0.0
    fill = element("span", class_=f"fill {when or 'after'}", style=f"width:{share:.2f}%")
    words = "not in the model" if value is None else mm(shown)
    title = f"{when}: {words}" if when else words
    amount = element("span", text(title), class_="amount")
    return element("div", element("span", fill, class_="track"), amount, class_="bar")
