"""The columns of a file as ours: by the settings' formulas, by headers that are ours, by headers spelled otherwise."""

from __future__ import annotations

import datetime
from collections.abc import Set
from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS
from linkwright.core.sections.numeric import Array
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown

from .columns import ColumnMeaning, UnitMissing, meaning_of, of_kind, otherwise_spelled
from .foreign.clock import has_stamps, iso_stamp
from .foreign.header_units import alone_in_unit
from .foreign.headers import Headers
from .foreign.mapped import plain_headers, taken_for_ours
from .formula import Formula, read_condition, read_formula
from .read_column import ReadColumn
from .settings import ReadingSettings
from .table import Table

_KNOWN = ("time_s", "payload_kg", "temperature_degC", "x_mm", "y_mm", "z_mm", "basex_mm", "fx_N", "qw", "rx_deg")
_KNOWN_JOINT = ("q{}_deg", "q{}_mm", "dir{}", "c{}_deg", "j{}_deg", "v{}_deg_s", "a{}_deg_s2", "tau{}_Nm")
_LARGEST = 1e12
"""In SI; seconds since 1970 count to 2e9."""
PROPOSES = " (`linkwright columns FILE --arm ARM --out recording.yaml` proposes it)"


def chosen_rows(table: Table, held: ReadingSettings) -> tuple[Table, list[str]]:
    """The rows that the settings ask for; the others are not readings of this recording."""
    keep = np.ones(len(table.row), dtype=bool)
    for text in held.rows:
        condition = read_condition(text, table.names, file=held.file, key="rows")
        keep &= condition.holds(table.numbers, len(keep))
    if keep.all():
        return table, []
    if not keep.any():
        raise InputError(held.file, "rows", f"no row of {table.file} meets {' and '.join(held.rows)}")
    sentence = f"{' and '.join(held.rows)} ({held.file}) chooses {int(keep.sum())} of {len(keep)} rows."
    return table.kept(keep), [sentence]


def named_columns(
    table: Table, held: ReadingSettings, arm: Arm
) -> tuple[dict[str, ReadColumn], dict[str, Array], list[str]]:
    """Our columns by name (`q1`, `x`), the numbers of strangers, and sentences about what is not used."""
    for name in held.ignore:
        if name not in table.columns:
            raise InputError(held.file, "ignore", f"there is no column {shown(name)}{nearest(name, table.names)}")
    naming, labels = _Naming(table, held, arm), _labels_of(held)
    for header, text in held.columns.items():
        if header in labels:
            naming.used.add(text)
        else:
            naming.by_formula(header, text)
    ours = naming.translated()
    for header in table.names:
        if header not in held.ignore and header not in labels:
            naming.by_header(header, ours.get(header, header))
    aside = [header for header in naming.strangers if naming.mapped and header not in naming.asked]
    if aside:
        naming.warnings.append(f"No columns that are known here: {', '.join(aside)}. They are kept as they are.")
    strangers = {name: values for name, values in naming.strangers.items() if np.isfinite(values).any()}
    return naming.columns, strangers, naming.warnings


class _Naming:
    """Our columns as they are named, one after the other; of `used` columns of the file nothing is said, and `asked`
    says what a stranger may be by its unit. `mapped`: columns have names that are not ours, so that strangers are no
    slips of spelling."""

    def __init__(self, table: Table, held: ReadingSettings, arm: Arm) -> None:
        self.table, self.held, self.arm = table, held, arm
        self.columns: dict[str, ReadColumn] = {}
        self.strangers: dict[str, Array] = {}
        self.warnings: list[str] = []
        self.used, self.asked, self.mapped = set(held.ignore), dict[str, str](), bool(held.columns)

    def by_formula(self, header: str, text: str) -> None:
        """A column of ours that the settings give. Raises `InputError`."""
        held, key = self.held, f"columns.{header}"
        meaning = _meaning(header, self.arm, held, held.file)
        if meaning is None:
            hint = nearest(header, _known_headers(self.arm))
            raise InputError(held.file, key, f"is no column of a recording{hint}")
        formula = read_formula(text, self.table.names, file=f"{held.file} (for {self.table.file})", key=key)
        if meaning.name in self.columns:
            raise InputError(held.file, key, f"is given twice; {self.columns[meaning.name].header} gives it")
        self.used.update(formula.columns)
        column = _by_formula(self.table, header, meaning, formula, held)
        self.columns[meaning.name] = replace(column, formula="" if text == header else text)

    def translated(self) -> dict[str, str]:
        """Headers of other tools, and those that are ours but for how they are written, each with ours. Says which,
        and keeps what units alone say of strangers."""
        table, held, arm = self.table, self.held, self.arm
        mapped = plain_headers(table, arm, held) if held.motion is None else {}
        foreign = {header: item for header, item in mapped.items() if header not in self.used}
        if foreign:
            self.mapped = True
            self.warnings.append(taken_for_ours(list(foreign.values())))
        known = {*self.columns, *(item.what for item in foreign.values())}
        asked = alone_in_unit(table.names)
        self.asked = {header: f"{what}_{unit}" for what, (header, unit) in asked.items() if what not in known}
        spelled = _spelled(table, held, arm, self.used)
        if spelled:
            pairs = ", ".join(f"{shown(header)} as {ours}" for header, ours in spelled.items())
            self.warnings.append(f"Headers that are written otherwise are read as ours: {pairs}.")
        return spelled | {header: item.ours for header, item in foreign.items()}

    def by_header(self, header: str, ours: str) -> None:
        """A column by its header, which is `ours` where it was written otherwise. Raises `InputError`."""
        table, held = self.table, self.held
        meaning = self._meaning(header, ours)
        if meaning is None:
            if header not in self.used:  # what a column of ours is made of tells nothing further
                self._stranger(header)
        elif meaning.name in self.columns:
            given = self.columns[meaning.name].header
            if given not in held.columns:
                raise InputError(table.file, header, f"says the same as {given}; drop one")
            if header not in self.used:
                self.warnings.append(f"{header} gives way to {meaning.name} of {Path(held.file).name}.")
        else:
            form = _time_format(table, header, held) if meaning.base == "time" else None
            column = (
                _plain(table, header, meaning) if form is None else _stamps(table, header, header, meaning, form, held)
            )
            if ours != header:
                column = replace(column, ours=ours, formula=f"`{header}`")
            self.columns[meaning.name] = column

    def _meaning(self, header: str, ours: str) -> ColumnMeaning | None:
        try:
            return _meaning(ours, self.arm, self.held, self.table.file)
        except UnitMissing as error:
            if not self.held.columns and not error.stranger:
                raise UnitMissing(error.file, error.key, error.message + PROPOSES, *error.remedies) from None
            if header not in self.used:
                self.warnings.append(f"{header} is not used: {error.message}.")
            return None

    def _stranger(self, header: str) -> None:
        self.strangers[header] = measurable(self.table.numbers(header))
        if self.mapped and header not in self.asked:
            return
        hint = nearest(header, _known_headers(self.arm))
        meant = hint if hint.startswith("; did") else ". It is kept as it is."
        if header in self.asked and not hint.startswith("; did"):
            ours = self.asked[header]
            write = Headers({}, {}, tuple(self.held.columns), self.held.file).write({"columns": {ours: f"`{header}`"}})
            meant = f". Is it the {ours.partition('_')[0]}? Then {write}."
        self.warnings.append(f"{header} is no column that is known here{meant}")


