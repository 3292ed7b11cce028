"""The columns that a recording may have, and the units that their headers carry as suffixes: `q1_deg`, `tau2_Nm`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.registry import INSTRUMENTS
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, kind_of, read_quantity

_JOINT = re.compile(r"(dir|tau|temperature_link|current|voltage|dq|[qcjva])([0-9]{1,3})(?:_(.+))?")
_WHOLE = (
    r"(time|t(?=_(?:s|ms|us|ns)$)|payload|temperature|x|y|z|bar|basex|basey|basez|fx|fy|fz|rx|ry|rz|"
    r"qw|qx|qy|qz%s)(?:_(.+))?"
)
_TURNS = MappingProxyType(
    {
        "q": "angle",
        "c": "angle",
        "j": "angle",
        "v": "angular_speed",
        "a": "angular_acceleration",
        "tau": "torque",
        "current": "current",
        "voltage": "voltage",
    }
)
_SLIDES = MappingProxyType(
    {
        "q": "length",
        "c": "length",
        "j": "length",
        "v": "speed",
        "a": "acceleration",
        "tau": "force",
        "current": "current",
        "voltage": "voltage",
    }
)
_KINDS = MappingProxyType(
    {
        "time": "time",
        "payload": "mass",
        "temperature": "temperature",
        **dict.fromkeys(("x", "y", "z", "bar", "basex", "basey", "basez"), "length"),
        **dict.fromkeys(("fx", "fy", "fz"), "force"),
        **dict.fromkeys(("rx", "ry", "rz"), "angle"),
    }
)
_SUFFIXES = MappingProxyType(
    {
        "time": ("s", "min", "h", "ms", "us", "ns"),
        "mass": ("kg", "g"),
        "temperature": ("degC", "K"),
        "length": ("mm", "m", "um"),
        "force": ("N",),
        "angle": ("deg", "rad"),
        "angular_speed": ("deg_s", "rad_s"),
        "speed": ("mm_s", "m_s"),
        "angular_acceleration": ("deg_s2", "rad_s2"),
        "acceleration": ("mm_s2", "m_s2"),
        "torque": ("Nm",),
        "current": ("A",),
        "voltage": ("V",),
    }
)
_ALSO = MappingProxyType({"dq": "v", "t": "time"})
"""Other names of columns."""
_PER_SECOND = MappingProxyType({"radps": "rad_s", "degps": "deg_s", "mps": "m_s", "mmps": "mm_s"})
"""Other spellings of suffixes."""
_IN_BRACKETS = re.compile(r"(.+?)[ _]*[\[(]\s*(.+?)\s*[\])]")
_APART = re.compile(r"((?:temperature[ _]link|[a-z]+)[ _]?[0-9]*)[ _]+(.+)", re.IGNORECASE)
_NUMBERED = re.compile(r"([a-z_]+?)[ _]?([0-9]+)")
DEGREES = (
    *("degree", "degrees", "grad", "grados", "grado", "gradi", "degrés", "degré", "degres", "graus", "grau"),
    *("stopnie", "stopni", "graden", "stupně", "stupňů", "stupne", "grader"),
)
"""What an angle's unit is called in several languages, in small letters."""
_UNITS = MappingProxyType(
    {
        **{suffix.lower(): suffix for suffixes in _SUFFIXES.values() for suffix in suffixes},
        **dict.fromkeys(("°", "º", *DEGREES), "deg"),
        **dict.fromkeys(("radian", "radians", "radianes", "radianti", "radianos", "radiany", "radianer"), "rad"),
        **dict.fromkeys(("°c", "ºc", "deg c", "celsius"), "degC"),
        **dict.fromkeys(("µm", "μm", "micron", "microns"), "um"),
        **dict.fromkeys(("sec", "seg", "sek", "second", "seconds"), "s"),
        **dict.fromkeys(("n*m", "n·m", "n m", "n.m"), "Nm"),
    }
)
"""How people write the units of headers, in small letters."""


def _observed() -> dict[str, tuple[str, str]]:
    """The columns of what only some recordings observe, each with the kind of instrument and what it holds."""
    return {
        number.column: (kind.name, number.quantity)
        for kind in INSTRUMENTS.values()
        for number in kind.numbers
        if number.column and number.column not in _KINDS
    } | {"bar": ("bar", "length")}


def _whole(header: str) -> re.Match[str] | None:
    """A header of the whole arm's, in its name and its unit."""
    return re.fullmatch(_WHOLE % "".join(f"|{re.escape(name)}" for name in _observed() if name not in _KINDS), header)


def _kind_of(base: str) -> str:
    """What a column of the whole arm's holds."""
    return _KINDS[base] if base in _KINDS else _observed()[base][1]


