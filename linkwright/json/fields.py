"""Fields of a result as entries of JSON: which, in which order and in which unit is said by their keys."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.units.quantities import format_quantity, kind_of
from linkwright.core.units.temperature import ZERO_CELSIUS

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.diagnose.judge.rivals import Rivals
    from linkwright.core.sections.numeric import Array


def in_mm(metres: float | Sequence[Any] | None) -> Any:
    """A length or points (m) in mm; None where it is not known."""
    if isinstance(metres, Sequence):
        return [in_mm(metre) for metre in metres]
    return None if metres is None or not math.isfinite(metres) else 1e3 * metres


_UNITS: Mapping[str, Callable[[Any], Any]] = MappingProxyType(
    {
        "_mm": in_mm,
        "_deg": math.degrees,
        "_arcmin": lambda angle: math.degrees(angle) * 60.0,
        "_MPa": lambda pressure: pressure / 1e6,
        "_degC": lambda temperature: temperature - ZERO_CELSIUS,
        **dict.fromkeys(("_Nm_per_rad", "_Nm", "_N", "_kg", "_EUR", "_Hz"), lambda value: value),
    }
)
"""What makes of a figure in SI that in the unit by which a key ends."""


def fields(item: object, *keys: str) -> dict[str, Any]:
    """Some fields of an object by key. A key is the name of its field, with the unit in which it is given behind it
    (`mass_kg`), or says where it is found (`since_s=since`, `seed=sheet.seed`)."""
    content: dict[str, Any] = {}
    for each in keys:
        key, _, place = each.partition("=")
        unit = next((unit for unit in _UNITS if key.endswith(unit)), "")
        value = reduce(getattr, (place or key.removesuffix(unit)).split("."), item)
        value = list(value) if isinstance(value, tuple) and unit != "_mm" else value
        content[key] = value if value is None or not unit else _UNITS[unit](value)
    return content


def fields_if(item: object, *keys: str) -> dict[str, Any] | None:
    """The same of what may be missing."""
    return None if item is None else fields(item, *keys)


def joint_unit(arm: Arm, index: int) -> str:
    """The unit of a joint's coordinate (from 0) for people: degrees where it turns, mm where it slides."""
    return "deg" if arm.joints[index].revolute else "mm"


def in_joint_unit(arm: Arm, index: int, value: float) -> float:
    """A joint's coordinate (rad, m) in that unit."""
    return math.degrees(value) if arm.joints[index].revolute else 1e3 * value


def joint_columns(arm: Arm, q: Array, prefix: str = "q") -> dict[str, Array]:
    """Joint coordinates (N, n), or changes of them, as columns in degrees and mm: `q1_deg`, `q2_mm`."""
    import numpy as np

    return {
        f"{prefix}{number}_{'deg' if joint.revolute else 'mm'}": np.degrees(values) if joint.revolute else 1e3 * values
        for number, (joint, values) in enumerate(zip(arm.joints, q.T, strict=True), start=1)
    }


_PARAMETER_UNITS = MappingProxyType(
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
    return _PARAMETER_UNITS.get(kind, kind_of(kind).si)


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
