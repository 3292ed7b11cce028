"""A recording's file to `Recording`: columns, units and rows are checked at this door.

Whatever is left out of the result is said: rows in `rejected` with the reason, columns in `warnings`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.first_look.readings import checked
from linkwright.core.diagnose.first_look.torque_sign import refuse_torques_of_another_sign
from linkwright.core.diagnose.fitting.origins import located
from linkwright.core.diagnose.instruments.checks import sights_checked
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS, labels
from linkwright.core.diagnose.instruments.split import laid_out
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import refusal

from .assemble import assembled
from .branches import to_its_tip, with_others_at_rest
from .columns import example_headers, meaning_of
from .files import read_table
from .followers import with_followers
from .foreign.headers import Headers
from .named_columns import PROPOSES, chosen_rows, named_columns
from .read_column import ReadColumn
from .settings import ReadingSettings, find_settings, read_settings
from .sights import in_part, sights_of
from .table import Table

_PLACE = ("x", "y", "z")
_QUATERNION = ("qw", "qx", "qy", "qz")
_ROUNDED = 0.01
"""By how much the length of a quaternion may differ from 1: files round to three digits or more."""
_LEVEL = 1e-9
_ROUNDED_TIP = 9
"""Digits of a tip (m) that the angles give."""


def read_recording(path: Path | str, arm: Arm, settings: Path | None = None, *, rules: Rules = RULES) -> Recording:
    """The recording that a CSV, .xlsx or parquet file holds, checked against the arm.

    `settings` is its recording.yaml; without one, a YAML file of the recording's name or recording.yaml in its folder
    counts. Rows that cannot be used are in `rejected` with the reason, everything else worth saying in `warnings`.
    Raises `InputError` where nothing sensible can follow: no such file, no table, a required column missing, a
    column in another unit than its header says, another frame than the base's.
    """
    path = Path(path)
    held = read_settings(settings if settings is not None else find_settings(path))
    # The table is not kept beside what it says: cells of text take more memory than all else.
    return _checked(*_unchecked(read_table(path, held.layout), arm, held, rules), rules)


def recording_from(table: Table, arm: Arm, held: ReadingSettings, *, rules: Rules = RULES) -> Recording:
    """The recording that a table holds, under settings; see `read_recording`."""
    return _checked(*_unchecked(table, arm, held, rules), rules)


def _unchecked(table: Table, arm: Arm, held: ReadingSettings, rules: Rules) -> tuple[Recording, Arm, Headers, bool]:
    """What a table holds before it is checked against the arm: the recording, the arm to its tip, what the columns are
    called in the file, and whether the tip's place was seen in part only."""
    path = Path(table.file)
    arm = to_its_tip(arm, held, table.file)
    warnings = [*table.notes]
    table, sentence = chosen_rows(table, held)
    warnings += sentence
    columns, strangers, sentences = named_columns(table, held, arm)
    warnings += sentences
    columns, sentences = with_others_at_rest(columns, table, arm)
    warnings += sentences
    columns = with_followers(columns, table, arm, rules.residual)
    partly = in_part(columns, table, held, rules.mistakes.few_rows)
    _refuse_torques_alone(columns, table)
    columns, sentences = _with_tip_of_angles(columns, table, arm, partly=partly)
    warnings += sentences
    _require(columns, table, arm, held, whole=not partly)
    sights, seen = None, columns
    bare: list[RejectedRow] = []
    if partly:
        sights, seen, bare, sentences = sights_of(columns, table, held, arm)
        warnings += sentences
    columns, rejected, sentences = _faults(seen, table)
    warnings += sentences
    faulty = {item.row: item for item in rejected}
    rejected = [*rejected, *(item for item in bare if item.row not in faulty)]
    known = {item.row for item in rejected}
    rejected += [item for item in _not_unit(columns, table) if item.row not in known]
    recording = assembled(path, columns, strangers, table, arm, held, sights=sights, rules=rules.residual)
    recording = replace(recording, rejected=(*table.ragged, *rejected), warnings=(*warnings, *recording.warnings))
    bad = {item.row for item in recording.rejected}
    recording = recording.kept(np.array([row not in bad for row in recording.row.tolist()], dtype=bool))
    if not recording.size:
        why = recording.rejected[0]
        raise InputError(path, "", f"no row can be used; row {why.row}: {why.reason}")
    headers = {column.meaning.name: column for column in columns.values()}
    return recording, arm, Headers.of(headers, held.columns, held.file), sights is not None


