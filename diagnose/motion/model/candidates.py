"""Candidates of a motion diagnosis: what each effect that acts on torques does at each place, as columns and groups."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Effect, Parameter
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.effects.torques import Bent
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import regressor
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .groups import SHARPER, Group, Source, groups_of

_MOST_VARIANTS = 12
"""Values of an effect's shapes up to which all are candidates; of more, a scan proposes some."""
_BETWEEN = 4
"""Parts into which the step on either side of a shape that was taken is cut."""
_PROBED = 200
"""Instants at which it is tried whether an effect goes by the drives' torque."""


@dataclass(frozen=True)
class Candidates:
    """All sources of columns, `width` columns in all, and the groups that a diagnosis chooses among; `clock` s by which
    torques may be late to coordinates without being a delay."""

    sources: tuple[Source, ...]
    groups: tuple[Group, ...]
    width: int
    clock: float


def candidates(
    arm: Arm, effects: Sequence[Effect], motion: Motion, masses: Array, clock: float, *, rules: Rules
) -> Candidates:
    """The candidates that can act on an arm in a motion.

    Args:
        arm: The arm.
        effects: Effects with `torques`, of which some may not act on this arm or motion.
        motion: A motion, for which conditions that are missing leave effects out.
        masses: (n, 10) the links' inertial parameters as the arm file has them.
        clock: s by which torques may be late to coordinates without being a delay.
        rules: What is usual.
    """
    probe = _probe(motion)
    slopes = regressor(arm, probe[0].q, probe[0].velocity, probe[0].acceleration)
    sources: list[Source] = []
    width = 0
    for effect in (*effects, SHARPER):
        variants = _grid(effect, rules.motion.slow)
        late = len(variants) > _MOST_VARIANTS or effect.recording.last_resort
        if effect.torques is None or not _shown(effect, motion) or late:
            continue
        for at in _places(arm, effect):
            acting = _acting(effect, at, variants[0], arm, probe, slopes)
            if acting is None:
                continue
            for shapes in variants:
                sources.append(replace(acting, shapes=shapes, start=width))
                width += len(acting.sizes)
    return Candidates(tuple(sources), tuple(groups_of(sources, arm, masses, clock, rules)), width, clock)


def _acting(
    effect: Effect,
    at: tuple[int, ...],
    shapes: Mapping[str, float],
    arm: Arm,
    probe: tuple[Motion, Motion],
    slopes: Array,
) -> Source | None:
    """An effect at a place (from 0) with those of its sizes that change some joint's torque; None without any."""
    bent = effect.torques if isinstance(effect.torques, Bent) else None
    whole = Source(effect, at, shapes, effect.torque_sizes[:1] if bent else effect.torque_sizes, 0, False)
    if isinstance(effect.torques, OfInertia):
        first = second = replace(whole, joints=tuple(range(arm.size))).torques(probe[0], slopes)
        first = {joint: columns for joint, columns in first.items() if columns.any()}
    else:
        first, second = (whole.torques(item) for item in probe)
    sizes = tuple(
        size
        for number, size in enumerate(whole.sizes)
        if any(np.abs(columns[:, number]).max() > 0.0 for columns in first.values())
    )
    if not sizes:
        return None
    usual = np.array([max(map(abs, size.typical)) for size in sizes])
    if bent:
        usual[0] = bent.usual(probe[0], at[0])
    by_load = any(not np.allclose(first[j], second[j], rtol=1e-6, atol=1e-12) for j in first)
    return replace(whole, sizes=sizes, by_load=by_load, joints=tuple(sorted(first)), usual=usual)


def acting(*, voltages: bool) -> list[Effect]:
    """The effects that act on torques; with `voltages` what only a log of these shows, too."""
    every = (EFFECTS[name] for name in EFFECTS)
    return [each for each in every if each.torques is not None and (voltages or not each.recording.of_voltage)]


def scanned(effects: Sequence[Effect]) -> list[tuple[Effect, tuple[float, ...]]]:
    """Effects of one shape with too many values to be candidates all, with those values."""
    return [
        (effect, effect.shapes[0].grid)
        for effect in effects
        if effect.torques is not None and len(effect.shapes) == 1 and len(effect.shapes[0].grid) > _MOST_VARIANTS
    ]


