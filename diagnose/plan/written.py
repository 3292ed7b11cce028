"""A plan as a file that is the recording once its tip is filled in, and such a file read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import Number, Stood
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, kinds_of, labels
from linkwright.core.diagnose.reading.columns import UnitMissing, meaning_of
from linkwright.core.diagnose.reading.files import read_table
from linkwright.core.diagnose.reading.named_columns import measurable
from linkwright.core.diagnose.reading.read import recording_from
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Layout, Table
from linkwright.core.diagnose.reading.write import csv_text, recording_columns
from linkwright.core.diagnose.recording import Recording, since_the_reading_before
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .plan_request import TURNS, Asked
from .simulate import Plan, simulate
from .tried import Tried

ALONG_BAR = "bar_mm"
_TURNS = ("qw", "qx", "qy", "qz")
"""Three turns are four numbers of a quaternion."""
_CLOCK = (2.0, 20.0, 300.0)
"""Seconds from reading to reading, for a move, and to change the payload."""


def _header(number: Number) -> str:
    """The column of a number, with its unit."""
    return f"{number.column}_{'deg' if number.quantity == 'angle' else 'mm'}"


def left_blank() -> tuple[str, ...]:
    """What a plan leaves blank of what a recording holds."""
    numbers = [number for kind in INSTRUMENTS.values() for number in kind.numbers if number.column]
    return (*dict.fromkeys(_header(number) for number in numbers), *_TURNS)


def _headers(axis: str) -> tuple[str, ...]:
    """The columns of one of the numbers that an instrument reads."""
    if axis in TURNS:
        return _TURNS if axis == TURNS[0] else ()
    number = next(number for kind in INSTRUMENTS.values() for number in kind.numbers if number.name == axis)
    return (_header(number),) if number.column else ()


def to_record(arm: Arm, tried: Tried, order: NDArray[np.int64], asked: Asked) -> Recording:
    """Some of the visits tried, in their `order` (N,), as a recording whose tip is where the arm stands undeformed, at
    what it touches; each visit read `repeats` times, by a clock of usual paces."""
    (reading, move, exchange), each = _CLOCK, asked.repeats
    q, sides, payload = tried.q[order], tried.sides[order], tried.payload[order]
    label = None if tried.label is None else tried.label[order]
    visits = len(q)
    change = np.concatenate([[0.0], np.cumsum(np.diff(payload) != 0.0)])
    start = np.arange(visits) * (move + each * reading) + change * exchange
    time = np.repeat(start, each) + np.tile(np.arange(each) * reading, visits)
    read = np.repeat(q, each, axis=0)
    return Recording(
        file="",
        q=read,
        tip=_undeformed(arm, read),
        row=np.arange(1, visits * each + 1),
        time=time,
        sides=np.repeat(sides, each, axis=0),
        last_moves=since_the_reading_before(read),
        payload_mass=np.repeat(payload, each),
        branch=arm.tip,
        touches=None if label is None else np.repeat(label, each),
        bar_at=None if tried.along is None else np.repeat(tried.along[order], each),
        instrument=Instrument() if label is None else _labelled_by(asked.reads, label),
    )


def _labelled_by(reads: Instrument, label: NDArray[np.int64]) -> Instrument:
    return replace(reads, labels=tuple(f"{number + 1}" for number in range(int(label.max()) + 1)))


def as_read(recording: Recording, arm: Arm, asked: Asked) -> Recording:
    """Readings of the tip's whole place as another instrument reads them without noise; of that place as they are."""
    if not asked.slots:
        return recording
    if asked.touches:
        zeros = np.zeros((recording.size, len(asked.slots)))
        return replace(recording, tip=zeros, slots=np.tile(asked.slots, (recording.size, 1)))
    (kind,) = kinds_of(asked.slots)
    if kind.turns_with:
        made = Plan(
            1, noise=0.0, at=recording, seed=asked.seed, slots=asked.slots, instrument=asked.reads, every_row=True
        )
        return simulate(weightless(arm), made).recording
    tip = np.zeros((recording.size, 3))
    tip[:, : recording.tip.shape[1]] = recording.tip
    read = kind.simulated(Stood(tip, None, None, arm), asked.reads, np.random.default_rng(asked.seed))
    instrument = kind.recorded(asked.reads, anchor_free=asked.anchor_free)
    return replace(recording, tip=read, slots=np.tile(asked.slots, (recording.size, 1)), instrument=instrument)


