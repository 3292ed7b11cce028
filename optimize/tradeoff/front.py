"""What a trade-off found: designs, the fronts that they make, and their envelope."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from linkwright.core.arm.chain.chain import Arm

from .question import Question

Figures = Mapping[str, Any]


@dataclass(frozen=True)
class Point:
    """A design on a front, numbered through from 1 over all fronts.

    `x` and `y` are its figures (SI) as `evaluate` gives them, `figures` all of them. `slope` is dy/dx along the front
    (SI), from the multiplier of the limit on x; None where no multiplier tells. `converged`: the exchange ended by
    itself; `certified`: the worst error is proved.
    """

    number: int
    front: str
    x: float
    y: float
    slope: float | None
    arm: Arm
    shapes: tuple[str | None, ...]
    materials: tuple[str | None, ...]
    figures: Figures
    converged: bool

    @property
    def certified(self) -> bool:
        """Whether no pose is worse than the upper bound."""
        return bool(self.figures["certified"])

    @property
    def unreached_share(self) -> float:
        """What share of a box or a path the design does not reach; its figures are of the rest."""
        return float(self.figures["unreached_share"])


@dataclass(frozen=True)
class Front:
    """The designs none of which is beaten in both figures, in order of x; points by their numbers.

    `error` is the largest relative error of y on a straight line between two points, measured half-way before the point
    there joined them. `steps` are pairs of neighbouring points between which y jumps: nothing between is gained by more
    x until the second. `idle` are stretches of x (SI) along which more x buys nothing. `failed` are values of x (SI) at
    which the solver found no design though there must be one. `capped`: the end with the best y is where the problem's
    limit on x ends it. `complete`: the refinement ended by itself and found a design wherever it looked.
    `exhaustive`: at every point each combination was solved, or excluded by what it cannot reach; `undecided` counts
    the points at which the solver failed on one that could be better.
    """

    name: str
    points: tuple[int, ...]
    knee: int | None
    error: float
    steps: tuple[tuple[int, int], ...]
    idle: tuple[tuple[float, float], ...]
    failed: tuple[float, ...]
    capped: bool
    complete: bool
    exhaustive: bool
    undecided: int = 0


@dataclass(frozen=True)
class Tradeoff:
    """A trade-off: its points, a front for each material or shape (or one for all), and the envelope of them.

    `without` are the names that have no design at all, with the reason. `logs`: whether x and y span more than a factor
    of ten. `solved` counts the points solved, those without a design among them.
    """

    asked: Question
    accuracy: float
    points: tuple[Point, ...]
    fronts: tuple[Front, ...]
    envelope: Front
    without: tuple[tuple[str, str], ...]
    logs: tuple[bool, bool]
    seconds: float
    solved: int
    interrupted: bool = False
    """Whether an interrupt ended the work: these are then the points that it had."""
    start: str | None = None
    """Why the search began with other lengths than those of the arm as given, where that does not reach what is
    asked."""

    def of(self, front: Front) -> tuple[Point, ...]:
        """The points of a front."""
        return tuple(self.points[number - 1] for number in front.points)
