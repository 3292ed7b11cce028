"""How a rule is written: a field of a frozen dataclass that knows its unit, its reason and its source."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields, is_dataclass
from types import MappingProxyType
from typing import Any, TypeVar

Value = TypeVar("Value", int, float, tuple[int, ...], tuple[float, float], tuple[float, float, float])

PROOF = "chosen on the proof's disclosed half"
JUDGED = "judged; no figure is published"
TIME = "computing time"


@dataclass(frozen=True)
class Rule:
    """One rule as a page shows it: `name` within its stage, value, unit, why there is such a rule and why this value,
    where the value comes from, and why it may change with one more reading (empty: it does not)."""

    stage: str
    name: str
    value: int | float | tuple[float, ...]
    unit: str
    reason: str
    source: str
    rows: str

    @property
    def path(self) -> str:
        """`search.false_alarm`: how the rule is reached from a `Rules`."""
        return f"{self.stage}.{self.name}"


def rule(value: Value, unit: str, reason: str, source: str = JUDGED, *, rows: str = "") -> Value:
    """The default of a dataclass field that is a rule. `rows` says why it takes effect at some number of readings,
    visits or poses, where it does; what counts those must say so.

    To a type checker it is the value itself, which is what the field holds.
    """
    about = MappingProxyType({"unit": unit, "reason": reason, "source": source, "rows": rows})
    made: Any = field(default=value, metadata=about)
    return made


def rules_in(rules: object) -> Iterator[Rule]:
    """Every rule of a `Rules`, stage by stage, in the order in which they are written."""
    for stage in _fields(rules):
        stage_rules = getattr(rules, stage.name)
        for item in _fields(stage_rules):
            yield Rule(stage.name, item.name, getattr(stage_rules, item.name), **item.metadata)


def _fields(instance: object) -> tuple[Field[Any], ...]:
    return fields(instance) if is_dataclass(instance) else ()
