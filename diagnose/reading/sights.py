"""What each row of a file observes: the columns of every kind, where they are filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument, Slots
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, kind_at, labels, slots_of
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError

from .columns import example_headers
from .read_column import ReadColumn
from .settings import ReadingSettings
from .table import Table

_ALONG_BAR = "bar"


@dataclass(frozen=True)
class Sights:
    """What rows hold: numbers `tip` (N, W), zero where there is none, `slots` (N, W) that say what each is (-1:
    none), `touches` (N,), `bar_at` (N,) m how far along its bar each touches (None without bars) and the
    `instrument`."""

    tip: Array
    slots: Slots
    touches: Slots
    bar_at: Array | None
    instrument: Instrument


def in_part(columns: Mapping[str, ReadColumn], table: Table, held: ReadingSettings, some_blank: float) -> bool:
    """Whether something else than the whole place may have been measured: where the settings say so, and where cells of
    x, y or z are blank in so many rows that nobody forgot them."""
    if held.instrument is not None:
        return True
    present = [columns[name] for name in ("x", "y", "z") if name in columns]
    if not present or held.columns:
        return False
    blank = np.stack([_blank(table, item.header) for item in present], axis=1)
    return float(np.mean(blank.any(axis=1) & ~blank.all(axis=1))) > some_blank


def _blank(table: Table, header: str) -> Array:
    if header not in table.columns:
        return np.zeros(len(table.row), dtype=bool)
    return np.array([table.text(header, index).lower() in ("", "nan") for index in range(len(table.row))])


def sights_of(
    columns: dict[str, ReadColumn], table: Table, held: ReadingSettings, arm: Arm
) -> tuple[Sights | None, dict[str, ReadColumn], list[RejectedRow], list[str]]:
    """What each row observes, the other columns, the rows that hold nothing usable, and what else is to be said. None
    where every row holds the whole place of the tip."""
    instrument = held.instrument or Instrument()
    flat, total = arm.planar(), len(table.row)
    if "camera" in instrument.kinds:
        return _of_camera(columns, table, held, arm)
    every = {name for kind in INSTRUMENTS.values() for name in kind.columns}
    rest = {name: column for name, column in columns.items() if name not in every | {_ALONG_BAR}}
    numbers, reasons, sentences = _numbers(columns, table, instrument, flat=flat)
    touches, names, touched = _touches(table, held, instrument, flat=flat)
    numbers += touched
    bar_at = _along_bars(columns, table, touches, reasons, arm) if "bar" in instrument.kinds else None
    _all_there(instrument, {slot for slot, _ in numbers}, table, held, arm)
    values = np.stack([item for _, item in numbers], axis=1)
    there = np.isfinite(values)
    if instrument.kinds == ("position",) and there.all() and len(numbers) == (2 if flat else 3):
        return None, columns, [], sentences
    slots = np.where(there, np.array([slot for slot, _ in numbers]), -1)
    for index in np.flatnonzero(~there.any(axis=1)).tolist():
        reasons.setdefault(index, []).append("nothing that is observed is filled in")
    sound = np.array([index not in reasons for index in range(total)], dtype=bool)
    _enough_touches(table, touches, names, slots, sound, flat=flat)
    if bar_at is not None:
        _long_enough(table, touches, names, slots, sound, bar_at)
    if held.instrument is None:
        some = table.row[~there.all(axis=1)]
        sentences.append(f"Only what was measured counts: cells are blank in {rows_text(some)}.")
    sights = Sights(np.where(there, values, 0.0), slots, touches, bar_at, replace(instrument, labels=tuple(names)))
    return sights, rest, _rejected(table, reasons), sentences


def _rejected(table: Table, reasons: Mapping[int, Sequence[str]]) -> list[RejectedRow]:
    """Rows (from 0) with what is wrong in each."""
    return [RejectedRow(int(table.row[index]), "; ".join(reasons[index])) for index in sorted(reasons)]


def _numbers(
    columns: Mapping[str, ReadColumn], table: Table, instrument: Instrument, *, flat: bool
) -> tuple[list[tuple[int, Array]], dict[int, list[str]], list[str]]:
    """The numbers that rows hold, each with its slot; what is wrong with cells, by row; and what else is to be said.
    Raises `InputError` where most cells of a column cannot be."""
    sentences: list[str] = []
    numbers: list[tuple[int, Array]] = []
    reasons: dict[int, list[str]] = {}
    for slot in sorted(slot for kind in instrument.kinds for slot in slots_of(kind)):
        kind, number = kind_at(slot)
        name = number.column
        if name not in columns:
            continue
        column = columns[name]
        if flat and not number.in_plane and kind.framed:
            sentences.append(f"{column.header} is not used: the arm does not leave its plane.")
            continue
        for index in np.flatnonzero(~np.isfinite(column.values)).tolist():
            fault = column.fault(index)
            if not fault.lower().endswith(("is blank", "is nan")):
                reasons.setdefault(index, []).append(fault)
        wrong, why, mostly = kind.impossible(column.values)
        for index in np.flatnonzero(wrong).tolist():
            reasons.setdefault(index, []).append(f"{column.header} {why}")
        if wrong.any() and wrong.sum() > 0.5 * np.isfinite(column.values).sum():
            row = int(table.row[int(np.argmax(wrong))])
            raise InputError(table.file, column.header, mostly.format(row=row))
        numbers.append((slot, kind.of_file(column.values)))
    return numbers, reasons, sentences


def _of_camera(
    columns: dict[str, ReadColumn], table: Table, held: ReadingSettings, arm: Arm
) -> tuple[Sights, dict[str, ReadColumn], list[RejectedRow], list[str]]:
    """Where a target is in a camera's frame: whole rows."""
    if arm.planar():
        would_do = "`observes: position`, `frame: free`, `tool: free`, `orientation: free`"
        raise InputError(held.file, "observes", f"camera needs an arm in space; of one in the plane, write {would_do}")
    for name in ("x", "y", "z"):
        if name not in columns:
            would_do = f"of a camera, z is how deep; write {example_headers(name, arm)}"
            raise InputError(table.file, name, f"is missing: {would_do}")
    reasons: dict[int, list[str]] = {}
    for name in ("x", "y", "z"):
        for index in np.flatnonzero(~np.isfinite(columns[name].values)).tolist():
            reasons.setdefault(index, []).append(columns[name].fault(index))
    values = np.stack([columns[name].values for name in ("x", "y", "z")], axis=1)
    total, instrument = len(values), held.instrument or Instrument()
    slots = np.tile(slots_of("camera"), (total, 1))
    rest = {name: column for name, column in columns.items() if name not in ("x", "y", "z")}
    sights = Sights(np.nan_to_num(values), slots, np.full(total, -1), None, instrument)
    return sights, rest, _rejected(table, reasons), []


