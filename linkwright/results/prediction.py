"""What an arm is worth on a recording, described."""

from __future__ import annotations

from pathlib import PurePath

from diagnose.mistakes.row_lists import rows_text
from diagnose.predict import Prediction

from .document import Description, Item, Paragraph, length, table
from .figures_in_words import mm


def describe(found: Prediction) -> Description:
    """How far the model is off, beside the geometry alone."""
    recording = found.recording
    fitted = " and ".join(name for name in ("frame", "tool") if getattr(recording, name) == "free")
    how = f"{fitted} fitted" if fitted else "frame and tool as declared"
    rows = [
        ("the arm file's model", length(found.rms, 3), length(found.mean, 3), length(found.largest, 3)),
        ("its geometry alone", length(found.nominal_rms, 3), "", ""),
    ]
    items: list[Item] = [table(("residual", "RMS", "mean", "largest"), rows)]
    if found.outside:
        where = "Beyond the coordinates that the arm was learned from (or its ranges)"
        items.append(Paragraph(f"{where}: {rows_text(found.outside)}."))
    name = PurePath(recording.file).name
    headline = f"{mm(found.rms, 3)} RMS over {recording.size} readings, {how}"
    return Description(f"{found.arm.name} on {name}", headline, tuple(items), headline, f"{found.arm.name}: ")
