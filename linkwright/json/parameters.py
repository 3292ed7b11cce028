"""Fitted parameters and the rivals of a diagnosis in the units of files for machines."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.units.quantities import format_quantity, kind_of
from linkwright.json.fields import fields

if TYPE_CHECKING:
    from linkwright.core.diagnose.judge.rivals import Rivals

_UNITS = MappingProxyType(
    {
        "length": "mm",
        "angle": "mrad",
        "temperature": "degC",
        "thermal_expansion": "um/(m*K)",
        "linear_stiffness": "N/mm",
        "linear_compliance": "um/N",
        "elastic_modulus": "GPa",
        "pressure": "MPa",
        "angle_per_temperature": "mrad/K",
        "length_per_temperature": "um/K",
        "angle_per_length": "mrad/m",
    }
)
"""Units that files for machines use, whatever the size of the figure; SI for all other kinds."""


def unit_of(kind: str) -> str:
    """The unit in which JSON gives a kind of quantity; empty for pure numbers."""
    return _UNITS.get(kind, kind_of(kind).si)


def in_unit(value: float, kind: str) -> float | None:
    """An SI value in the unit of `unit_of`; None where it is not known."""
    if not math.isfinite(value):
        return None
    return float(format_quantity(value, kind, unit_of(kind) or None).split()[0])


def parameter_json(fitted: FittedParameter) -> dict[str, Any]:
    """A fitted parameter with its unit and 95 % interval."""
    return {
        "value": in_unit(fitted.value, fitted.kind),
        "unit": unit_of(fitted.kind),
        "ci95": [in_unit(end, fitted.kind) for end in fitted.alone],
        **fields(fitted, "parameter", "at", "at_bound"),
        "may_hold": fitted.may_hold or None,
    }


def parameter_row(fitted: FittedParameter) -> dict[str, Any]:
    """A fitted parameter as columns: value and 95 % interval in `unit`."""
    value, low, high = (in_unit(item, fitted.kind) for item in (fitted.value, *fitted.alone))
    return {"parameter": fitted.name, "value": value, "low": low, "high": high, "unit": unit_of(fitted.kind)}


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
