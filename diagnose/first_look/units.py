"""Changes of unit that people forget, and how to say them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass
from linkwright.core.arm.evaluation import link_masses
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_TIP = ("x", "y", "z")
_MILLIONS = (1e6, 1e-6)
"""Between um and m; a millionth of a millimetre is no unit that anybody writes."""
_LENGTHS = (1e3, 1e-3, *_MILLIONS, 10.0, 0.1, 100.0, 0.01, 25.4, 1.0 / 25.4)
_LENGTH_SIZES = MappingProxyType({"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254})
_ANGLE_SIZES = MappingProxyType({"rad": 1.0, "deg": math.radians(1.0)})
IN_A_ROW = (1e3, 1e-3, math.degrees(1.0), math.radians(1.0))
"""Single rows slip between m and mm, deg and rad; odder units come by the file."""


@dataclass(frozen=True)
class UnitChange:
    """A change of unit that may bring joints and tip together: factors on q (n,) and on the tip (D,), and how to say
    it, column by column."""

    q: Array
    tip: Array
    columns: tuple[str, ...]
    factors: tuple[float, ...]

    def said(self) -> str:
        """`x_mm, y_mm seem to be in m`."""
        units = [_unit_of_numbers(name, factor) for name, factor in zip(self.columns, self.factors, strict=True)]
        by_unit: dict[str, list[str]] = {}
        for name, unit in zip(self.columns, units, strict=True):
            by_unit.setdefault(unit, []).append(name)
        parts = [
            f"{', '.join(names)} {'seems' if len(names) == 1 else 'seem'} to be in {unit}"
            for unit, names in by_unit.items()
        ]
        return " and ".join(parts)


def _unit_named(header: str, factor: float) -> str | None:
    """The unit in which a column's numbers are, where they fit with `factor` times the unit of its header."""
    sizes = _ANGLE_SIZES if header.rpartition("_")[2] in _ANGLE_SIZES else _LENGTH_SIZES
    wanted = factor * sizes.get(header.rpartition("_")[2], 1.0)
    return next((unit for unit, size in sizes.items() if math.isclose(size, wanted)), None)


def _unit_of_numbers(header: str, factor: float) -> str:
    """The same in words, for any factor."""
    named = _unit_named(header, factor)
    if named is not None:
        return named
    return f"a unit {factor:.6g} times as large" if factor > 1.0 else f"a unit {1.0 / factor:.6g} times as small"


def unit_changes(arm: Arm, width: int, headers: Mapping[str, str]) -> Iterator[UnitChange]:
    """Every change of unit that people forget: one column, all of a kind, or all angles and all lengths together."""
    turns = [k for k, joint in enumerate(arm.joints) if joint.revolute]
    slides = [k for k, joint in enumerate(arm.joints) if not joint.revolute]
    names_q = [headers.get(f"q{k + 1}", f"q{k + 1}") for k in range(arm.size)]
    names_tip = [headers.get(name, name) for name in _TIP[:width]]

    def change(joints: list[int], by: float, axes: list[int], by_tip: float) -> UnitChange:
        q, tip = np.ones(arm.size), np.ones(width)
        q[joints], tip[axes] = by, by_tip
        names = (*(names_q[k] for k in joints), *(names_tip[k] for k in axes))
        return UnitChange(q, tip, names, (*[by] * len(joints), *[by_tip] * len(axes)))

    def groups(members: list[int]) -> list[list[int]]:
        return ([members] if members else []) + ([[k] for k in members] if len(members) > 1 else [])

    angles = (math.degrees(1.0), math.radians(1.0))
    for axes, factor in itertools.product(groups(list(range(width))), _LENGTHS):
        if factor not in _MILLIONS or all(_unit_named(names_tip[k], factor) is not None for k in axes):
            yield change([], 1.0, axes, factor)
    for joints, factor in itertools.product(groups(turns), angles):
        yield change(joints, factor, [], 1.0)
    for joints, factor in itertools.product(groups(slides), _LENGTHS):
        yield change(joints, factor, [], 1.0)
    if turns:
        for by_angle, by_length in itertools.product(angles, _LENGTHS):
            yield change(turns, by_angle, list(range(width)), by_length)


def refuse_grams(file: str, payload: Array | None, arm: Arm, headers: Headers, rules: Rules) -> None:
    """Refuse payloads (N,), kg, that no such arm carries, and that it might if they were in grams. Nothing is said of
    an arm whose weight and drives nobody knows."""
    most = 0.0 if payload is None else float(np.nanmax(payload, initial=0.0))
    known = {"the arm weighs": _weight(arm), "its drives hold at full stretch": _held_stretched(arm)}
    what, size = max(known.items(), key=lambda item: item[1])
    if size > 0.0 and most > rules.mistakes.payload_in_grams * size:
        name = headers.get("payload", "payload_kg")
        message = f"reaches {most:.4g} kg where {what} {size:.3g} kg; is it in g?"
        raise headers.refusal(file, name, message, {"columns": {name: f"{name}/1000"}})


def _weight(arm: Arm) -> float:
    """What links, joints and motors weigh, kg; 0 where the mass of a link is not known."""
    return 0.0 if of_unknown_mass(arm) else sum(link_masses(beams_of(arm))) + arm.carried_mass


def _held_stretched(arm: Arm) -> float:
    """The mass at the tip that the strongest drive holds at full stretch, kg; 0 where no drive's torque is known."""
    held = max((joint.greatest_static_load or 0.0 for joint in arm.joints if joint.revolute), default=0.0)
    reach = sum(arm.lengths) * math.hypot(*arm.gravity)
    return held / reach if reach > 0.0 else 0.0


def widest(arm: Arm) -> Array:
    """What no coordinate exceeds, rad or m."""
    return np.array(
        [
            2.0 * max(math.pi, *map(abs, joint.range)) if joint.revolute else 2.0 * max(map(abs, joint.range))
            for joint in arm.joints
        ]
    )
