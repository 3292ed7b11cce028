"""Which tolerance to buy: how the worst error answers to each of them; and the error along a seam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.paper.corrected import search_of
from linkwright.paper.postures import Postures, around
from linkwright.paper.rows import Cell, Column, ExtendedTable
from linkwright.results.figures_in_words import figure

Kind = Literal["clearance", "backlash", "stiffness", "length"]

_STEP = 1e-3
"""Relative step of the central differences."""
_UNITS = MappingProxyType(
    {
        "clearance": ("mm", 1e-3),
        "backlash": ("arcmin", math.radians(1.0 / 60.0)),
        "stiffness": ("kN·m/rad", 1e3),
        "length": ("mm", 1e-3),
    }
)
"""The unit in which people buy each tolerance, and how much of it is one SI unit."""


@dataclass(frozen=True)
class Sensitivity:
    """How the worst error answers to one figure of the arm, SI.

    `number` is the joint's or link's (from 1), `value` the figure itself, `slope` the derivative of the worst error
    (m per SI unit of the figure; rad for backlash, N*m/rad for stiffness).
    """

    kind: Kind
    number: int
    value: float
    slope: float

    @property
    def tenth(self) -> float:
        """What 10 % more of the figure adds to the worst error, m, to first order."""
        return 0.1 * self.value * self.slope


def sensitivities(arm: Arm) -> tuple[Sensitivity, ...]:
    """Every clearance, backlash, stiffness and length that the arm has, the one that buys most by 10 % first.

    Central differences of the worst error over the joint ranges, its pose sought again at each. Figures of zero and
    rigid drives are left out: there is no tenth of them. The other figures stay, so that a longer link is a longer arm.
    """
    found: list[Sensitivity] = []
    kinds: tuple[Kind, ...] = ("clearance", "backlash", "stiffness", "length")
    for kind in kinds:
        for index in range(arm.size):
            value = _value(arm, kind, index)
            if value:
                step = _STEP * value
                ends = [_worst(_changed(arm, kind, index, value + sign * step)) for sign in (1.0, -1.0)]
                found.append(Sensitivity(kind, index + 1, value, (ends[0] - ends[1]) / (2.0 * step)))
    return tuple(sorted(found, key=lambda each: -abs(each.tenth)))


def _worst(arm: Arm) -> float:
    search, design = search_of(arm)
    return search.worst(design, certify=False).error


def _value(arm: Arm, kind: Kind, index: int) -> float | None:
    if kind == "length":
        return arm.links[index].length
    return getattr(arm.joints[index], kind)


def _changed(arm: Arm, kind: Kind, index: int, value: float) -> Arm:
    if kind == "length":
        links = tuple(replace(link, length=value) if k == index else link for k, link in enumerate(arm.links))
        return replace(arm, links=links)
    joints = tuple(replace(joint, **{kind: value}) if k == index else joint for k, joint in enumerate(arm.joints))
    return replace(arm, joints=joints)


def tolerance_table(arm: Arm, note: str) -> ExtendedTable:
    """The sensitivities of an arm as a table; `note` says which arm it is."""
    columns = (
        Column("rank"),
        Column("tolerance"),
        Column("value"),
        Column("in"),
        Column("per unit", "mm"),
        Column("per 10 %", "mm"),
    )
    rows: list[tuple[Cell, ...]] = []
    for rank, each in enumerate(sensitivities(arm), start=1):
        unit, size = _UNITS[each.kind]
        where = "link" if each.kind == "length" else "joint"
        name = f"{each.kind} of {where} {each.number}"
        per_unit = 1e3 * each.slope * size
        rows.append((float(rank), name, each.value / size, unit, per_unit, 1e3 * each.tenth))
    remark = (
        "Derivatives of the worst error over all poses (central differences, the worst pose sought again), per unit "
        "of the tolerance and for 10 % more of it, to first order. A longer link makes a longer arm. "
    )
    return ExtendedTable("tolerances", "Which tolerance to buy", columns, tuple(rows), remark + note)


def seam_table(
    arm: Arm, start: Sequence[float], end: Sequence[float], *, points: int = 9, postures: int = 256
) -> ExtendedTable:
    """The worst error along and across a straight seam (m, two components) over every posture at each of its points.

    Raises `Unreachable` where the arm cannot follow, ValueError for an arm that leaves the plane.
    """
    if not arm.planar():
        raise ValueError("a seam's normal is one direction in the plane only")
    one, other = np.array([*start, 0.0]), np.array([*end, 0.0])
    length = float(np.linalg.norm(other - one))
    along = (other - one) / length
    normal = np.array([-along[1], along[0], 0.0])
    share = np.linspace(0.0, 1.0, points)
    circle = around(180)
    directions = np.vstack([along, -along, normal, -normal, circle])
    reach = Postures(arm, postures).farthest(one + share[:, None] * (other - one), directions)
    tangential, across = reach[:, :2].max(axis=1), reach[:, 2:4].max(axis=1)
    total = reach.max(axis=1)
    rows: list[tuple[Cell, ...]] = [
        (figure(1e3 * float(s) * length), 1e3 * float(t), 1e3 * float(n), 1e3 * float(e))
        for s, t, n, e in zip(share, tangential, across, total, strict=True)
    ]
    rows.append(("worst along it", 1e3 * float(tangential.max()), 1e3 * float(across.max()), 1e3 * float(total.max())))
    ends = " to ".join(f"({figure(1e3 * float(x))}, {figure(1e3 * float(y))})" for x, y in (start, end))
    note = (
        f"The seam runs straight from {ends} mm. At each point the worst over every posture that holds the tip there, "
        "play where it is worst: along the seam (the weld starts and ends wrong), normal to it (the torch misses the "
        "joint), and in any direction. Each is a worst case of its own, so that they need not meet in one posture."
    )
    columns = (Column("along the seam, mm"), *(Column(name, "mm") for name in ("tangential", "normal", "in all")))
    return ExtendedTable("seam", "Error along a seam", columns, tuple(rows), note)
