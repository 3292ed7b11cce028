"""A recording that was written and read back, beside the one that was meant."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording

from .write import label_columns, recording_columns, settings_text

_ROUNDED = 0.500001
"""How far a number may be from what it was, in units of the last decimal that is written."""
_LARGE = 1e-13
"""The same of large numbers, of what a float can hold."""


def unlike(meant: Recording, back: Recording, arm: Arm, *, without: Collection[str] = ()) -> Iterator[str]:
    """What a recording of an arm that was read back says otherwise than the one that was meant, column by column, in
    the units of a file; nothing where it is the same. Columns `without` are left aside."""
    if back.rejected:
        first = back.rejected[0]
        yield f"row {first.row} is set aside: {first.reason}"
        return
    if meant.size != back.size:
        yield f"it had {meant.size} readings and reads {back.size}"
        return
    read = {name: values for name, values, _ in recording_columns(back, arm)}
    for name, values, digits in recording_columns(meant, arm):
        if name in without:
            continue
        if name not in read:
            yield f"{name} is gone"
            continue
        near = np.abs(read[name] - values) <= _ROUNDED * 10.0**-digits + _LARGE * np.abs(values)
        if len(bad := np.flatnonzero(~(near | (np.isnan(values) & np.isnan(read[name]))))):
            k = int(bad[0])
            yield f"{name} in row {back.row[k]} was {values[k]:.9g} and reads {read[name][k]:.9g}"
    labels = dict(label_columns(back))
    asked = ((name, item) for name, item in label_columns(meant) if name not in without)
    yield from (f"{name} names other places" for name, item in asked if labels.get(name) != item)


def unlike_settings(meant: Recording, back: Recording) -> Iterator[str]:
    """The settings of a recording that was read back where they are not those that were meant."""
    was, reads = (settings_text(item).splitlines() for item in (meant, back))
    if was != reads:
        line = next((line for line in was if line not in reads), "nothing")
        other = next((line for line in reads if line not in was), "nothing")
        yield f"its settings were '{line}' and read '{other}'"
