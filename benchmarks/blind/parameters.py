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
        "m/s": ("m/s", 1.0),
        "m/h": ("m/s", 1.0 / 3600.0),
        "rad/s": ("rad/s", 1.0),
        "rad/h": ("rad/s", 1.0 / 3600.0),
        "deg/s": ("rad/s", math.pi / 180),
        "mm/s": ("m/s", 1e-3),
        "N": ("N", 1.0),
        "kN": ("N", 1e3),
        "N/m": ("N/m", 1.0),
        "N/mm": ("N/m", 1e3),
        "N*m/rad": ("N*m/rad", 1.0),
        "kN*m/rad": ("N*m/rad", 1e3),
        "N*s/m": ("N*s/m", 1.0),
        "N*m*s/rad": ("N*m*s/rad", 1.0),
        "N*s^2/m^2": ("N*s^2/m^2", 1.0),
        "N*m*s^2/rad^2": ("N*m*s^2/rad^2", 1.0),
        "kg*m": ("kg*m", 1.0),
        "kg*m^2": ("kg*m^2", 1.0),
    }
)
Translation = Mapping[str, tuple[str, str, float]]
_ANGLES: Translation = MappingProxyType({"sine": ("sine", "rad", 1.0), "cosine": ("cosine", "rad", 1.0)})
TRANSLATED: Mapping[str, Translation] = MappingProxyType(
    {
        "encoder_eccentricity": _ANGLES,
        "gear_transmission_error": _ANGLES,
        "friction_windup": MappingProxyType(
            {"coulomb": ("windup", "rad", 1.0), "proportional": ("windup_per_load", "rad/(N*m)", 1.0)}
        ),
        "gearbox_thermal": MappingProxyType({"rate": ("per_kelvin", "rad/K", 1.0), "lag": ("lag", "s", 1.0)}),
        "thermal_expansion": MappingProxyType({"lag": ("lag", "s", 1.0)}),
        "thermal_bending": MappingProxyType({"lag": ("lag", "s", 1.0)}),
        "tool_offset": MappingProxyType({"a": ("along", "m", 1.0), "b": ("across", "m", 1.0)}),
        "link_modulus": MappingProxyType({"ratio": ("excess", "1", 1.0)}),
        # a base turned one way sees gravity turned the other
        "base_tilt": MappingProxyType({axis: (f"about_{axis}", "rad", -1.0) for axis in "xyz"}),
        "frame_misalignment": MappingProxyType(
            {axis: (axis, "m", 1.0) for axis in "xyz"} | {"rotation": ("about_z", "rad", 1.0)}
        ),
        "frame_drift": MappingProxyType(
            {axis: (axis, "m/h", 1.0) for axis in "xyz"} | {"rotation": ("about_z", "rad/h", 1.0)}
        ),
    }
)
"""What a true parameter is called where the words differ or the truth has no unit: name, unit of the truth, factor."""
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


def _other_words(entry: Mapping[str, Any], true: Mapping[str, Any]) -> bool:
    """Whether the two speak of different things: three zones have neither the knee nor the compliance of a smooth
    curve, and a tool's axes are those of the last link or of the last joint, which are one in the plane only."""
    if true.get("effect") == "joint_hardening":
        return any(name.startswith("zones") and item["value"] > 0.5 for name, item in true["parameters"].items())
    return true.get("effect") == "tool_offset" and "out" in (entry.get("parameters") or {})


def coverage(entry: Mapping[str, Any], true: Mapping[str, Any]) -> list[tuple[str, bool]]:
    """For each stated parameter with an interval and a true value of its name and dimension: whether it is inside."""
    if _other_words(entry, true):
        return []
    words = TRANSLATED.get(true.get("effect", ""), MappingProxyType({}))
    results = []
    for name, stated in (entry.get("parameters") or {}).items():
        interval = stated.get("ci95") if isinstance(stated, Mapping) else None
        if not interval or any(end is None for end in interval):
            continue
        for true_name, value in true["parameters"].items():
            base, place = _base(true_name)
            called, own_unit, factor = words.get(base, (base, value["unit"], 1.0))
            unit, own = UNITS.get(stated.get("unit") or ""), UNITS.get(own_unit)
            if not _same(name, f"{called}_{place}" if place else called):
                continue
            if unit is None or own is None or unit[0] != own[0]:
                continue
            amount = factor * value["value"] * own[1] / unit[1]
            results.append((_base(true_name)[0], bool(interval[0] <= amount <= interval[1])))
            break
    return results
