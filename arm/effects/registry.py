"""The registry of effects; `arm.effects` ships its own into it, users and installed packages add theirs."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.registries import Registry

from .effect import Effect


def _fault(entry: object) -> str | None:
    return None if isinstance(entry, Effect) else f"an effect must be an Effect, not {entry!r}"


EFFECTS: Registry[Effect] = Registry("effect", "linkwright.effects", lambda effect: effect.id, _fault)


def parameter_title(effect: str, parameter: str) -> str:
    """How tables and sentences call a parameter of the effect of an id, or of what is no effect (an event's, say)."""
    known = EFFECTS[effect].parameters if effect in EFFECTS else ()
    titles = {item.name: item.title for item in known}
    return titles.get(parameter, parameter.replace("_", " "))


def without_zeros(entries: Sequence[EffectEntry], given: Sequence[EffectEntry]) -> tuple[EffectEntry, ...]:
    """The entries but those of which every number is zero, shapes aside, and that are none of the `given` ones."""
    return tuple(entry for entry in entries if entry in given or not _is_zero(entry))


def _is_zero(entry: EffectEntry) -> bool:
    shapes = {item.name for item in EFFECTS[entry.effect].parameters if item.role in ("shape", "torque_shape")}
    sizes = [value for name, value in entry.parameters.items() if name not in shapes]
    return bool(sizes) and not any(sizes)
