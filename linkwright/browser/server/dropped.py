"""Recordings that were dropped on a page: what is told of each, and the question that they make together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePosixPath
from typing import Any

import numpy as np

import linkwright as lw
from linkwright.core.diagnose.reading.settings import read_settings
from linkwright.core.diagnose.reading.table import Table, as_number, read_table
from linkwright.core.units.quantities import InputError

from .folder import staged
from .guard import MOST_UPLOADED
from .mapping import IGNORED, OTHER, Meaning, proposed, settings_text

SETTINGS = "recording.yaml"
LAYOUT = ("skip_rows", "separator", "decimal", "encoding")
_LONGEST_NAME = 80
"""Bytes of a file's name that are kept, its end."""
_LOOKED_AT = 50
"""Rows that show how numbers are written."""
MOST = 12
"""Recordings that can be diagnosed at once here."""


@dataclass
class Dropped:
    """A recording: its name and bytes, what its columns are taken for, and what else is told of it by the settings'
    keys. `line` and `notes` say what was read, `problem` what is wrong."""

    name: str
    content: bytes
    told: dict[str, str] = field(default_factory=dict[str, str])
    meanings: list[Meaning] = field(default_factory=list[Meaning])
    line: str = ""
    notes: str = ""
    problem: str = ""

    def settings(self) -> str:
        """The settings file that says what is told. Raises `InputError` where two columns are said to be one."""
        named = [each.what for each in self.meanings if each.what not in (OTHER, IGNORED)]
        again = next((name for k, name in enumerate(named) if name in named[:k]), None)
        if again is not None:
            raise InputError(self.name, again, "is what two columns are said to be; choose one of them")
        return settings_text(self.meanings, self.told)

    def propose(self, arm: Any, like: Dropped | None = None) -> None:
        """Read the header anew and propose what the columns are: as those of another recording `like` it, where its
        columns are the same. `problem` says why that cannot be done."""
        self.line = self.notes = self.problem = ""
        self.meanings = []
        try:
            table = self._table()
            if "decimal" not in self.told and _has_decimal_commas(table):
                self.told = {**self.told, "decimal": ","}
                table = self._table()
        except InputError as error:
            self.problem = self._said(error)
            return
        found = list(proposed(table, arm.model))
        same = like is not None and [each.header for each in like.meanings] == [each.header for each in found]
        self.meanings = list(like.meanings) if same and like is not None else found

    def check(self, arm: Any) -> None:
        """Read the recording as it is described now."""
        self.line = self.notes = ""
        try:
            text = self.settings()
            with staged({self.name: self.content, SETTINGS: text.encode()}) as root:
                read = lw.read_recording(root / self.name, arm, settings=root / SETTINGS)
        except InputError as error:
            self.problem = self._said(error)
            return
        self.problem = ""
        self.line = repr(read)[1:-1]
        guessed = [each for each in self.meanings if each.guessed]
        notes = [f"{each.header}: {each.unit} is a guess by the size of its numbers." for each in guessed]
        self.notes = " ".join([*notes, *read.warnings])

    def change(self, number: int, what: str, unit: str) -> bool:
        """Say what a column is; whether that is another thing than before."""
        before = self.meanings[number]
        self.meanings[number] = replace(before, what=what, unit=unit, guessed=False)
        return (before.what, before.unit) != (what, unit)

    def _said(self, error: InputError) -> str:
        """What is wrong, and with which recording."""
        return str(error) if error.file == self.name else f"{self.name}: {error}"

    def _table(self) -> Table:
        layout = {name: self.told.get(name, "") for name in LAYOUT}
        with staged({self.name: self.content, SETTINGS: settings_text((), layout).encode()}) as root:
            return read_table(root / self.name, read_settings(root / SETTINGS).layout)


def _has_decimal_commas(table: Table) -> bool:
    """Whether more cells are numbers with a comma for a decimal point than with a point, or without either."""
    texts = [column for column in table.columns.values() if not isinstance(column, np.ndarray)]
    cells = [cell for column in texts for cell in column[:_LOOKED_AT]]
    by_point, by_comma = (sum(math.isfinite(as_number(cell, sign)) for cell in cells) for sign in ".,")
    return by_comma > by_point


def plain_name(name: str) -> str:
    """The name of a dropped file without folders, and with what every file system can keep."""
    own = PurePosixPath(name.replace("\\", "/")).name
    letters = "".join(each if each.isalnum() or each in "._- " else "-" for each in own[-_LONGEST_NAME:])
    return letters.encode()[-_LONGEST_NAME:].decode(errors="ignore").lstrip(".") or "recording.csv"


def with_another(held: Sequence[Dropped], fresh: Dropped) -> list[Dropped]:
    """The recordings with another, which takes the place of one of its name. Raises `InputError` where that is too
    much at once."""
    others = [each for each in held if each.name != fresh.name]
    if len(others) >= MOST:
        raise InputError(
            fresh.name, "", f"would be one more than the {MOST} recordings that are diagnosed at once here"
        )
    if sum(len(each.content) for each in (*others, fresh)) > MOST_UPLOADED:
        raise InputError(fresh.name, "", f"makes them more than {MOST_UPLOADED // 1024**2} MB together")
    place = next((k for k, each in enumerate(held) if each.name == fresh.name), len(others))
    return [*others[:place], fresh, *others[place:]]


def question(
    arm: str, text: str, held: Sequence[Dropped], **more: bool
) -> tuple[str, dict[str, bytes], dict[str, Any]]:
    """The title, the files and the question that the recordings make. Raises `InputError`."""
    inputs = {arm: text.encode()}
    recordings: list[str] = []
    settings: list[str] = []
    for number, each in enumerate(held, start=1):
        folder = "told" if len(held) == 1 else f"told/{number}"
        recordings.append(f"{folder}/{each.name}")
        settings.append(f"{folder}/{SETTINGS}")
        inputs |= {recordings[-1]: each.content, settings[-1]: each.settings().encode()}
    title = f"{arm} by {held[0].name}" if len(held) == 1 else f"{arm} by {len(held)} recordings"
    return title, inputs, {"arm": arm, "recordings": recordings, "settings": settings, **more}
