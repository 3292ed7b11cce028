"""The worst error across or along a path: each straight piece has a separate direction, and so a part of the error.

A piece's poses are searched with the error projected, by the same search, and the same certificate, as the whole error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.errors.parts import Part, onto, part_of
from linkwright.core.sections.numeric import Array

from .search import DEFAULT_GAP, WorstCase, WorstPose, WorstSearch, distinct
from .workspace import Workspace, distance_to_path


@dataclass(frozen=True)
class SeamErrors:
    """The worst errors (m) on a path: of the whole, of what lies across it and of what lies along it."""

    whole: WorstCase
    across: WorstCase
    along: WorstCase


class PartSearch(WorstSearch):
    """Searches a path for the worst part of an error. Its model has the load cases once for each straight piece: piece
    k under load case i is case k * (number of load cases) + i."""

    def __init__(self, model: ErrorModel, workspace: Workspace, *, gap: float = DEFAULT_GAP) -> None:
        """As `WorstSearch`, for a path with `workspace.error` other than `whole` and at least one piece."""
        self.pieces = workspace.segments
        self._loads = len(model.cases)
        projections = [onto(_direction(piece), workspace.error, planar=model.planar) for piece in self.pieces]
        super().__init__(part_of(model, projections), workspace, gap=gap)
        entries = [self.model.cases[k * self._loads : (k + 1) * self._loads] for k in range(len(self.pieces))]
        self._searches = [
            WorstSearch(replace(self.model, cases=cases), replace(piece, error="whole"), gap=gap)
            for cases, piece in zip(entries, self.pieces, strict=True)
        ]

    def worst(
        self, p: Array, *, certify: bool = True, extra: Array | None = None, certify_up_to: float = np.inf
    ) -> WorstCase:
        """The worst case of a design p over all pieces; `extra` is of no use on a path."""
        del extra
        worst_cases = [search.worst(p, certify=certify, certify_up_to=certify_up_to) for search in self._searches]
        poses = [
            replace(pose, load_case=k * self._loads + pose.load_case)
            for k, case in enumerate(worst_cases)
            for pose in case.poses
        ]
        bounds = [case.upper_bound for case in worst_cases]
        bound = None if None in bounds else max(item for item in bounds if item is not None)
        error = max(case.error for case in worst_cases)
        closed = bound is not None and self._closed(error, bound)
        return WorstCase(error, bound, closed, distinct(poses))

    def case_at(self, q: Array, p: Array, load_case: int) -> int:
        """The piece on which the tip stands, under a load case."""
        tip = self.tip(q, p)[:1]
        axes = slice(0, 2) if self.workspace.in_plane else slice(0, 3)
        away = [float(distance_to_path(tip[:, axes], piece)[0]) for piece in self.pieces]
        return int(np.argmin(away)) * self._loads + load_case

    def load_case(self, case: int) -> int:
        """The load case of one of the model's cases."""
        return case % self._loads

    def of_loads(self, worst_case: WorstCase) -> WorstCase:
        """A worst case with the load cases by their numbers."""
        poses: list[WorstPose] = []
        for pose in worst_case.poses:
            pose_ = replace(pose, load_case=self.load_case(pose.load_case))
            if (pose_.q, pose_.load_case) not in {(item.q, item.load_case) for item in poses}:
                poses.append(pose_)
        return replace(worst_case, poses=tuple(poses))


def _direction(piece: Workspace) -> tuple[float, ...]:
    start, end = piece.points
    return tuple(np.subtract(end, start).tolist())


def worst_search(model: ErrorModel, workspace: Workspace, *, gap: float = DEFAULT_GAP) -> WorstSearch:
    """The search for the worst of what counts of the error over a workspace."""
    kind = WorstSearch if workspace.error == "whole" else PartSearch
    return kind(model, workspace, gap=gap)


def projections_at(model: ErrorModel, workspace: Workspace, tips: Array) -> Array | None:
    """What leaves the part of the error that counts at tips (N, 3) on a path: (N, 3, 3), None where all of it does."""
    if workspace.error == "whole":
        return None
    axes = slice(0, 2) if workspace.in_plane else slice(0, 3)
    pieces = workspace.segments
    away = [distance_to_path(tips[:, axes], piece) for piece in pieces]
    projections = [onto(_direction(piece), workspace.error, planar=model.planar) for piece in pieces]
    return np.array(projections)[np.argmin(away, axis=0)]


def seam_errors(model: ErrorModel, workspace: Workspace, p: Array, worst_case: WorstCase) -> SeamErrors | None:
    """The worst of each part of the error on a path for a design p, `worst_case` being that of the part that counts;
    the others are searched for, without a certificate. None where there is no direction."""
    if not workspace.segments:
        return None

    def worst(part: Part) -> WorstCase:
        if part == workspace.error:
            return worst_case
        search = worst_search(model, replace(workspace, error=part))
        other = search.worst(p, certify=False)
        return search.of_loads(other)

    return SeamErrors(worst("whole"), worst("across"), worst("along"))
