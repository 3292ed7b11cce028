"""Fields of a result as entries of JSON: which, in which order and in which unit is said by their keys."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.units.temperature import ZERO_CELSIUS

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
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
