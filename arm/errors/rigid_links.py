"""Links that neither give nor weigh: what an arm errs by beside them, which no section and no material betters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.sections.numeric import Array

from .model import BEAM_FIELDS, beam_values

_RIGID = 1e30
"""N, N*m^2: a rigidity under which nothing gives."""


def rigid(beam: Beam) -> Beam:
    """A beam of the same length that neither gives nor weighs, and grows as it did when it warms; what balances the arm
    stays."""
    return Beam(
        length=beam.length,
        thermal_expansion=beam.thermal_expansion,
        balancer=beam.balancer,
        counterweight=beam.counterweight,
        counterweight_at=beam.counterweight_at,
    )


def values_of_rigid(beams: Sequence[Beam]) -> Array:
    """As `beam_values`, for an error model whose links are elastic: rigidities that a beam lacks are so large that
    nothing gives."""
    values = beam_values(beams).reshape(len(beams), -1)
    for k, name in enumerate(BEAM_FIELDS):
        if "rigidity" in name and "coupling" not in name:
            values[:, k] = np.where(values[:, k] == 0.0, _RIGID, values[:, k])
    return values.ravel()
