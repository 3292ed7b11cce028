"""How stiff a planar arm is out of its plane, which its planar model does not count: a thin section bends sideways.

Links bend about their other axis and, where the arm is bent, twist; joints give in their own motion and, where they
have a `tilting_stiffness`, in their bearings. To first order, by unit forces across the plane through the arm's own
model in space.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.sections.numeric import Array

from .tip_stiffness import TipCompliance, TipStiffness, compliance_along, least_stiffness, tips_of

if TYPE_CHECKING:
    from linkwright.core.arm.worst.search import WorstSearch

SIDEWAYS = LoadCase(force=(0.0, 0.0, 1.0))
"""One newton across the plane."""


def sideways_compliance(arm: Arm, tips: Sequence[str] = ()) -> TipCompliance:
    """A planar arm's compliance at its tip across its plane, as a function of poses and designs; `tips` are as for
    `compliance_along`."""
    return compliance_along(arm, (2,), tuple(tips))


def least_sideways(arm: Arm, cases: Sequence[LoadCase], poses: Array, search: WorstSearch) -> TipStiffness | None:
    """A planar arm's least stiffness across its plane over the workspace of `search`, the poses being where climbs
    start; None where nothing gives.

    Raises `MissingProperty` for what a planar model does without: a shear modulus, say, for links that twist.
    """
    p = beam_values(beams_of(arm, [*cases, SIDEWAYS]))
    return least_stiffness(sideways_compliance(arm, tips_of(cases)), poses, p, search)


def sideways_rigidities(arm: Arm) -> tuple[float | None, ...]:
    """Each link's flexural rigidity about its other axis (N*m^2), E I_z; None where it is rigid."""
    beams = beams_of(arm)
    found = (beam.flexural_rigidity_width for beam in beams)
    return tuple(None if value is None else float(value) for value in found)
