"""Which entries of a catalogue a list shows, in which order and with which columns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Generic, Protocol, TypeVar

from units.quantities import InputError, read_quantity
from units.reading import nearest

_CONDITION = re.compile(r"\s*(\w+)\s*(<=|>=|==|=|<|>)\s*(.+)")


def _equal(one: float, other: float) -> bool:
    return abs(one - other) <= 1e-9 * abs(other)


_RELATIONS: Mapping[str, Callable[[float, float], bool]] = MappingProxyType(
    {
        "<": lambda one, other: one < other,
        "<=": lambda one, other: one <= other * (1 + 1e-12) if other >= 0 else one <= other,
        ">": lambda one, other: one > other,
        ">=": lambda one, other: one >= other * (1 - 1e-12) if other >= 0 else one >= other,
        "=": _equal,
        "==": _equal,
    }
)


class _Listed(Protocol):
    @property
    def name(self) -> str: ...

    @property
    def family(self) -> str: ...


E = TypeVar("E", bound=_Listed)
N = TypeVar("N", bound=str)


@dataclass(frozen=True)
class Query(Generic[E, N]):
    """What can be asked of one kind of entry.

    Attributes:
        names: what an entry can have: properties, figures, dimensions.
        short: headings shorter than the names.
        usual: the columns of a list that nobody chose columns for.
        every: those of `--columns all`.
        kind: the kind of quantity of a name.
        value: an entry's value in SI, None where it has none.
        lacks: the message for an unknown name, which it quotes at `{}`.
        example: a condition, for messages.
    """

    names: Callable[[], Sequence[N]]
    short: Mapping[N, str]
    usual: tuple[N, ...]
    every: tuple[N, ...]
    kind: Callable[[N], str]
    value: Callable[[E, N], float | None]
    lacks: str
    example: str

    def name(self, text: str, option: str) -> N:
        """What a user names, by its name or its short heading. Raises `InputError`."""
        wanted = text.strip().replace(" ", "_").replace("-", "_")
        names = self.names()
        for name in names:
            if wanted in (name, self.short.get(name, name)):
                return name
        raise InputError("", option, f"{self.lacks.format(text.strip())}{nearest(wanted, names)}")

    def condition(self, text: str) -> Callable[[E], bool]:
        """`density < 3 g/cm^3`: whether an entry has the value and keeps the limit. Raises `InputError`."""
        found = _CONDITION.fullmatch(text)
        if not found:
            raise InputError("", "--where", f"'{text}' is no condition; write e.g. '{self.example}'")
        name, relation = self.name(found[1], "--where"), _RELATIONS[found[2]]
        limit = read_quantity(found[3].strip(), self.kind(name), file="--where", key=name)
        return lambda entry: (value := self.value(entry, name)) is not None and relation(value, limit)

    def chosen(self, entries: Iterable[E], where: Sequence[str] | None, sort: str | None) -> list[E]:
        """The entries that keep every condition, in the order asked for; those without the sorted value last.

        `sort` is `name`, `family` or what an entry can have, with `-` before it for the largest first. Raises
        `InputError`.
        """
        conditions = [self.condition(text) for text in where or ()]
        found = [entry for entry in entries if all(holds(entry) for holds in conditions)]
        if not sort:
            return found
        key, descending = sort.removeprefix("-"), sort.startswith("-")
        if key in ("name", "family"):
            return sorted(found, key=lambda entry: str(getattr(entry, key)), reverse=descending)
        name = self.name(key, "--sort")
        values = {entry.name: value for entry in found if (value := self.value(entry, name)) is not None}
        having = (entry for entry in found if entry.name in values)
        lacking = (entry for entry in found if entry.name not in values)
        return [*sorted(having, key=lambda entry: values[entry.name], reverse=descending), *lacking]

    def columns(self, text: str | None) -> tuple[N, ...]:
        """The columns of `--columns density,cost`. Raises `InputError`."""
        if not text or text.strip() == "all":
            return self.every if text else self.usual
        return tuple(self.name(part, "--columns") for part in text.split(",") if part.strip())
