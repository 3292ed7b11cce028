"""Which columns are of the joints where no word of their headers is known: by numbers, units and signs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.columns import units_for
from linkwright.core.diagnose.reading.table import Table

from .header_units import name_and_unit, unit_of
from .words import unknown_words, without_number

_BASES = ("q", "v", "tau", "current")


def joint_columns(headers: Sequence[str], table: Table, arm: Arm, taken: set[str]) -> dict[str, tuple[str, str, str]]:
    """For each column of the joints: what it is (`q1`), its unit, and why.

    `headers` are those that no word tells, `taken` what other columns are. Columns of unknown words numbered from 1 to
    the last joint count where no second such series has the same kind of unit, or holds signs alone. Columns without
    numbers count where as many hold numbers as the arm has joints, and nothing else tells the coordinates.
    """
    whole = _whole_series(headers, arm.size)
    columns = _by_unit(whole, arm, taken) | _by_signs(whole, table, taken)
    if "q1" in taken or whole or any(what == "q1" for what, _, _ in columns.values()):
        return columns
    bare = [header for header in headers if not name_and_unit(header)[1] and np.isfinite(table.numbers(header)).all()]
    if len(bare) == arm.size:
        columns |= {header: (f"q{joint}", "", "by its place") for joint, header in enumerate(bare, start=1)}
    return columns


def _whole_series(headers: Sequence[str], size: int) -> list[dict[int, str]]:
    """Headers of unknown words that differ in their number alone, from 1 to the last joint, by that number."""
    series: dict[str, dict[int, str]] = defaultdict(dict)
    for header in headers:
        words, number = without_number(name_and_unit(header)[0])
        if number is not None and unknown_words(header):
            series[words][number] = header
    return [group for group in series.values() if set(group) == set(range(1, size + 1))]


def _by_unit(whole: Sequence[Mapping[int, str]], arm: Arm, taken: set[str]) -> dict[str, tuple[str, str, str]]:
    columns: dict[str, tuple[str, str, str]] = {}
    for base in _BASES:
        of_base = [units for group in whole if (units := _units(base, group, arm)) is not None]
        if len(of_base) == 1 and f"{base}1" not in taken:
            why = "by its number and unit"
            columns |= {header: (f"{base}{joint}", unit, why) for joint, (header, unit) in of_base[0].items()}
    return columns


def _by_signs(whole: Sequence[Mapping[int, str]], table: Table, taken: set[str]) -> dict[str, tuple[str, str, str]]:
    signs = [group for group in whole if all(_signs(table, header) for header in group.values())]
    if len(signs) != 1 or "dir1" in taken:
        return {}
    return {header: (f"dir{joint}", "", "by its number and signs") for joint, header in signs[0].items()}


def _units(base: str, group: Mapping[int, str], arm: Arm) -> dict[int, tuple[str, str]] | None:
    """The headers of a series with their units, None where one cannot be of the kind."""
    units = {joint: (header, unit_of(f"{base}{joint}", name_and_unit(header)[1])) for joint, header in group.items()}
    fits = all(unit in units_for(base, arm, joint - 1) for joint, (_, unit) in units.items())
    return units if fits else None


def _signs(table: Table, header: str) -> bool:
    return bool(np.isin(table.sides(header), (-1.0, 1.0)).all())
