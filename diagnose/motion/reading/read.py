"""A motion log's file to `MotionLog`: columns, clock, torques and samples are checked at this door.

Whatever is left out of the result is said: samples in `rejected` with the reason, all else in `warnings`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.reading.columns import canonical, example_headers, of_kind
from linkwright.core.diagnose.reading.files import read_table
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.reading.foreign.mapped import with_foreign
from linkwright.core.diagnose.reading.foreign.proposal import proposed
from linkwright.core.diagnose.reading.motion_settings import MotionSettings
from linkwright.core.diagnose.reading.named_columns import chosen_rows, named_columns
from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.diagnose.reading.settings import ReadingSettings, find_settings, read_settings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import refusal

from .drives import Drives, drives_of
from .samples import checked_samples

_TIP = ("x", "y", "z", "along", "distance", "bar", "tilt")
_HEAD = 400
"""Rows of a text that tell what it is."""
_OF_A_LOG = ("time", "temperature", "payload")
_OF_JOINTS = ("q", "v", "a", "tau", "current", "voltage", "c", "j", "dir", "temperature_link")


def read_log(path: Path | str, arm: Arm, settings: Path | str | None = None, *, rules: Rules = RULES) -> MotionLog:
    """Motion log that a file holds, checked against the arm.

    Args:
        path: A CSV, .xlsx or parquet file.
        arm: The arm that moved, with a joint for each that the log tells of.
        settings: Its recording.yaml; by default a YAML file of the log's name, or recording.yaml in its folder.
        rules: What is set aside and what is refused.

    Returns:
        The log in SI, less the samples in `rejected`.

    Raises:
        InputError: Where nothing sensible can follow: no clock, joints or torques that the arm lacks or the log does,
            a clock that runs backwards, an arm that never moves, torques that never change, two robots in one file.
    """
    return logs_from([table_of_log(path, settings)], arm, rules=rules)[0]


def table_of_log(path: Path | str, settings: Path | str | None = None) -> tuple[Table, ReadingSettings]:
    """The table that a file holds, and its settings; see `read_log`."""
    path = Path(path)
    held = read_settings(find_settings(path) if settings is None else Path(settings))
    return read_table(path, held.layout), held


def is_motion_log(path: Path | str, arm: Arm, settings: Path | str | None = None) -> bool:
    """Whether a file is a motion log: its settings say `observes: motion`, or it has a clock, torques, currents or
    voltages, and nothing of the tip. Raises `InputError` where it cannot be read."""
    path = Path(path)
    held = read_settings(find_settings(path) if settings is None else Path(settings))
    if held.motion is not None or any(kind != "position" for kind in held.kinds):
        return held.motion is not None
    return holds_motion(read_table(path, held.layout, rows=_HEAD), arm, held)


def holds_motion(table: Table, arm: Arm, held: ReadingSettings) -> bool:
    """Whether a table has a clock, torques, currents or voltages, and nothing of the tip; see `is_motion_log`."""
    if held.motion is not None or any(kind != "position" for kind in held.kinds):
        return held.motion is not None
    named = {item.what for item in proposed(table, arm) if item.header not in held.ignore}
    named |= {canonical(header).partition("_")[0] for header in held.columns}
    named |= {of_kind(header) or "" for header in table.names}
    drives = any(re.fullmatch(r"(?:tau|current|voltage)[0-9]+", name) for name in named)
    return drives and "time" in named and not named & set(_TIP)


def logs_from(
    tables: Sequence[tuple[Table, ReadingSettings]], arm: Arm, *, rules: Rules = RULES
) -> tuple[MotionLog, ...]:
    """Motion logs of one arm that tables hold, each under its settings; see `read_log`. What is doubted of one is
    doubted of all that do not contradict it."""
    from linkwright.core.diagnose.first_look.log import look_at_logs  # here, for what is a log is told without it

    return look_at_logs([_checked(table, arm, held, rules) for table, held in tables], arm, rules)


def _checked(table: Table, arm: Arm, held: ReadingSettings, rules: Rules) -> tuple[MotionLog, Headers]:
    """The log that a table holds, its samples checked, and the headers of its columns by name."""
    if arm.branches:
        message = f"is a motion log, and {arm.name!r} has several arms on one torso; give one of them"
        raise InputError(table.file, "", message)
    motion = held.motion or MotionSettings()
    own = held.columns
    held, mapped = with_foreign(table, arm, replace(held, motion=motion))
    table, said = chosen_rows(table, held)
    columns, strangers, more = named_columns(table, held, arm)
    if (others := _rows_of_others(columns, rules.mistakes.few_stray)) is not None:
        said.append(
            f"{int(others.sum())} rows hold nothing of the joints. These rows are of other signals and not used."
        )
        table = table.kept(~others)
        columns, strangers, more = named_columns(table, held, arm)
    warnings = [*table.notes, *mapped, *said, *more]
    _require(columns, table, arm)
    columns, said = _without_blank(columns, table)
    warnings += said
    drives = drives_of(columns, arm, motion, table, held)
    warnings += drives.warnings
    log = _assembled(columns, strangers, table, arm, held, drives, warnings)
    headers = Headers.of(columns, own, held.file)
    return checked_samples(log, arm, columns, table.ragged, headers, rules=rules), headers


def _rows_of_others(columns: dict[str, ReadColumn], few: float) -> NDArray[np.bool_] | None:
    """The rows in which no joint has a number, where they are more than a few: exports of several topics on one clock
    have rows of each; None else."""
    of_joints = [column.values for column in columns.values() if column.meaning.base == "q"]
    if not of_joints:
        return None
    blank = np.asarray(~np.isfinite(np.stack(of_joints)).any(axis=0), dtype=np.bool_)
    return blank if few < blank.mean() < 1.0 else None


def _require(columns: dict[str, ReadColumn], table: Table, arm: Arm) -> None:
    """Refuse a file without clock or without all of the arm's joints, with what would do."""
    names = ", ".join(table.names)
    there = names if len(names) <= 300 else names[:300] + " ..."
    if "time" not in columns:
        message = f"is missing; a motion log has a clock (t_s or time_s); the file has {there}"
        raise InputError(table.file, "t_s", message)
    joints = [k for k, joint in enumerate(arm.joints) if joint.driven]
    lacking = [k for k in joints if f"q{k + 1}" not in columns]
    if lacking:
        called = ", ".join(f"q{k + 1}" for k in lacking)
        would_do = example_headers("q", arm, lacking[0])
        message = (
            f"{'is' if len(lacking) == 1 else 'are'} missing: {arm.name!r} has {arm.size} joints, and the log has "
            f"{len(joints) - len(lacking)} of them; the file has {there}; write {would_do}, map it in recording.yaml "
            "(`columns:`), or give the arm that was logged"
        )
        raise InputError(table.file, called, message)


