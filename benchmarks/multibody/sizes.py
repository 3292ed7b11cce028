"""Sizes that cannot be: a stated parameter against what the arm file and nature allow."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from benchmarks.blind.parameters import UNITS

NEVER_NEGATIVE = frozenset(
    {
        ("backlash", "total"),
        ("friction_windup", "windup"),
        ("friction_windup", "windup_per_load"),
        ("clearance", "radius"),
        ("base_compliance", "compliance"),
        ("base_compliance", "compliance_about_z"),
        ("creep", "compliance"),
        ("servo_droop", "compliance"),
        ("joint_hardening", "compliance"),
    }
)
GREATEST: Mapping[tuple[str, str], float] = MappingProxyType(
    {
        ("backlash", "total"): 0.02,
        ("friction_windup", "windup"): 0.01,
        ("clearance", "radius"): 2e-3,
        ("encoder_offset", "offset"): 0.1,
        ("encoder_scale", "scale"): 0.05,
        ("encoder_eccentricity", "sine"): 0.02,
        ("encoder_eccentricity", "cosine"): 0.02,
        ("gear_transmission_error", "sine"): 0.01,
        ("gear_transmission_error", "cosine"): 0.01,
        ("joint_coupling", "coupling"): 0.2,
        ("link_length", "length"): 0.05,
        ("instrument_scale", "scale"): 0.01,
        ("base_tilt", "about_x"): 0.15,
        ("base_tilt", "about_y"): 0.15,
        ("base_tilt", "about_z"): 0.15,
        ("thermal_expansion", "expansion"): 2e-4,
        ("gearbox_thermal", "per_kelvin"): 1e-3,
    }
)
"""Beyond these, in SI, no machine of the proof's size can be: twenty and more times what any case holds."""


CABLES = 5.0  # kg


def impossible(entry: Mapping[str, Any], file: Mapping[str, Any]) -> list[str]:
    """The parameters of a finding whose stated value no machine can have, as sentences."""
    results = []
    effect, places = str(entry["effect"]), [int(i) for i in entry.get("at") or []]
    for name, stated in (entry.get("parameters") or {}).items():
        unit = UNITS.get(stated.get("unit") or "")
        if stated.get("value") is None or unit is None:
            continue
        base = str(stated.get("parameter") or name.rstrip("0123456789").rstrip("_"))
        where = stated.get("at") or places
        value = float(stated["value"]) * unit[1]
        for place in where if isinstance(where, list) else [where]:
            reason = _why(effect, base, int(place), value, file)
            if reason:
                results.append(f"{effect} at {places}: {name} = {stated['value']} {stated.get('unit')}: {reason}")
        if not where and (reason := _why(effect, base, 0, value, file)):
            results.append(f"{effect}: {name} = {stated['value']} {stated.get('unit')}: {reason}")
    return results


def _why(effect: str, base: str, place: int, value: float, file: Mapping[str, Any]) -> str:
    if (effect, base) in NEVER_NEGATIVE and value < 0.0:
        return "cannot be negative"
    most = GREATEST.get((effect, base))
    if most is not None and abs(value) > most:
        return f"beyond {most:g}"
    if effect == "link_modulus" and base == "excess" and not -0.9 < value < 5.0:
        return "no material"
    if effect == "joint_compliance" and base == "compliance" and place:
        declared = float(file["drive_compliance"][place - 1])
        if declared + value < 0.0:
            return "the drive would give against its load"
    if base == "mass" and (effect == "payload" or (effect == "link_mass" and place)):
        there = float(file["link_mass_kg"][place - 1 if effect == "link_mass" else -1])
        there += float(file["payload_kg"]) if effect == "payload" else 0.0
        if there + value <= 0.0:
            return f"what weighs {there:.3g} kg would weigh nothing or less"
        if value > 2.0 * there + CABLES:
            return f"what weighs {there:.3g} kg would weigh three times that and {CABLES:g} kg more"
    return ""
