"""An arm's error at many poses in parts: what each effect does at each place, and what each tolerance could.

All to first order, from the effects' formulas on arrays of poses; so halving a part or drawing another arm is only
another sum.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from linkwright.core.arm.chain.arrays import columns as as_rows
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import BACKLASH, EFFECTS, JOINT_COMPLIANCE, Settings
from linkwright.core.arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import ActiveEffect, TipError, active_effects, tip_error
from linkwright.core.optimize.exchange.scenarios import resized
from linkwright.core.sections.numeric import Array

from .sheet import Sheet

Owner = tuple[str, int]
"""`("joint", 0)`, `("link", 2)`; `("base", -1)` and `("tip", -1)` are nobody's in the chain."""

REPEATABILITY, TEMPERATURE = "repeatability", "temperature"
EACH_TIME = ", each time"
"""Ends the name of a cause that is drawn anew at every pose."""
_WARM = "warming"


@dataclass(frozen=True)
class Fixed:
    """What an effect does at a place in every arm: `vector` (S, 3) m. A drive's stiffness or a link's modulus
    (`factor`) divides it."""

    cause: str
    owner: Owner
    factor: str | None
    vector: Array


@dataclass(frozen=True)
class Varying:
    """What differs from arm to arm (or, `each_time`, from pose to pose): `vector` (S, 3) m at the bound, times a number
    between -1 and 1, and `bent` (S, 3) times its square. `key` names the number, so that the same draws serve again."""

    cause: str
    owner: Owner
    key: str
    vector: Array
    bent: Array | None = None
    each_time: bool = False


@dataclass(frozen=True)
class Play:
    """Play that moves the tip within an interval (S, 3), or within a disc of `radius` normal to `normal` (S, 3)."""

    cause: str
    owner: Owner
    vector: Array
    seating: Array
    radius: float | None = None


@dataclass(frozen=True)
class Parts:
    """The error at S states (poses under loads, load after load) in parts. `scatter` (m) is one standard deviation of
    the tip in each direction; `load_scale` (S,) the size of the loads; `widths` how far off factors are."""

    arm: Arm
    planar: bool
    fixed: tuple[Fixed, ...]
    varying: tuple[Varying, ...]
    play: tuple[Play, ...]
    scatter: float
    load_scale: Array
    widths: dict[tuple[str, int], float]
    unwarmed: tuple[int, ...]
    """Links that would grow by an unknown amount (from 0)."""

    @property
    def states(self) -> int:
        """How many."""
        return len(self.load_scale)


def parts_of(arm: Arm, sheet: Sheet, poses: Array, loads: Sequence[LoadCase]) -> Parts:
    """The parts at poses (N, n) under load cases; `PropertyNeeded` where a link's mass or material is not known."""
    by_load = [_at_load(arm, sheet, poses, load) for load in loads]
    states = [item.states for item in by_load]
    return replace(
        by_load[0],
        planar=all(item.planar for item in by_load),
        fixed=_stacked([item.fixed for item in by_load], states),
        varying=_stacked([item.varying for item in by_load], states),
        play=_stacked([item.play for item in by_load], states),
        load_scale=np.concatenate([item.load_scale for item in by_load]),
        unwarmed=tuple(sorted({k for item in by_load for k in item.unwarmed})),
    )


_Part = TypeVar("_Part", Fixed, Varying, Play)


def _stacked(loads: Sequence[Sequence[_Part]], states: Sequence[int]) -> tuple[_Part, ...]:
    """The parts under one load after another. One that another tip alone has, of several on one torso, is zero at
    the states of the others."""
    by_load = [_numbered(parts) for parts in loads]
    results: list[_Part] = []
    for key in dict.fromkeys(key for item in by_load for key in item):
        there = [item.get(key) for item in by_load]
        first = next(item for item in there if item is not None)
        names = [name for name in ("vector", "seating", "bent") if getattr(first, name, None) is not None]
        rows = {
            name: np.concatenate(
                [
                    np.zeros((count, *getattr(first, name).shape[1:])) if item is None else getattr(item, name)
                    for item, count in zip(there, states, strict=True)
                ]
            )
            for name in names
        }
        results.append(replace(first, **rows))
    return tuple(results)


def _numbered(parts: Sequence[_Part]) -> dict[tuple[object, ...], _Part]:
    """Parts by what they are; alike ones are told by their number."""
    numbered: dict[tuple[object, ...], _Part] = {}
    for part in parts:
        what = (part.cause, part.owner, getattr(part, "factor", None), getattr(part, "key", None))
        number = 0
        while (*what, number) in numbered:
            number += 1
        numbered[(*what, number)] = part
    return numbered


def _at_load(arm: Arm, sheet: Sheet, poses: Array, load: LoadCase) -> Parts:
    columns = [poses[:, k] for k in range(arm.size)]
    state = solve(arm, columns, beams_of(arm, (load,)), load)
    count = len(poses)
    fixed: list[Fixed] = []
    play: list[Play] = []
    for active in active_effects(arm):
        for owner, settings in _places(arm, active):
            error = tip_error(state, [replace(active, settings=settings)])
            vector = as_rows(error.vector, count)
            if vector.any():
                fixed.append(Fixed(active.effect.id, owner, _factor(active, owner), vector))
            play += _play(error, owner, count)
    widths = (
        {}
        if sheet.uncertain is None
        else {(name, k): sheet.uncertain.widths[name][k] for name, k in sheet.uncertain.places}
    )
    varying = [
        *_tolerances(state, sheet, count),
        *_resized(arm, load, columns, widths, count),
        *_warmed(state, sheet.temperature, count),
    ]
    unwarmed = tuple(
        k for k, link in enumerate(state.links) if link.beam.thermal_expansion is None and sheet.temperature > 0.0
    )
    scale = np.linalg.norm(as_rows(state.joints[0].force, count), axis=1)
    scale = scale + np.linalg.norm(as_rows(state.joints[0].moment, count), axis=1)
    scatter = sheet.repeatability / reach_of_repeatability(state.planar)
    return Parts(arm, state.planar, tuple(fixed), tuple(varying), tuple(play), scatter, scale, widths, unwarmed)


