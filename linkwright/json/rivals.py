"""The rivals of a diagnosis as JSON, tips and torques alike."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from .fields import fields

if TYPE_CHECKING:
    from linkwright.core.diagnose.judge.rivals import Rivals


def rivals_json(rivals: Rivals | None, *figures: str, by_joint: bool = False) -> dict[str, Any]:
    """The models that were tried on held-out readings with some `figures` (see `fields`), and which of them the file
    holds and why; `by_joint` of which branch."""
    if rivals is None:
        return {"rivals": [], "written": None, "written_because": None}
    table = [fields(item, "name", "parameters", *figures) for item in rivals.table]
    if by_joint:
        for entry, item in zip(table, rivals.table, strict=True):
            entry["by_joint"] = [value if math.isfinite(value) else None for value in item.rms().tolist()]
    return {"rivals": table, "written": rivals.written, "written_because": rivals.why}
