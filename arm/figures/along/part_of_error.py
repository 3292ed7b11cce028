"""What else the tip's error is asked for: along a direction, as a rotation, and as far as play and friction make it.

Each is the worst over the workspace and all load cases, by the search that finds the worst error, without a
certificate. A rotation is that of the tip's frame to first order; repeatability is the farthest that lost motion alone
moves the tip (ISO 9283, 7.2.2 asks for its spread).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import ErrorModel, error_model
from linkwright.core.arm.errors.parts import onto, part_of
from linkwright.core.arm.errors.tip import Counted
from linkwright.core.arm.figures.design import DesignExpressions, Designs, DesignValues
from linkwright.core.arm.figures.figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .direction import Directed, Direction, direction_key, direction_words

_MOST_SHOWN = 3
"""Worst poses that become rows together."""
_FLOOR = 1e-24
"""Keeps the logarithm of an error of zero (m^2, rad^2) finite."""


class PartOfError(PoseFamily[WorstCase]):
    """The worst of what is counted of the tip's error: a cut holds where play stands beside the pose."""

    is_error: ClassVar[bool] = True

    def __init__(self, name: str, counted: Counted, direction: Direction | None = None) -> None:
        """`name`: that of the figure; `direction`: along (or about) which the error counts, all of it by default."""
        self.name, self.direction = name, direction
        self.counted: Counted = counted
        self.needs = frozenset({"masses"}) if counted == "orientation" else frozenset[str]()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PartOfError) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> tuple[object, ...]:
        return self.name, self.counted, self.direction

    def _model(self, asked: Asked | DesignValues) -> ErrorModel:
        model = error_model(asked.arm, asked.load_cases, counted=self.counted)
        if self.direction is None:
            return model
        in_plane = model.planar and self.direction[2] == 0.0
        return part_of(_planar(model, planar=in_plane), [onto(self.direction, "along", planar=in_plane)])

    def prepare(self, problem: Asked) -> WorstSearch:
        """The search for the worst of it; raises `InputError` where nothing of the arm can make it any."""
        model = self._model(problem)
        if self.counted == "lost_motion" and not _has_play(model):
            message = "needs an arm with play: no joint has backlash, clearance or friction wind-up (friction_windup)"
            raise InputError("", f"subject_to.{self.name}", message)
        return WorstSearch(model, problem.workspace)

    def more(self, prepared: WorstSearch) -> int:
        """The side of each play, and how far clearances move the tip."""
        return self._plays(prepared) + 3

    def _plays(self, prepared: WorstSearch) -> int:
        return max(len(case.error.intervals) for case in prepared.model.cases)

    def rows(
        self, prepared: WorstSearch, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The error over what is allowed, in logarithms."""
        case, plays = prepared.model.cases[group], self._plays(prepared)
        outputs = case.function(pose[0], design.beam_column)
        vector = outputs[0] + pose[1][plays:]
        for k in range(len(case.error.intervals)):
            vector = vector + pose[1][k] * outputs[1][3 * k : 3 * k + 3]
        for number, value, slack in held.on(self.name):
            yield number, 0.5 * ca.log(ca.dot(vector, vector) + _FLOOR) - ca.log(value) - slack

    def evaluate(self, design: DesignValues) -> WorstCase | None:
        """The worst of it; None where nothing of the arm can make it any."""
        model = self._model(design)
        if self.counted == "lost_motion" and not _has_play(model):
            return None
        return WorstSearch(model, design.search.workspace).worst(design.p, certify=False)

    def values(self, found: WorstCase) -> Mapping[str, float | None]:
        """The worst of it."""
        return {self.name: found.error}

    def worst(self, prepared: WorstSearch, problem: Asked, design: DesignValues) -> list[Worst]:
        """The worst poses, with where play stands."""
        del problem
        worst: list[Worst] = []
        for pose in prepared.worst(design.p, certify=False).poses[:_MOST_SHOWN]:
            shift = np.reshape(pose.shifts, (-1, 3)).sum(axis=0).tolist()
            signs = (*pose.signs, *[0.0] * (self._plays(prepared) - len(pose.signs)))
            worst.append(Worst(self.name, pose.error, Cut(pose.q, pose.load_case, (*signs, *shift))))
        return worst

    def at_pose(self, prepared: WorstSearch, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The error of each design at its pose."""
        model = prepared.model
        case, arm = model.cases[group], model.arm
        arrays = case.arrays(q, designs.p)
        error = played(arrays, case.radii, arm.play, planar=model.planar, statistics=arm.statistics)
        return {self.name: error.error}


def _has_play(model: ErrorModel) -> bool:
    return any(case.error.intervals or case.error.discs for case in model.cases)


def _planar(model: ErrorModel, *, planar: bool) -> ErrorModel:
    return model if model.planar == planar else replace(model, planar=planar)


def _where(found: WorstCase) -> tuple[float, ...]:
    return found.poses[0].q


def _length(name: str, title: str, key: str, family: PartOfError, **more: Any) -> Figure:
    """A figure in mm."""
    limit: dict[str, Any] = {"kind": "length", "unit": "mm", "factor": 1e3, "senses": ("<=",), "everywhere": False}
    return Figure(name=name, title=title, key=key, follows=ThroughPoses(family), **limit, **more)


def _angle(name: str, title: str, key: str, family: PartOfError, **more: Any) -> Figure:
    """A figure in mrad."""
    limit: dict[str, Any] = {"kind": "angle", "unit": "mrad", "factor": 1e3, "senses": ("<=",), "everywhere": False}
    return Figure(name=name, title=title, key=key, follows=ThroughPoses(family), **limit, **more)


def error_along(direction: Direction) -> Figure:
    """The worst error along a direction."""
    name = f"error_along {direction_words(direction)}"
    title, key = f"worst error along {direction_words(direction)}", f"error_along_{direction_key(direction)}_mm"
    return _length(name, title, key, PartOfError(name, "position", direction))


def orientation_about(axis: Direction) -> Figure:
    """The worst rotation of the tip about an axis."""
    name = f"orientation_error {direction_words(axis)}"
    title, key = f"worst rotation about {direction_words(axis)}", f"orientation_error_{direction_key(axis)}_mrad"
    return _angle(name, title, key, PartOfError(name, "orientation", axis))


ERROR_ALONG = Directed("error_along", "direction", error_along, ("deflection_along", "sag_along", "directional_error"))
ORIENTATION_ABOUT = Directed("orientation_error", "axis", orientation_about)
ORIENTATION_ERROR = _angle(
    "orientation_error",
    "worst rotation of the tip",
    "orientation_error_mrad",
    PartOfError("orientation_error", "orientation"),
    where=_where,
    note="greatest",
    synonyms=("angle_error", "rotation", "tilt", "angular_error"),
)
REPEATABILITY = _length(
    "repeatability",
    "repeatability",
    "repeatability_mm",
    PartOfError("repeatability", "lost_motion"),
    where=_where,
    note="farthest that play and friction alone move the tip",
    synonyms=("pose_repeatability", "lost_motion"),
)