@dataclass(frozen=True)
class ColumnMeaning:
    """What a column holds: `base` (q, dir, x, ..), the joint or link that it is of (from 0; None: the whole arm), and
    the way to SI: factor * number + offset."""

    base: str
    index: int | None
    factor: float
    offset: float = 0.0

    @property
    def name(self) -> str:
        """The column's name without its unit."""
        return self.base if self.index is None else f"{self.base}{self.index + 1}"


class UnitMissing(InputError):
    """A known name without a unit that would do. In a foreign file it may be somebody's column; anywhere, where
    words follow it and not just a unit (`stranger`: x_mean_of_ten)."""

    def __init__(
        self, file: object, key: str, message: str, *remedies: Mapping[str, Any], stranger: bool = False
    ) -> None:
        super().__init__(file, key, message, *remedies)
        self.stranger = stranger


def meaning_of(header: str, arm: Arm, *, file: object) -> ColumnMeaning | None:
    """What a header says, None where it is not one of ours.

    Raises `InputError` for a joint that the arm does not have, `UnitMissing` for a known name with no or a wrong unit.
    """
    parsed = _JOINT.fullmatch(numbered_through(header, arm))
    if parsed is not None:
        base, number, suffix = _ALSO.get(parsed[1], parsed[1]), int(parsed[2]), parsed[3]
        if not 1 <= number <= arm.size:
            of = "link" if base == "temperature_link" else "joint"
            count_text = f"{arm.size} {of}{'s' if arm.size > 1 else ''}"
            hint = f"write `ignore: [{header}]` in recording.yaml if it is none of the arm's"
            message = f"is of {of} {number}, but {arm.name!r} has {count_text}; {hint}"
            raise UnitMissing(file, header, message, {"ignore": [header]})
        if base == "temperature_link":
            return _with_unit(header, base, number - 1, "temperature", suffix, file)
        if base == "dir":
            return _bare(header, base, number - 1, suffix, file)
        kinds = _TURNS if arm.joints[number - 1].revolute else _SLIDES
        return _with_unit(header, base, number - 1, kinds[base], suffix, file)
    parsed = _whole(header)
    if parsed is None:
        return None
    base, suffix = _ALSO.get(parsed[1], parsed[1]), parsed[2]
    if base in ("qw", "qx", "qy", "qz"):
        return _bare(header, base, None, suffix, file)
    return _with_unit(header, base, None, _kind_of(base), suffix, file)


def numbered_through(header: str, arm: Arm) -> str:
    """A header of a branch's joint (`left_q1_deg`) with its number in the whole arm (`q3_deg`); others as they are."""
    for branch in arm.branches:
        parsed = _JOINT.fullmatch(header.removeprefix(f"{branch.name}_"))
        if parsed is not None and header.startswith(f"{branch.name}_"):
            number = int(parsed[2])
            whole = branch.first + number if 1 <= number <= branch.end - branch.first else 1000 + number
            return f"{parsed[1]}{whole}" + ("" if parsed[3] is None else f"_{parsed[3]}")
    return header


def of_kind(header: str) -> str | None:
    """The kind of observation that a header is of, where only some recordings observe that (`along`, `distance`,
    `tilt`, `bar`, of currents and voltages `motion`); else None."""
    parsed = _JOINT.fullmatch(header)
    if parsed is not None and parsed[1] in ("current", "voltage"):
        return "motion"
    parsed = _whole(header)
    observed = None if parsed is None else _observed().get(parsed[1])
    return None if observed is None else observed[0]


def canonical(header: str) -> str:
    """The name that a column of ours goes by, of one that has several: `time_s` for `t_s`, `v1_rad_s` for
    `dq1_radps`."""
    parsed = _JOINT.fullmatch(header)
    if parsed is not None:
        name, suffix = f"{_ALSO.get(parsed[1], parsed[1])}{parsed[2]}", parsed[3]
    else:
        parsed = _whole(header)
        if parsed is None:
            return header
        name, suffix = _ALSO.get(parsed[1], parsed[1]), parsed[2]
    return name if suffix is None else f"{name}_{_PER_SECOND.get(suffix, suffix)}"


def otherwise_spelled(header: str) -> str | None:
    """Our header for one that differs from it in nothing but how it is written (`Q1_DEG`, `q1 (deg)`, `x [mm]`, `Time
    (s)`); None for any other, and for one of ours as it stands."""
    parsed = _IN_BRACKETS.fullmatch(header) or _APART.fullmatch(header)
    name, unit = (header, None) if parsed is None else (parsed[1], parsed[2].strip())
    name = _NUMBERED.sub(r"\1\2", name.strip().lower().replace("temperature link", "temperature_link"))
    if unit is not None:
        parts = re.sub(r"[\^²]2?$", "2", unit.lower()).split("/")
        known = [_UNITS.get(part.strip(), part.strip()) for part in parts]
        unit = _UNITS.get(unit.lower(), "_".join(known))
    ours = name if unit is None else f"{name}_{unit}"
    return ours if ours != header and looks_like_ours(ours) else None


