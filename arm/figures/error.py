"""The errors of the tip over the workspace and all load cases: the worst, and the average.

The average is the root of the mean square, of the load case in which that is greatest. It is over the poses that a
workspace lists, by their weights, over its points or along its path, and over poses spread evenly elsewhere. Play
stands at each pose as it does for the worst error.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import CaseModel, ErrorModel, beam_values, beams_of, error_model
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.search import WorstCase
from linkwright.core.arm.worst.workspace import Unreachable, place_shares, weights_of_points
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, Designs, DesignValues
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst, WorstError
from .limit import Limit

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.worst.search import WorstSearch
    from linkwright.core.arm.worst.workspace import Workspace

SPREAD = 192
"""Poses that a workspace which lists none is looked at in."""
_MOST_AT_ONCE = 4_000_000
"""Designs times poses that are looked at together."""
_MOST_SHOWN = 3
"""Worst poses that become rows together."""
_THERE = 1e-6
"""m; a tip this near to a point is there."""
_FLOOR = 1e-24
"""Keeps the logarithm of an error of zero (m^2, rad^2) finite."""


@dataclass(frozen=True)
class AverageError:
    """The root mean square of the error (m) of each load case, over so many `poses`."""

    by_case: tuple[float, ...]
    poses: int


@dataclass(frozen=True)
class PreparedAverage:
    """The model, and the poses (N, n) with their shares (N), which add up to one."""

    model: ErrorModel
    poses: Array
    shares: Array

    @property
    def plays(self) -> int:
        """The most intervals of play that a load case has."""
        return _plays(self.model)


def averaged_over(search: WorstSearch, p: Array) -> tuple[Array, Array]:
    """The poses (N, n) of a workspace that an average is over, and how much each of them counts, (N)."""
    poses = search.poses(p, SPREAD)
    if search.workspace.kind == "joints":
        poses = poses[:SPREAD]  # the rest are corners
    weights = np.array(search.workspace.weights) if search.workspace.weights else np.ones(len(poses))
    if search.workspace.kind == "path":
        weights = place_shares(search.workspace, search.tip(poses, p))
        weights = weights * weights_of_points(search.workspace, search.tip(poses, p))
    return poses, weights / weights.sum()


class Average(PoseFamily[AverageError]):
    """The average over all poses at once: a cut holds where play stands at each of them."""

    name: str = "average_error"
    is_error: ClassVar[bool] = True
    bounds_many: ClassVar[bool] = False

    def prepare(self, problem: Asked) -> PreparedAverage:
        """The poses of the workspace, which do not change with the design."""
        search = worst_search(error_model(problem.arm, problem.load_cases), problem.workspace)
        given = beam_values(beams_of(problem.arm, problem.load_cases))
        return PreparedAverage(search.model, *averaged_over(search, given))

    def more(self, prepared: PreparedAverage) -> int:
        """Of each pose the side of each play and how far clearances move the tip."""
        return len(prepared.poses) * (prepared.plays + 3)

    def rows(
        self, prepared: PreparedAverage, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The root mean square over what is allowed, in logarithms."""
        case, width = prepared.model.cases[group], prepared.plays + 3
        total: Any = 0.0
        for number, (q, share) in enumerate(zip(prepared.poses, prepared.shares.tolist(), strict=True)):
            vector = _displaced(case, ca.SX(q), pose[1][width * number : width * (number + 1)], design)
            total = total + share * ca.dot(vector, vector)
        for number, value, slack in held.on(self.name):
            yield number, 0.5 * ca.log(total + _FLOOR) - ca.log(value) - slack

    def evaluate(self, design: DesignValues) -> AverageError | None:
        """The average of each load case; None where only a part of the error counts, or at the worst instants of a
        cycle."""
        search = design.search
        if search.workspace.error != "whole" or any(case.moving is not None for case in design.load_cases):
            return None
        poses, shares = averaged_over(search, design.p)
        errors = [search.errors(poses, design.p, case).error for case in range(len(design.load_cases))]
        return AverageError(tuple(_mean(error, shares) for error in errors), len(poses))

    def values(self, result: AverageError) -> Mapping[str, float | None]:
        """The greatest of any load case."""
        return {self.name: max(result.by_case)}

    def worst(self, prepared: PreparedAverage, problem: Asked, design: DesignValues) -> list[Worst]:
        """The average of each load case, with where play stands."""
        del problem
        worst: list[Worst] = []
        for group in range(len(prepared.model.cases)):
            error = design.search.errors(prepared.poses, design.p, group)
            plays = np.zeros((len(prepared.poses), prepared.plays))
            plays[:, : error.signs.shape[1]] = error.signs
            row = np.hstack([plays, error.shifts.sum(axis=1)])
            place = (0.0,) * prepared.poses.shape[1]
            cut = Cut(place, group, tuple(row.ravel().tolist()))
            worst.append(Worst(self.name, _mean(error.error, prepared.shares), cut))
        return worst

    def exactly(self, prepared: PreparedAverage, limit: Limit, designs: Designs) -> Array | None:
        """The average of each design; None where there are too many to look at."""
        del limit
        if len(designs.p) * len(prepared.poses) > _MOST_AT_ONCE:
            return None
        return np.max([self._means(prepared, case, designs.p) for case in prepared.model.cases], axis=0)

    def _means(self, prepared: PreparedAverage, case: CaseModel, p: Array) -> Array:
        total = np.zeros(len(p))
        for q, share in zip(prepared.poses, prepared.shares.tolist(), strict=True):
            total += share * _played(prepared.model, case, np.broadcast_to(q, (len(p), len(q))), p) ** 2
        return np.sqrt(total)


