"""Recordings that were dropped on a page: the meanings of their columns, their settings, and the resulting call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any, cast

import linkwright as lw
from linkwright.browser.server.folder import staged
from linkwright.browser.server.guard import MOST_UPLOADED
from linkwright.core.diagnose.reading.files import read_table
from linkwright.core.diagnose.reading.foreign.proposal import Meaning, proposed, settings_text
from linkwright.core.diagnose.reading.foreign.remedy import with_columns, with_ignored
from linkwright.core.diagnose.reading.settings import read_settings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import yaml_line
from linkwright.face.motion.log import logs_of

SETTINGS = "recording.yaml"
FURTHER = "further"
"""What is told by further lines of the settings."""
LAYOUT = ("skip_rows", "separator", "decimal", "encoding")
_LONGEST_NAME = 80
"""Bytes of a file's name that are kept, its end."""
_SIMULATED, _OFF = 30, 0.25
"""Poses, and degrees that an encoder is off, of a recording to try."""
MOST = 12
"""Recordings that can be diagnosed at once here."""


@dataclass
class Dropped:
    """A recording: its name and bytes, what its columns are taken for, and what else is told of it by the settings'
    keys. `line` and `notes` say what was read, `log` whether that is a motion log, `problem` what is wrong, `remedies`
    the settings that would do."""

    name: str
    content: bytes
    given: dict[str, str] = field(default_factory=dict[str, str])
    meanings: list[Meaning] = field(default_factory=list[Meaning])
    line: str = ""
    notes: str = ""
    log: bool = False
    problem: str = ""
    remedies: tuple[Mapping[str, Any], ...] = ()

    def settings(self) -> str:
        """The settings file that says what is reported. Raises `InputError` where two columns are said to be one."""
        named = [meaning.what for meaning in self.meanings if meaning.named]
        again = next((name for k, name in enumerate(named) if name in named[:k]), None)
        if again is not None:
            raise InputError(self.name, again, "is what two columns are said to be; choose one of them")
        settings = {name: text for name, text in self.given.items() if name != FURTHER}
        return settings_text(self.meanings, settings) + self.given.get(FURTHER, "") + "\n"

    def propose(self, arm: Any, like: Dropped | None = None) -> None:
        """Read the header anew and propose what the columns are: as those of another recording `like` it, where its
        columns are the same. `problem` says why that cannot be done."""
        self.line = self.notes = self.problem = ""
        self.meanings, self.remedies = [], ()
        try:
            table = self._table()
            if "decimal" not in self.given and table.decimal == ",":
                self.given = {**self.given, "decimal": ","}
        except InputError as error:
            self._refuse(error)
            return
        meanings = list(proposed(table, arm.model))
        same = like is not None and [meaning.header for meaning in like.meanings] == [
            meaning.header for meaning in meanings
        ]
        self.meanings = list(like.meanings) if same and like is not None else meanings

    def check(self, arm: Any) -> None:
        """Read the recording as it is described now."""
        self.line = self.notes = ""
        self.log = False
        try:
            text = self.settings()
            with staged({self.name: self.content, SETTINGS: text.encode()}) as root:
                place, settings = root / self.name, root / SETTINGS
                logs = logs_of(place, arm, settings)
                read = logs[0] if logs else lw.read_recording(place, arm, settings=settings)
        except InputError as error:
            self._refuse(error)
            return
        self.problem, self.remedies, self.log = "", (), bool(logs)
        self.line = repr(read)[1:-1]
        guessed = [meaning for meaning in self.meanings if meaning.guessed]
        notes = [f"{item.header}: {item.unit} is a guess {item.said}." for item in guessed]
        self.notes = " ".join([*notes, *read.warnings])

    def take(self, remedy: Mapping[str, Any]) -> None:
        """Settle it so: columns made otherwise or passed over, keys told. Raises `InputError`."""
        if isinstance(columns := remedy.get("columns"), dict):
            self.meanings = with_columns(self.meanings, cast(dict[str, Any], columns), file=self.name)
        if isinstance(ignored := remedy.get("ignore"), list):
            self.meanings = with_ignored(self.meanings, cast(list[object], ignored))
        for key, value in remedy.items():
            if isinstance(value, str):
                self.given = {**self.given, key: value}
            elif key not in ("columns", "ignore"):
                lines = [self.given.get(FURTHER, ""), f"{key}: {yaml_line(value)}"]
                self.given = {**self.given, FURTHER: "\n".join(filter(None, lines))}

    def change(self, number: int, what: str, unit: str, factor: float, zero: float) -> bool:
        """Say what a column is, by which factor and with what added; whether that is another thing than before."""
        before = self.meanings[number]
        other = (before.what, before.unit) != (what, unit)
        if not other and (before.factor, before.zero) == (factor, zero):
            return False
        made = "" if before.what != what else before.formula
        self.meanings[number] = Meaning(before.header, what, unit, formula=made, factor=factor, zero=zero)
        return True

    def _refuse(self, error: InputError) -> None:
        """Say what is wrong, with which recording, and what would do."""
        self.problem = str(error) if error.file == self.name else f"{self.name}: {error}"
        self.remedies = error.remedies

    def _table(self) -> Table:
        layout = {name: self.given.get(name, "") for name in LAYOUT}
        with staged({self.name: self.content, SETTINGS: settings_text((), layout).encode()}) as root:
            return read_table(root / self.name, read_settings(root / SETTINGS).layout)


