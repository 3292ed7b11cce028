"""Which entries of a catalogue a list shows, in which order and with which columns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Generic, Protocol, TypeVar

from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, read_quantity

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


_ANSWERS = MappingProxyType({"yes": 1.0, "true": 1.0, "no": 0.0, "false": 0.0})


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
        value: an entry's value in SI, None where it has none; 1 and 0 for yes and no.
        yes_or_no: the names that are so.
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
    yes_or_no: tuple[N, ...] = ()

    def name(self, text: str, option: str) -> N:
        """What a user names, by its name, its short heading or the end of one name alone (`service_temperature`).
        Raises `InputError`."""
        wanted = text.strip().replace(" ", "_").replace("-", "_")
        names = self.names()
        for name in names:
            if wanted in (name, self.short.get(name, name)):
                return name
        ends = [name for name in names if name.endswith(f"_{wanted}")]
        if len(ends) == 1:
            return ends[0]
        raise InputError("", option, f"{self.lacks.format(text.strip())}{nearest(wanted, names)}")

    def condition(self, text: str) -> Callable[[E], bool]:
        """`density < 3 g/cm^3`: whether an entry has the value and keeps the limit. Raises `InputError`."""
        parsed = _CONDITION.fullmatch(text)
        if not parsed:
            raise InputError("", "--where", f"'{text}' is no condition; write e.g. '{self.example}'")
        name, relation = self.name(parsed[1], "--where"), _RELATIONS[parsed[2]]
        limit = self._limit(name, parsed[2], parsed[3].strip())
        return lambda entry: (value := self.value(entry, name)) is not None and relation(value, limit)

    def _limit(self, name: N, relation: str, text: str) -> float:
        if name not in self.yes_or_no:
            return read_quantity(text, self.kind(name), file="--where", key=name)
        if _RELATIONS[relation] is not _equal or text.lower() not in _ANSWERS:
            raise InputError("", "--where", f"'{name} {relation} {text}': {name} is yes or no; write '{name} = no'")
        return _ANSWERS[text.lower()]

    def chosen(self, entries: Iterable[E], where: Sequence[str] | None, sort: str | None) -> list[E]:
        """The entries that keep every condition, in the order asked for; those without the sorted value last.

        `sort` is `name`, `family` or what an entry can have, with `-` before it for the largest first. Raises
        `InputError`.
        """
        conditions = [self.condition(text) for text in where or ()]
        chosen_entries = [entry for entry in entries if all(holds(entry) for holds in conditions)]
        if not sort:
            return chosen_entries
        key, descending = sort.removeprefix("-"), sort.startswith("-")
        if key in ("name", "family"):
            return sorted(chosen_entries, key=lambda entry: str(getattr(entry, key)), reverse=descending)
        name = self.name(key, "--sort")
        values = {entry.name: value for entry in chosen_entries if (value := self.value(entry, name)) is not None}
        having = (entry for entry in chosen_entries if entry.name in values)
        lacking = (entry for entry in chosen_entries if entry.name not in values)
        return [*sorted(having, key=lambda entry: values[entry.name], reverse=descending), *lacking]

    def columns(self, text: str | None) -> tuple[N, ...]:
        """The columns of `--columns density,cost`. Raises `InputError`."""
        if not text or text.strip() == "all":
            return self.every if text else self.usual
        return tuple(self.name(part, "--columns") for part in text.split(",") if part.strip())
