"""Fixed transforms of an arm file: where a joint stands on the link before it, and what nobody knows of that."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

from linkwright.core.arm.chain.chain import FloatVector, Joint, OriginPart
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO, Rotation, from_roll_pitch_yaw, to_roll_pitch_yaw
from linkwright.core.units.quantities import format_quantity, kind_of, read_quantity
from linkwright.core.units.reading import Mapping

SHIFTS: tuple[OriginPart, ...] = ("x", "y", "z")
TURNS: tuple[OriginPart, ...] = ("roll", "pitch", "yaw")
_KEYS = MappingProxyType({"xyz": (SHIFTS, "length"), "rpy": (TURNS, "angle")})
FREE = "free"
UNKNOWN_ORIGIN = (
    "is free: nobody knows where that joint stands. Run `linkwright diagnose ARM RECORDING --out FOLDER` first and go "
    "on with the arm.yaml that it writes"
)
"""What whoever has to know an arm's transforms says of one that is free."""


def read_origin(mapping: Mapping) -> tuple[tuple[Rotation, FloatVector], tuple[OriginPart, ...]]:
    """The transform under `origin`, zero wherever it is free, and which of its numbers are.

    `origin: free` frees all six; `xyz: free` and `rpy: free` three; a component of a list may be free too."""
    if mapping.content.get("origin") == FREE:
        mapping.has("origin")
        return (IDENTITY, ZERO), (*SHIFTS, *TURNS)
    with mapping.mapping("origin").reading() as frame:
        (xyz, shifts), (rpy, turns) = (_part(frame, name, *_KEYS[name]) for name in _KEYS)
    return (from_roll_pitch_yaw(*rpy), xyz), (*shifts, *turns)


def _part(
    frame: Mapping, name: str, parts: tuple[OriginPart, ...], kind: str
) -> tuple[FloatVector, tuple[OriginPart, ...]]:
    if frame.content.get(name) == FREE:
        frame.has(name)
        return ZERO, parts
    if not frame.has(name):
        return ZERO, ()
    values = frame.items(name)
    if len(values) not in (2, 3):
        raise frame.error(name, f"needs two components (x, y) or three, not {len(values)}")
    path = frame.path_of(name)
    numbers = [
        0.0 if value == FREE else read_quantity(value, kind, file=frame.file, key=f"{path}[{number}]")
        for number, value in enumerate(values, start=1)
    ]
    free: list[OriginPart] = [part for part, value in zip(parts, values, strict=False) if value == FREE]
    return (numbers[0], numbers[1], numbers[2] if len(numbers) == 3 else 0.0), tuple(free)


def read_vector(mapping: Mapping, name: str, kind: str, default: FloatVector) -> FloatVector:
    """Two or three quantities (SI; the third is 0 where it is left out), or the default where there are none."""
    if not mapping.has(name):
        return default
    example = default if any(default) else (0.0, 0.0, read_quantity(kind_of(kind).example, kind, file="", key=name))
    written = ", ".join(format_quantity(value, kind, digits=4) for value in example)
    values = mapping.items(name, would_do=f"a list of x, y and z, e.g. [{written}]")
    if len(values) not in (2, 3):
        raise mapping.error(name, f"needs two components (x, y) or three, not {len(values)}")
    path = mapping.path_of(name)
    numbers = [
        read_quantity(value, kind, file=mapping.file, key=f"{path}[{number}]")
        for number, value in enumerate(values, start=1)
    ]
    return (numbers[0], numbers[1], numbers[2] if len(numbers) == 3 else 0.0)


def origin_to_value(joint: Joint) -> Any:
    """A joint's fixed transform as an arm file holds it."""
    free = joint.origin_free
    if len(free) == len(SHIFTS) + len(TURNS):
        return FREE
    rpy = to_roll_pitch_yaw(joint.origin_rotation)
    out: dict[str, Any] = {}
    for (name, (parts, kind)), values in zip(_KEYS.items(), (joint.origin_translation, rpy), strict=True):
        texts = [
            FREE if part in free else format_quantity(value, kind) for part, value in zip(parts, values, strict=True)
        ]
        out[name] = FREE if set(texts) == {FREE} else texts
    return out


def origin_given(joint: Joint) -> bool:
    """Whether a joint stands elsewhere than at the end of the link before, or nobody knows where."""
    return bool(joint.origin_free) or joint.origin_rotation != IDENTITY or any(joint.origin_translation)
