"""A recording's file to `Recording`: columns, units and rows are checked at this door.

Whatever is left out of the result is said: rows in `rejected` with the reason, columns in `warnings`.
"""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.origins import located
from linkwright.core.diagnose.instruments.checks import sights_checked
from linkwright.core.diagnose.instruments.instrument import LABELS
from linkwright.core.diagnose.instruments.split import laid_out
from linkwright.core.diagnose.mistakes.readings import checked
from linkwright.core.diagnose.mistakes.row_lists import rows_text
from linkwright.core.diagnose.mistakes.torque_sign import refuse_torques_of_another_sign
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

from .assemble import assembled
from .branches import to_its_tip, with_others_at_rest
from .columns import ColumnMeaning, UnitMissing, example_headers, meaning_of, of_kind, otherwise_spelled
from .followers import with_followers
from .formula import Formula, read_condition, read_formula
from .read_column import ReadColumn
from .settings import ReadingSettings, find_settings, read_settings
from .sights import in_part, sights_of
from .table import Table, read_table

_KNOWN = ("time_s", "payload_kg", "temperature_degC", "x_mm", "y_mm", "z_mm", "basex_mm", "fx_N", "qw", "rx_deg")
_KNOWN_JOINT = ("q{}_deg", "q{}_mm", "dir{}", "c{}_deg", "j{}_deg", "v{}_deg_s", "a{}_deg_s2", "tau{}_Nm")
_PLACE = ("x", "y", "z")
_QUATERNION = ("qw", "qx", "qy", "qz")
_LEVEL = 1e-9
_LARGEST = 1e12
"""In SI; seconds since 1970 count to 2e9."""


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


def _unchecked(
    table: Table, arm: Arm, held: ReadingSettings, rules: Rules
) -> tuple[Recording, Arm, dict[str, str], bool]:
    """What a table holds before it is checked against the arm: the recording, the arm to its tip, what the columns are
    called in the file, and whether the tip's place was seen in part only."""
    path = Path(table.file)
    arm = to_its_tip(arm, held, table.file)
    warnings = [*table.notes]
    table, sentence = _chosen_rows(table, held)
    warnings += sentence
    columns, strangers, said = _columns(table, held, arm)
    warnings += said
    columns, said = with_others_at_rest(columns, table, arm)
    warnings += said
    columns = with_followers(columns, table, arm, rules.residual)
    partly = in_part(columns, table, held, rules.reading.some_blank)
    _refuse_torques_alone(columns, table)
    _require(columns, table, arm, held, whole=not partly)
    sights, seen = None, columns
    bare: list[RejectedRow] = []
    if partly:
        sights, seen, bare, said = sights_of(columns, table, held, arm)
        warnings += said
    columns, rejected, said = _faults(seen, table, rules.reading.mostly_blank)
    warnings += said
    faulty = {each.row: each for each in rejected}
    rejected = [*rejected, *(each for each in bare if each.row not in faulty)]
    known = {each.row for each in rejected}
    rejected += [each for each in _not_unit(columns, table, rules.reading.unit_length) if each.row not in known]
    recording = assembled(path, columns, strangers, table, arm, held, sights=sights, rules=rules.residual)
    recording = replace(recording, rejected=(*table.ragged, *rejected), warnings=(*warnings, *recording.warnings))
    bad = {each.row for each in recording.rejected}
    recording = recording.kept(np.array([row not in bad for row in recording.row.tolist()], dtype=bool))
    if not recording.size:
        why = recording.rejected[0]
        raise InputError(path, "", f"no row can be used; row {why.row}: {why.reason}")
    headers = {column.meaning.name: column.header for column in columns.values()}
    return recording, arm, headers, sights is not None


def _checked(recording: Recording, arm: Arm, headers: dict[str, str], in_parts: bool, rules: Rules) -> Recording:
    # A transform that nobody knows cannot be contradicted: joints and tips are checked with it where they put it.
    arm = located(arm, recording, rules=rules)
    done = checked(recording, arm, headers, rules=rules)
    refuse_torques_of_another_sign(done, arm, headers, rules=rules.residual)
    if in_parts:
        done = sights_checked(laid_out(done), arm, rules=rules)
    return replace(done, rejected=tuple(sorted(done.rejected, key=lambda each: each.row)))


