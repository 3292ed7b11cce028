"""What the columns of a file are called in refusals, and in the settings that would mend it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.units.lists import listed
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import written, yaml_line

_NONE: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Headers(Mapping[str, str]):
    """Our header of each column by name (`q1`: `q1_deg`), and what makes each of the file's columns where that is not
    its header (`formulas`). `mapped` are our headers that the `columns` of the settings (`file`) say, if there are."""

    names: Mapping[str, str]
    formulas: Mapping[str, str] = field(default_factory=lambda: _NONE)
    mapped: Sequence[str] = ()
    file: str = ""

    @classmethod
    def of(cls, columns: Mapping[str, ReadColumn], mapped: Mapping[str, str], file: str) -> Headers:
        """Those of columns as read, where settings map some."""
        names = {name: column.ours or column.header for name, column in columns.items()}
        formulas = {names[name]: column.formula for name, column in columns.items() if column.formula}
        return cls(names, formulas, tuple(mapped), file)

    def __getitem__(self, name: str) -> str:
        return self.names[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def clock(self) -> str:
        """Our header for a clock in seconds, as the file's is called where something makes it."""
        return next((ours for ours in ("time_s", "t_s") if ours in self.formulas), "t_s")

    def refusal(self, file: object, key: str, message: str, *remedies: Mapping[str, Any]) -> InputError:
        """Wrong input, with the settings of which any would do, said as they are written there. Formulas in `columns`
        are of our headers."""
        write = f"; {self.write(*remedies)}" if remedies else ""
        return InputError(file, key, message + write, *map(self._of_file, remedies))

    def write(self, *remedies: Mapping[str, Any]) -> str:
        """What to write, or to change where the settings have `columns` already, of which any would do."""
        of_file = [self._of_file(remedy) for remedy in remedies]
        if not self.mapped or not any("columns" in remedy for remedy in remedies):
            return f"write {' or '.join(map(written, of_file))} in recording.yaml"
        return f"in `columns` of {Path(self.file).name} {', or '.join(map(self._changed, of_file))}"

    def _of_file(self, remedy: Mapping[str, Any]) -> Mapping[str, Any]:
        """A remedy with formulas of the file's columns."""
        if not self.formulas or "columns" not in remedy:
            return remedy
        called = re.compile(rf"(?<![\w`])({'|'.join(map(re.escape, self.formulas))})(?![\w`])")

        def made(name: re.Match[str]) -> str:
            formula = re.sub(r"^`([^\W\d]\w*)`$", r"\1", self.formulas[name[1]])  # a plain word needs no quotes
            whole = called.fullmatch(text) or re.fullmatch(r"`[^`]*`|\w+", formula)
            return formula if whole else f"({formula})"

        columns = dict[str, str]()
        for ours, text in remedy["columns"].items():
            columns[ours] = called.sub(made, text)
        return {**remedy, "columns": columns}

    def _changed(self, remedy: Mapping[str, Any]) -> str:
        """How `columns` are changed so that a remedy is done."""
        lines = {ours: f"{ours}: {yaml_line(text, quoted=True)}" for ours, text in remedy.get("columns", {}).items()}
        there, more = ([ours for ours in lines if (ours in self.mapped) == known] for known in (True, False))
        parts: list[str] = []
        if there:
            of = f"the line{'s' if len(there) > 1 else ''} of {listed(there)}"
            parts.append(f"change {of} to {listed([lines[ours] for ours in there])}")
        if more:
            parts.append(f"add {listed([lines[ours] for ours in more])}")
        further = {key: value for key, value in remedy.items() if key != "columns"}
        return " and ".join([*parts, *([f"write {written(further)} beside them"] if further else [])])
