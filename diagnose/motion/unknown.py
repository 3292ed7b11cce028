"""What is left of each joint's torque, where no few causes explain it, and what it depends on beyond chance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .events.changed import change_of
from .judged import Judged
from .model.chance import DRAWS
from .model.identify import Identified
from .model.rows import LogRows
from .preparation import PreparedLog
from .result import MotionFinding, MotionUnknown, OfJoint

_BINS = 10
"""Bins of equal counts over whatever the residual may depend on."""


@dataclass(frozen=True)
class Residuals:
    """RMS (n,) N*m by joint: as given, of the file, of the file held out, of the names held out, and what the whole
    library leaves (`floor`), NaN where a joint stood still; `sensors` is the noise of the sensors themselves."""

    before: Array
    after: Array
    held_out: Array
    of_named: Array
    floor: Array
    sensors: Array


def residuals(identified: Identified, judge: Judged, given: Array) -> Residuals:
    """What is left by joint, where the arm as given leaves the squares `given` (B, n)."""
    counts = judge.counts.sum(axis=0)
    squares = (given, judge.written.left, judge.written.held_out, judge.named.beside[1])
    rms = (np.sqrt(each.sum(axis=0) / np.maximum(counts, 1)) for each in squares)
    # Nobody knows what a model is worth at a joint that stood still.
    left = (np.where(counts > 0, each, np.nan) for each in (*rms, identified.noise.sigma))
    return Residuals(*left, sensors=sensor_noise([row.prepared for row in identified.rows]))


def sensor_noise(prepared: Sequence[PreparedLog]) -> Array:
    """The noise (n,) N*m that the sensors are heard to have."""
    return np.asarray(np.sqrt(np.mean([np.square(log.noise()) for log in prepared], axis=0)))


def beyond_noise(floor: Array, torque: Array, sensors: Array, rules: Rules) -> NDArray[np.bool_]:
    """At which joints (n,) so much is left that it is no noise."""
    share = floor / torque
    beyond = (share > rules.motion.unexplained) & (
        share > np.minimum(rules.motion.uneven * np.nanmedian(share), rules.motion.never_noise)
    )
    # What depends on something is no noise where it is as loud as the noise that the sensors are heard to have.
    above = np.maximum(rules.motion.above_noise * sensors, rules.motion.filters * torque)
    return beyond | (floor > above)  # well above what the sensors are heard to have, it is physics, if small


@dataclass(frozen=True)
class Structure:
    """What a joint's residual depends on: names with the share that bins explain beyond chance and the p-value."""

    names: tuple[str, ...]
    shares: tuple[float, ...]
    p_value: float


def residual_structures(identified: Identified, options: Options) -> list[Structure]:
    """What depends on something of what the whole library leaves of each joint's torque, over all logs."""
    return [_of_joint(identified, joint, options) for joint in range(len(identified.torque))]


def _of_joint(identified: Identified, joint: int, options: Options) -> Structure:
    residual, number, parts = [], [], []
    for log, rows in enumerate(identified.rows):
        use = rows.prepared.moving[:, joint]
        residual.append((rows.target[:, joint] - rows.design[joint] @ identified.noise.sizes[rows.columns[joint]])[use])
        number.append(np.full(np.count_nonzero(use), log))
        parts.append(_variables(joint, rows, rows.prepared.kept[use]))
    names = set.intersection(*(set(part) for part in parts))
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0] if name in names}
    way = np.sign(joined["speed"])
    return _structure(np.concatenate(residual), way, np.concatenate(number), joined, options.seed, rules=options.rules)


def _structure(
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


def _variables(joint: int, rows: LogRows, at: NDArray[np.int64]) -> dict[str, Array]:
    """What a joint's residual may depend on at some samples, by name: its angle, speed, acceleration, load, the time,
    and the angles and speeds of its neighbours."""
    motion = rows.prepared.motion
    values = {
        f"q{joint + 1}": motion.q[at, joint],
        "speed": motion.velocity[at, joint],
        "acceleration": motion.acceleration[at, joint],
        "load": rows.nominal[at, joint],
        "time": motion.time[at],
    }
    for other in (joint - 1, joint + 1):
        if 0 <= other < motion.q.shape[1]:
            values[f"q{other + 1}"] = motion.q[at, other]
            values[f"speed_of_joint_{other + 1}"] = motion.velocity[at, other]
    if motion.temperature is not None:
        values["temperature_degC"] = motion.temperature[at]
    return values


def _depends(structures: Sequence[Structure]) -> tuple[str, ...]:
    """What several joints' residuals depend on, the commonest first."""
    counts: dict[str, float] = {}
    for item in structures:
        for name, share in zip(item.names, item.shares, strict=True):
            counts[name] = counts.get(name, 0.0) + share
    return tuple(sorted(counts, key=lambda name: -counts[name]))


def unexplained(
    identified: Identified,
    left: Residuals,
    structures: Sequence[Structure],
    per_joint: Sequence[OfJoint],
    named: Sequence[MotionFinding],
    *,
    rules: Rules,
) -> MotionUnknown | None:
    """What stays unknown beside what was named in the torques; None where nothing does."""
    far = _far_from_floor(named, left, identified.torque, rules)
    joints = sorted({*_misleading(named, left), *far, *_open_joints(identified, left, structures, per_joint, rules)})
    if not joints:
        return None
    # Where names leave more than the library it is all of that, elsewhere what depends on something.
    sizes = {
        joint: float(left.of_named[joint - 1])
        if joint in far
        else per_joint[joint - 1].floor * min(_share(structures[joint - 1]), 1.0) ** 0.5
        for joint in joints
    }
    worst = max(joints, key=lambda joint: sizes[joint])
    names = _depends([structures[joint - 1] for joint in joints])
    shape = f"changes with {names[0].replace('_', ' ')}" if names else "no pattern over angle, speed, load or time"
    unknown = MotionUnknown(tuple(joints), names, sizes[worst], shape, _decides(names), worst)
    change = change_of(identified, rules=rules)
    if change is None:
        return unknown
    shape = f"changes at {change.start.time:.4g} s"
    return replace(unknown, change=change, shape=shape, decide="the log before and after that instant, each by itself")


def _open_joints(
    identified: Identified, left: Residuals, structures: Sequence[Structure], per_joint: Sequence[OfJoint], rules: Rules
) -> list[int]:
    """The joints (from 1) of which more is left than noise, or something that depends on the motion."""
    beyond = beyond_noise(left.floor, identified.torque, left.sensors, rules)
    least = np.minimum(rules.motion.unexplained * identified.torque, left.sensors)
    return [
        item.joint
        for item, what, large in zip(per_joint, structures, beyond.tolist(), strict=True)
        if large or (item.depends_on and item.floor * max(what.shares) ** 0.5 > least[item.joint - 1])
    ]


def _misleading(named: Sequence[MotionFinding], left: Residuals) -> list[int]:
    """The joints (from 1) at which what is named foretells no other motion, and so is not what is there."""
    claimed = np.sqrt(sum((np.square(item.rms_explained) for item in named), np.zeros(len(left.before))))
    return (np.flatnonzero((claimed > 0.5 * left.before) & (left.of_named > left.before)) + 1).tolist()


def _far_from_floor(named: Sequence[MotionFinding], left: Residuals, torque: Array, rules: Rules) -> list[int]:
    """The joints (from 1) at which the names leave far more of other motion than the whole library leaves: a few names
    are not what is there, and many together say nothing."""
    if not named:
        return []
    most = np.maximum(rules.motion.above_noise * left.floor, rules.motion.filters * torque)
    return (np.flatnonzero(left.of_named > most) + 1).tolist()


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
