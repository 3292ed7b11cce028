"""The tip's stiffness along a direction: a force over the displacement along it that the same force brings."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.figures.figure import Asked, Figure
from linkwright.core.arm.figures.tip_stiffness import (
    Stiffness,
    TipCompliance,
    compliance_along,
    stiffness_figure,
    tips_of,
)
from linkwright.core.units.quantities import InputError

from .direction import Directed, Direction, direction_key, direction_words


class StiffnessAlong(Stiffness):
    """The compliance along a direction."""

    def __init__(self, name: str, direction: Direction) -> None:
        """`name`: that of the figure."""
        self.name = self.called = name
        self.direction, self.forces = direction, (LoadCase(force=direction),)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StiffnessAlong) and (self.name, self.direction) == (other.name, other.direction)

    def __hash__(self) -> int:
        return hash((self.name, self.direction))

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
