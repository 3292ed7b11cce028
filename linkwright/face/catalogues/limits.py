"""The figures of a design that can be limited, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.face.catalogues.catalogue_lists import Open
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


class Limits(Open[Figure]):
    """The figures that a problem can limit, by name; open: what is registered is read, held, priced and told.

    >>> import linkwright as lw
    >>> lw.limits["first_frequency"].senses
    ('>=',)
    >>> lw.limits["masss"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: limit: there is no limit 'masss'; did you mean 'mass'?
    """

    @property
    def table(self) -> pd.DataFrame:
        """All of them: name, title, unit, the relations that a limit may have, and whether one is assumed unasked."""
        rows = [(item.name, item.title, item.unit, item.senses, item.assumed is not None) for item in self.values()]
        return frame(rows, ["name", "title", "unit", "senses", "assumed"])


limits = Limits("limit", FIGURES)