def looks_like_ours(header: str) -> bool:
    """Whether a header is one of ours, unit and all (of whatever arm)."""
    parsed = _JOINT.fullmatch(header) or _whole(header)
    if parsed is None:
        return False
    return parsed[parsed.re.groups] is not None or parsed[1] in ("dir", "qw", "qx", "qy", "qz")


def units_for(base: str, arm: Arm, index: int | None = None) -> tuple[str, ...]:
    """The units that a column's header can carry, such as `deg`, `rad`, by what it holds and of which joint."""
    if index is None:
        return _SUFFIXES[_kind_of(base)]
    return _SUFFIXES[(_TURNS if arm.joints[index].revolute else _SLIDES)[base]]


def example_headers(base: str, arm: Arm, index: int | None = None) -> str:
    """The headers that would do for a column, such as `q2_deg or q2_rad`."""
    name = base if index is None else arm.column(base, index)
    return " or ".join(f"{name}_{suffix}" for suffix in units_for(base, arm, index)[:2])


def unit_in_header(suffix: str) -> str:
    """A header's suffix as a unit: deg_s is deg/s, deg_s2 deg/s^2."""
    parts = _PER_SECOND.get(suffix, suffix).split("_")
    return parts[0] + "".join("/" + re.sub(r"([A-Za-z])([2-9])$", r"\1^\2", part) for part in parts[1:])


_SHORT = 8
"""Digits and more in which a factor is better written as a division."""


def formulas(headers: Sequence[str], arm: Arm, matrix: Array, offset: Array | None = None) -> dict[str, str]:
    """Formulas that make of columns what they were meant to be, those that stay as they are left out.

    Args:
        headers: The headers (n) of joints, torques or the tip's coordinates; no formula holds one that has no unit.
        arm: The arm.
        matrix: What is meant is `matrix` (n, n) @ what stands there, SI,
        offset: and this (n) added.
    """
    sizes = np.array([_size(header, arm) for header in headers])
    results: dict[str, str] = {}
    for k, here in enumerate(headers):
        order = sorted(np.flatnonzero(matrix[k]).tolist(), key=lambda index: index != k)
        terms = [(float(matrix[k, n] * sizes[n] / sizes[k]), headers[n]) for n in order]
        if offset is not None and offset[k]:
            terms.append((float(offset[k] / sizes[k]), ""))
        parts = [("- " if factor < 0.0 else "+ ") + _term(abs(factor), of) for factor, of in terms]
        formula = " ".join(parts).removeprefix("+ ")
        if formula != here and np.isfinite([factor for factor, _ in terms]).all():
            results[here] = f"-{formula[2:]}" if formula.startswith("- ") else formula
    return results


def _term(factor: float, of: str) -> str:
    """`2.5*q1_deg`, `q1_deg`, `q1_deg/57.2957795` where that is shorter, or a number alone."""
    number = f"{factor:.9g}"
    if not of:
        return number
    if factor == 1.0:
        return of
    inverse = f"{1.0 / factor:.9g}" if factor else number
    return f"{of}/{inverse}" if factor < 1.0 and len(number) > _SHORT and "e" not in inverse else f"{number}*{of}"


def _size(header: str, arm: Arm) -> float:
    """One of a column's unit, SI; nan where the header names none."""
    try:
        meaning = meaning_of(header, arm, file="")
    except UnitMissing:
        return math.nan
    return math.nan if meaning is None else meaning.factor


def _bare(header: str, base: str, index: int | None, suffix: str | None, file: object) -> ColumnMeaning:
    if suffix is not None:
        bare = header[: -len(suffix) - 1]
        raise UnitMissing(file, header, f"takes no unit; write {bare}", {"columns": {bare: header}})
    return ColumnMeaning(base, index, 1.0)


def _with_unit(header: str, base: str, index: int | None, kind: str, suffix: str | None, file: object) -> ColumnMeaning:
    name = header if suffix is None else header[: -len(suffix) - 1]
    due = [f"{name}_{item}" for item in _SUFFIXES[kind]]
    would_do, remedies = " or ".join(due), [{"columns": {item: header}} for item in due]
    if suffix is None:
        raise UnitMissing(file, header, f"has no unit; write {would_do} in the header", *remedies)
    try:
        one = read_quantity(f"1 {unit_in_header(suffix)}", kind, file=file, key=header)
        nothing = 0.0
        if kind == "temperature":
            nothing = read_quantity(f"0 {unit_in_header(suffix)}", kind, file=file, key=header)
    except InputError:
        article = "an" if kind_of(kind).name[0] in "aeiou" else "a"
        message = f"'{suffix}' is no unit of {article} {kind.replace('_', ' ')}; write {would_do} in the header"
        words = 3 if kind in ("angular_speed", "speed", "angular_acceleration", "acceleration") else 2
        raise UnitMissing(file, header, message, *remedies, stranger=len(suffix.split("_")) >= words) from None
    return ColumnMeaning(base, index, one - nothing, nothing)