def with_variants(
    pool: Candidates,
    arm: Arm,
    masses: Array,
    more: Sequence[tuple[Effect, int, Mapping[str, float]]],
    *,
    rules: Rules,
) -> Candidates:
    """The candidates with more effects at joints (from 0), of these shapes."""
    sources = list(pool.sources)
    width = pool.width
    for effect, joint, shapes in more:
        usual = np.array([max(map(abs, size.typical)) for size in effect.torque_sizes])
        sources.append(Source(effect, (joint,), shapes, effect.torque_sizes, width, False, (joint,), usual))
        width += len(effect.torque_sizes)
    return Candidates(tuple(sources), tuple(groups_of(sources, arm, masses, pool.clock, rules)), width, pool.clock)


def refined(pool: Candidates, chosen: Sequence[int], *, named: bool = False, rules: Rules) -> Candidates:
    """The candidates with shapes of some groups (their numbers) between those that were tried and these groups' own,
    within the grid until they are `named`: beyond it, a form that other physics takes on would pass for the effect."""
    more: list[tuple[int, str, list[float]]] = []
    for number in chosen:
        for shape in (item for item in _free_shapes(pool, number) if not item.whole):
            value, tried = pool.groups[number].shapes[shape.name], _tried(pool, number, shape.name)
            if len(tried) < 2:
                continue
            at = tried.index(value)
            below = tried[at - 1] if at else value**2 / tried[at + 1]
            above = tried[at + 1] if at + 1 < len(tried) else value**2 / below
            least = max(shape.grid[0], rules.motion.slow if shape.kind == "angular_speed" else 0.0)
            least, most = (shape.lower, shape.upper) if named else (least, shape.grid[-1])
            between = np.geomspace(below, above, 2 * _BETWEEN + 1).tolist()
            more.append((number, shape.name, [each for each in between if least < each < most]))
    return _with_shapes(pool, more)


def beyond(pool: Candidates, chosen: Sequence[tuple[int, bool, bool]], *, rules: Rules) -> Candidates:
    """The candidates with shapes of some groups (their numbers) below the least and above the greatest that were tried,
    where that is asked, to the ends of what the parameter may be, and with those between where a group's own is beyond
    the grid: of a cause that is named, they may be as likely."""
    outside = [
        number
        for number, *_ in chosen
        for shape in _free_shapes(pool, number)
        if not shape.grid[0] <= pool.groups[number].shapes[shape.name] <= shape.grid[-1]
    ]
    pool = refined(pool, outside, named=True, rules=rules)
    more: list[tuple[int, str, list[float]]] = []
    for number, below, above in chosen:
        for shape in _free_shapes(pool, number):
            tried = _tried(pool, number, shape.name)
            if shape.whole:
                steps = range(1, _BETWEEN + 1)
                values = [tried[0] - step for step in steps if below] + [tried[-1] + step for step in steps if above]
                more.append((number, shape.name, [value for value in values if value in shape.grid]))
                continue
            step = (shape.grid[1] / shape.grid[0]) ** (1.0 / (2 * _BETWEEN))
            ends = [(tried[0], shape.lower)] * below + [(tried[-1], shape.upper)] * above
            for begun, end in ends:
                count = math.ceil(abs(math.log(end / begun)) / math.log(step)) + 1 if end > 0.0 else 1
                more.append((number, shape.name, np.geomspace(begun, end, count).tolist() if count > 1 else []))
    return _with_shapes(pool, more)


def _free_shapes(pool: Candidates, number: int) -> tuple[Parameter, ...]:
    """The shapes of a group (its number) of which others can be added to rows."""
    group = pool.groups[number]
    by_load = any(source.by_load for source in pool.sources if source.start == group.columns[0])
    return () if group.tied or by_load or not group.shapes else group.effect.torque_shapes


def _tried(pool: Candidates, number: int, name: str) -> list[float]:
    """The values of a shape that a group's family (its number) was tried with, the least first."""
    family = pool.groups[number].family
    return sorted({group.shapes[name] for group in pool.groups if group.family == family})


