"""The arm with what was identified among its effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.sections.numeric import Array

from .model.candidates import Group
from .model.ripple import Ripple


def entry_of(effect: Effect, ripple: Ripple) -> EffectEntry:
    """The entry of an order that stands out beyond the low-pass."""
    sine, cosine = (size.name for size in effect.torque_sizes)
    values = {sine: ripple.sine, cosine: ripple.cosine, effect.shapes[0].name: ripple.order}
    return EffectEntry(effect.id, (ripple.joint + 1,), values)


def completed(arm: Arm, groups: Sequence[Group], numbers: Sequence[Array], more: Sequence[EffectEntry] = ()) -> Arm:
    """The arm with entries for groups by their numbers (SI), joined to what it has of the same effect, place
    and shapes, and `more`."""
    entries = list(arm.effects)
    for group, own in zip(groups, numbers, strict=True):
        for entry in _entries(group, own):
            _join(entries, entry, {shape.name for shape in group.effect.shapes}, arm.size)
    return replace(arm, effects=tuple(_readable(entry) for entry in (*entries, *more)))


def _entries(group: Group, numbers: Array) -> list[EffectEntry]:
    shapes = {name: float(value) for name, value in group.shapes.items()}
    by_place: dict[tuple[int, ...], dict[str, float]] = {}
    for (at, name), value in zip(group.labels, group.values(numbers).tolist(), strict=True):
        by_place.setdefault(at, {})[name] = value
    first, *others = by_place.values()
    if others and all(item == first for item in others):
        by_place = {group.at: first}
    return [EffectEntry(group.effect.id, at, {**values, **shapes}) for at, values in by_place.items()]


def _join(entries: list[EffectEntry], entry: EffectEntry, shapes: set[str], joints: int) -> None:
    """Enter an entry, added to what the arm has of the same effect, place and shapes. What it has at several places
    with that among them is taken apart: a size that only a sum makes possible is no file's."""
    for number, item in enumerate(entries):
        if item.effect != entry.effect or any(item.parameters.get(k) != entry.parameters.get(k) for k in shapes):
            continue
        places = item.at or (tuple(range(1, joints + 1)) if entry.at else ())
        if not set(entry.at) <= set(places) or (places and not entry.at):
            continue
        names = {**item.parameters, **entry.parameters}
        summed = {
            name: value if name in shapes else item.parameters.get(name, 0.0) + entry.parameters.get(name, 0.0)
            for name, value in names.items()
        }
        others = tuple(place for place in places if place not in entry.at)
        rest = [EffectEntry(item.effect, others, item.parameters)] if others else []
        entries[number : number + 1] = [*rest, EffectEntry(entry.effect, entry.at, summed)]
        return
    entries.append(entry)


def _readable(entry: EffectEntry) -> EffectEntry:
    """An entry whose sizes a file may hold."""
    effect = EFFECTS[entry.effect]
    limits = {size.name: (size.lower, size.upper) for size in (*effect.torque_sizes, *effect.shapes)}
    held = {
        name: min(max(value, limits[name][0]), limits[name][1]) if name in limits else value
        for name, value in entry.parameters.items()
    }
    return EffectEntry(entry.effect, entry.at, held)
