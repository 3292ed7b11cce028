"""Rules that remember which of them were asked, and rules of which one is another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

from linkwright.core.diagnose.rules.rule import Rule
from linkwright.core.diagnose.rules.rules import Rules


def watched(rules: Rules, asked: set[str]) -> Rules:
    """The same rules; whichever is consulted adds its path (`search.margin`) to `asked`."""
    stages = {each.name: _watched(getattr(rules, each.name), each.name, asked.add) for each in fields(rules)}
    return Rules(**stages)


def _watched(stage: Any, name: str, hear: Callable[[str], None]) -> Any:
    kind: Any = type(stage)
    own = frozenset(each.name for each in fields(stage))

    def heard(self: Any, key: str) -> Any:
        if key in own:
            hear(f"{name}.{key}")
        return object.__getattribute__(self, key)

    listening: Any = type(kind.__name__, (kind,), {"__getattribute__": heard})
    return listening(**{key: getattr(stage, key) for key in own})


def perturbed(rules: Rules, rule: Rule, factor: float) -> Rules:
    """The rules with one of them times `factor`; a whole number by one at least, and never below one."""
    stage = getattr(rules, rule.stage)
    values = rule.value if isinstance(rule.value, tuple) else (rule.value,)
    other = tuple(_times(value, factor) for value in values)
    changed: Any = other if isinstance(rule.value, tuple) else other[0]
    return replace(rules, **{rule.stage: replace(stage, **{rule.name: changed})})


def _times(value: float, factor: float) -> float:
    if not isinstance(value, int):
        return value * factor
    moved = round(value * factor)
    return max(1, moved if moved != value else value + (1 if factor > 1.0 else -1))