def _mean(errors: Array, shares: Array) -> float:
    return float(np.sqrt(shares @ errors**2))


class SearchedError(PoseFamily[WorstCase]):
    """The worst over a workspace of what counts of the tip's error, by a separate search without a certificate: a cut
    holds where play stands beside the pose. `name` is that of its figure."""

    is_error: ClassVar[bool] = True

    @abstractmethod
    def search(self, arm: Arm, cases: Sequence[LoadCase], workspace: Workspace) -> WorstSearch:
        """What counts of the error of an arm under load cases, over a workspace."""

    def prepare(self, problem: Asked) -> WorstSearch:
        """The search."""
        return self.search(problem.arm, problem.load_cases, problem.workspace)

    def evaluate(self, design: DesignValues) -> WorstCase | None:
        """The worst of it."""
        return self.search(design.arm, design.load_cases, design.search.workspace).worst(design.p, certify=False)

    def case(self, group: int) -> int | None:
        """Which of the model's cases tells of a load case; None where none does."""
        return group

    def group(self, case: int) -> int:
        """The load case of one of the model's cases."""
        return case

    def more(self, prepared: WorstSearch) -> int:
        """The side of each play, and how far clearances move the tip."""
        return _plays(prepared.model) + 3

    def rows(
        self, prepared: WorstSearch, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The error over what is allowed, in logarithms."""
        number = self.case(group)
        if number is None:
            return
        vector = _displaced(prepared.model.cases[number], pose[0], pose[1], design)
        for number, value, slack in held.on(self.name):
            yield number, 0.5 * ca.log(ca.dot(vector, vector) + _FLOOR) - ca.log(value) - slack

    def values(self, result: WorstCase) -> Mapping[str, float | None]:
        """The worst of it."""
        return {self.name: result.error}

    def worst(self, prepared: WorstSearch, problem: Asked, design: DesignValues) -> list[Worst]:
        """The worst poses, with where play stands."""
        del problem
        worst: list[Worst] = []
        for pose in self.worst_case(prepared, design).poses[:_MOST_SHOWN]:
            shift = np.reshape(pose.shifts, (-1, 3)).sum(axis=0).tolist()
            signs = (*pose.signs, *[0.0] * (_plays(prepared.model) - len(pose.signs)))
            worst.append(Worst(self.name, pose.error, Cut(pose.q, self.group(pose.load_case), (*signs, *shift))))
        return worst

    def worst_case(self, prepared: WorstSearch, design: DesignValues) -> WorstCase:
        """The worst of it for a design, without a certificate."""
        return prepared.worst(design.p, certify=False)

    def at_pose(self, prepared: WorstSearch, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The error of each design at its pose."""
        case = self.case(group)
        return {} if case is None else {self.name: _played(prepared.model, prepared.model.cases[case], q, designs.p)}


def _plays(model: ErrorModel) -> int:
    """The most intervals of play that a load case has."""
    return max(len(case.error.intervals) for case in model.cases)


def _displaced(case: CaseModel, q: Any, play: Any, design: DesignExpressions) -> Any:
    """The tip's error at a pose in symbols; `play` holds the side of each interval and, last, how far clearances move
    the tip."""
    outputs = case.function(q, design.beam_column)
    vector = outputs[0] + play[play.numel() - 3 :]
    for k in range(len(case.error.intervals)):
        vector = vector + play[k] * outputs[1][3 * k : 3 * k + 3]
    return vector


def _played(model: ErrorModel, case: CaseModel, q: Array, p: Array) -> Array:
    """The errors (N,) at poses q (N, n) of designs p (N, m), with the play where the arm's mode puts it."""
    arm, arrays = model.arm, case.arrays(q, p)
    return played(arrays, case.radii, arm.play, planar=model.planar, statistics=arm.statistics).error


class SingleError(SearchedError):
    """The worst error under one load case or at one point, which a limit of its own is on."""

    @abstractmethod
    def part(self, cases: Sequence[LoadCase], workspace: Workspace) -> tuple[Sequence[LoadCase], Workspace]:
        """The load cases and the workspace that count, of all."""

    def search(self, arm: Arm, cases: Sequence[LoadCase], workspace: Workspace) -> WorstSearch:
        """The error where it counts."""
        counted, places = self.part(cases, workspace)
        return worst_search(error_model(arm, counted), places)


class CaseError(SingleError):
    """The worst error under one load case (from 0)."""

    def __init__(self, case: int) -> None:
        self.number, self.name = case, f"max_error of load case {case + 1}"

    def part(self, cases: Sequence[LoadCase], workspace: Workspace) -> tuple[Sequence[LoadCase], Workspace]:
        """This load case, wherever."""
        return (cases[self.number],), workspace

    def case(self, group: int) -> int | None:
        """The only one."""
        return 0 if group == self.number else None

    def group(self, case: int) -> int:
        """This one."""
        del case
        return self.number


def error_of_case(case: int) -> Figure:
    """The worst error under one load case (from 0), which a limit of that case's own is on."""
    return _part_figure(CaseError(case), f"worst error of load case {case + 1}")


def _part_figure(family: SingleError, title: str) -> Figure:
    return Figure(
        name=family.name,
        title=title,
        kind="length",
        unit="mm",
        factor=1e3,
        senses=("<=",),
        key=f"{family.name.replace(' ', '_')}_mm",
        follows=ThroughPoses(family),
        traded=False,
        digits=5,
    )


class PointError(SingleError):
    """The worst error at one of the points (from 0) that a workspace lists, over all load cases."""

    def __init__(self, number: int) -> None:
        self.number, self.name = number, f"max_error at point {number + 1}"

    def part(self, cases: Sequence[LoadCase], workspace: Workspace) -> tuple[Sequence[LoadCase], Workspace]:
        """This point, under all load cases."""
        return cases, replace(workspace, points=(workspace.points[self.number],))

    def at_pose(self, prepared: WorstSearch, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The error of each design at its pose; nothing of it counts at the poses of other points."""
        target = np.array(prepared.workspace.points[0])
        away = (prepared.tip(q, designs.p[0]) - target)[:, : 2 if prepared.workspace.in_plane else 3]
        errors = super().at_pose(prepared, group, q, designs)[self.name]
        return {self.name: np.where(np.linalg.norm(away, axis=1) < _THERE, errors, 0.0)}

    def evaluate(self, design: DesignValues) -> WorstCase | None:
        """The worst error there; None where no pose reaches it."""
        try:
            return super().evaluate(design)
        except Unreachable:
            return None


def error_at_point(number: int) -> Figure:
    """The worst error at a point (from 0) of a workspace, which a limit of that point's own is on."""
    return _part_figure(PointError(number), f"worst error at point {number + 1}")


AVERAGE = Average()
"""The average over a workspace."""

AVERAGE_ERROR = Figure(
    name="average_error",
    synonyms=("mean_error", "rms_error", "rms", "average", "mean"),
    title="average error",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=("<=",),
    key="average_error_mm",
    follows=ThroughPoses(AVERAGE),
    note="root mean square over the workspace",
    everywhere=False,
)

MAX_ERROR = Figure(
    name="max_error",
    synonyms=("deflection", "displacement", "error", "position_error", "worst_error", "accuracy", "sag", "deformation"),
    title="worst error",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=("<=",),
    key="max_error_mm",
    follows=WorstError(),
    digits=5,
)
