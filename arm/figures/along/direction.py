"""A figure that takes a direction, and how a direction is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from linkwright.core.arm.figures.figure import Figure

Direction = tuple[float, float, float]
"""A unit vector in the base frame."""


@dataclass(frozen=True)
class Directed:
    """A figure that takes a direction.

    Attributes:
        name: its key in problem files.
        word: the key of its direction.
        figure: the figure along a direction.
        synonyms: what people call it as well.
    """

    name: str
    word: str
    figure: Callable[[Direction], Figure]
    synonyms: tuple[str, ...] = ()


def direction_words(direction: Direction) -> str:
    """A direction as people read it: `(0, 0, 1)`."""
    return f"({', '.join(f'{x + 0.0:.6g}' for x in direction)})"


def direction_key(direction: Direction) -> str:
    """A direction as part of a key in JSON: `0_0_1`."""
    return "_".join(f"{x + 0.0:.6g}" for x in direction)