def reach_of_repeatability(planar: bool) -> float:
    """Repeatability over one standard deviation in each direction: the mean distance from the mean position and three
    times its standard deviation (ISO 9283:1998, 7.2.2), of a normal scatter in two or three directions."""
    mean = np.sqrt(np.pi / 2.0) if planar else 2.0 * np.sqrt(2.0 / np.pi)
    spread = np.sqrt(2.0 - np.pi / 2.0) if planar else np.sqrt(3.0 - 8.0 / np.pi)
    return float(mean + 3.0 * spread)


def _places(arm: Arm, active: ActiveEffect) -> list[tuple[Owner, Settings]]:
    """Each place at which an effect acts, by itself."""
    effect = active.effect
    if effect.place not in ("joint", "link"):
        return [((effect.place, -1), active.settings)]
    return [
        ((effect.place, k), replace(active.settings, at=(k,)))
        for k in range(arm.size)
        if active.settings.acts_at(k)
        and effect.can_act(k, revolute=arm.joints[k].revolute, passive=arm.joints[k].passive)
    ]


def _factor(active: ActiveEffect, owner: Owner) -> str | None:
    if active.effect.id == JOINT_COMPLIANCE.id:
        return "stiffness"
    return "elastic_modulus" if active.effect.link.flexible and owner[0] == "link" else None


def _play(error: TipError, owner: Owner, count: int) -> list[Play]:
    intervals = [
        Play(interval.effect, owner, as_rows(interval.vector, count), np.broadcast_to(interval.seating, (count,)))
        for interval in error.intervals
    ]
    discs = [
        Play(disc.effect, owner, as_rows(disc.normal, count), as_rows(disc.seating, count), disc.radius)
        for disc in error.discs
    ]
    return [*intervals, *discs]


def _tolerances(state: PoseState, sheet: Sheet, count: int) -> list[Varying]:
    varying: list[Varying] = []
    for tolerance in sheet.tolerances:
        entry = tolerance.entry
        active = ActiveEffect(EFFECTS[entry.effect], Settings(tuple(k - 1 for k in entry.at), entry.parameters))
        for owner, settings in _places(state.arm, active):
            for name, width in entry.parameters.items():
                alone = replace(active, settings=replace(settings, values={name: width}))
                vector = as_rows(tip_error(state, [alone]).vector, count)
                key = f"{entry.effect} {name} {owner} {tolerance.each_time}"
                cause = f"{entry.effect}{EACH_TIME}" if tolerance.each_time else entry.effect
                if vector.any():
                    varying.append(Varying(cause, owner, key, vector, each_time=tolerance.each_time))
    return varying


def _resized(
    arm: Arm, load: LoadCase, columns: Sequence[Array], widths: dict[tuple[str, int], float], count: int
) -> list[Varying]:
    """What links of other dimensions do more or less, to second order."""
    varying: list[Varying] = []
    middle: Array | None = None
    for (name, k), width in widths.items():
        section = arm.links[k].section
        if name not in ("size", "thickness") or section is None:
            continue
        if middle is None:
            middle = _whole(arm, load, columns, count)
        ends: list[Array] = []
        for side in (1.0 - width, 1.0 + width):
            size, wall = (side, 1.0) if name == "size" else (1.0, side)
            links = list(arm.links)
            links[k] = replace(links[k], section=resized(section, size, wall), section_name=None)
            ends.append(_whole(arm.with_links(tuple(links)), load, columns, count) - middle)
        low, high = ends
        if low.any() or high.any():
            varying.append(Varying(name, ("link", k), f"{name} {k}", 0.5 * (high - low), 0.5 * (high + low)))
    return varying


def _whole(arm: Arm, load: LoadCase, columns: Sequence[Array], count: int) -> Array:
    state = solve(arm, columns, beams_of(arm, (load,)), load)
    return as_rows(tip_error(state, active_effects(arm)).vector, count)


def _warmed(state: PoseState, swing: float, count: int) -> list[Varying]:
    """All links warmer or colder by as much."""
    if swing == 0.0:
        return []
    total = np.zeros((count, 3))
    for k, link in enumerate(state.links):
        if link.beam.thermal_expansion is not None:
            settings = Settings((k,), {_WARM: swing})
            total = total + as_rows(tip_error(state, [ActiveEffect(THERMAL_EXPANSION, settings)]).vector, count)
    return [Varying(TEMPERATURE, ("base", -1), TEMPERATURE, total)] if total.any() else []


def generator_of(seed: int, key: str) -> np.random.Generator:
    """The draws of one number, the same whatever else is drawn."""
    return np.random.default_rng([seed, zlib.crc32(key.encode())])


def backlash_width(parts: Parts, play: Play) -> float:
    """How far off the backlash of a play's joint may be."""
    return parts.widths.get(("backlash", play.owner[1]), 0.0) if play.cause == BACKLASH.id else 0.0