def _chosen_rows(table: Table, held: ReadingSettings) -> tuple[Table, list[str]]:
    """The rows that the settings ask for; the others are not readings of this recording."""
    keep = np.ones(len(table.row), dtype=bool)
    for text in held.rows:
        condition = read_condition(text, table.names, file=held.file, key="rows")
        keep &= condition.holds(table.numbers, len(keep))
    if keep.all():
        return table, []
    if not keep.any():
        raise InputError(held.file, "rows", f"no row of {table.file} meets {' and '.join(held.rows)}")
    chosen = np.flatnonzero(keep)
    columns = {
        name: cells[keep] if isinstance(cells, np.ndarray) else tuple(cells[k] for k in chosen)
        for name, cells in table.columns.items()
    }
    sentence = f"{' and '.join(held.rows)} ({held.file}) chooses {len(chosen)} of {len(keep)} rows."
    return replace(table, columns=MappingProxyType(columns), row=table.row[keep]), [sentence]


def _columns(
    table: Table, held: ReadingSettings, arm: Arm
) -> tuple[dict[str, ReadColumn], dict[str, Array], list[str]]:
    """Our columns by name (`q1`, `x`), the numbers of strangers, and sentences about what is not used."""
    warnings: list[str] = []
    found: dict[str, ReadColumn] = {}
    used: set[str] = set(held.ignore)
    for name in held.ignore:
        if name not in table.columns:
            raise InputError(held.file, "ignore", f"there is no column {shown(name)}{nearest(name, table.names)}")
    for header, text in held.columns.items():
        if header in _labels_of(held):
            used.add(text)
            continue
        meaning = _meaning(header, arm, held, held.file)
        if meaning is None:
            hint = nearest(header, _known_headers(arm))
            raise InputError(held.file, f"columns.{header}", f"is no column of a recording{hint}")
        formula = read_formula(text, table.names, file=held.file, key=f"columns.{header}")
        if meaning.name in found:
            raise InputError(held.file, f"columns.{header}", f"is given twice; {found[meaning.name].header} gives it")
        used.update(formula.columns)
        found[meaning.name] = _by_formula(table, header, meaning, formula, held)
    strangers: dict[str, Array] = {}
    spelled = {} if held.columns else _spelled(table, held, arm)
    if spelled:
        pairs = ", ".join(f"{shown(header)} as {ours}" for header, ours in spelled.items())
        warnings.append(f"Headers that are written otherwise are read as ours: {pairs}.")
    for header in table.names:
        if header in held.ignore or header in _labels_of(held):
            continue
        try:
            meaning = _meaning(spelled.get(header, header), arm, held, table.file)
        except UnitMissing as error:
            if not held.columns and not error.stranger:
                raise
            meaning = None
            if header not in used:
                warnings.append(f"{header} is not used: {error.message}.")
        if meaning is None:
            if header in used:
                continue  # what a column of ours is made of tells nothing further
            strangers[header] = measurable(table.numbers(header))
            if not held.columns:
                hint = nearest(header, _known_headers(arm))
                meant = hint if hint.startswith("; did") else ""
                warnings.append(f"{header} is no column that is known here{meant or '; it is kept as it is.'}")
            continue
        if meaning.name in found:
            if not held.columns or found[meaning.name].header not in held.columns:
                raise InputError(table.file, header, f"says the same as {found[meaning.name].header}; drop one")
            if header not in used:
                warnings.append(f"{header} gives way to {meaning.name} of {Path(held.file).name}.")
            continue
        if meaning.base == "time" and held.time_format is not None:
            found[meaning.name] = _stamps(table, header, header, meaning, held)
        else:
            found[meaning.name] = _plain(table, header, meaning)
    return found, {name: values for name, values in strangers.items() if np.isfinite(values).any()}, warnings


def _meaning(header: str, arm: Arm, held: ReadingSettings, file: object) -> ColumnMeaning | None:
    """What a header says; heights and distances are strangers to a recording that does not observe them."""
    kind = of_kind(header)
    if kind is not None and (held.instrument is None or kind not in held.instrument.kinds):
        return None
    return meaning_of(header, arm, file=file)


def _labels_of(held: ReadingSettings) -> tuple[str, ...]:
    """The columns of labels that a recording has."""
    return () if held.instrument is None else tuple(LABELS[k] for k in held.instrument.kinds if k in LABELS)


