"""What else the tip's error is asked for: along a direction, as a rotation, and as far as play and friction make it.

Each is the worst over the workspace and all load cases, by the search that finds the worst error, without a
certificate. A rotation is that of the tip's frame to first order; repeatability is the farthest that lost motion alone
moves the tip (ISO 9283, 7.2.2 asks for its spread).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from linkwright.core.arm.errors.model import ErrorModel, error_model
from linkwright.core.arm.errors.parts import onto, part_of
from linkwright.core.arm.errors.tip import Counted
from linkwright.core.arm.figures.design import DesignValues
from linkwright.core.arm.figures.error import SearchedError
from linkwright.core.arm.figures.figure import Asked, Figure, ThroughPoses
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.units.quantities import InputError

from .direction import Directed, Direction, direction_key, direction_words


class PartOfError(SearchedError):
    """The worst of what is counted of the tip's error."""

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

    def evaluate(self, design: DesignValues) -> WorstCase | None:
        """The worst of it; None where nothing of the arm can make it any."""
        model = self._model(design)
        if self.counted == "lost_motion" and not _has_play(model):
            return None
        return WorstSearch(model, design.search.workspace).worst(design.p, certify=False)


def _has_play(model: ErrorModel) -> bool:
    return any(case.error.intervals or case.error.discs for case in model.cases)


def _planar(model: ErrorModel, *, planar: bool) -> ErrorModel:
    return model if model.planar == planar else replace(model, planar=planar)


def _where(worst_case: WorstCase) -> tuple[float, ...]:
    return worst_case.poses[0].q


def _length(name: str, title: str, key: str, family: PartOfError, **more: Any) -> Figure:
    limit: dict[str, Any] = {"kind": "length", "unit": "mm", "factor": 1e3, "senses": ("<=",), "everywhere": False}
    return Figure(name=name, title=title, key=key, follows=ThroughPoses(family), **limit, **more)


def _angle(name: str, title: str, key: str, family: PartOfError, **more: Any) -> Figure:
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
