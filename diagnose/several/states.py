"""States of an arm at several recordings' readings as one: what differs becomes a column of all readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, TypeVar

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.kinematics import Orientation
from linkwright.core.arm.chain.vectors import Scalar

Held = TypeVar("Held")


@dataclass(frozen=True)
class ConditionsOfSeveral(Conditions):
    """Conditions of the readings of several recordings, each with its past: a lag begins anew with each that does
    not go on from another."""

    parts: tuple[Conditions, ...] = ()
    counts: tuple[int, ...] = ()

    def lagged_warming(self, link: int, lag: float) -> Scalar:
        """The warming of `link` (from 0) behind a lag of `lag` s, by recording."""
        return _column([part.lagged_warming(link, lag) for part in self.parts], self.counts)


def joined(held: Sequence[Held], counts: Sequence[int]) -> Held:
    """What is held of several recordings with so many readings each, as one: arms are the first's (but for which
    branch the tip is of), numbers
    that agree stay numbers, others become columns."""
    return _joined(list(held), tuple(counts))


def _joined(held: list[Any], counts: tuple[int, ...]) -> Any:
    first = held[0]
    if isinstance(first, Arm):
        return replace(first, branches=_joined([item.branches for item in held], counts)) if first.branches else first
    if isinstance(first, Conditions):
        return _conditions(held, counts)
    if isinstance(first, Orientation) and any(item.axis != first.axis for item in held):
        # A joint of a branch is at rest where the tip is another's: the last turn is no common one.
        return Orientation(_joined([item.matrix() for item in held], counts), (0.0, 0.0, 1.0), 0.0)
    if is_dataclass(first) and not isinstance(first, type):
        changed = {field.name: _joined([getattr(h, field.name) for h in held], counts) for field in fields(first)}
        return replace(first, **changed)
    if isinstance(first, tuple):
        parts = [_joined(list(of), counts) for of in zip(*held, strict=True)]
        return first.__class__(*parts) if hasattr(first, "_fields") else tuple(parts)
    if isinstance(first, np.ndarray) or (isinstance(first, int | float) and not isinstance(first, bool)):
        return _column(held, counts)
    return first


def _conditions(held: list[Conditions], counts: tuple[int, ...]) -> Conditions:
    names = [field.name for field in fields(Conditions) if field.name != "past"]
    plain = {name: [getattr(item, name) for item in held] for name in names}
    conditions = {name: None if any(p is None for p in of) else _joined(of, counts) for name, of in plain.items()}
    return ConditionsOfSeveral(**conditions, parts=tuple(held), counts=counts)


def _column(held: Sequence[Any], counts: Sequence[int]) -> Any:
    if all(isinstance(item, int | float) and item == held[0] for item in held):
        return held[0]
    return np.concatenate(
        [np.broadcast_to(np.asarray(item, float), (count,)) for item, count in zip(held, counts, strict=True)]
    )
