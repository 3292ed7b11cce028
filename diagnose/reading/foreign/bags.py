"""ROS bags (ROS 1, ROS 2 by SQLite or MCAP) as tables: joint states and other numbers by topic, on one clock.

Columns are called as PlotJuggler calls them: `/joint_states/shoulder_pan_joint/position`, `/pose/pose/position/x`.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.diagnose.reading.table import Table
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown

from .messages import Heard, Message, fields_of, messages_of

_ENDINGS = (".mcap", ".bag", ".db3")
_OF_A_JOINT = ("position", "velocity", "effort")
_MOST = 64
"""An array in a message with more numbers is a picture or a map, and nothing of an arm."""


def is_bag(path: Path) -> bool:
    """Whether a path is a ROS bag or MCAP: by its ending, or as a folder with a bag's metadata.yaml."""
    return path.suffix.lower() in _ENDINGS or os.path.isfile(path / "metadata.yaml")


def bag_table(path: Path, topics: Sequence[str] = ()) -> Table:
    """Table of a bag's numbers, a row for each message of the topic that tells most of joints.

    Args:
        path: The file, or the folder of a ROS 2 bag.
        topics: Those that count; all by default.

    Returns:
        The table: `time_s` (s, of the messages' stamps where they have some), and a column for each number. Other
        topics stand where that one has its messages, between their own in proportion; blank where they are silent.

    Raises:
        InputError: Where a library is not installed, the file is no bag, has no topic of these, or no numbers.
    """
    if not path.exists():
        raise InputError(path, "", "there is no such file")
    topics_heard = Heard(set(), set())
    streams: dict[tuple[str, tuple[str, ...]], _Stream] = {}
    for message in messages_of(path, topics, topics_heard):
        names = _joint_names(message)
        numbers = dict(_joint_numbers(message, names) if message.kind == "JointState" else _numbers(message))
        if numbers:
            stream = streams.setdefault((message.topic, names), _Stream(message.topic, message.kind == "JointState"))
            stream.add(_stamp(message), message.received, numbers)
    there = ", ".join(sorted(topics_heard.topics))
    if lacking := [topic for topic in topics if topic not in topics_heard.topics]:
        raise InputError(path, "topics", f"there is no {lacking[0]}; the bag has {there or 'none'}")
    if not streams:
        why = f"; it has {there}" if there else ""
        raise InputError(path, "", f"has no messages with numbers of an arm{why}")
    unknown = ", ".join(sorted(item or "no type" for item in topics_heard.unknown))
    notes = [f"Messages of {unknown} are not used: what they hold is not known."] if unknown else []
    if topics_heard.broken:
        notes.append(f"{path.name} breaks off ({shown(topics_heard.broken)}). The file was read up to there.")
    base = max(streams.values(), key=lambda item: item.rank)
    clock = base.clock
    columns: dict[str, Array] = {"time_s": clock, **{name: base.column(name) for name in base.cells}}
    for each in streams.values():
        if each is not base:
            notes += _joined(each, base, columns, RULES)
    return Table(str(path), MappingProxyType(columns), np.arange(1, len(clock) + 1), notes=tuple(notes))


@dataclass
class _Stream:
    """Messages of one topic (of joint states: of the same joints): their stamps (nan where they have none) and when
    they were received (s), numbers by column."""

    topic: str
    joints: bool
    stamps: list[float] = field(default_factory=list[float])
    received: list[float] = field(default_factory=list[float])
    cells: dict[str, list[float]] = field(default_factory=dict[str, list[float]])

    def add(self, stamp: float, received: float, numbers: Mapping[str, float]) -> None:
        """A further message."""
        for name, value in numbers.items():
            column = self.cells.setdefault(name, [])
            column += [math.nan] * (len(self.stamps) - len(column))
            column.append(value)
        self.stamps.append(stamp)
        self.received.append(received)

    def column(self, name: str) -> Array:
        """A column (N,), nan where a message did not have it."""
        cells = self.cells[name]
        return np.array([*cells, *[math.nan] * (len(self.stamps) - len(cells))])

    @property
    def stamped(self) -> bool:
        """Whether the messages have stamps of their own."""
        return bool(np.isfinite(self.stamps).all())

    @property
    def clock(self) -> Array:
        """When each message is of (N,), s: its stamp, else when it was received."""
        return np.array(self.stamps if self.stamped else self.received)

    @property
    def rank(self) -> tuple[int, int]:
        """How much it tells of joints: efforts and positions, positions, nothing; and how often."""
        effort, position = (any(name.endswith(f"/{what}") for name in self.cells) for what in ("effort", "position"))
        return (2 * effort + position if self.joints else 0, len(self.stamps))


def _joined(stream: _Stream, base: _Stream, columns: dict[str, Array], rules: Rules) -> list[str]:
    """Columns of another topic at the base's instants, into `columns`; sentences that say so."""
    if len(stream.stamps) < 2:
        return [f"{stream.topic} has one message and is not used."]
    # Where one of them has no stamps, both were received by one clock.
    both = stream.stamped and base.stamped
    clock, times = (base.clock, stream.clock) if both else (np.array(base.received), np.array(stream.received))
    order = np.argsort(times, kind="stable")
    times = times[order]
    period = float(np.median(np.diff(times)))
    after = np.clip(np.searchsorted(times, clock), 1, len(times) - 1)
    known = np.minimum(np.abs(clock - times[after - 1]), np.abs(clock - times[after])) <= rules.log.gap * period
    for name in stream.cells:
        if name not in columns:
            columns[name] = np.where(known, np.interp(clock, times, stream.column(name)[order]), np.nan)
    if np.array_equal(times, clock):
        return []
    rates = " and ".join(f"{1.0 / max(float(np.median(np.diff(np.sort(of)))), 1e-9):.3g} Hz" for of in (times, clock))
    return [f"{stream.topic} is read at the instants of {base.topic} ({rates})."]


def _joint_names(message: Message) -> tuple[str, ...]:
    return tuple(map(str, message.body.get("name", ()))) if message.kind == "JointState" else ()


def _stamp(message: Message) -> float:
    """The stamp of a message's header, s; nan where it has none."""
    stamp = fields_of(fields_of(message.body.get("header")).get("stamp"))
    parts = [stamp.get(name, stamp.get(other)) for name, other in (("sec", "secs"), ("nanosec", "nsec"))]
    if not all(isinstance(part, int | float) for part in parts):
        return math.nan
    return float(parts[0]) + 1e-9 * float(parts[1]) or math.nan


def _joint_numbers(message: Message, names: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    for what in _OF_A_JOINT:
        values = message.body.get(what, ())
        if names and len(values) != len(names):
            continue  # a driver that knows no efforts leaves the list empty
        for number, value in enumerate(values):
            yield f"{message.topic}/{names[number] if names else f'[{number}]'}/{what}", float(value)


def _numbers(message: Message) -> Iterator[tuple[str, float]]:
    for name, value in message.body.items():
        if name != "header":
            yield from _of(value, f"{message.topic}/{name}")


def _of(value: Any, name: str) -> Iterator[tuple[str, float]]:
    """Numbers in a field, by the path to them; texts and long arrays are passed over."""
    if isinstance(value, bool | int | float | np.integer | np.floating):
        yield name, float(value)
    elif inner := fields_of(value):
        for part, item in inner.items():
            yield from _of(item, f"{name}/{part}")
    elif not isinstance(value, str | bytes) and hasattr(value, "__len__") and len(value) <= _MOST:
        for number, item in enumerate(value):
            if isinstance(item, bool | int | float | np.integer | np.floating):
                yield f"{name}[{number}]", float(item)
