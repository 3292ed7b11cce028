"""Effects, kinds of instruments and figures that can be limited, by name: registries that stay open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwright.core.arm.effects import EFFECTS, Effect
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.diagnose.instruments import INSTRUMENTS, InstrumentKind
from linkwright.face.catalogues.catalogue_lists import Open
from linkwright.output.table_file import frame

if TYPE_CHECKING:
    import pandas as pd


class Effects(Open[Effect]):
    """The physics that moves the tip and loads the drives, by id; open: what is registered is simulated, evaluated and
    diagnosed.

    >>> import linkwright as lw
    >>> lw.effects["backlash"].place
    'joint'
    >>> lw.effects["backlsh"]
    Traceback (most recent call last):
    ...
    linkwright.InputError: effect: there is no effect 'backlsh'; did you mean 'backlash'?
    """

    def check(self, effect: Effect) -> None:
        """Hold an effect against the contract that every effect keeps. Raises `InputError`, one line a breach."""
        from linkwright.core.arm.effects.contract import check

        check(effect)

    @property
    def table(self) -> pd.DataFrame:
        """All effects: id, title, where they act, and what a recording must hold to show them."""
        rows = [(item.id, item.title, item.place, item.needs) for item in self.values()]
        return frame(rows, ["id", "title", "place", "needs"])


effects = Effects("effect", EFFECTS)


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
