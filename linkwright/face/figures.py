"""The figures of a design, as every result of the face that has one tells them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.optimize.limits import FIGURES, Figure
from linkwright.core.optimize.limits.error import MAX_ERROR
from linkwright.core.optimize.limits.frequency import FIRST_FREQUENCY

if TYPE_CHECKING:
    import pandas as pd

UPPER, LOWER, ROBUST, DRIVES = "upper_bound", "lower_bound", "robust_error", "first_frequency_of_drives"
Values = Mapping[str, float | None]
"""Figures (SI) by name; None where one is not known."""
_NONE: Values = MappingProxyType({})


@dataclass(frozen=True)
class Row:
    """A figure beside those that can be limited: of the kind of one of them, with a title of its own."""

    name: str
    title: str
    like: Figure


_BESIDE = (
    Row(UPPER, "upper bound of the worst error", MAX_ERROR),
    Row(LOWER, "lower bound of the worst error", MAX_ERROR),
    Row(ROBUST, "worst error over what is uncertain", MAX_ERROR),
    Row(DRIVES, "first frequency of the drives alone", FIRST_FREQUENCY),
)


class Figured(ABC):
    """A result with a design: its figures, those that everybody asks for by their names."""

    @abstractmethod
    def _designs(self) -> Mapping[str, Values]:
        """The figures of the design by what its column is called, last; those that it is compared with before it."""

    @abstractmethod
    def _figured(self) -> tuple[Arm, Mapping[str, Figure]]:
        """The design's arm, and the figures that are known."""

    def _value(self, name: str, factor: float = 1.0) -> float | None:
        value = [*self._designs().values()][-1].get(name)
        return None if value is None else factor * value

    @property
    def max_error_mm(self) -> float:
        """The worst position error over the workspace and all load cases, mm."""
        error = self._value(MAX_ERROR.name, 1e3)
        assert error is not None
        return error

    @property
    def upper_bound_mm(self) -> float | None:
        """The bound to first order and the most by which samples were longer beyond it, mm; None where unknown."""
        return self._value(UPPER, 1e3)

    @property
    def lower_bound_mm(self) -> float | None:
        """What no allowed design's worst error goes below (see `found.bound_of`), mm; None where something else was
        minimised, or nothing is known."""
        return self._value(LOWER, 1e3)

    @property
    def mass_kg(self) -> float | None:
        """The links' mass, kg; None where some link's is unknown."""
        return self._value("mass")

    @property
    def figures(self) -> pd.DataFrame:
        """A row for each figure that the screen prints, by its name: its title, its value (one for each design where
        several are compared; nan where it is not known) and the unit of that row, empty for a pure number."""
        import pandas as pd

        designs = self._designs()
        arm, known = self._figured()
        rows = [Row(each.name, each.title_for(arm), each) for each in known.values()]
        rows = [*rows[:1], *(each for each in _BESIDE if each.like is MAX_ERROR), *rows[1:], _BESIDE[-1]]
        told = [row for row in rows if any(values.get(row.name) is not None for values in designs.values())]
        table = {"title": [row.title for row in told]}
        columns = {which: [row.like.shown(values.get(row.name)) for row in told] for which, values in designs.items()}
        frame = pd.DataFrame({**table, **columns, "unit": [row.like.unit for row in told]})
        frame.index = pd.Index([row.name for row in told], name="figure")
        return frame.astype(dict.fromkeys(columns, float))


def values_of(evaluation: Evaluation, beside: Values = _NONE, known: Mapping[str, Figure] = FIGURES) -> Values:
    """The figures (SI) of an evaluated design, those `beside` too."""
    drives = evaluation.frequency_of_drives
    found = {name: each.value(evaluation) if each.told(evaluation) else None for name, each in known.items()}
    return {**found, UPPER: evaluation.upper_bound, DRIVES: None if drives is None else drives.value, **beside}
