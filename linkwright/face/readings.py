"""What recordings of a tip and motion logs have in common: rows set aside, warnings, settings, how they are shown."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast

from linkwright.core.units.quantities import InputError

from .plain_input import File

if TYPE_CHECKING:
    import pandas as pd

T = TypeVar("T")


class Readings(ABC):
    """Readings of a real arm, less those set aside."""

    found: Any
    """What was read, in SI."""

    @property
    @abstractmethod
    def table(self) -> pd.DataFrame:
        """The readings by the columns of a file; the index is the row in the file."""

    @property
    def rejected(self) -> pd.DataFrame:
        """The rows that were set aside, and why."""
        import pandas as pd

        rows = [(item.row, item.reason) for item in self.found.rejected]
        return pd.DataFrame(rows, columns=["row", "reason"])

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what was not used, and why."""
        return self.found.warnings

    @abstractmethod
    def _line(self) -> str:
        """The readings in a line."""

    def _aside(self) -> str:
        """How many rows were set aside, as what follows their number."""
        aside = len(self.found.rejected)
        return f", {aside} rows set aside" if aside else ""

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__}: {self._line()}>"

    def _repr_html_(self) -> str:
        """The line and the first readings, for a notebook."""
        import html

        return f"<p>{html.escape(repr(self)[1:-1])}</p>\n{self.table.head(10).to_html(border=0)}"


def paired(given: Sequence[T], settings: File | Sequence[File] | None) -> list[tuple[T, File | None]]:
    """Each of several with its settings: those given for all, or of each its own. Raises `InputError`."""
    settings_list = list(settings) if isinstance(settings, list | tuple) else [cast("File | None", settings)]
    if len(settings_list) not in (1, len(given)):
        message = f"there are {len(settings_list)} for {len(given)} recordings; give one for all, or one each"
        raise InputError("", "settings", message)
    return list(zip(given, settings_list * len(given) if len(settings_list) == 1 else settings_list, strict=True))
