"""Which tip of several arms on one torso a recording is of, and where the other arms were meanwhile."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Branch
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import refusal

from .columns import meaning_of
from .read_column import ReadColumn
from .settings import ReadingSettings
from .table import Table


def to_its_tip(arm: Arm, held: ReadingSettings, file: object) -> Arm:
    """The arm to the tip that the settings name. Raises `InputError` where they name none of its, or none at all."""
    names = [branch.name for branch in arm.branches]
    if not names and held.tip:
        raise InputError(held.file, "tip", f"is {held.tip}, but {arm.name!r} has no branches; leave it out")
    if names and not held.tip:
        raise refusal(file, "tip", f"is not said, and {arm.name!r} has several", *({"tip": name} for name in names))
    if names and held.tip not in names:
        hint = nearest(held.tip, names)
        raise InputError(held.file, "tip", f"is {held.tip}, but {arm.name!r} has {' and '.join(names)}{hint}")
    return arm.on(held.tip)


def refuse_unmeasured_origins(arm: Arm, tips: Collection[str], file: object) -> None:
    """Raises `InputError` where a branch has a fixed transform that is free and none of the recordings, which are to
    these `tips`, measures beyond it: its weight alone would have to say where it stands."""
    for branch in arm.branches:
        free = [index for index in arm.unknown_origins if branch.first <= index < branch.end]
        if free and branch.name not in tips:
            key = f"branches.{branch.name}.chain[{free[0] - branch.first + 1}].origin"
            would_do = f"add a recording with `tip: {branch.name}`, or write where it stands"
            raise InputError(file, key, f"is free, and no recording is of {branch.name}'s tip; {would_do}")


def with_others_at_rest(
    columns: dict[str, ReadColumn], table: Table, arm: Arm
) -> tuple[dict[str, ReadColumn], list[str]]:
    """The columns with those of other branches that the recording does not hold, as if they had stood still at zero, or
    as near to it as they come; and sentences that say so."""
    columns_of_all, sentences = dict(columns), list[str]()
    for branch in arm.branches:
        indices = range(branch.first, branch.end)
        if branch.name == arm.tip or all(f"q{index + 1}" in columns for index in indices):
            continue
        held = [arm.column("q", index) for index in indices if f"q{index + 1}" in columns]
        lacking = [arm.column("q", index) for index in indices if f"q{index + 1}" not in columns]
        if held:
            raise InputError(table.file, lacking[0], f"is missing beside {held[0]}; give all of {branch.name} or none")
        sentences.append(_at_rest(columns_of_all, table, arm, branch))
    return columns_of_all, sentences


def _at_rest(columns: dict[str, ReadColumn], table: Table, arm: Arm, branch: Branch) -> str:
    places: list[str] = []
    for index in range(branch.first, branch.end):
        joint = arm.joints[index]
        low, high = joint.range
        rest = min(max(0.0, low), high)
        places.append(format_quantity(rest, "angle" if joint.revolute else "length"))
        header = f"{arm.column('q', index)}_{'deg' if joint.revolute else 'mm'}"
        meaning = meaning_of(header, arm, file=table.file)
        if meaning is not None:
            values = np.full(len(table.row), rest)
            columns[meaning.name] = ReadColumn(meaning, header, values, lambda _: "where the branch was is not known")
    name = arm.column("q", branch.first)
    where = f"it is taken to have stood still at {', '.join(places)}, and its weight loads the torso so"
    return f"Where {branch.name} was meanwhile is not said ({name} and on): {where}."
