"""The trade-off of a problem: two figures chosen, the front traced, its points clicked."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

from nicegui import ui

import linkwright as lw
from linkwright.browser.server.desk import Desk

from .frame import row
from .optimise import ProblemPage

_ACCURACIES = MappingProxyType({0.3: "30 %: a first look", 0.1: "10 %", 0.03: "3 %", 0.01: "1 %: fine"})


class TradeoffPage(ProblemPage):
    """A problem, and two figures of its designs."""

    def __init__(self, desk: Desk) -> None:
        lead = "The designs that none beats in both of two figures. Stop leaves the points so far."
        super().__init__(desk, "Trade-off", lead)

    def _asked(self) -> None:
        traded = sorted(name for name in lw.limits if lw.limits[name].traded)
        names = {name: name.replace("_", " ") for name in traded}
        with row():
            self._x = _choice(names, "mass", "To the right")
            self._y = _choice(names, "max_error", "Upwards")
            self._by = _choice({"": "one front", "material": "each material", "shape": "each shape"}, "", "A front for")
            self._accuracy = _choice(dict(_ACCURACIES), 0.1, "Accuracy")
            self._ask = ui.button("Trace", on_click=self._start).props("no-caps")

    def _question(self) -> tuple[str, dict[str, Any]]:
        asked = {"x": self._x.value, "y": self._y.value, "by": self._by.value, "accuracy": self._accuracy.value}
        return "tradeoff", asked


def _choice(options: dict[Any, str], value: object, label: str) -> ui.select:
    return ui.select(options, value=value, label=label).props("dense outlined").classes("grow min-w-32")
