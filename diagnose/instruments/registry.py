"""The registry of instruments, and the slots that their numbers take in recordings; `diagnose.instruments` ships its
own into it, users and installed packages add theirs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.registries import Registry

from .instrument import Slots
from .kind import InstrumentKind, Marked, Number


def _fault(entry: object) -> str | None:
    good = isinstance(entry, InstrumentKind)
    return None if good else f"an instrument must be an InstrumentKind, not {entry!r}"


INSTRUMENTS: Registry[InstrumentKind] = Registry(
    "instrument",
    "linkwright.instruments",
    lambda kind: kind.name,
    _fault,
    "linkwright.core.diagnose.instruments.registry:INSTRUMENTS",
)
"""Every kind of instrument by its name in `observes:`."""


def slots_of(name: str, *, flat: bool = False) -> tuple[int, ...]:
    """The slots of a kind's numbers: they are numbered through all kinds, in the registry's order. Of a `flat` arm's
    those in its plane."""
    first = 0
    for kind in INSTRUMENTS.values():
        if kind.name == name:
            return tuple(range(first, first + kind.count(flat=flat)))
        first += len(kind.numbers)
    raise KeyError(name)


def kind_at(slot: int) -> tuple[InstrumentKind, Number]:
    """The kind of the number in a slot, and that number."""
    first = 0
    for kind in INSTRUMENTS.values():
        if slot < first + len(kind.numbers):
            return kind, kind.numbers[slot - first]
        first += len(kind.numbers)
    raise KeyError(slot)


def kinds_of(slots: Slots | Sequence[int]) -> tuple[InstrumentKind, ...]:
    """The kinds of which there are numbers."""
    there = sorted({int(slot) for slot in np.unique(slots) if slot >= 0})
    return tuple(dict.fromkeys(kind_at(slot)[0] for slot in there))


def marked(slots: Slots, kinds: Sequence[InstrumentKind]) -> Marked:
    """Which numbers are of some kinds, of the shape of `slots`."""
    return np.asarray(np.isin(slots, [slot for kind in kinds for slot in slots_of(kind.name)]), dtype=np.bool_)


def labels() -> dict[str, str]:
    """The kinds whose readings name what they touch, each with the column that does."""
    return {kind.name: kind.label for kind in INSTRUMENTS.values() if kind.label}


def with_setting(name: str) -> list[str]:
    """The kinds of which a setting says something."""
    return [kind.name for kind in INSTRUMENTS.values() if name in kind.settings]


def turns_with(slots: Slots | None) -> str:
    """What the instrument of some numbers stands on where turns of that change them: `tool`, `link`, or nothing."""
    of = set[str]() if slots is None else {kind.turns_with for kind in kinds_of(slots)}
    return "tool" if "tool" in of else "link" if "link" in of else ""
