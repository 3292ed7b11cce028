"""Whether a stated interval holds the true value: names and units matched with tolerance, never guessed."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

UNITS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "": ("1", 1.0),
        "1": ("1", 1.0),
        "dimensionless": ("1", 1.0),
        "ppm": ("1", 1e-6),
        "%": ("1", 1e-2),
        "rad/rad": ("1", 1.0),
        "m/m": ("1", 1.0),
        "rad": ("rad", 1.0),
        "mrad": ("rad", 1e-3),
        "urad": ("rad", 1e-6),
        "deg": ("rad", math.pi / 180),
        "arcmin": ("rad", math.pi / 10800),
        "arcsec": ("rad", math.pi / 648000),
        "m": ("m", 1.0),
        "mm": ("m", 1e-3),
        "um": ("m", 1e-6),
        "kg": ("kg", 1.0),
        "g": ("kg", 1e-3),
        "s": ("s", 1.0),
        "ms": ("s", 1e-3),
        "min": ("s", 60.0),
        "h": ("s", 3600.0),
        "rad/(N*m)": ("rad/(N*m)", 1.0),
        "urad/(N*m)": ("rad/(N*m)", 1e-6),
        "mrad/(N*m)": ("rad/(N*m)", 1e-3),
        "1/(N*m)": ("rad/(N*m)", 1.0),
        "1/K": ("1/K", 1.0),
        "m/(m*K)": ("1/K", 1.0),
        "um/(m*K)": ("1/K", 1e-6),
        "1/degC": ("1/K", 1.0),
        "rad/K": ("rad/K", 1.0),
        "mrad/K": ("rad/K", 1e-3),
        "urad/K": ("rad/K", 1e-6),
        "N*m": ("N*m", 1.0),
        "kN*m": ("N*m", 1e3),
        "1/(N*m^2)": ("1/(N*m^2)", 1.0),
    }
)
SYNONYMS: tuple[frozenset[str], ...] = (
    frozenset({"total", "backlash"}),
    frozenset({"offset", "delta"}),
    frozenset({"expansion", "alpha", "thermal_expansion"}),
    frozenset({"length", "delta_length", "dl", "difference"}),
    frozenset({"mass", "extra_mass"}),
    frozenset({"radius", "clearance", "radial"}),
    frozenset({"delay", "latency", "dt"}),
    frozenset({"ratio", "coupling", "change"}),
    frozenset({"scale", "error"}),
    frozenset({"lag", "time_constant"}),
    frozenset({"harmonic", "k", "order"}),
    frozenset({"spring", "strength"}),
    frozenset({"rate", "thermal_rate", "turn"}),
)


def _base(name: str) -> tuple[str, str]:
    match = re.fullmatch(r"(.*?)_?(\d+)?", name)
    return (match[1].lower(), match[2] or "") if match else (name.lower(), "")


def _same(stated: str, true: str) -> bool:
    one, place = _base(stated)
    two, true_place = _base(true)
    if place and true_place and place != true_place:
        return False
    return one == two or any(one in group and two in group for group in SYNONYMS)


def coverage(entry: Mapping[str, Any], true: Mapping[str, Any]) -> list[tuple[str, bool]]:
    """For each stated parameter with an interval and a true value of its name and dimension: whether it is inside."""
    found = []
    for name, stated in (entry.get("parameters") or {}).items():
        interval = stated.get("ci95") if isinstance(stated, Mapping) else None
        if not interval or any(end is None for end in interval):
            continue
        for true_name, value in true["parameters"].items():
            unit, own = UNITS.get(stated.get("unit") or ""), UNITS.get(value["unit"])
            if not _same(name, true_name) or unit is None or own is None or unit[0] != own[0]:
                continue
            amount = value["value"] * own[1] / unit[1]
            found.append((_base(true_name)[0], bool(interval[0] <= amount <= interval[1])))
            break
    return found
