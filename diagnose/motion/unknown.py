"""Structure that nothing in the library explains: what the torque left depends on, and whether by chance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .model.chance import DRAWS
from .result import Change, MotionUnknown, OfJoint

_BINS = 10
"""Bins of equal counts over whatever the residual may depend on."""


@dataclass(frozen=True)
class Structure:
    """What a joint's residual depends on: names with the share that bins explain beyond chance and the p-value."""

    names: tuple[str, ...]
    shares: tuple[float, ...]
    p_value: float


def structure(
    residual: Array,
    way: Array,
    log: NDArray[np.int64],
    variables: Mapping[str, Array],
    seed: int,
    *,
    rules: Rules,
) -> Structure:
    """What a residual (M,) depends on: itself, against the motion (as friction is), or its size.

    Args:
        residual: (M,) rows of a joint in the order of time.
        way: (M,) the sign of the joint's speed.
        log: (M,) the log of each row.
        variables: Each (M,), by name.
        seed: For the shifts.
        rules: What is structure.

    Circular shifts keep how rows hang together, and break what they depend on.
    """
    if len(residual) < rules.fitting.least_parts * rules.fitting.enough:
        return Structure((), (), 1.0)
    shifted = np.stack([residual, *(residual[order] for order in _shifts(log, seed))])
    names: list[str] = []
    tables: list[Array] = []
    for name, values in variables.items():
        if np.ptp(values) <= 0.0:
            continue
        edges = np.quantile(values, np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
        inside = np.zeros((len(values), _BINS))
        inside[np.arange(len(values)), np.searchsorted(edges, values)] = 1.0
        for item in (shifted, shifted * way, shifted**2):
            names.append(name)
            tables.append(_explained(item, inside))
    if not names:
        return Structure((), (), 1.0)
    # The greatest share of all, each beside its scatter, so that one test is made of many.
    stacked = np.stack(tables)
    middle, spread = np.median(stacked[:, 1:], axis=1), np.std(stacked[:, 1:], axis=1)
    beyond = stacked[:, 0] - middle
    standing = ((stacked - middle[:, None]) / np.maximum(spread, 1e-12)[:, None]).max(axis=0)
    p_value = float((1 + np.sum(standing[1:] >= standing[0])) / len(standing))
    best: dict[str, float] = {}
    for name, share in zip(names, beyond.tolist(), strict=True):
        best[name] = max(best.get(name, 0.0), share)
    kept = sorted((name for name in best if best[name] > rules.motion.dependence), key=lambda name: -best[name])
    return Structure(tuple(kept), tuple(best[name] for name in kept), p_value)


def _explained(values: Array, inside: Array) -> Array:
    """The share of each row's scatter (D,) that the means of bins (M, K) explain."""
    centred = values - values.mean(axis=1, keepdims=True)
    count = np.maximum(inside.sum(axis=0), 1.0)
    return np.asarray(((centred @ inside) ** 2 / count).sum(axis=1) / np.maximum((centred**2).sum(axis=1), 1e-300))


def _shifts(log: NDArray[np.int64], seed: int) -> list[NDArray[np.int64]]:
    random = np.random.default_rng(seed)
    places = [np.flatnonzero(log == number) for number in np.unique(log)]
    shifts: list[NDArray[np.int64]] = []
    for _ in range(DRAWS):
        order = np.arange(len(log))
        for place in places:
            order[place] = np.roll(
                place, int(random.integers(len(place) // 10, max(len(place) - len(place) // 10, 1) + 1))
            )
        shifts.append(order)
    return shifts


def variables(
    joint: int, q: Array, velocity: Array, acceleration: Array, load: Array, time: Array, temperature: Array | None
) -> dict[str, Array]:
    """What a joint's residual may depend on (M,), by name: its angle, speed, acceleration, load, the time, and the
    angles and speeds of its neighbours."""
    values = {
        f"q{joint + 1}": q[:, joint],
        "speed": velocity[:, joint],
        "acceleration": acceleration[:, joint],
        "load": load[:, joint],
        "time": time,
    }
    for other in (joint - 1, joint + 1):
        if 0 <= other < q.shape[1]:
            values[f"q{other + 1}"] = q[:, other]
            values[f"speed_of_joint_{other + 1}"] = velocity[:, other]
    if temperature is not None:
        values["temperature_degC"] = temperature
    return values


def depends(structures: Sequence[Structure]) -> tuple[str, ...]:
    """What several joints' residuals depend on, the commonest first."""
    counts: dict[str, float] = {}
    for item in structures:
        for name, share in zip(item.names, item.shares, strict=True):
            counts[name] = counts.get(name, 0.0) + share
    return tuple(sorted(counts, key=lambda name: -counts[name]))


def unknown_of(
    joints: Sequence[int],
    structures: Sequence[Structure],
    per_joint: Sequence[OfJoint],
    stays: Mapping[int, float] = MappingProxyType({}),
) -> MotionUnknown | None:
    """What stays unknown at some joints (from 1); None where there are none. Of some joints it is known what `stays`
    (N*m), of the others it is what depends on something of what the whole library leaves."""
    if not joints:
        return None
    sizes = {
        joint: stays.get(joint, per_joint[joint - 1].floor * min(_share(structures[joint - 1]), 1.0) ** 0.5)
        for joint in joints
    }
    worst = max(joints, key=lambda joint: sizes[joint])
    names = depends([structures[joint - 1] for joint in joints])
    shape = f"changes with {names[0].replace('_', ' ')}" if names else "no pattern over angle, speed, load or time"
    return MotionUnknown(tuple(joints), names, sizes[worst], shape, _decides(names), worst)


def since(unknown: MotionUnknown, change: Change) -> MotionUnknown:
    """What stays unknown, where it begins within a log."""
    shape = f"changes at {change.start.time:.4g} s"
    return replace(unknown, change=change, shape=shape, decide="the log before and after that instant, each by itself")


def _share(each: Structure) -> float:
    return max(each.shares, default=1.0)


def _decides(names: Sequence[str]) -> str:
    if not names:
        return "the same motion once more: what repeats is physics, what does not is disturbance"
    if names[0] == "time":
        return "the same motion at the start and after an hour"
    if names[0].startswith("q"):
        return f"slow motion of that joint alone through its whole range, both ways ({names[0]})"
    return "that joint alone at several constant speeds, both ways"
