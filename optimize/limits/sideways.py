"""The least stiffness of a planar arm across its plane, where a thin section gives way and no planar figure tells."""

from __future__ import annotations

from typing import ClassVar

from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.limits.sideways import SIDEWAYS, sideways_compliance
from linkwright.core.arm.limits.tip_stiffness import TipCompliance, tips_of
from linkwright.core.units.quantities import InputError

from .figure import Asked, Figure, ThroughPoses
from .tip_stiffness import Stiffness


class Sideways(Stiffness):
    """The compliance under a force across the plane: the same rows as in the plane, with one direction alone."""

    name: ClassVar[str] = "sideways"
    limited: ClassVar[str] = "sideways_stiffness"

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance across the plane; raises `InputError` where there is none to limit."""
        arm, cases = problem.arm, problem.load_cases
        if not all(arm.planar(load) for load in cases):
            message = "is for arms that stay in the x-y plane; this one moves in space: use tip_stiffness"
            raise InputError("", f"subject_to.{self.limited}", message)
        if needs_shear_modulus(arm, [SIDEWAYS]) and not needs_shear_modulus(arm, cases):
            message = "needs links that shear: leave out torsion too, or do not leave out shear_deformation"
            raise InputError("", f"subject_to.{self.limited}", message)
        return sideways_compliance(arm, tips_of(cases))


SIDEWAYS_STIFFNESS = Figure(
    name="sideways_stiffness",
    synonyms=("lateral_stiffness", "out_of_plane_stiffness"),
    title="sideways stiffness",
    kind="linear_stiffness",
    unit="N/mm",
    factor=1e-3,
    senses=(">=",),
    key="sideways_stiffness_N_per_mm",
    follows=ThroughPoses(Sideways()),
    of=lambda evaluation: None if evaluation.sideways is None else evaluation.sideways.value,
    more_is_better=True,
    note="least, across the arm's plane",
    where=lambda evaluation: None if evaluation.sideways is None else evaluation.sideways.q,
    everywhere=False,
)
