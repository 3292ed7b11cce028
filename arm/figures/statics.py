"""A figure that follows from the statics of a pose: the greatest of some of its values, or the least."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.compiled.vectorise import Expressions
from linkwright.core.arm.errors.model import beam_symbols, symbolic_beams
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.arm.limits.weakest_poses import climbed
from linkwright.core.sections.numeric import Array, column_of_symbols

from .design import DesignExpressions, Designs, DesignValues
from .figure import Asked, Cut, FigureResult, Held, PoseFamily, ThroughPoses, Worst

if TYPE_CHECKING:
    from linkwright.core.arm.worst.search import WorstSearch

Values = Callable[[PoseState], Sequence[Any]]
_CLIMBS = 4
"""Climbs for each value."""


@dataclass(frozen=True)
class Extreme:
    """The greatest of a value (the least where that counts) over a workspace and load cases, with its pose and case."""

    value: float
    q: tuple[float, ...]
    load_case: int


@by_structure
def statics_case(arm: Arm, load: LoadCase, values: Values) -> Expressions:
    """Values of an arm's state under a load case, for symbols (q, p)."""
    q, p = column_of_symbols("q", arm.size), beam_symbols(arm)
    state = solve(arm, parts(q), symbolic_beams(arm, p), load)
    return Expressions((q, p), (ca.vertcat(ca.SX(0, 1), *[ca.SX(value) for value in values(state)]),))


def greatest(
    cases: Sequence[Callable[[Array], Array]], poses: Array, p: Array, search: WorstSearch | None
) -> list[Extreme]:
    """The greatest of each of K values (N, K) of poses (N, n), which each load case gives, over poses; with `search`
    over its workspace, the poses being where climbs start."""
    if search is not None:
        climbs = [climbed(search, case, poses, p, _CLIMBS, least=-np.inf) for case in cases]
        poses = np.vstack([poses, *climbs])
    values = np.stack([case(poses) for case in cases])
    extremes: list[Extreme] = []
    for item in np.moveaxis(values, -1, 0):
        case, pose = np.unravel_index(int(np.argmax(item)), item.shape)
        extremes.append(Extreme(float(item[case, pose]), tuple(poses[int(pose)].tolist()), int(case)))
    return extremes


def at_poses(name: str, values: Values, *, least: bool = False, either_way: bool = False) -> ThroughPoses:
    """How a figure of that name follows from statics: `values` are one or more of a pose's state (floats or symbols),
    the greatest of which counts over the workspace and all load cases, the `least` where more is better. `either_way`:
    their sizes count, whatever their signs.

    >>> import linkwright as lw
    >>> def pressed(state: lw.PoseState) -> list[object]:
    ...     return [joint.force[1] for joint in state.joints]
    >>> lw.at_poses("joint_force", pressed, either_way=True).family.name
    'joint_force'
    """
    return ThroughPoses(Extremes(name, values, least=least, either_way=either_way))


class OfStatics(PoseFamily[FigureResult]):
    """The greatest of some values of a pose's state, or the least, or the greatest of their sizes."""

    needs = frozenset({"masses"})

    def __init__(
        self, name: str, values: Values, *, least: bool = False, either_way: bool = False, called: str = ""
    ) -> None:
        """`name`: that of the figure."""
        self.name, self.called = name, called or name
        self._values, self._sign, self._either_way = values, -1.0 if least else 1.0, either_way

    def prepare(self, problem: Asked) -> tuple[Expressions, ...]:
        """The values under each load case."""
        return self.cases(problem.arm, problem.load_cases)

    def cases(self, arm: Arm, loads: Sequence[LoadCase]) -> tuple[Expressions, ...]:
        """The values under each load case."""
        return tuple(statics_case(arm, load, self._values) for load in loads)

    def rows(
        self,
        prepared: tuple[Expressions, ...],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """Each value over what is allowed."""
        values = prepared[group].function(pose[0], design.beam_column)
        for number, limit, slack in held.on(self.name):
            for k in range(values.numel()):
                for side in (1.0, -1.0) if self._either_way else (1.0,):
                    yield number, self._sign * (side * values[k] / limit - ca.exp(self._sign * slack))

    def _badness(self, case: Expressions, q: Array, p: Array) -> Array:
        values = np.asarray(case.vectorised(q, p)[0])
        return self._sign * (np.abs(values) if self._either_way else values)

    def each(self, design: DesignValues, cases: Sequence[Expressions]) -> list[Extreme]:
        """Each value where it is worst."""

        def signed(case: Expressions, q: Array) -> Array:
            return self._badness(case, q, design.p)

        extremes = greatest([partial(signed, case) for case in cases], design.poses, design.p, design.search)
        return [Extreme(self._sign * extreme.value, extreme.q, extreme.load_case) for extreme in extremes]

    def worst(self, prepared: tuple[Expressions, ...], problem: Asked, design: DesignValues) -> list[Worst]:
        """Each value where it is worst."""
        del problem
        return [Worst(self.name, item.value, Cut(item.q, item.load_case)) for item in self.each(design, prepared)]

    def at_pose(self, prepared: tuple[Expressions, ...], group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The worst value of each design at its pose."""
        badness = self._badness(prepared[group], q, designs.p)
        return {self.name: self._sign * badness.max(axis=1) if badness.size else np.full(len(q), np.nan)}


class Extremes(OfStatics[Extreme]):
    """The worst of all values, and where it is."""

    def evaluate(self, design: DesignValues) -> Extreme | None:
        """The worst of all values; None where there is none."""
        every = self.each(design, self.cases(design.arm, design.load_cases))
        return min(every, key=lambda item: -self._sign * item.value, default=None)

    def values(self, result: Extreme) -> Mapping[str, float | None]:
        """The worst value."""
        return {self.name: result.value}
