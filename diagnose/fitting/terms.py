"""A finding as the joint fit holds it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.patterns.library import Candidate, parameter_of
from linkwright.core.diagnose.patterns.unknown_weights import Weight
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

DIFFERENCE = 1e-4
"""The share of a size's typical upper end by which it is changed to see what that does."""


@dataclass(frozen=True)
class Term:
    """One finding with its parameters: `sizes` (d,) and the candidate's shapes; `columns` (N, C, d) are the derivatives
    by the sizes, `moved` (N, C) what it adds to the model, m and rad. `through` (N, C, d) is what flexibility adds to
    its derivatives by the loads found that act through it, None where there are none.

    What gives under unknown `weights` (none named: those of the arm file) has a product for each of them among its
    sizes, and last its size under the loads that are known; None: nothing of that kind."""

    candidate: Candidate
    sizes: Array
    columns: Array
    moved: Array
    through: Array | None = None
    weights: tuple[Weight, ...] | None = None

    @property
    def shared(self) -> bool:
        """Whether it gives under unknown weights, which are one set for all that does."""
        return self.weights is not None


def linear(candidate: Candidate) -> bool:
    """Whether the displacement is the columns times the sizes, whatever these are."""
    return candidate.share or candidate.outside or EFFECTS[candidate.effect].linear


def term_at(observed: Observed, candidate: Candidate, sizes: Array, columns: Array) -> Term:
    """A candidate at some sizes, with its derivatives there; `columns` (N, C, d) are those of small sizes."""
    if linear(candidate):
        return Term(candidate, sizes, columns, columns @ sizes)
    values = dict(zip(candidate.sizes, sizes.tolist(), strict=True))
    moved = observed.signature(candidate.effect, candidate.settings(values))
    parts: list[Array] = []
    for name in candidate.sizes:
        step = DIFFERENCE * parameter_of(EFFECTS[candidate.effect], name).typical[1]
        further = observed.signature(candidate.effect, candidate.settings({**values, name: values[name] + step}))
        parts.append((further - moved) / step)
    return Term(candidate, sizes, np.stack(parts, axis=2), moved)