def simulated(arm: lw.Arm) -> Dropped:
    """A recording that an arm makes whose last encoder is off by a quarter of a degree. Raises `InputError`,
    `NoAnswer`."""
    turning = [number for number, joint in enumerate(arm.model.joints, start=1) if joint.revolute and joint.driven]
    made = lw.simulate(arm, poses=_SIMULATED, sides="one").table
    for number in turning[-1:]:
        made[f"q{number}_deg"] += _OFF
    return Dropped("simulated.csv", made.to_csv(index=False).encode())


def plain_name(name: str) -> str:
    """The name of a dropped file without folders, and with what every file system can keep."""
    name_alone = PurePosixPath(name.replace("\\", "/")).name
    letters = "".join(item if item.isalnum() or item in "._- " else "-" for item in name_alone[-_LONGEST_NAME:])
    return letters.encode()[-_LONGEST_NAME:].decode(errors="ignore").lstrip(".") or "recording.csv"


def with_another(held: Sequence[Dropped], fresh: Dropped) -> list[Dropped]:
    """The recordings with another, which takes the place of one of its name. Raises `InputError` where that is too
    much at once."""
    others = [item for item in held if item.name != fresh.name]
    if len(others) >= MOST:
        raise InputError(
            fresh.name, "", f"would be one more than the {MOST} recordings that are diagnosed at once here"
        )
    if sum(len(item.content) for item in (*others, fresh)) > MOST_UPLOADED:
        raise InputError(fresh.name, "", f"makes them more than {MOST_UPLOADED // 1024**2} MB together")
    place = next((k for k, item in enumerate(held) if item.name == fresh.name), len(others))
    return [*others[:place], fresh, *others[place:]]


def question(
    arm: str, files: Mapping[str, bytes], held: Sequence[Dropped], **more: bool
) -> tuple[str, dict[str, bytes], dict[str, Any]]:
    """The title, the files (those of the arm among them) and the question that the recordings make. Raises
    `InputError`."""
    inputs = dict(files)
    recordings: list[str] = []
    settings: list[str] = []
    for number, item in enumerate(held, start=1):
        folder = "told" if len(held) == 1 else f"told/{number}"
        recordings.append(f"{folder}/{item.name}")
        settings.append(f"{folder}/{SETTINGS}")
        inputs |= {recordings[-1]: item.content, settings[-1]: item.settings().encode()}
    title = f"{arm} by {held[0].name}" if len(held) == 1 else f"{arm} by {len(held)} recordings"
    return title, inputs, {"arm": arm, "recording": recordings, "settings": settings, **more}
