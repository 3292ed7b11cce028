"""What an arm is worth on a recording, described."""

from __future__ import annotations

import math
from pathlib import PurePath

import numpy as np

from linkwright.core.arm.errors.unknown_mass import payloads_left_out
from linkwright.core.diagnose.mistakes.row_lists import rows_text
from linkwright.core.diagnose.predict import Leaving, Prediction
from linkwright.results.document import Description, Item, Lines, Paragraph, length, table
from linkwright.results.figures_in_words import mm


def describe(found: Prediction) -> Description:
    """How far the model is off, beside the geometry alone."""
    recording = found.recording
    fitted = " and ".join(name for name in ("frame", "tool") if getattr(recording, name) == "free")
    how = f"{fitted} fitted" if fitted else "frame and tool as declared"
    rows = [
        ("the arm file's model", length(found.rms, 3), length(found.mean, 3), length(found.largest, 3)),
        ("its geometry alone", length(found.nominal_rms, 3), "", ""),
    ]
    payloads = () if recording.payload_mass is None else np.unique(recording.payload_mass).tolist()
    items: list[Item] = [table(("residual", "RMS", "mean", "largest"), rows)]
    if found.left:
        lead = "Beyond what the arm was learned from nothing promises that its findings hold."
        items.append(Lines((*(_leaving(found, each) for each in found.left), lead)))
    if (missing := payloads_left_out(found.arm, payloads)) is not None:
        items.append(Paragraph(f"Warning: {missing}."))
    name = PurePath(recording.file).name
    headline = f"{mm(found.rms, 3)} RMS over {recording.size} readings, {how}"
    return Description(f"{found.arm.name} on {name}", headline, tuple(items), headline, f"{found.arm.name}: ")


def _leaving(found: Prediction, each: Leaving) -> str:
    """Where a joint leaves the coordinates that the arm was learned from, as a warning."""
    revolute = found.arm.joints[each.joint - 1].revolute
    low, high = (math.degrees(end) if revolute else 1e3 * end for end in each.span)
    what = "the coordinates that were learned" if each.learned else "its range"
    return f"Warning: joint {each.joint} leaves {what} ({low:.4g} to {high:.4g} {'deg' if revolute else 'mm'}) in " + (
        f"{rows_text(each.rows)}."
    )
