"""A plan as a file that is the recording once its tip is filled in, and such a file read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from arm.chain.chain import Arm
from arm.chain.following import completed
from arm.chain.kinematics import tip_position
from diagnose.reading.columns import UnitMissing, meaning_of
from diagnose.reading.read import measurable, recording_from
from diagnose.reading.settings import ReadingSettings
from diagnose.reading.table import Layout, Table, read_table
from diagnose.reading.write import cell, recording_columns
from diagnose.recording import Recording, since_the_reading_before
from diagnose.rules.rules import RULES, Rules
from sections.numeric import Array
from units.quantities import InputError

from .asked import Asked

READ = ("x_mm", "y_mm", "z_mm", "along_mm", "distance_mm")
"""What a plan leaves blank of what a recording holds."""


def to_record(arm: Arm, q: Array, sides: Array, payload: Array, asked: Asked) -> Recording:
    """Visits in their order, q (N, n), sides (N, n), payload (N,) kg, as a recording whose tip is where the arm stands
    undeformed; each visit read `repeats` times, by a clock of usual paces."""
    rules, each = asked.rules.plan, asked.repeats
    visits = len(q)
    change = np.concatenate([[0.0], np.cumsum(np.diff(payload) != 0.0)])
    start = np.arange(visits) * (rules.between_visits + each * rules.between_readings) + change * rules.between_payloads
    time = np.repeat(start, each) + np.tile(np.arange(each) * rules.between_readings, visits)
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
    )


def as_read(recording: Recording, asked: Asked) -> Recording:
    """Readings of the tip's whole place as an instrument of heights or distances reads them; of others as they are."""
    if not asked.slots:
        return recording
    tip = np.zeros((recording.size, 3))
    tip[:, : recording.tip.shape[1]] = recording.tip
    read = tip @ np.array(asked.reads.direction or (0.0, 0.0, 0.0))
    if asked.reads.anchor is not None:
        read = np.linalg.norm(tip - np.array(asked.reads.anchor), axis=1)
    own = replace(asked.reads, anchor=None) if asked.anchor_free else asked.reads
    return replace(recording, tip=read[:, None], slots=np.tile(asked.slots, (recording.size, 1)), instrument=own)


def plan_text(recording: Recording, arm: Arm, axes: Sequence[str]) -> str:
    """The plan as CSV: what a recording has, with blank columns for what the instrument sees of the tip."""
    kept = [each for each in recording_columns(recording, arm) if each[0] not in READ]
    lines = [",".join([*(name for name, _, _ in kept), *(f"{axis}_mm" for axis in axes)])]
    blank = "," * len(axes)
    lines += [
        ",".join(cell(values[row], digits) for _, values, digits in kept) + blank for row in range(recording.size)
    ]
    return "\n".join(lines) + "\n"


def read_plan(path: Path | str, arm: Arm, *, rules: Rules = RULES) -> Recording:
    """The poses, sides and payloads of a plan or of a recording, in their order, whatever it says of the tip, which is
    where the arm stands undeformed. Raises `InputError`."""
    table = read_table(Path(path), Layout())
    q = completed(arm, np.stack([_coordinate(table, arm, index) for index in range(arm.size)], axis=1))
    tips = _undeformed(arm, q)
    columns = {name: cells for name, cells in table.columns.items() if not _of_tip(name, arm)}
    columns |= {f"{axis}_mm": 1e3 * values for axis, values in zip("xyz", tips.T, strict=False)}
    read = recording_from(
        replace(table, columns=MappingProxyType(columns)), arm, ReadingSettings(tip=arm.tip), rules=rules
    )
    return replace(read, frame="known", tool="known", sigma=None)


def _undeformed(arm: Arm, q: Array) -> Array:
    return tip_position(arm, q)[:, : 2 if arm.planar() else 3]


def _of_tip(header: str, arm: Arm) -> bool:
    try:
        meaning = meaning_of(header, arm, file="")
    except UnitMissing:
        return False
    return meaning is not None and meaning.base in (
        "x",
        "y",
        "z",
        "qw",
        "qx",
        "qy",
        "qz",
        "rx",
        "ry",
        "rz",
        "along",
        "distance",
    )


def _coordinate(table: Table, arm: Arm, index: int) -> Array:
    """One joint's coordinates; nought where it has no drive and no column."""
    for header in table.names:
        meaning = meaning_of(header, arm, file=table.file)
        if meaning is not None and meaning.name == f"q{index + 1}":
            return measurable(table.numbers(header) * meaning.factor + meaning.offset)
    if not arm.joints[index].driven:
        return np.zeros(len(table.row))
    unit = "deg" if arm.joints[index].revolute else "mm"
    raise InputError(table.file, "", f"has no column q{index + 1}_{unit}; a plan names every joint's coordinate")
