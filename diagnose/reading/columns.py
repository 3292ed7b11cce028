"""The columns that a recording may have, and the units that their headers carry as suffixes: `q1_deg`, `tau2_Nm`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import InputError, kind_of, read_quantity

_JOINT = re.compile(r"(dir|tau|temperature_link|[qcjva])([0-9]{1,3})(?:_(.+))?")
_WHOLE = re.compile(
    r"(time|payload|temperature|x|y|z|along|distance|bar|tilt_x|tilt_y|basex|basey|basez|fx|fy|fz|rx|ry|rz|qw|qx|qy|qz)(?:_(.+))?"
)
_TURNS = MappingProxyType(
    {"q": "angle", "c": "angle", "j": "angle", "v": "angular_speed", "a": "angular_acceleration", "tau": "torque"}
)
_SLIDES = MappingProxyType(
    {"q": "length", "c": "length", "j": "length", "v": "speed", "a": "acceleration", "tau": "force"}
)
_KINDS = MappingProxyType(
    {
        "time": "time",
        "payload": "mass",
        "temperature": "temperature",
        **dict.fromkeys(("x", "y", "z", "along", "distance", "bar", "basex", "basey", "basez"), "length"),
        **dict.fromkeys(("fx", "fy", "fz"), "force"),
        **dict.fromkeys(("rx", "ry", "rz", "tilt_x", "tilt_y"), "angle"),
    }
)
_SUFFIXES = MappingProxyType(
    {
        "time": ("s", "min", "h"),
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
    }
)
_OBSERVED = MappingProxyType(
    {"along": "along", "distance": "distance", "bar": "bar", "tilt_x": "tilt", "tilt_y": "tilt"}
)
_IN_BRACKETS = re.compile(r"(.+?)[ _]*[\[(]\s*(.+?)\s*[\])]")
_APART = re.compile(r"((?:temperature[ _]link|[a-z]+)[ _]?[0-9]*)[ _]+(.+)", re.IGNORECASE)
_NUMBERED = re.compile(r"([a-z_]+?)[ _]?([0-9]+)")
_UNITS = MappingProxyType(
    {
        **{suffix.lower(): suffix for suffixes in _SUFFIXES.values() for suffix in suffixes},
        **dict.fromkeys(("°", "º", "degree", "degrees"), "deg"),
        **dict.fromkeys(("radian", "radians"), "rad"),
        **dict.fromkeys(("°c", "ºc", "deg c", "celsius"), "degC"),
        **dict.fromkeys(("µm", "μm", "micron", "microns"), "um"),
        **dict.fromkeys(("sec", "second", "seconds"), "s"),
        **dict.fromkeys(("n*m", "n·m", "n m"), "Nm"),
    }
)
"""How people write the units of headers, in small letters."""


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
    """A known name without a unit that would do. In a foreign file it may be somebody's own column; anywhere, where
    words follow it and not just a unit (`stranger`: x_mean_of_ten)."""

    def __init__(self, file: object, key: str, message: str, *, stranger: bool = False) -> None:
        super().__init__(file, key, message)
        self.stranger = stranger


def meaning_of(header: str, arm: Arm, *, file: object) -> ColumnMeaning | None:
    """What a header says, None where it is not one of ours.

    Raises `InputError` for a joint that the arm does not have, `UnitMissing` for a known name with no or a wrong unit.
    """
    found = _JOINT.fullmatch(numbered_through(header, arm))
    if found is not None:
        base, number, suffix = found[1], int(found[2]), found[3]
        if not 1 <= number <= arm.size:
            of = "link" if base == "temperature_link" else "joint"
            many = f"{arm.size} {of}{'s' if arm.size > 1 else ''}"
            hint = f"write `ignore: [{header}]` in recording.yaml if it is none of the arm's"
            raise UnitMissing(file, header, f"is of {of} {number}, but {arm.name!r} has {many}; {hint}")
        if base == "temperature_link":
            return _with_unit(header, base, number - 1, "temperature", suffix, file)
        if base == "dir":
            return _bare(header, base, number - 1, suffix, file)
        kinds = _TURNS if arm.joints[number - 1].revolute else _SLIDES
        return _with_unit(header, base, number - 1, kinds[base], suffix, file)
    found = _WHOLE.fullmatch(header)
    if found is None:
        return None
    base, suffix = found[1], found[2]
    if base in ("qw", "qx", "qy", "qz"):
        return _bare(header, base, None, suffix, file)
    return _with_unit(header, base, None, _KINDS[base], suffix, file)


def numbered_through(header: str, arm: Arm) -> str:
    """A header of a branch's joint (`left_q1_deg`) with its number in the whole arm (`q3_deg`); others as they are."""
    for branch in arm.branches:
        found = _JOINT.fullmatch(header.removeprefix(f"{branch.name}_"))
        if found is not None and header.startswith(f"{branch.name}_"):
            number = int(found[2])
            whole = branch.first + number if 1 <= number <= branch.end - branch.first else 1000 + number
            return f"{found[1]}{whole}" + ("" if found[3] is None else f"_{found[3]}")
    return header


