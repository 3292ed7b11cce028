"""What the columns of a foreign recording may mean: proposed from their headers and numbers, written as settings."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import looks_like_ours, otherwise_spelled, units_for
from linkwright.core.diagnose.reading.table import Table
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
