"""What the library has no entry for: a class draws where and how it acts, and writes itself into a plan at any size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.multibody.causes import Stage
from benchmarks.multibody.session import Plan

Act = Callable[[Plan, float], None]


@dataclass(frozen=True)
class Unknown:
    """One draw of a class: `act` writes it at a size (1 is middling); which joints (from 1) it sits at, what it depends
    on in a recording's words, and between which times (s), where it is not always there."""

    name: str
    act: Act
    joints: tuple[int, ...] = ()
    depends_on: frozenset[str] = field(default_factory=frozenset)
    since: float | None = None
    until: float | None = None


Draw = Callable[[Stage, np.random.Generator], Unknown]


@dataclass(frozen=True)
class UnknownClass:
    """A class of unknowns: its name, what it is in words, how it is drawn, and which arms can have it."""

    name: str
    words: str
    draw: Draw
    needs: frozenset[str] = frozenset()
