"""A compensation table on the screen: how much it takes away, at its poses and between them."""

from __future__ import annotations

import numpy as np
from rich.console import Console

from arm.compensation import INSTRUMENT, Table
from linkwright.words import coordinate, effect_title, figure, mm, with_unit

from .console import table

_NOTE = "The table holds what is certain: play lies where the load seats it; sides, time and warming are not in it."


def show_compensation(out: Console, found: Table) -> None:
    """Print what the table does."""
    arm = found.arm
    payloads = ", ".join(with_unit(value, "kg") for value in np.unique(found.payload).tolist())
    out.print(f"{arm.name}: {len(found.q)} poses, payload {payloads}", style="bold")
    if found.axes is not None:
        steps = [
            f"joint {index + 1} every {coordinate(arm, index, float(axis[1] - axis[0]))}"
            for index, axis in enumerate(found.axes)
        ]
        out.print(f"grid: {', '.join(steps)}", soft_wrap=True)
    length = np.linalg.norm(found.error, axis=1)
    shown = table("error of the tip", "RMS", "largest", numbers=(1, 2))

    def row(name: str, rms: float, largest: float) -> None:
        shown.add_row(name, mm(rms, 3), mm(largest, 3))

    row("at the table's poses, without it", _rms(length), float(length.max()))
    row("there, joint corrections added", _rms(found.left), float(found.left.max()))
    check = found.check
    if check is not None:
        row(f"between them ({check.poses} poses checked), without it", check.rms_without, check.largest_without)
        row("there, interpolated displacement subtracted", check.rms_subtracted, check.largest_subtracted)
        row("there, interpolated joint corrections added", check.rms_corrected, check.largest_corrected)
    out.print(shown)
    if check is not None and check.largest_subtracted > 0.1 * check.largest_without > 0.0:
        share = figure(100.0 * check.largest_subtracted / check.largest_without, 2)
        why = "the grid is coarse for it, or the load turns play over"
        out.print(f"Between the poses {share} % of the largest error stays: {why}.")
    out.print(_NOTE, soft_wrap=True)
    left = dict.fromkeys(entry.effect for entry in arm.effects if entry.effect in INSTRUMENT)
    if left:
        names = ", ".join(effect_title(effect) for effect in left)
        out.print(f"Not in it, because it belongs to the instrument: {names}.", soft_wrap=True)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values * values)))