def plan_text(recording: Recording, arm: Arm, axes: Sequence[str], *, torques: bool = False) -> str:
    """The plan as CSV: what a recording has, with blank columns for what the instrument sees of the tip, and for the
    drives' `torques`."""
    columns = [column for column in recording_columns(recording, arm) if column[0] not in (*left_blank(), ALONG_BAR)]
    if recording.bar_at is not None:
        columns.append((ALONG_BAR, 1e3 * recording.bar_at, 5))
    units = ["Nm" if joint.revolute else "N" for joint in arm.joints]
    held = [f"{arm.column('tau', index)}_{unit}" for index, unit in enumerate(units)] if torques else []
    left = [name for axis in axes for name in _headers(axis)]
    columns += [(name, np.full(recording.size, np.nan), 0) for name in (*held, *left)]
    if recording.touches is None:
        return csv_text(columns, [])
    names = recording.instrument.labels
    touched = [names[which] for which in recording.touches.tolist()]
    return csv_text(columns, [(labels()[recording.instrument.kinds[0]], touched)])


def read_plan(path: Path | str, arm: Arm, *, rules: Rules = RULES) -> Recording:
    """The poses, sides and payloads of a plan or of a recording, in their order, whatever it says of the tip, which is
    where the arm stands undeformed. Raises `InputError`."""
    table = read_table(Path(path), Layout())
    q = completed(arm, np.stack([_coordinate(table, arm, index) for index in range(arm.size)], axis=1))
    tips = _undeformed(arm, q)
    touched = tuple(labels().values())
    columns = {name: cells for name, cells in table.columns.items() if name not in touched and not _of_tip(name, arm)}
    columns |= {f"{axis}_mm": 1e3 * values for axis, values in zip("xyz", tips.T, strict=False)}
    read = recording_from(
        replace(table, columns=MappingProxyType(columns)), arm, ReadingSettings(tip=arm.tip), rules=rules
    )
    return _labelled(replace(read, frame="known", tool="known", sigma=None), table, arm)


def _labelled(recording: Recording, table: Table, arm: Arm) -> Recording:
    """A plan with what each of its visits touches, where it has a column that says so."""
    for kind, name in labels().items():
        if name not in table.columns:
            continue
        cells = [table.text(name, index) for index in np.searchsorted(table.row, recording.row).tolist()]
        if all(cells):
            names = tuple(dict.fromkeys(cells))
            which = np.array([names.index(text) for text in cells], dtype=np.int64)
            along = _along_bars(table, recording, arm) if kind == "bar" else None
            instrument = Instrument((kind,), labels=names)
            return replace(recording, touches=which, bar_at=along, instrument=instrument)
    return recording


def _along_bars(table: Table, recording: Recording, arm: Arm) -> Array:
    """How far along its bar each reading of a plan touches (N,), m."""
    for header in table.names:
        if header.partition("_")[0] == "bar" and header not in labels().values():
            meaning = meaning_of(header, arm, file=table.file)
            if meaning is None:
                continue
            values = measurable(table.numbers(header) * meaning.factor + meaning.offset)
            return values[np.searchsorted(table.row, recording.row)]
    raise InputError(table.file, "bar_mm", "is missing: where along its bar each visit touches, e.g. 0 and 500")


def weightless(arm: Arm) -> Arm:
    """The arm with links of unknown mass taken for nothing, as `observe` has it."""
    return arm.with_links(
        tuple(replace(link, mass=0.0) if link.section is None and link.mass is None else link for link in arm.links)
    )


def _undeformed(arm: Arm, q: Array) -> Array:
    return tip_position(arm, q)[:, : 2 if arm.planar() else 3]


def _of_tip(header: str, arm: Arm) -> bool:
    try:
        meaning = meaning_of(header, arm, file="")
    except UnitMissing:
        return False
    columns = [name for kind in INSTRUMENTS.values() for name in kind.columns]
    return meaning is not None and meaning.base in (*columns, "qw", "qx", "qy", "qz", "rx", "ry", "rz", "bar", "tau")


def _coordinate(table: Table, arm: Arm, index: int) -> Array:
    """One joint's coordinates; zero where it has no drive and no column."""
    for header in table.names:
        meaning = meaning_of(header, arm, file=table.file)
        if meaning is not None and meaning.name == f"q{index + 1}":
            return measurable(table.numbers(header) * meaning.factor + meaning.offset)
    if not arm.joints[index].driven:
        return np.zeros(len(table.row))
    unit = "deg" if arm.joints[index].revolute else "mm"
    raise InputError(table.file, "", f"has no column q{index + 1}_{unit}; a plan names every joint's coordinate")
