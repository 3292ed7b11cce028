"""A finding as the joint fit holds it."""

from __future__ import annotations

from dataclasses import dataclass

from diagnose.patterns.library import Candidate
from diagnose.patterns.unknown_weights import Weight
from sections.numeric import Array


@dataclass(frozen=True)
class Term:
    """One finding with its parameters: `sizes` (d,) and the candidate's shapes; `columns` (N, C, d) are the derivatives
    by the sizes, `moved` (N, C) what it adds to the model, m and rad. `through` (N, C, d) is what flexibility adds to
    its derivatives by the loads found that act through it, None where there are none.

    What gives under unknown `weights` (none named: those of the arm file) has a product for each of them among its
    sizes, and last its own size under the loads that are known; None: nothing of that kind."""

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
