"""Columns of joints that only follow others: what the arm says of them, and whether a recording agrees."""

from __future__ import annotations

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import coordinates
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.units.quantities import InputError, format_quantity

from .columns import meaning_of
from .read_column import ReadColumn
from .table import Table


def with_followers(
    columns: dict[str, ReadColumn], table: Table, arm: Arm, rules: ResidualRules
) -> dict[str, ReadColumn]:
    """The columns with the coordinates of joints that only follow others, which a recording need not have.

    Raises `InputError` where it has one that is not what the arm file says.
    """
    names = [f"q{index + 1}" for index in range(arm.size)]
    if any(joint.driven and name not in columns for joint, name in zip(arm.joints, names, strict=True)):
        return columns  # what lacks is said elsewhere
    nothing = np.zeros(len(table.row))
    given = [columns[name].values if name in columns else nothing for name in names]
    columns_of_all = dict(columns)
    for index, (joint, values) in enumerate(zip(arm.joints, coordinates(arm, given), strict=True)):
        if joint.driven:
            continue
        name, kind = names[index], "angle" if joint.revolute else "length"
        if name in columns:
            off = np.abs(columns[name].values - values)
            worst = int(np.argmax(np.nan_to_num(off)))
            if off[worst] > rules.same_coordinate(joint.revolute):
                says, due = (format_quantity(float(item[worst]), kind, digits=6) for item in (given[index], values))
                message = f"is {says} in row {table.row[worst]}, where what the joint follows (arm file) makes it {due}"
                raise InputError(
                    table.file, columns[name].header, f"{message}; leave the column out, or correct either"
                )
        meaning = meaning_of(f"{name}_{'deg' if joint.revolute else 'mm'}", arm, file=table.file)
        if meaning is not None:
            columns_of_all[name] = ReadColumn(
                meaning, name, np.asarray(values), lambda _: "what the joint follows is not known"
            )
    return columns_of_all