def _touches(
    table: Table, held: ReadingSettings, instrument: Instrument, *, flat: bool
) -> tuple[Slots, list[str], list[tuple[int, Array]]]:
    """The label that each row touches (N,), -1 none; the labels; and the numbers of touches, which are zero."""
    touches, names, numbers = np.full(len(table.row), -1), list[str](), list[tuple[int, Array]]()
    for kind in instrument.kinds:
        if INSTRUMENTS[kind].label:
            rows = _labelled(table, held, INSTRUMENTS[kind].label, touches, names)
            numbers += [(slot, np.where(rows, 0.0, np.nan)) for slot in slots_of(kind, flat=flat)]
    return touches, names, numbers


def _labelled(table: Table, held: ReadingSettings, name: str, touches: Slots, names: list[str]) -> Array:
    """Which rows touched something of a kind, whose column of labels is `name`; `touches` and `names` get theirs."""
    header = held.columns.get(name, name)
    if header not in table.columns:
        where = held.file if name in held.columns else table.file
        raise InputError(where, name, f"is missing: a column of labels, each that of one {name} that rows touch")
    text = [table.text(header, index) for index in range(len(table.row))]
    labelled = np.array([bool(item) and item.lower() != "nan" for item in text])
    both = labelled & (touches >= 0)
    if both.any():
        row = table.row[int(np.argmax(both))]
        known = [] if held.instrument is None else [labels()[k] for k in held.instrument.kinds if k in labels()]
        other = " or a ".join(known[: known.index(name)])
        raise InputError(table.file, name, f"row {row} names a {other} and a {name}; keep one")
    first = len(names)
    names += sorted({item for item, there in zip(text, labelled.tolist(), strict=True) if there})
    number = {label: first + k for k, label in enumerate(names[first:])}
    for index in np.flatnonzero(labelled).tolist():
        touches[index] = number[text[index]]
    return labelled


def _along_bars(
    columns: Mapping[str, ReadColumn], table: Table, touches: Slots, reasons: dict[int, list[str]], arm: Arm
) -> Array:
    """How far along its bar each row touches, m; zero where it touches none."""
    if _ALONG_BAR not in columns:
        would_do = f"write {example_headers(_ALONG_BAR, arm)}: 0 at one ball, say, and 500 at the other"
        raise InputError(table.file, "bar_mm", f"is missing: where along its bar each row touches; {would_do}")
    column = columns[_ALONG_BAR]
    for index in np.flatnonzero(~np.isfinite(column.values) & (touches >= 0)).tolist():
        reasons.setdefault(index, []).append(column.fault(index))
    return np.where(np.isfinite(column.values), column.values, 0.0)


def _long_enough(table: Table, touches: Slots, names: list[str], slots: Slots, sound: Array, bar_at: Array) -> None:
    """Whether each bar was touched at two places along it."""
    for label, name in enumerate(names):
        rows = (touches == label) & np.isin(slots, slots_of("bar")).any(axis=1)
        if rows.any() and np.ptp(bar_at[rows & sound]) <= 0.0:
            where = f"{1e3 * float(bar_at[rows & sound][0]):.6g} mm"
            raise InputError(
                table.file,
                "bar_mm",
                f"'{name}' is touched at {where} only ({rows_text(table.row[rows])}): it tells no distance; touch its "
                "other end too",
            )


def _all_there(instrument: Instrument, slots: set[int], table: Table, held: ReadingSettings, arm: Arm) -> None:
    """Whether every kind that the settings name has a column."""
    for kind in instrument.kinds:
        if not slots & set(slots_of(kind)):
            name = INSTRUMENTS[kind].numbers[0].column or kind
            settings_text = f"`observes: {kind}` ({held.file})" if held.file else f"observing {kind}"
            raise InputError(
                table.file, name, f"is missing, which {settings_text} needs; write {example_headers(name, arm)}"
            )


def _enough_touches(table: Table, touches: Slots, names: list[str], slots: Slots, sound: Array, *, flat: bool) -> None:
    """Whether each label has more touches than any place or plane would fit."""
    for label, name in enumerate(names):
        rows = (touches == label) & sound
        of = {kind_at(slot)[0].label for slot in np.unique(slots[touches == label]).tolist() if slot >= 0}
        what = next((item for item in ("plane", "bar") if item in of), "point")
        least = (3 if flat else 4) if what == "plane" else 2
        if int(rows.sum()) < least:
            count = f"{int(rows.sum())} row{'s' if rows.sum() != 1 else ''} only"
            raise InputError(
                table.file,
                what,
                f"'{name}' has {count} ({rows_text(table.row[touches == label])}): any {what} fits that; touch it from "
                f"{least} postures or more, or blank the label",
            )
