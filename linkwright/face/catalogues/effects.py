"""The physics that moves the tip and loads the drives, by id."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwright.core.arm.effects import EFFECTS, Effect
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