def _spelled(table: Table, held: ReadingSettings, arm: Arm) -> dict[str, str]:
    """The headers that are ours but for how they are written, with ours; none whose like is there as it should be."""

    def meant(header: str) -> str:
        try:
            meaning = _meaning(header, arm, held, table.file)
        except UnitMissing:
            return ""
        return "" if meaning is None else meaning.name

    taken = {meant(header) for header in table.names}
    ours = {header: otherwise_spelled(header) for header in table.names if header not in held.ignore}
    return {header: name for header, name in ours.items() if name and meant(name) and meant(name) not in taken}


def _known_headers(arm: Arm) -> list[str]:
    joints = [each.format(number) for number in range(1, arm.size + 1) for each in _KNOWN_JOINT]
    return [*_KNOWN, *joints, *(f"temperature_link{number}_degC" for number in range(1, arm.size + 1))]


def _plain(table: Table, header: str, meaning: ColumnMeaning) -> ReadColumn:
    def fault(index: int) -> str:
        return table.fault(header, index) or f"{header} is {table.text(header, index)}, beyond anything measured"

    numbers = table.sides(header) if meaning.base == "dir" else table.numbers(header)
    return ReadColumn(meaning, header, measurable(numbers * meaning.factor + meaning.offset), fault)


def measurable(values: Array) -> Array:
    """The values (SI), nan for what nobody measures: powers of it would not be finite."""
    return np.where(np.abs(values) <= _LARGEST, values, np.nan)


def _by_formula(
    table: Table, header: str, meaning: ColumnMeaning, formula: Formula, held: ReadingSettings
) -> ReadColumn:
    if meaning.base == "time" and held.time_format is not None:
        if formula.columns != (formula.text.strip("`"),):
            raise InputError(held.file, f"columns.{header}", "is a time stamp; it names one column and nothing else")
        return _stamps(table, formula.columns[0], header, meaning, held)

    def fault(index: int) -> str:
        for name in formula.columns:
            if said := table.fault(name, index):
                return said
        return f"{header} = {formula.text} is not finite, or beyond anything measured"

    numbers = table.sides if meaning.base == "dir" else table.numbers
    values = formula.value(numbers, len(table.row)) * meaning.factor + meaning.offset
    return ReadColumn(meaning, header, measurable(values), fault)


def _stamps(table: Table, column: str, header: str, meaning: ColumnMeaning, held: ReadingSettings) -> ReadColumn:
    """Time stamps in s since 1970: files of one day are on one clock."""
    values = np.full(len(table.row), np.nan)
    stamps = [_stamp(table.text(column, index), str(held.time_format)) for index in range(len(table.row))]
    first = next((stamp for stamp in stamps if stamp is not None), None)
    if first is None:
        message = f"{shown(held.time_format)} does not fit {column}: row 1 holds {shown(table.text(column, 0))}"
        raise InputError(held.file, "time_format", message)
    began = datetime.datetime(1970, 1, 1, tzinfo=None if first.tzinfo is None else datetime.UTC)
    for index, stamp in enumerate(stamps):
        if stamp is not None:
            if (stamp.tzinfo is None) != (first.tzinfo is None):
                continue
            values[index] = (stamp - began).total_seconds()

    def fault(index: int) -> str:
        text = table.text(column, index)
        return f"{column} is {shown(text)}, not a time ({held.time_format})" if text else f"{column} is blank"

    return ReadColumn(meaning, header, values, fault)


def _stamp(text: str, form: str) -> datetime.datetime | None:
    if form == "unix":
        return None
    try:
        return datetime.datetime.fromisoformat(text) if form == "iso" else datetime.datetime.strptime(text, form)
    except ValueError:
        return None


def _refuse_torques_alone(columns: dict[str, ReadColumn], table: Table) -> None:
    """Refuse a log of torques that holds nothing of the tip, whatever its settings call it."""
    torques = [column.header for name, column in columns.items() if name.startswith("tau")]
    seen = (*_PLACE, "along", "distance", "tilt_x", "tilt_y")
    if torques and not any(name in columns for name in seen) and not set(table.names) & set(LABELS.values()):
        message = (
            "has drives' torques and nothing of the tip, beside which alone torques are judged; record the tip too "
            "(x_mm, y_mm), or a height, a distance or a level (along_mm, distance_mm, tilt_x_deg) in the same rows"
        )
        raise InputError(table.file, torques[0], message)


