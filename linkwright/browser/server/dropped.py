"""Recordings that were dropped on a page: what their columns may mean, what is told of each, the question they make."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePosixPath
from types import MappingProxyType
from typing import Any

import numpy as np

import linkwright as lw
from linkwright.browser.server.folder import staged
from linkwright.browser.server.guard import MOST_UPLOADED
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import looks_like_ours, otherwise_spelled, units_for
from linkwright.core.diagnose.reading.settings import read_settings
from linkwright.core.diagnose.reading.table import Table, as_number, read_table
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import yaml_line

OTHER = "other"
"""A column of somebody's own: kept, as something that the error may depend on."""
IGNORED = "ignored"
_WHOLE = ("x", "y", "z", "payload", "temperature", "time", "fx", "fy", "fz", "qw", "qx", "qy", "qz")
_BARE = ("dir", "qw", "qx", "qy", "qz")
_IN_BRACKETS = re.compile(r"^(.*?)[\s_]*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_AT_END = re.compile(
    r"^(.*?)[\s_]+(deg|degrees?|rad|radians?|mm|m|um|kg|g|s|sec|min|h|ms|degc|k|n|nm|°|°c)$", re.IGNORECASE
)
_JOINT = re.compile(
    r"^(?:joint|axis|theta|angle|achse|gelenk|enc(?:oder)?|motor|pos(?:ition)?|actual|j|a|q|th)?"
    r"[\s_.-]*(?:joint|axis|angle|pos(?:ition)?|j|a|q)?[\s_.-]*([0-9]{1,2})(?:[\s_.-]*(?:angle|pos(?:ition)?|act(?:ual)?|enc(?:oder)?))?$"
)
_PLACE = re.compile(
    r"^(?:tcp|tip|tool|ee|end[\s_-]?effector|pos(?:ition)?|meas(?:ured)?|tracker|laser|point|p)?[\s_.-]*([xyz])$"
)
_WORDS = MappingProxyType(
    {
        "payload": re.compile(r"^(payload|load|mass|weight|last)$"),
        "temperature": re.compile(r"^(temp|temperature|t[\s_-]?amb|ambient)([\s_-].*)?$"),
        "time": re.compile(r"^(t|time|timestamp|elapsed|zeit|clock)$"),
    }
)
_SIDE = re.compile(r"^(?:dir|direction|side|approach)[\s_.-]*(?:joint|axis|j|q)?[\s_.-]*([0-9]{1,2})$")
_TORQUE = re.compile(r"^(?:tau|torque|moment|effort)[\s_.-]*(?:joint|axis|j|q)?[\s_.-]*([0-9]{1,2})$")
_TURN = 2.0 * math.pi * 1.05
"""No joint in radians is read beyond."""
_METRES = 20.0
"""No arm in metres reaches farther."""


@dataclass(frozen=True)
class Meaning:
    """What a column is taken for: one of ours (`q1`, `x`), OTHER or IGNORED; in a unit, `guessed` where its header has
    none."""

    header: str
    what: str
    unit: str = ""
    guessed: bool = False


def known_names(arm: Arm) -> tuple[str, ...]:
    """What a column of a recording of this arm can be."""
    joints = range(1, arm.size + 1)
    return (*(f"q{n}" for n in joints), *_WHOLE, *(f"dir{n}" for n in joints), *(f"tau{n}" for n in joints))


def units_of(what: str, arm: Arm) -> tuple[str, ...]:
    """The units that a column can be in; none for a side or a part of a quaternion."""
    found = re.fullmatch(r"([a-z]+)([0-9]+)?", what)
    if found is None or what in (OTHER, IGNORED) or found[1] in _BARE:
        return ()
    return units_for(found[1], arm, None if found[2] is None else int(found[2]) - 1)


def proposed(table: Table, arm: Arm) -> tuple[Meaning, ...]:
    """A meaning for each column, none twice."""
    taken: set[str] = set()
    found: list[Meaning] = []
    for header in table.names:
        meaning = _of(header, table, arm)
        if meaning.what in taken:
            meaning = Meaning(header, OTHER)
        if meaning.what != OTHER:
            taken.add(meaning.what)
        found.append(meaning)
    return tuple(found)


def _of(header: str, table: Table, arm: Arm) -> Meaning:
    ours = header if looks_like_ours(header) else otherwise_spelled(header)
    if ours is not None and looks_like_ours(ours):
        what, _, unit = ours.partition("_")
        if what in known_names(arm) and (not units_of(what, arm) or unit in units_of(what, arm)):
            return Meaning(header, what, unit)
    bracketed = _IN_BRACKETS.match(header) or _AT_END.match(header)
    name, unit = (header, "") if bracketed is None else (bracketed[1], bracketed[2])
    what = _named(name.strip().lower(), arm)
    units = units_of(what, arm)
    if what == OTHER or not units:
        return Meaning(header, what)
    spelled = otherwise_spelled(f"{what} [{unit}]") if unit else None
    told = (spelled or f"{what}_{unit}").partition("_")[2]
    if told in units:
        return Meaning(header, what, told)
    return Meaning(header, what, _guessed(table, header, units), guessed=True)


def _named(name: str, arm: Arm) -> str:
    for pattern, base in ((_SIDE, "dir"), (_TORQUE, "tau"), (_JOINT, "q")):
        joint = pattern.match(name)
        if joint is not None and 1 <= int(joint[1]) <= arm.size:
            return f"{base}{int(joint[1])}"
    place = _PLACE.match(name)
    if place is not None:
        return place[1]
    return next((word for word, pattern in _WORDS.items() if pattern.match(name)), OTHER)


def _guessed(table: Table, header: str, units: Sequence[str]) -> str:
    """The unit that the numbers can be in, where the header has none: by their size."""
    numbers = table.numbers(header)
    finite = np.abs(numbers[np.isfinite(numbers)])
    largest = float(finite.max()) if finite.size else 0.0
    if "rad" in units and largest <= _TURN:
        return "rad"
    if "m" in units and "mm" in units:
        return "m" if largest <= _METRES else "mm"
    return units[0]


def settings_text(meanings: Sequence[Meaning], extra: Mapping[str, str]) -> str:
    """The recording.yaml that says so; `extra` are further keys, empty ones left out."""
    lines = [f"{name}: {yaml_line(_number(name, value))}" for name, value in extra.items() if value]
    if any(each.what not in (OTHER, IGNORED) and _ours(each) != each.header for each in meanings):
        lines.append("columns:")
        lines += [
            f"  {_ours(each)}: {yaml_line(_quoted(each.header), quoted=True)}"
            for each in meanings
            if each.what not in (OTHER, IGNORED)
        ]
    ignored = [each.header for each in meanings if each.what == IGNORED]
    if ignored:
        lines.append("ignore: [" + ", ".join(yaml_line(header, quoted=True) for header in ignored) + "]")
    return "\n".join(lines) + "\n"


def _number(name: str, value: str) -> str | int:
    """A setting that is a number as one; what is none is left for the reader to refuse."""
    return int(value) if name == "skip_rows" and value.isascii() and value.isdecimal() and len(value) < 10 else value


def _ours(meaning: Meaning) -> str:
    return f"{meaning.what}_{meaning.unit}" if meaning.unit else meaning.what


def _quoted(header: str) -> str:
    return header if "`" in header else f"`{header}`"


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
    return title, inputs, {"arm": arm, "recording": recordings, "settings": settings, **more}
