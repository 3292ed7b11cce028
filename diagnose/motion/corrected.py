"""The arm with what was identified among its effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, EffectEntry
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
            _join(entries, entry, {shape.name for shape in group.effect.shapes})
    return replace(arm, effects=(*entries, *more))


def _entries(group: Group, numbers: Array) -> list[EffectEntry]:
    shapes = {name: float(value) for name, value in group.shapes.items()}
    by_place: dict[tuple[int, ...], dict[str, float]] = {}
    for (at, name), value in zip(group.labels, group.values(numbers).tolist(), strict=True):
        by_place.setdefault(at, {})[name] = value
    first, *others = by_place.values()
    if others and all(item == first for item in others):
        by_place = {group.at: first}
    return [EffectEntry(group.effect.id, at, {**values, **shapes}) for at, values in by_place.items()]


def _join(entries: list[EffectEntry], entry: EffectEntry, shapes: set[str]) -> None:
    for number, item in enumerate(entries):
        same = item.effect == entry.effect and item.at == entry.at
        if same and all(item.parameters.get(name) == entry.parameters.get(name) for name in shapes):
            names = {**item.parameters, **entry.parameters}
            summed = {
                name: value if name in shapes else item.parameters.get(name, 0.0) + entry.parameters.get(name, 0.0)
                for name, value in names.items()
            }
            entries[number] = EffectEntry(entry.effect, entry.at, summed)
            return
    entries.append(entry)