def of_kind(header: str) -> str | None:
    """The kind of observation that a header is of, where only some recordings observe that (`along`, `distance`,
    `tilt`, `bar`); else None."""
    found = _WHOLE.fullmatch(header)
    return None if found is None else _OBSERVED.get(found[1])


def otherwise_spelled(header: str) -> str | None:
    """Our header for one that differs from it in nothing but how it is written (`Q1_DEG`, `q1 (deg)`, `x [mm]`, `Time
    (s)`); None for any other, and for one of ours as it stands."""
    found = _IN_BRACKETS.fullmatch(header) or _APART.fullmatch(header)
    name, unit = (header, None) if found is None else (found[1], found[2].strip())
    name = _NUMBERED.sub(r"\1\2", name.strip().lower().replace("temperature link", "temperature_link"))
    if unit is not None:
        parts = re.sub(r"[\^²]2?$", "2", unit.lower()).split("/")
        known = [_UNITS.get(part.strip(), part.strip()) for part in parts]
        unit = _UNITS.get(unit.lower(), "_".join(known))
    ours = name if unit is None else f"{name}_{unit}"
    return ours if ours != header and looks_like_ours(ours) else None


def looks_like_ours(header: str) -> bool:
    """Whether a header is one of ours, unit and all (of whatever arm)."""
    found = _JOINT.fullmatch(header) or _WHOLE.fullmatch(header)
    if found is None:
        return False
    return found[found.re.groups] is not None or found[1] in ("dir", "qw", "qx", "qy", "qz")


def units_for(base: str, arm: Arm, index: int | None = None) -> tuple[str, ...]:
    """The units that a column's header can carry, such as `deg`, `rad`, by what it holds and of which joint."""
    if index is None:
        return _SUFFIXES[_KINDS[base]]
    return _SUFFIXES[(_TURNS if arm.joints[index].revolute else _SLIDES)[base]]


def example_headers(base: str, arm: Arm, index: int | None = None) -> str:
    """The headers that would do for a column, such as `q2_deg or q2_rad`."""
    name = base if index is None else arm.column(base, index)
    return " or ".join(f"{name}_{suffix}" for suffix in units_for(base, arm, index)[:2])


def unit_in_header(suffix: str) -> str:
    """A header's suffix as a unit: deg_s is deg/s, deg_s2 deg/s^2."""
    parts = suffix.split("_")
    return parts[0] + "".join("/" + re.sub(r"([A-Za-z])([2-9])$", r"\1^\2", part) for part in parts[1:])


def _bare(header: str, base: str, index: int | None, suffix: str | None, file: object) -> ColumnMeaning:
    if suffix is not None:
        raise UnitMissing(file, header, f"takes no unit; write {header[: -len(suffix) - 1]}")
    return ColumnMeaning(base, index, 1.0)


def _with_unit(header: str, base: str, index: int | None, kind: str, suffix: str | None, file: object) -> ColumnMeaning:
    name = header if suffix is None else header[: -len(suffix) - 1]
    would_do = " or ".join(f"{name}_{each}" for each in _SUFFIXES[kind])
    if suffix is None:
        raise UnitMissing(file, header, f"has no unit; write {would_do} in the header")
    try:
        one = read_quantity(f"1 {unit_in_header(suffix)}", kind, file=file, key=header)
        nothing = 0.0
        if kind == "temperature":
            nothing = read_quantity(f"0 {unit_in_header(suffix)}", kind, file=file, key=header)
    except InputError:
        article = "an" if kind_of(kind).name[0] in "aeiou" else "a"
        message = f"'{suffix}' is no unit of {article} {kind.replace('_', ' ')}; write {would_do} in the header"
        words = 3 if kind in ("angular_speed", "speed", "angular_acceleration", "acceleration") else 2
        raise UnitMissing(file, header, message, stranger=len(suffix.split("_")) >= words) from None
    return ColumnMeaning(base, index, one - nothing, nothing)
