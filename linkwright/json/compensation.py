"""A compensation table as columns, and as a plain mapping for JSON: degrees and mm."""

from __future__ import annotations

from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.compensation import Table
from linkwright.core.arm.errors.unknown_mass import payloads_left_out
from linkwright.version import program_version

from .fields import fields, joint_columns

_DIGITS = 9


def table_columns(table: Table) -> dict[str, NDArray[np.float64]]:
    """The table's columns by name, in degrees and mm."""
    arm = table.arm
    columns = {**joint_columns(arm, table.q), "payload_kg": table.payload}
    for axis, values in zip("xy" if arm.planar() else "xyz", table.error.T, strict=False):
        columns[f"d{axis}_mm"] = 1e3 * values
    columns |= {**joint_columns(arm, table.correction, "dq"), "left_mm": 1e3 * table.left}
    return {name: values.round(_DIGITS) + 0.0 for name, values in columns.items()}


def compensation_json(table: Table) -> dict[str, Any]:
    """What `compensate --json` writes."""
    columns = table_columns(table)
    length = 1e3 * np.linalg.norm(table.error, axis=1)
    warning = payloads_left_out(table.arm, np.unique(table.payload).tolist())
    pairs = [(f"rms_{name}_mm", f"max_{name}_mm=largest_{name}") for name in ("without", "subtracted", "corrected")]
    return {
        "made_by": f"linkwright compensate {program_version()}",
        "arm": table.arm.name,
        "grid": None if table.axes is None else [len(axis) for axis in table.axes],
        "rms_error_mm": float(np.sqrt(np.mean(length**2))),
        "max_error_mm": float(length.max()),
        "max_left_mm": float(1e3 * table.left.max()),
        "between": None if table.check is None else fields(table.check, "poses", *chain(*pairs)),
        "warnings": [warning] if warning else [],
        "columns": list(columns),
        "rows": np.stack(list(columns.values()), axis=1).tolist(),
    }
