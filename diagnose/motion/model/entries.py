"""Groups as entries of an arm file, joined to those that an arm has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.sections.numeric import Array

from .groups import Group


def with_entries(arm: Arm, more: Sequence[EffectEntry]) -> Arm:
    """The arm with entries joined to what it has of the same effect, place and shapes, whatever a file may hold."""
    entries = list(arm.effects)
    for entry in more:
        _join(entries, entry, {shape.name for shape in EFFECTS[entry.effect].torque_shapes}, arm.size)
    return replace(arm, effects=tuple(entries))


def entries_of(group: Group, numbers: Array) -> list[EffectEntry]:
    """A group's entries by its numbers (SI)."""
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
