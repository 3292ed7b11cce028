"""The recording.yaml that is proposed for a foreign file, and how the file is read with it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.reading.read import is_motion_log, read_log
from linkwright.core.diagnose.reading.columns import canonical
from linkwright.core.diagnose.reading.files import read_table
from linkwright.core.diagnose.reading.foreign.header_units import name_and_unit
from linkwright.core.diagnose.reading.foreign.proposal import IGNORED, Meaning, is_motion, proposed, settings_text
from linkwright.core.diagnose.reading.foreign.words import said_by
from linkwright.core.diagnose.reading.formula import read_formula
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.reading.settings import ReadingSettings, content_of, find_settings, read_settings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.units.quantities import InputError

from .doubts import Doubt, doubts_of

SETTINGS = "recording.yaml"


@dataclass(frozen=True)
class Proposal:
    """What the columns of a file may mean: each column's `meanings`, the `settings` that say so, what was said of the
    file's layout (`notes`), whether it is a `motion` log, and how the file is read with them: `reads` in a line and
    `warnings`, or what is `wrong` (empty: nothing) with the `remedies`, settings of which any would do."""

    file: str
    arm: str
    meanings: tuple[Meaning, ...]
    settings: str
    notes: tuple[str, ...]
    motion: bool
    reads: str
    warnings: tuple[str, ...]
    wrong: str
    remedies: tuple[Mapping[str, Any], ...]
    doubts: tuple[Doubt, ...] | None = None


def propose(file: Path, arm: Arm | None, *, check: bool = False, rules: Rules = RULES) -> Proposal:
    """What the columns of a file may mean, for an arm or for one with as many joints as the file; what the settings
    beside it say stands. `check`: all that is doubtful of it is said too (`doubts`). Raises
    `InputError` where it is no table."""
    beside = find_settings(file)
    held = read_settings(beside)
    table = read_table(file, held.layout)
    arm_or_stand_in = arm if arm is not None else _stand_in(table)
    meanings, foreign = _completed(proposed(table, arm_or_stand_in), held, table.names)
    motion = is_motion(meanings)
    extra: dict[str, object] = {"observes": "motion"} if motion else {}
    if motion and not any(re.fullmatch(r"tau[0-9]+", meaning.what) for meaning in meanings):
        extra["torque_constants"] = "free"
    extra |= {name: value for name, value in content_of(beside).items() if name not in ("columns", "ignore")}
    head = f"# Proposed by `linkwright columns` for {file.name}. What is a guess says so.\n"
    settings = head + settings_text(meanings, extra, comments=True)
    reads, warnings, wrong = ("", (), None) if arm is None else _read(file, arm, settings, rules)
    fresh = tuple(warning for warning in warnings if warning not in table.notes)
    said, remedies = ("", ()) if wrong is None else wrong
    return Proposal(
        str(file),
        arm_or_stand_in.name,
        meanings,
        settings,
        (*table.notes, *foreign),
        motion,
        reads,
        fresh,
        said,
        remedies,
        doubts_of(file, arm, settings, _read, rules) if check and arm is not None else None,
    )


def _completed(
    meanings: Sequence[Meaning], held: ReadingSettings, names: Sequence[str]
) -> tuple[tuple[Meaning, ...], tuple[str, ...]]:
    """What is proposed, but for the columns of which the settings say what they are or that they are passed over; and a
    note of formulas that do not fit its columns (`names`): settings of a folder may be another file's."""
    said: list[Meaning] = []
    foreign: list[str] = []
    for name, formula in held.columns.items():
        try:
            read_formula(formula, names, file=held.file, key=f"columns.{name}")
        except InputError:
            foreign.append(name)
            continue
        what, _, unit = canonical(name).partition("_")
        said.append(Meaning(formula, what, unit, formula=formula))
    said += [Meaning(header, IGNORED) for header in held.ignore if header in names]
    known, whats = {item.header.strip("`") for item in said}, {item.what for item in said}
    place = Path(held.file).name
    passed_over = (
        f"{place} beside it has formulas that do not fit this file ({', '.join(foreign)}) and are not used. Settings "
        "for this file alone belong in a YAML file of its name."
    )
    others = (item for item in meanings if item.header not in known and item.what not in whats)
    return (*said, *others), (passed_over,) if foreign else ()


def _stand_in(table: Table) -> Arm:
    """An arm with as many joints that turn as the columns tell of."""
    meanings = [
        meaning
        for name in table.names
        if (meaning := said_by(re.sub(r"_[A-Za-z]+$", "", name_and_unit(name)[0]), ())) is not None
    ]
    labels = list(dict.fromkeys(item.label for item in meanings if item.label and item.base == "q"))
    first = 0 if any(item.number == 0 for item in meanings) else 1
    most = max(
        (item.number + 1 - first for item in meanings if item.number is not None and item.base == "q"), default=0
    )
    joints = tuple(Joint(name=name) for name in labels) or tuple(Joint() for _ in range(max(most, 1)))
    return Arm("an arm of as many joints", joints, tuple(Link(0.0, mass=0.0) for _ in joints))


def _read(
    file: Path, arm: Arm, settings: str, rules: Rules
) -> tuple[str, tuple[str, ...], tuple[str, tuple[Mapping[str, Any], ...]] | None]:
    """How a file is read with settings: in a line, what is said of it, and what is wrong with what would do."""
    with TemporaryDirectory() as folder:
        place = Path(folder) / SETTINGS
        place.write_text(settings, encoding="utf-8")
        try:
            if is_motion_log(file, arm, place):
                log = read_log(file, arm, place, rules=rules)
                return f"{log.size} samples in {log.time[-1]:.4g} s", log.warnings, None
            recording = read_recording(file, arm, place, rules=rules)
        except InputError as error:
            where = f"{error.key or file.name}: "
            return "", (), (f"{where}{error.message}".replace(str(place), SETTINGS), error.remedies)
    return f"{recording.size} readings", recording.warnings, None