def _require(
    columns: dict[str, ReadColumn], table: Table, arm: Arm, held: ReadingSettings, *, whole: bool = True
) -> None:
    wanted = [(f"q{k + 1}", example_headers("q", arm, k)) for k in range(arm.size)]
    wanted += [(name, example_headers(name, arm)) for name in ("x", "y") if whole]
    if whole and not planar_motion(arm):
        wanted.append(("z", example_headers("z", arm)))
    missing = [(name, would_do) for name, would_do in wanted if name not in columns]
    if missing:
        names = ", ".join(table.names)
        there = names if len(names) <= 300 else names[:300] + " ..."
        called = {f"q{k + 1}": arm.column("q", k) for k in range(arm.size)}
        (first, would_do), others = missing[0], [called.get(name, name) for name, _ in missing[1:]]
        also = f" (and {', '.join(others)})" if others else ""
        where = "" if held.columns else f", or map it in recording.yaml: `columns: {{{would_do.split()[0]}: FORMULA}}`"
        part = ""
        if first in _PLACE:
            some = any(name in columns for name in _PLACE)
            part = (
                "position` in recording.yaml if it was not" if some else "along`, distance, tilt or the like if it was"
            )
            part = f"; `observes: {part} measured"
        said = called.get(first, first)
        raise InputError(table.file, said, f"is missing{also}; the file has {there}; write {would_do}{where}{part}")
    given = [name for name in _QUATERNION if name in columns]
    if 0 < len(given) < len(_QUATERNION):
        lacking = ", ".join(name for name in _QUATERNION if name not in given)
        raise InputError(table.file, given[0], f"needs the rest of its quaternion: {lacking}")
    for group in (("rx", "ry", "rz"), ("basex", "basey"), ("fx", "fy")):
        given = [name for name in group if name in columns]
        if 0 < len(given) < len(group):
            lacking = ", ".join(name for name in group if name not in given)
            raise InputError(table.file, columns[given[0]].header, f"is there without {lacking}")


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


def _faults(
    columns: dict[str, ReadColumn], table: Table, mostly_blank: float
) -> tuple[dict[str, ReadColumn], list[RejectedRow], list[str]]:
    """Set rows without a number aside; an optional column that is mostly blank is set aside itself."""
    warnings: list[str] = []
    kept = dict(columns)
    total = len(table.row)
    reasons: dict[int, list[str]] = {}
    for name, column in columns.items():
        bad = np.flatnonzero(~np.isfinite(column.values))
        if not len(bad):
            continue
        base = column.meaning.base
        if len(bad) > mostly_blank * total:
            said = column.fault(int(bad[0]))
            where = f"row {table.row[bad[0]]}: {said}" + (f"; so do {len(bad) - 1} more rows" if len(bad) > 1 else "")
            if base in ("q", "x", "y", "z"):
                comma = "," in said and "not a number" in said and table.decimal == "."
                hint = '; decimal commas need `decimal: ","` in recording.yaml' if comma else ""
                raise InputError(table.file, column.header, f"holds no numbers in most rows ({where}){hint}")
            stamp = " A time stamp needs `time_format: iso`, say, in recording.yaml." if base == "time" else ""
            warnings.append(f"{column.header} is not used, because most of its cells hold no number ({where}).{stamp}")
            del kept[name]
            continue
        if base == "dir":
            blank = [int(k) for k in bad if (said := column.fault(int(k))).endswith("is blank")]
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
    return kept, rejected, warnings


def _not_unit(columns: dict[str, ReadColumn], table: Table, off: float) -> list[RejectedRow]:
    """Rows whose quaternion is none: a rotation's has the length 1."""
    if any(name not in columns for name in _QUATERNION):
        return []
    length = np.sqrt(sum(columns[name].values ** 2 for name in _QUATERNION))
    wrong = np.flatnonzero(np.isfinite(length) & (np.abs(length - 1.0) > off))
    if len(wrong) > 0.5 * len(table.row):
        first = f"row {table.row[wrong[0]]}: {length[wrong[0]]:.4g}"
        raise InputError(table.file, ", ".join(_QUATERNION), f"are no quaternions of length 1 in most rows ({first})")
    return [
        RejectedRow(int(table.row[k]), f"qw, qx, qy, qz have the length {length[k]:.4g}, not 1") for k in wrong.tolist()
    ]
