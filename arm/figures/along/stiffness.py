"""The tip's stiffness along a direction: a force over the displacement along it that the same force brings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import casadi as ca

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, needs_shear_modulus
from linkwright.core.arm.figures.design import DesignValues
from linkwright.core.arm.figures.figure import Asked, Figure, ThroughPoses
from linkwright.core.arm.figures.tip_stiffness import (
    Stiffness,
    TipCompliance,
    TipStiffness,
    compliance_along,
    least_stiffness,
    tips_of,
)
from linkwright.core.units.quantities import InputError

from .direction import Directed, Direction, direction_key, direction_words

if TYPE_CHECKING:
    from linkwright.core.arm.evaluation import Evaluation


class StiffnessAlong(Stiffness):
    """The compliance along a direction."""

    def __init__(self, name: str, direction: Direction) -> None:
        """`name`: that of the figure."""
        self.name = self.called = name
        self.direction = direction

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StiffnessAlong) and (self.name, self.direction) == (other.name, other.direction)

    def __hash__(self) -> int:
        return hash((self.name, self.direction))

    def _along(self, arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
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
        pressed = [LoadCase(force=self.direction)]
        if needs_shear_modulus(problem.arm, pressed) and not needs_shear_modulus(problem.arm, problem.load_cases):
            message = "is out of the arm's plane, and needs links that shear: do not leave out shear_deformation"
            raise InputError("", f"subject_to.{self.called}", message)
        return self._along(problem.arm, problem.load_cases)

    def evaluate(self, design: DesignValues) -> TipStiffness | None:
        """The softest pose of the workspace; None where nothing gives."""
        p = beam_values(beams_of(design.arm, [*design.load_cases, LoadCase(force=self.direction)]))
        return least_stiffness(self._along(design.arm, design.load_cases), design.poses, p, design.search)

    def at_poses(self, evaluation: Evaluation, poses: Sequence[tuple[float, ...]]) -> float | None:
        """The least at the poses that a limit names."""
        cases = evaluation.load_cases
        p = beam_values(beams_of(evaluation.arm, [*cases, LoadCase(force=self.direction)]))
        stiffness = least_stiffness(self._along(evaluation.arm, cases), poses, p)
        return None if stiffness is None else stiffness.value


def stiffness_along(direction: Direction) -> Figure:
    """The least stiffness along a direction."""
    name = f"tip_stiffness_along {direction_words(direction)}"
    family = StiffnessAlong(name, direction)
    return Figure(
        name=name,
        title=f"tip stiffness along {direction_words(direction)}",
        kind="linear_stiffness",
        unit="N/mm",
        factor=1e-3,
        senses=(">=",),
        key=f"tip_stiffness_along_{direction_key(direction)}_N_per_mm",
        follows=ThroughPoses(family),
        more_is_better=True,
        note="least",
        at_poses=family.at_poses,
        everywhere=False,
    )


STIFFNESS_ALONG = Directed(
    "tip_stiffness_along", "direction", stiffness_along, ("stiffness_along", "directional_stiffness")
)
