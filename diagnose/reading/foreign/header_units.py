"""Units in headers as people write them, and what a column is whose unit no other has."""

from __future__ import annotations

import re
from collections.abc import Sequence
from types import MappingProxyType

from linkwright.core.diagnose.reading.columns import DEGREES, canonical, otherwise_spelled

_IN_BRACKETS = re.compile(r"^(.*?)[\s_]*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_AT_END = re.compile(
    r"^(.*?)[\s_]+(?:in[\s_]+)?"
    rf"(deg|{'|'.join(DEGREES)}|rad|radians?|mm|m|um|kg|g|s|sec|min|h|ms|degc|k|n|nm|a|rad/s|deg/s|°|°c)$",
    re.IGNORECASE,
)
_BY_UNIT = MappingProxyType({"payload": ("kg",), "temperature": ("degC",)})
"""What a recording of an arm has in a unit, if it has one column in it."""


def name_and_unit(header: str) -> tuple[str, str]:
    """A header without its unit, and the unit, empty where there is none; a number in brackets counts something."""
    parsed = _IN_BRACKETS.match(header) or _AT_END.match(header)
    return (header, "") if parsed is None or parsed[2].isdecimal() else (parsed[1], parsed[2])


def unit_of(what: str, unit: str) -> str:
    """Our suffix for a unit as people write it."""
    spelled = otherwise_spelled(f"{what} [{unit}]") if unit else None
    return canonical(spelled or f"{what}_{unit}").partition("_")[2]


def alone_in_unit(headers: Sequence[str]) -> dict[str, tuple[str, str]]:
    """What the only column in kg, or in degrees Celsius, is in whatever language (`payload`), with header and unit."""
    alone: dict[str, tuple[str, str]] = {}
    for what, units in _BY_UNIT.items():
        matching = [(header, unit) for header in headers if (unit := unit_of(what, name_and_unit(header)[1])) in units]
        if len(matching) == 1:
            alone[what] = matching[0]
    return alone
