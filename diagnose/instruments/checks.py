"""What cannot be right in a recording that observes in part, looked at before it is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity

from .kind import InstrumentKind
from .level import stand_of
from .look import SCALES, Look
from .registry import kind_at, kinds_of, marked
from .view import View, viewed


def sights_checked(recording: Recording, arm: Arm, *, rules: Rules = RULES) -> Recording:
    """The recording less rows far off, where numbers contradict the joints. Raises `InputError` where they do so as a
    whole, where any anchor would fit, and for planes that were touched on a line."""
    slots = recording.slots
    if slots is None:
        return recording
    tips, axes = nominal(arm, recording.q, 3)
    kinds = kinds_of(slots)
    stand = stand_of(recording, arm)

    def view(tried: Recording) -> View:
        return viewed(tried, tips, axes, stand, flat=arm.planar(), rules=rules.residual)

    def refuse(off: Array | None) -> None:
        framed = any(kind.framed for kind in kinds)
        for kind in kinds:
            numbers = marked(slots, (kind,))
            kind.refuse(Look(recording, tips, axes, arm.planar(), view, off, rules, numbers, framed))

    refuse(None)
    if recording.size < rules.residual.enough_freedom or not np.ptp(recording.q, axis=0).any():
        return recording
    off, extent = np.abs(view(recording).residual), float(np.linalg.norm(np.ptp(tips, axis=0)))
    numbers = marked(slots, [kind for kind in kinds if _lengths(kind)])
    refuse(off)
    misfit = float(np.median(off[numbers])) if numbers.any() else 0.0
    if misfit > rules.reading.elsewhere * extent:
        _say_why(recording, view, numbers, misfit, extent, rules)
    limit = max(rules.mistakes.far * float(np.median(off)), rules.mistakes.gross * extent)
    far = (off > limit).any(axis=1)
    if not far.any() or far.mean() > rules.mistakes.few_rows:
        return recording
    bad: list[RejectedRow] = []
    for index in np.flatnonzero(far).tolist():
        column = int(np.argmax(off[index]))
        by = format_quantity(float(off[index, column]), "length", digits=3)
        what = kind_at(int(slots[index, column]))[1].name
        bad.append(RejectedRow(int(recording.row[index]), f"{what} is {by} from what its joints say"))
    return recording.without(bad)


def _say_why(
    recording: Recording,
    view: Callable[[Recording], View],
    numbers: NDArray[np.bool_],
    misfit: float,
    extent: float,
    rules: Rules,
) -> None:
    """Raise the error that says what is wrong with all of a recording."""
    at = [kind_at(slot) for slot in np.unique(np.asarray(recording.slots)).tolist()]
    read = ", ".join(number.name for kind, number in at if _lengths(kind))
    for scale, words in SCALES:
        other = float(np.median(np.abs(view(replace(recording, tip=recording.tip * scale)).residual[numbers])))
        if other < rules.mistakes.better * misfit and other < rules.reading.elsewhere * extent:
            message = (
                f"looks as if its numbers were {words} than the header's unit says; correct the unit in the header"
            )
            raise InputError(recording.file, read, message)
    off = format_quantity(misfit, "length", digits=3)
    free = "" if recording.frame == "free" else "; `frame: free` fits where it was measured from"
    settings = dict.fromkeys(name for kind, _ in at for name in kind.settings if not kind.alone)
    said = "".join(f", `{name}`" for name in settings)
    raise InputError(
        recording.file,
        read,
        f"the middle reading is {off} from what the arm file's geometry gives: check the arm, the order of the joints, "
        f"signs and zeros{said}{free}",
    )


def _lengths(kind: InstrumentKind) -> bool:
    """Whether a kind's numbers are lengths that are written."""
    return any(number.column and number.quantity == "length" for number in kind.numbers)