def _meaning(header: str, arm: Arm, held: ReadingSettings, file: object) -> ColumnMeaning | None:
    """What a header says; heights and distances are strangers to a recording that does not observe them."""
    kind = of_kind(header)
    if kind is not None and kind not in held.kinds:
        return None
    return meaning_of(header, arm, file=file)


def _labels_of(held: ReadingSettings) -> tuple[str, ...]:
    """The columns of labels that a recording has."""
    return (
        ()
        if held.instrument is None
        else tuple(label for k in held.instrument.kinds if (label := INSTRUMENTS[k].label))
    )


def _spelled(table: Table, held: ReadingSettings, arm: Arm, used: Set[str]) -> dict[str, str]:
    """The headers that are ours but for how they are written, with ours; none whose like is there as it should be, and
    none that are `used` already."""

    def meant(header: str) -> str:
        try:
            meaning = _meaning(header, arm, held, table.file)
        except UnitMissing:
            return ""
        return "" if meaning is None else meaning.name

    taken = {meant(header) for header in table.names}
    ours = {header: otherwise_spelled(header) for header in table.names if header not in used}
    return {header: name for header, name in ours.items() if name and meant(name) and meant(name) not in taken}


def _known_headers(arm: Arm) -> list[str]:
    joints = [item.format(number) for number in range(1, arm.size + 1) for item in _KNOWN_JOINT]
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
    alone = formula.columns == (formula.text.strip("`"),)
    form = held.time_format if meaning.base == "time" else None
    if form is not None and not alone:
        raise InputError(held.file, f"columns.{header}", "is a time stamp; it names one column and nothing else")
    if form is None and meaning.base == "time" and alone:
        form = _time_format(table, formula.columns[0], held)
    if form is not None:
        return _stamps(table, formula.columns[0], header, meaning, form, held)

    def fault(index: int) -> str:
        for name in formula.columns:
            if fault_text := table.fault(name, index):
                return fault_text
        return f"{header} = {formula.text} is not finite, or beyond anything measured"

    numbers = table.sides if meaning.base == "dir" else table.numbers
    values = formula.value(numbers, len(table.row)) * meaning.factor + meaning.offset
    return ReadColumn(meaning, header, measurable(values), fault)


def _time_format(table: Table, column: str, held: ReadingSettings) -> str | None:
    """How a column's time stamps are written: as the settings say, by ISO 8601 where they say nothing and the cells are
    such stamps and no numbers; None for seconds that are counted."""
    if held.time_format is not None:
        return held.time_format
    return "iso" if has_stamps(table, column) else None


def _stamps(
    table: Table, column: str, header: str, meaning: ColumnMeaning, form: str, held: ReadingSettings
) -> ReadColumn:
    """Time stamps in s since 1970: files of one day are on one clock."""
    values = np.full(len(table.row), np.nan)
    stamps = [_stamp(table.text(column, index), form) for index in range(len(table.row))]
    first = next((stamp for stamp in stamps if stamp is not None), None)
    if first is None:
        message = f"{shown(form)} does not fit {column}: row 1 holds {shown(table.text(column, 0))}"
        raise InputError(held.file, "time_format", message)
    began = datetime.datetime(1970, 1, 1, tzinfo=None if first.tzinfo is None else datetime.UTC)
    for index, stamp in enumerate(stamps):
        if stamp is not None:
            if (stamp.tzinfo is None) != (first.tzinfo is None):
                continue
            values[index] = (stamp - began).total_seconds()

    def fault(index: int) -> str:
        text = table.text(column, index)
        return f"{column} is {shown(text)}, not a time ({form})" if text else f"{column} is blank"

    return ReadColumn(meaning, header, values, fault)


def _stamp(text: str, form: str) -> datetime.datetime | None:
    if form in ("iso", "unix"):
        return iso_stamp(text) if form == "iso" else None
    try:
        return datetime.datetime.strptime(text, form)
    except ValueError:
        return None
