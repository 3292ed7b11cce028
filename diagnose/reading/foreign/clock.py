"""The clock of a foreign file: stamps in one column or two, and in which unit they count."""

from __future__ import annotations

import datetime
import re
from dataclasses import dataclass
from itertools import takewhile
from types import MappingProxyType

import numpy as np

from linkwright.core.diagnose.reading.table import Table
from linkwright.core.sections.numeric import Array

_SECONDS = re.compile(r"(?P<of>.*?)(?:header[./])?stamp[./]secs?$")
_NANOSECONDS = ("nanosec", "nsecs", "nsec", "nanosecs")
_CLOCKS = (
    re.compile(r".*header[./]stamp$"),
    re.compile(r"(?:.*[./])?(?:t|time|timestamp|stamp|elapsed|zeit(?:stempel)?|clock)$", re.IGNORECASE),
    re.compile(r"(?:%time|__time|log_?time|rosbagtimestamp|robot_time|header[./_]?stamp)$", re.IGNORECASE),
)
_UNITS = MappingProxyType({"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9})
_SINCE_1970 = (1e8, 1e10)
"""Seconds since 1970, from 1973 to 2286."""
_SHORTEST, _LONGEST = 5e-5, 5.0
"""Seconds from sample to sample of what logs motions."""


@dataclass(frozen=True)
class Clock:
    """A column that is a clock, the unit that it counts in (whether that was guessed), the formula that makes it of two
    columns (empty: it is one), and what is to be said of it."""

    header: str
    unit: str
    guessed: bool
    formula: str = ""
    said: str = ""


def clock_of(table: Table, beside: str) -> Clock | None:
    """The clock of a table, best that of the topic that a column `beside` it is of; None where there is none."""
    pairs: list[tuple[int, str, str]] = []
    for header in table.names:
        hits = _SECONDS.fullmatch(header)
        if hits is not None:
            stem = re.sub(r"secs?$", "", header)
            other = next((f"{stem}{item}" for item in _NANOSECONDS if f"{stem}{item}" in table.names), "")
            if other:
                pairs.append((_alike(header, beside), header, other))
    if pairs:
        _, seconds, other = max(pairs)
        return Clock(seconds, "s", False, f"`{seconds}` + `{other}`*1e-9", "s, as ROS stamps its messages")
    for pattern in _CLOCKS:
        hits = [name for name in table.names if pattern.fullmatch(name)]
        for header in sorted(hits, key=lambda item: _alike(item, beside), reverse=True):
            unit = counted_in(table.numbers(header))
            if unit is not None:
                return Clock(header, unit, True, said="by the size of its numbers")
    stamped = [name for name in table.names if has_stamps(table, name)]
    if len(stamped) == 1 and _runs(table, stamped[0]):
        return Clock(stamped[0], "s", False, said="the only column of time stamps")
    return None


def _runs(table: Table, header: str) -> bool:
    """Whether the stamps of a column go on from row to row: a date alone is no clock."""
    stamps = [iso_stamp(table.text(header, index)) for index in range(len(table.row))]
    seconds = [stamp.timestamp() for stamp in stamps if stamp is not None]
    return len(set(seconds)) > len(seconds) / 2 and seconds == sorted(seconds)


def has_stamps(table: Table, column: str) -> bool:
    """Whether the cells of a column are time stamps by ISO 8601, and no numbers."""
    if np.isfinite(table.numbers(column)).any():
        return False
    texts = (table.text(column, index) for index in range(len(table.row)))
    first = next((text for text in texts if text), "")
    return iso_stamp(first) is not None


def iso_stamp(text: str) -> datetime.datetime | None:
    """A time stamp by ISO 8601, None for anything else."""
    try:
        return datetime.datetime.fromisoformat(text)
    except ValueError:
        return None


def _alike(header: str, other: str) -> int:
    """How many characters two headers begin with alike."""
    same = (a == b for a, b in zip(header, other, strict=False))
    return sum(1 for _ in takewhile(bool, same))


def counted_in(numbers: Array) -> str | None:
    """The unit in which stamps count: that of seconds since 1970, or of steps that a log can have."""
    there = numbers[np.isfinite(numbers)]
    if len(there) < 2:
        return None
    middle, step = abs(float(np.median(there))), float(np.median(np.abs(np.diff(there))))
    for unit, size in _UNITS.items():
        if _SINCE_1970[0] < middle * size < _SINCE_1970[1]:
            return unit
    if step <= 0.0:
        return None
    return next((unit for unit, size in _UNITS.items() if _SHORTEST <= step * size <= _LONGEST), "s")
