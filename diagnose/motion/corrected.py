"""The arm with what was identified among its effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS, without_zeros
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.sections.numeric import Array

from .model.entries import entries_of, with_entries
from .model.groups import Group
from .model.ripple import Ripple


def entry_of(effect: Effect, ripple: Ripple) -> EffectEntry:
    """The entry of an order that stands out beyond the low-pass."""
    sine, cosine = (size.name for size in effect.torque_sizes)
    values = {sine: ripple.sine, cosine: ripple.cosine, effect.torque_shapes[0].name: ripple.order}
    return EffectEntry(effect.id, (ripple.joint + 1,), values)


def completed(arm: Arm, groups: Sequence[Group], numbers: Sequence[Array], more: Sequence[EffectEntry] = ()) -> Arm:
    """The arm with entries for groups by their numbers (SI), joined to what it has of the same effect, place
    and shapes, and `more`."""
    joined = with_entries(
        arm, [e for group, values in zip(groups, numbers, strict=True) for e in entries_of(group, values)]
    )
    effects = without_zeros([_readable(entry) for entry in (*joined.effects, *more)], arm.effects)
    return replace(arm, effects=effects)


def _readable(entry: EffectEntry) -> EffectEntry:
    """An entry whose sizes a file may hold."""
    effect = EFFECTS[entry.effect]
    limits = {size.name: (size.lower, size.upper) for size in (*effect.torque_sizes, *effect.torque_shapes)}
    held = {
        name: min(max(value, limits[name][0]), limits[name][1]) if name in limits else value
        for name, value in entry.parameters.items()
    }
    return EffectEntry(entry.effect, entry.at, held)
