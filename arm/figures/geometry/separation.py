"""How far an arm keeps from what it is to avoid: the least over its workspace, a link as thick as its section reaches.

A cut is a pose with the points of the pieces that come nearest there. At that pose any other design is at most as far
away as these points of it are, so that every cut is valid for every design.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.avoid.obstacle import Obstacle, Piece, pieces
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity

from ..design import DesignExpressions, DesignValues
from ..figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from ..statics import greatest

_ASSUMED = 1e-3
"""m that are kept where nobody says how much."""
_SCALE = 0.02
"""m; rows over it are of the order of one, as those of other limits are."""


@dataclass(frozen=True)
class CollisionPair:
    """One piece of an arm (by number) and an obstacle, or two pieces of which an obstacle asks that they keep clear."""

    obstacle: Obstacle
    numbers: tuple[int, ...]

    def of(self, parts: Sequence[Piece]) -> list[Piece]:
        """The pieces of an arm that it is asked of."""
        return [parts[number] for number in self.numbers]


@dataclass(frozen=True)
class Prepared:
    """A problem's arm, and all that is asked of it."""

    arm: Arm
    asked: tuple[CollisionPair, ...]


@dataclass(frozen=True)
class Nearest:
    """The least separation (m), the pose that has it, and what comes near what there."""

    value: float
    q: tuple[float, ...]
    words: str


def collision_pairs(arm: Arm) -> tuple[CollisionPair, ...]:
    """All that is asked of an arm."""
    parts = list(pieces(arm, [0.0] * arm.size))
    return tuple(CollisionPair(obstacle, numbers) for obstacle in arm.avoid for numbers in obstacle.asks(parts))


def _gaps(arm: Arm, asked: Sequence[CollisionPair], q: Array) -> Array:
    """By how much each is clear (N, K) at poses q (N, n), m."""
    parts = list(pieces(arm, list(q.T)))
    return np.stack([one.obstacle.closest(one.of(parts), len(q))[0] for one in asked], axis=1)


class Separations(PoseFamily[Nearest]):
    """The separation of every piece of an arm from everything that is to be avoided."""

    name: str = "separation"
    called: str = "separation"
    bounds_many: ClassVar[bool] = False
    thinner_is_better: ClassVar[bool] = True

    def prepare(self, problem: Asked) -> Prepared:
        """The arm and what is asked of it. Raises `InputError` where nothing is to be avoided."""
        asked = collision_pairs(problem.arm)
        if not asked:
            raise InputError(
                "", "subject_to.separation", "needs what to keep clear of, e.g. avoid: [{below: {y: 0 mm}}]"
            )
        return Prepared(problem.arm, asked)

    def groups(self, problem: Asked) -> int:
        """One for each piece and what it keeps clear of."""
        return len(collision_pairs(problem.arm))

    def more(self, prepared: Prepared) -> int:
        """Where along the pieces they come nearest."""
        del prepared
        return 2

    def load_case(self, cut: Cut) -> int:
        """Any: what the arm carries moves nothing here."""
        del cut
        return 0

    def rows(
        self,
        prepared: Prepared,
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """What is asked less the gap at those points."""
        asked, lengths = prepared.asked[group], [beam.length for beam in design.beams]
        every = list(pieces(prepared.arm, parts(pose[0]), lengths, design.radii))
        gap = asked.obstacle.gap(asked.of(every), parts(pose[1]))
        for number, limit, slack in held.on(self.name):
            yield number, (limit * ca.exp(-slack) - gap) / _SCALE

    def evaluate(self, design: DesignValues) -> Nearest | None:
        """The nearest over the workspace; None where nothing is to be avoided."""
        asked = collision_pairs(design.arm)
        if not asked:
            return None
        worst = min(self._each(asked, design), key=lambda item: item.value)
        one = asked[worst.cut.group]
        names = [part.name for part in one.of(list(pieces(design.arm, [0.0] * design.arm.size)))]
        words = " and ".join(names) if len(names) > 1 else f"{names[0]} and {one.obstacle.words}"
        return Nearest(worst.value, worst.cut.q, words)

    def values(self, result: Nearest) -> Mapping[str, float | None]:
        """The least."""
        return {self.name: result.value}

    def worst(self, prepared: Prepared, problem: Asked, design: DesignValues) -> list[Worst]:
        """Each piece where it comes nearest to each thing."""
        del problem
        return self._each(prepared.asked, design)

    def _each(self, asked: Sequence[CollisionPair], design: DesignValues) -> list[Worst]:
        arm = design.arm
        nearest = greatest([lambda q: -_gaps(arm, asked, q)], design.poses, design.p, design.search)
        cuts = (self._cut(arm, one, group, np.array(nearest[group].q)) for group, one in enumerate(asked))
        return [Worst(self.name, gap, cut) for gap, cut in cuts]

    @staticmethod
    def _cut(arm: Arm, one: CollisionPair, group: int, q: Array) -> tuple[float, Cut]:
        (gap,), (shares,) = one.obstacle.closest(one.of(list(pieces(arm, list(q[None].T)))), 1)
        return float(gap), Cut(tuple(q.tolist()), group, tuple(shares.tolist()))

    def at_cut(self, prepared: Prepared, problem: Asked, arm: Arm, cut: Cut) -> float:
        """The gap there of one design."""
        del problem
        return self._cut(arm, prepared.asked[cut.group], cut.group, np.array(cut.q))[0]

    def warnings(self, arm: Arm, result: Nearest) -> Sequence[str]:
        """A line where something is met."""
        del arm
        if result.value >= 0.0:
            return ()
        return (f"{result.words} come {format_quantity(-result.value, 'length', digits=3)} into each other",)


def _where(result: Nearest) -> tuple[float, ...]:
    return result.q


def _assumed(problem: Asked) -> float | None:
    """A problem that says what to avoid means it."""
    return _ASSUMED if problem.avoid else None


SEPARATIONS = Separations()
"""The separation from what is to be avoided."""

SEPARATION = Figure(
    name="separation",
    synonyms=("gap", "safety_distance", "collision_distance"),
    title="separation",
    senses=(">=",),
    key="separation_mm",
    follows=ThroughPoses(SEPARATIONS),
    kind="length",
    unit="mm",
    factor=1e3,
    more_is_better=True,
    note="least, from what is to be avoided",
    where=_where,
    # It may be negative, which no axis of reciprocals can show.
    traded=False,
    everywhere=False,
    assumed=_assumed,
)
