"""What else the tip's error is asked for: along a direction, as a rotation, and as far as play and friction make it.

Each is the worst over the workspace and all load cases, by the search that finds the worst error, without a
certificate. A rotation is that of the tip's frame to first order; repeatability is the farthest that lost motion alone
moves the tip (ISO 9283, 7.2.2 asks for its spread).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import casadi as ca

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import ErrorModel, error_model, needs_shear_modulus
from linkwright.core.arm.errors.parts import onto, part_of
from linkwright.core.arm.errors.tip import Counted
from linkwright.core.arm.figures.design import DesignValues
from linkwright.core.arm.figures.error import SearchedError
from linkwright.core.arm.figures.figure import Asked, Figure, ThroughPoses
from linkwright.core.arm.figures.tip_stiffness import (
    Stiffness,
    TipCompliance,
    compliance_along,
    stiffness_figure,
    tips_of,
)
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.units.quantities import InputError

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


class PartOfError(SearchedError):
    """The worst of what is counted of the tip's error."""

    def __init__(self, name: str, counted: Counted, direction: Direction | None = None) -> None:
        """`name`: that of the figure; `direction`: along (or about) which the error counts, all of it by default."""
        self.name, self.direction = name, direction
        self.counted: Counted = counted
        self.needs = frozenset({"masses"}) if counted == "orientation" else frozenset[str]()

    def search(self, arm: Arm, cases: Sequence[LoadCase], workspace: Workspace) -> WorstSearch:
        """What is counted, along the direction or all of it."""
        return WorstSearch(self._model(arm, cases), workspace)

    def _model(self, arm: Arm, cases: Sequence[LoadCase]) -> ErrorModel:
        model = error_model(arm, cases, counted=self.counted)
        if self.direction is None:
            return model
        in_plane = model.planar and self.direction[2] == 0.0
        return part_of(_planar(model, planar=in_plane), [onto(self.direction, "along", planar=in_plane)])

    def _is_none(self, asked: Asked | DesignValues) -> bool:
        """Whether nothing of the arm can make it any."""
        if self.counted != "lost_motion":
            return False
        cases = self._model(asked.arm, asked.load_cases).cases
        return not any(case.error.intervals or case.error.discs for case in cases)

    def prepare(self, problem: Asked) -> WorstSearch:
        """The search for the worst of it; raises `InputError` where nothing of the arm can make it any, unless its
        drives are from the catalogue, of which some have no play."""
        catalogued = problem.actuators is not None or any(joint.actuator for joint in problem.arm.joints)
        if self._is_none(problem) and not catalogued:
            message = "needs an arm with play: no joint has backlash, clearance or friction wind-up (friction_windup)"
            raise InputError("", f"subject_to.{self.name}", message)
        return super().prepare(problem)

    def evaluate(self, design: DesignValues) -> WorstCase | None:
        """The worst of it; None where nothing of the arm can make it any."""
        return None if self._is_none(design) else super().evaluate(design)


def _planar(model: ErrorModel, *, planar: bool) -> ErrorModel:
    return model if model.planar == planar else replace(model, planar=planar)


def _where(worst_case: WorstCase) -> tuple[float, ...]:
    return worst_case.poses[0].q


def _part(name: str, title: str, key: str, family: PartOfError, **more: Any) -> Figure:
    """A figure of a part of the error: a rotation in mrad, all others in mm."""
    kind, unit = ("angle", "mrad") if family.counted == "orientation" else ("length", "mm")
    limit: dict[str, Any] = {"kind": kind, "unit": unit, "factor": 1e3, "senses": ("<=",), "everywhere": False}
    return Figure(name=name, title=title, key=f"{key}_{unit}", follows=ThroughPoses(family), **limit, **more)


def error_along(direction: Direction) -> Figure:
    """The worst error along a direction."""
    name = f"error_along {direction_words(direction)}"
    title, key = f"worst error along {direction_words(direction)}", f"error_along_{direction_key(direction)}"
    return _part(name, title, key, PartOfError(name, "position", direction))


def orientation_about(axis: Direction) -> Figure:
    """The worst rotation of the tip about an axis."""
    name = f"orientation_error {direction_words(axis)}"
    title, key = f"worst rotation about {direction_words(axis)}", f"orientation_error_{direction_key(axis)}"
    return _part(name, title, key, PartOfError(name, "orientation", axis))


ERROR_ALONG = Directed("error_along", "direction", error_along, ("deflection_along", "sag_along", "directional_error"))
ORIENTATION_ABOUT = Directed("orientation_error", "axis", orientation_about)
ORIENTATION_ERROR = _part(
    "orientation_error",
    "worst rotation of the tip",
    "orientation_error",
    PartOfError("orientation_error", "orientation"),
    where=_where,
    note="greatest",
    synonyms=("angle_error", "rotation", "tilt", "angular_error"),
)
REPEATABILITY = _part(
    "repeatability",
    "repeatability",
    "repeatability",
    PartOfError("repeatability", "lost_motion"),
    where=_where,
    note="farthest that play and friction alone move the tip",
    synonyms=("pose_repeatability", "lost_motion"),
)


class StiffnessAlong(Stiffness):
    """The compliance along a direction."""

    def __init__(self, name: str, direction: Direction) -> None:
        """`name`: that of the figure."""
        self.name = self.called = name
        self.direction, self.forces = direction, (LoadCase(force=direction),)

    def of_arm(self, arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
        """d C d of the tip, or of each tip that load cases name."""
        tips = tips_of(cases)
        parts = [compliance_along(arm, (0, 1, 2), (tip,)) for tip in tips]
        q, p = parts[0].inputs
        d = ca.SX(ca.DM(self.direction))
        entries = [ca.mtimes([d.T, ca.reshape(part.function(q, p), 3, 3), d]) for part in parts]
        matrix = ca.vec(ca.densify(ca.diagcat(*entries)))
        return TipCompliance((q, p), (matrix,), len(parts))

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance along the direction; raises `InputError` where the model does without what it needs."""
        if needs_shear_modulus(problem.arm, self.forces) and not needs_shear_modulus(problem.arm, problem.load_cases):
            message = "is out of the arm's plane, and needs links that shear: do not leave out shear_deformation"
            raise InputError("", f"subject_to.{self.called}", message)
        return super().compliance(problem)


def stiffness_along(direction: Direction) -> Figure:
    """The least stiffness along a direction."""
    name = f"tip_stiffness_along {direction_words(direction)}"
    family = StiffnessAlong(name, direction)
    return stiffness_figure(
        name,
        family,
        f"tip_stiffness_along_{direction_key(direction)}",
        title=f"tip stiffness along {direction_words(direction)}",
        note="least",
        at_poses=family.at_poses,
        everywhere=False,
    )


STIFFNESS_ALONG = Directed(
    "tip_stiffness_along", "direction", stiffness_along, ("stiffness_along", "directional_stiffness")
)

DIRECTED: Mapping[str, Directed] = MappingProxyType(
    {directed.name: directed for directed in (ERROR_ALONG, ORIENTATION_ABOUT, STIFFNESS_ALONG)}
)
"""The figures that take a direction, by the key of a problem file."""