def _with_shapes(pool: Candidates, more: Sequence[tuple[int, str, Sequence[float]]]) -> Candidates:
    """The candidates with other values of a shape of some groups (their numbers)."""
    sources, groups, width = list(pool.sources), list(pool.groups), pool.width
    by_start = {source.start: source for source in pool.sources}
    for number, name, values in more:
        group = pool.groups[number]
        tried = [other.shapes[name] for other in groups if other.family == group.family]
        for value in values:
            if np.isclose(value, tried).any():
                continue
            shapes = {**group.shapes, name: value}
            sources.append(replace(by_start[int(group.columns[0])], shapes=shapes, start=width))
            groups.append(replace(group, shapes=shapes, columns=sources[-1].columns))
            width += len(sources[-1].sizes)
    return replace(pool, sources=tuple(sources), groups=tuple(groups), width=width)


def at_estimates(pool: Candidates, sizes: Array) -> Candidates:
    """The candidates with one factor for all masses that holds what links are found to weigh, sizes (W,) of the model's
    columns included, as torque constants do."""
    groups = [
        replace(group, mixing=group.mixing + sizes[group.columns][:, None])
        if group.tied and isinstance(group.effect.torques, OfInertia)
        else group
        for group in pool.groups
    ]
    return replace(pool, groups=tuple(groups))


def bent_sizes(pool: Candidates, sizes: Array) -> dict[tuple[str, tuple[int, ...]], float]:
    """The sizes, by effect and place, of what is not in proportion to them, by those (W,) of the model's columns."""
    made: dict[tuple[str, tuple[int, ...]], float] = {}
    for source in pool.sources:
        if source.bent and sizes[source.start]:
            made[source.place] = made.get(source.place, 0.0) + float(sizes[source.start])
    return made


def _shown(effect: Effect, motion: Motion) -> bool:
    held = {
        "commanded": motion.commanded is not None,
        "warming": motion.temperature is not None,
    }
    return all(held.get(need, True) for need in effect.requires)


def _places(arm: Arm, effect: Effect) -> list[tuple[int, ...]]:
    if effect.place in ("base", "tip"):
        return [()]
    return [
        (index,)
        for index, joint in enumerate(arm.joints)
        if effect.can_act(index, revolute=joint.revolute, passive=joint.passive)
    ]


def _grid(effect: Effect, slow: float) -> list[Mapping[str, float]]:
    names = [shape.name for shape in effect.torque_shapes]
    # What depends on speeds whose sign is uncertain is not distinguished from a sign that is sharper or blurred.
    grids = [[v for v in s.grid if s.kind != "angular_speed" or v > slow] for s in effect.torque_shapes]
    return [dict(zip(names, values, strict=True)) for values in itertools.product(*grids)]


def _probe(motion: Motion) -> tuple[Motion, Motion]:
    """Two short swings to and fro from where an arm stands, alike but for the torque, with what the log has."""
    joints = np.arange(1, motion.q.shape[1] + 1)
    rate = 2.0 * np.pi * (0.4 + 0.05 * joints)
    time = np.linspace(0.0, 4.0, _PROBED)
    phase = time[:, None] * rate + joints
    q = motion.q[0] + 0.3 * np.sin(phase)
    wave = np.cos(0.7 * phase) + joints

    velocity, acceleration = 0.3 * rate * np.cos(phase), -0.3 * rate**2 * np.sin(phase)

    def like(held: Array | None, values: Array) -> Array | None:
        return None if held is None else values

    short = replace(
        motion,
        time=time,
        q=q,
        velocity=velocity,
        acceleration=acceleration,
        torque=wave,
        commanded=like(motion.commanded, q + 1e-3 * wave),
        joint_side=like(motion.joint_side, q + 1e-3 * wave),
        joint_side_rates=None if motion.joint_side_rates is None else (velocity, acceleration),
        payload_mass=None if motion.payload_mass is None else np.full(_PROBED, motion.payload_mass[0]),
        temperature=like(motion.temperature, 300.0 + time),
    )
    return short, replace(short, torque=2.0 * wave[::-1] + 1.0)


def of_arm(pool: Candidates) -> NDArray[np.bool_]:
    """Which columns (W,) change the torque that the drives pass on to the arm, by which friction under load goes."""
    columns = np.zeros(pool.width, dtype=bool)
    for source in pool.sources:
        columns[source.columns] = source.effect.place != "joint"
    return columns