def _without_blank(columns: dict[str, ReadColumn], table: Table) -> tuple[dict[str, ReadColumn], list[str]]:
    """The columns less those that hold next to no numbers. Raises `InputError` where the clock or a joint is such."""
    columns_kept: dict[str, ReadColumn] = {}
    warnings: list[str] = []
    for name, column in columns.items():
        bad = np.flatnonzero(~np.isfinite(column.values))
        if 2 * len(bad) <= len(column.values):
            columns_kept[name] = column
            continue
        why = column.fault(int(bad[0]))
        if name == "time" or column.meaning.base == "q":
            remedies = [{"time_format": "iso"}] if name == "time" else []
            raise refusal(table.file, column.header, f"holds no numbers in most samples ({why})", *remedies)
        warnings.append(f"{column.header} is not used, because most of its cells hold no number ({why}).")
    return columns_kept, warnings


def _assembled(
    columns: dict[str, ReadColumn],
    strangers: dict[str, Array],
    table: Table,
    arm: Arm,
    held: ReadingSettings,
    drives: Drives,
    warnings: list[str],
) -> MotionLog:
    """The log as the file has it, before its samples are looked at."""
    motion = held.motion or MotionSettings()
    total = len(table.row)

    def each_joint(base: str, what: str) -> Array | None:
        names = [f"{base}{k + 1}" for k in range(arm.size)]
        there = [name for name in names if name in columns]
        if not there:
            return None
        if len(there) < len(names):
            lacking = ", ".join(name for name in names if name not in columns)
            warnings.append(
                f"{', '.join(columns[name].header for name in there)}: not used as {what} ({lacking} lack)."
            )
            return None
        return np.stack([columns[name].values for name in names], axis=1)

    def one(name: str) -> Array | None:
        return columns[name].values if name in columns else None

    payload = one("payload")
    if payload is not None and np.nanmin(payload) < 0.0:
        warnings.append(f"{columns['payload'].header}: not used as a payload, for no payload is less than nothing.")
        payload = None
    velocity = each_joint("v", "speeds")
    if velocity is None:
        warnings.append("There are no speeds: they are differences of the joint coordinates.")
    unused = [
        column.header
        for name, column in columns.items()
        if name not in _OF_A_LOG and column.meaning.base not in _OF_JOINTS
    ]
    if unused:
        warnings.append(f"{', '.join(unused)}: not used. A motion log is judged by its torques.")
    sigma = motion.sigma
    if sigma is not None and len(sigma) != arm.size:
        if len(sigma) > 1:
            raise InputError(held.file, "sigma", f"has {len(sigma)} numbers, and {arm.name!r} has {arm.size} joints")
        sigma = sigma * arm.size
    zeros = np.zeros(total)
    return MotionLog(
        file=table.file,
        time=columns["time"].values,
        q=np.stack([columns[n].values if (n := f"q{k + 1}") in columns else zeros for k in range(arm.size)], axis=1),
        torque=drives.torque,
        row=table.row,
        velocity=velocity,
        commanded=each_joint("c", "commands"),
        joint_side=each_joint("j", "second encoders"),
        temperature=one("temperature"),
        payload_mass=payload,
        beyond_drive=motion.beyond_drive,
        drive=drives.signal,
        torque_constants_free=drives.free,
        loop=drives.loop,
        sigma=sigma,
        cutoff=motion.cutoff,
        warnings=tuple(warnings),
        settings=held.file,
        unit=held.unit,
        date=held.date,
        other=MappingProxyType({**strangers, **drives.other}),
    )
