"""A compensation table described: how much it takes away, at its poses and between them."""

from __future__ import annotations

import numpy as np

from linkwright.core.arm.compensation import Table as Compensation
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.errors.unknown_mass import payloads_left_out

from .document import Description, Item, Paragraph, length, table
from .figures_in_words import coordinate, effect_title, figure, mm, with_unit

_NOTE = "The table holds what is certain: play lies where the load seats it; sides, time and warming are not in it."


def describe(found: Compensation) -> Description:
    """What the table does."""
    arm, check = found.arm, found.check
    payloads = ", ".join(with_unit(value, "kg") for value in np.unique(found.payload).tolist())
    error = np.linalg.norm(found.error, axis=1)
    sizes = [
        ("at the table's poses, without it", _rms(error), float(error.max())),
        ("there, joint corrections added", _rms(found.left), float(found.left.max())),
    ]
    if check is not None:
        name = f"between them ({check.poses} poses checked), without it"
        sizes += [
            (name, check.rms_without, check.largest_without),
            ("there, interpolated displacement subtracted", check.rms_subtracted, check.largest_subtracted),
            ("there, interpolated joint corrections added", check.rms_corrected, check.largest_corrected),
        ]
    rows = [(name, length(rms, 3), length(largest, 3)) for name, rms, largest in sizes]
    items: list[Item] = []
    if found.axes is not None:
        steps = [
            f"joint {index + 1} every {coordinate(arm, index, float(axis[1] - axis[0]))}"
            for index, axis in enumerate(found.axes)
            if len(axis) > 1
        ]
        items.append(Paragraph(f"grid: {', '.join(steps)}"))
    items.append(table(("error of the tip", "RMS", "largest"), rows))
    if check is not None and check.largest_subtracted > 0.1 * check.largest_without > 0.0:
        share = figure(100.0 * check.largest_subtracted / check.largest_without, 2)
        why = "the grid is coarse for it, or the load turns play over"
        items.append(Paragraph(f"Between the poses {share} % of the largest error stays: {why}."))
    items.append(Paragraph(_NOTE))
    missing = payloads_left_out(arm, np.unique(found.payload).tolist())
    if missing:
        items.append(Paragraph(f"Warning: {missing}."))
    left = dict.fromkeys(entry.effect for entry in arm.effects if EFFECTS[entry.effect].of_instrument)
    if left:
        names = ", ".join(effect_title(effect) for effect in left)
        items.append(Paragraph(f"Not in it, because it belongs to the instrument: {names}."))
    headline = f"{len(found.q)} poses, payload {payloads}"
    brief = f"{headline}: largest error {mm(float(error.max()), 3)}"
    return Description(f"{arm.name}: compensation table", headline, tuple(items), brief, f"{arm.name}: ")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values * values)))