def _checked(recording: Recording, arm: Arm, headers: Headers, in_parts: bool, rules: Rules) -> Recording:
    # A transform that nobody knows cannot be contradicted: joints and tips are checked with it where they put it.
    arm = located(arm, recording, rules=rules)
    done = checked(recording, arm, headers, rules=rules)
    refuse_torques_of_another_sign(done, arm, headers, rules=rules.residual)
    if in_parts:
        done = sights_checked(laid_out(done), arm, rules=rules)
    return replace(done, rejected=tuple(sorted(done.rejected, key=lambda item: item.row)))


def _with_tip_of_angles(
    columns: dict[str, ReadColumn], table: Table, arm: Arm, *, partly: bool
) -> tuple[dict[str, ReadColumn], list[str]]:
    """The columns with the tip where the joints stand, and what is to be said of it, where commands and angles alone
    were recorded: between them lies the droop of loops."""
    names = [f"{base}{k + 1}" for base in "qc" for k in range(arm.size)]
    if partly or any(name in columns for name in _PLACE) or any(name not in columns for name in names):
        return columns, []
    q = np.stack([columns[name].values for name in names[: arm.size]], axis=1)
    tips = np.round(nominal(arm, np.nan_to_num(q), 3)[0], _ROUNDED_TIP)
    made = dict(columns)
    for axis, values in zip(_PLACE[: 2 if planar_motion(arm) else 3], tips.T, strict=False):
        if (meaning := meaning_of(f"{axis}_m", arm, file=table.file)) is not None:
            made[axis] = ReadColumn(meaning, axis, values, lambda _: "the joints' angles are not known")
    sentence = "No tip was recorded: it is taken where the angles have it, so that only what lies between commands and "
    return made, [f"{sentence}angles can be found. Readings at rest show the droop of loops alone."]


def _refuse_torques_alone(columns: dict[str, ReadColumn], table: Table) -> None:
    """Refuse a log of torques that holds nothing of the tip, whatever its settings call it."""
    torques = [column.header for name, column in columns.items() if name.startswith("tau")]
    seen = (*_PLACE, *(name for kind in INSTRUMENTS.values() for name in kind.columns))
    if torques and not any(name in columns for name in seen) and not set(table.names) & set(labels().values()):
        message = (
            "has drives' torques and nothing of the tip in the same rows, without which torques are not judged; record "
            "the tip too (x_mm, y_mm), or a height, a distance or a level (along_mm, distance_mm, tilt_x_deg)"
        )
        raise InputError(table.file, torques[0], message)


def _require(
    columns: dict[str, ReadColumn], table: Table, arm: Arm, held: ReadingSettings, *, whole: bool = True
) -> None:
    """Refuse a table that lacks columns, or some of a group that only makes sense together."""
    wanted = [(f"q{k + 1}", example_headers("q", arm, k)) for k in range(arm.size)]
    wanted += [(name, example_headers(name, arm)) for name in ("x", "y") if whole]
    if whole and not planar_motion(arm):
        wanted.append(("z", example_headers("z", arm)))
    missing = [(name, would_do) for name, would_do in wanted if name not in columns]
    if missing:
        raise _missing(missing, columns, table, arm, held)
    for group in (_QUATERNION, ("rx", "ry", "rz"), ("basex", "basey"), ("fx", "fy")):
        present = [name for name in group if name in columns]
        if not 0 < len(present) < len(group):
            continue
        lacking = ", ".join(name for name in group if name not in present)
        if group is _QUATERNION:
            raise InputError(table.file, present[0], f"needs the rest of its quaternion: {lacking}")
        raise InputError(table.file, columns[present[0]].header, f"is there without {lacking}")


