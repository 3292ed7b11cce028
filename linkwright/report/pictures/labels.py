"""Words in a drawing that must not stand on each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

LETTER = 0.56
"""Width of a letter, of its height."""


def width_of(words: str, size: float) -> float:
    """About how wide words of that size are drawn."""
    return LETTER * size * len(words)


@dataclass
class Levels:
    """Rows of words one above another: each goes to the first row where it is free from `low` to `high`."""

    rows: list[list[tuple[float, float]]] = field(default_factory=list[list[tuple[float, float]]])

    def placed(self, low: float, high: float) -> int:
        """The row that holds a span now."""
        for number, row in enumerate(self.rows):
            if all(high <= left or low >= right for left, right in row):
                row.append((low, high))
                return number
        self.rows.append([(low, high)])
        return len(self.rows) - 1


Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""


def free(box: Box, taken: Sequence[Box]) -> bool:
    """Whether a box overlaps none of the others."""
    return all(
        box[2] <= left or box[0] >= right or box[3] <= top or box[1] >= bottom for left, top, right, bottom in taken
    )
