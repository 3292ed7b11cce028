"""How stiff a planar arm is out of its plane, which its planar model does not count: a thin section bends sideways.

Links bend about their other axis and, where the arm is bent, twist; joints give in their motion and, where they
have a `tilting_stiffness`, in their bearings. To first order, by unit forces across the plane through the arm's
model in space.
"""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beams_of, needs_shear_modulus
from linkwright.core.units.quantities import InputError

from .design import DesignValues
from .figure import Asked
from .tip_stiffness import (
    Stiffness,
    TipCompliance,
    TipStiffness,
    compliance_along,
    softest_pose,
    stiffness_figure,
    tips_of,
)

SIDEWAYS = LoadCase(force=(0.0, 0.0, 1.0))
"""One newton across the plane."""


def sideways_compliance(arm: Arm, tips: Sequence[str] = ()) -> TipCompliance:
    """A planar arm's compliance at its tip across its plane, as a function of poses and designs; `tips` are as for
    `compliance_along`."""
    return compliance_along(arm, (2,), tuple(tips))


def sideways_rigidities(arm: Arm) -> tuple[float | None, ...]:
    """Each link's flexural rigidity about its other axis (N*m^2), E I_z; None where it is rigid."""
    beams = beams_of(arm)
    rigidities = (beam.flexural_rigidity_width for beam in beams)
    return tuple(None if value is None else float(value) for value in rigidities)


class Sideways(Stiffness):
    """The compliance under a force across the plane: the same rows as in the plane, with one direction alone."""

    name: str = "sideways"
    needs: frozenset[str] = frozenset()
    called: str = "sideways_stiffness"

    forces: tuple[LoadCase, ...] = (SIDEWAYS,)

    def of_arm(self, arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
        """The compliance across the plane."""
        return sideways_compliance(arm, tips_of(cases))

    def evaluate(self, design: DesignValues) -> TipStiffness | None:
        """The softest pose of the workspace; None in space, or where nothing gives.

        Raises `MissingProperty` for what a planar model does without: a shear modulus, say, for links that twist.
        """
        return super().evaluate(design) if design.search.model.planar else None

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance across the plane; raises `InputError` where there is none to limit."""
        arm, cases = problem.arm, problem.load_cases
        if not all(arm.planar(load) for load in cases):
            message = "is for arms that stay in the x-y plane; this one moves in space: use tip_stiffness"
            raise InputError("", f"subject_to.{self.called}", message)
        if needs_shear_modulus(arm, [SIDEWAYS]) and not needs_shear_modulus(arm, cases):
            message = "needs links that shear: leave out torsion too, or do not leave out shear_deformation"
            raise InputError("", f"subject_to.{self.called}", message)
        return self.of_arm(arm, cases)


ACROSS = Sideways()
"""What the tip of a planar arm gives across its plane."""

SIDEWAYS_STIFFNESS = stiffness_figure(
    "sideways_stiffness",
    ACROSS,
    "sideways_stiffness",
    synonyms=("lateral_stiffness", "out_of_plane_stiffness"),
    title="sideways stiffness",
    note="least, across the arm's plane",
    where=softest_pose,
    everywhere=False,
)