def _missing(
    missing: Sequence[tuple[str, str]], columns: Mapping[str, ReadColumn], table: Table, arm: Arm, held: ReadingSettings
) -> InputError:
    """That columns, each with headers that would do, are missing, what there is, and what to write."""
    names = ", ".join(table.names)
    there = names if len(names) <= 300 else names[:300] + " ..."
    called = {f"q{k + 1}": arm.column("q", k) for k in range(arm.size)}
    (first, would_do), others = missing[0], [called.get(name, name) for name, _ in missing[1:]]
    also = f" (and {', '.join(others)})" if others else ""
    where = f", or map it in {Path(held.file).name if held.columns else 'recording.yaml'}: "
    where += f"`columns: {{{would_do.split()[0]}: FORMULA}}`"
    where += "" if held.columns else PROPOSES
    part = ""
    if first in _PLACE:
        some = any(name in columns for name in _PLACE)
        part = (
            "; `observes: position` in recording.yaml if it was not measured"
            if some
            else "; where something else was measured, `observes: along` (distance, tilt, ...) says so; a motion "
            "log has torques (tau1_Nm) or currents (current1_A)"
        )
    said = f"is missing{also}; the file has {there}; write {would_do}{where}{part}"
    return InputError(table.file, called.get(first, first), said)


def planar_motion(arm: Arm) -> bool:
    """Whether x and y say where a joint has taken the tip, but for slides along z: all else turns about z or slides
    across it. A SCARA may then be measured from above."""
    moves = False
    for joint, link in zip(arm.joints, arm.links, strict=True):
        # Frames may be turned over as a whole, as they are in most tables of parameters.
        if not (_along_z(joint.origin_rotation[2]) and _along_z(link.end_rotation[2])):
            return False
        upright = _along_z(joint.axis)
        if not upright and (joint.revolute or abs(joint.axis[2]) > _LEVEL):
            return False
        moves |= joint.revolute or not upright
    return moves


def _along_z(direction: Sequence[float]) -> bool:
    return max(abs(direction[0]), abs(direction[1])) <= _LEVEL


def _faults(columns: dict[str, ReadColumn], table: Table) -> tuple[dict[str, ReadColumn], list[RejectedRow], list[str]]:
    """Set rows without a number aside; an optional column that is mostly blank is set aside itself."""
    warnings: list[str] = []
    columns_kept = dict(columns)
    total = len(table.row)
    reasons: dict[int, list[str]] = {}
    for name, column in columns.items():
        bad = np.flatnonzero(~np.isfinite(column.values))
        if not len(bad):
            continue
        base = column.meaning.base
        if 2 * len(bad) > total:
            fault_text = column.fault(int(bad[0]))
            where = f"row {table.row[bad[0]]}: {fault_text}" + (
                f"; so do {len(bad) - 1} more rows" if len(bad) > 1 else ""
            )
            if base in ("q", "x", "y", "z"):
                comma = "," in fault_text and "not a number" in fault_text and table.decimal == "."
                remedies = [{"decimal": ","}] if comma else []
                raise refusal(table.file, column.header, f"holds no numbers in most rows ({where})", *remedies)
            stamp = (
                " A time stamp needs its `time_format` in recording.yaml: '%d.%m.%Y %H:%M:%S', say."
                if base == "time"
                else ""
            )
            warnings.append(f"{column.header} is not used, because most of its cells hold no number ({where}).{stamp}")
            del columns_kept[name]
            continue
        if base == "dir":
            blank = [int(k) for k in bad if (fault_text := column.fault(int(k))).endswith("is blank")]
            if blank:
                column.values[blank] = 0.0
                rows = rows_text(table.row[blank])
                warnings.append(f"{column.header} is blank in {rows}: the side is unknown there.")
            bad = np.flatnonzero(~np.isfinite(column.values))
        for index in bad.tolist():
            reasons.setdefault(index, []).append(column.fault(index))
    rejected = [
        RejectedRow(int(table.row[index]), "; ".join(dict.fromkeys(reasons[index]))) for index in sorted(reasons)
    ]
    return columns_kept, rejected, warnings


def _not_unit(columns: dict[str, ReadColumn], table: Table) -> list[RejectedRow]:
    """Rows whose quaternion is none: a rotation's has the length 1."""
    if any(name not in columns for name in _QUATERNION):
        return []
    length = np.sqrt(sum(columns[name].values ** 2 for name in _QUATERNION))
    wrong = np.flatnonzero(np.isfinite(length) & (np.abs(length - 1.0) > _ROUNDED))
    if len(wrong) > 0.5 * len(table.row):
        first = f"row {table.row[wrong[0]]}: {length[wrong[0]]:.4g}"
        raise InputError(table.file, ", ".join(_QUATERNION), f"are no quaternions of length 1 in most rows ({first})")
    return [
        RejectedRow(int(table.row[k]), f"qw, qx, qy, qz have the length {length[k]:.4g}, not 1") for k in wrong.tolist()
    ]
