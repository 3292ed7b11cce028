"""The kinds of instruments, by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwright.core.diagnose.instruments import INSTRUMENTS, InstrumentKind
from linkwright.face.catalogues.catalogue_lists import Open
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


class Instruments(Open[InstrumentKind]):
    """The kinds of instruments, by their name in `observes:`; open: what is registered is read, simulated, diagnosed
    and planned.

    >>> import linkwright as lw
    >>> lw.instruments["tilt"].columns
    ('tilt_x', 'tilt_y')
    """

    def check(self, kind: InstrumentKind) -> None:
        """Hold a kind that is registered against the contract that every kind keeps. Raises `InputError`, one line."""
        from linkwright.core.diagnose.steps.instrument_contract import check_instrument

        check_instrument(kind)

    @property
    def table(self) -> pd.DataFrame:
        """All kinds: name, what each reads, the columns that hold it, its settings, and what it cannot see."""
        rows = [
            (kind.name, kind.title, ", ".join(kind.columns or (kind.label,)), ", ".join(kind.settings), kind.blind)
            for kind in self.values()
        ]
        return frame(rows, ["name", "title", "columns", "settings", "blind"])


instruments = Instruments("instrument", INSTRUMENTS)
