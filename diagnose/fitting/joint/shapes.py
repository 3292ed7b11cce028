"""Shapes of findings where they fit best: what is left with all sizes fitted anew is least (variable projection, G. H.
Golub & V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036)."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np
from scipy.optimize import minimize_scalar

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import solved
from linkwright.core.diagnose.fitting.prepare import Prepared, held_within
from linkwright.core.diagnose.fitting.terms import Term, term_at
from linkwright.core.diagnose.fitting.thresholds import between_loads, least_of
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, parameter_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.sections.numeric import Array

from .sizes import design_of, tethers

_SWEEPS = 2
_REACH = 1.2
"""How far a shape is sought about where it is, in its logarithm."""
_TINY = 1e-30


@dataclass(frozen=True)
class Scan:
    """What is left with other shapes of one term, all sizes fitted anew: everything else is projected out once."""

    prepared: Prepared
    candidate: Candidate
    others: Array
    left: Array
    unit: float

    def __call__(self, shapes: Mapping[str, float]) -> float:
        """The sum of squares left, in whitened units."""
        candidate = replace(self.candidate, shapes=MappingProxyType(dict(shapes)))
        columns = columns_of(self.prepared.observed, candidate)
        if columns is None:
            return float("inf")
        white = self.prepared.observed.whitened(columns)
        rules = self.prepared.observed.rules.fitting
        bound = held_within(candidate, columns, self.prepared.width, rules=rules)
        tether = (
            np.zeros((white.shape[1], white.shape[1])) if bound is None else np.diag(self.unit * rules.tether / bound)
        )
        padding = np.zeros((len(self.left) - len(white), white.shape[1]))
        white = np.vstack([white, padding])
        white = np.vstack([white - self.others @ (self.others.T @ white), tether])
        target = np.concatenate([self.left, np.zeros(len(tether))])
        left = target - white @ solved(white, target)
        return float(left @ left)

    def at(self, shapes: Mapping[str, float], name: str, logarithm: float) -> float:
        """The same with one shape given by its logarithm."""
        return self({**shapes, name: float(np.exp(logarithm))})


def scan_of(prepared: Prepared, terms: Sequence[Term], place: int, unit: float) -> Scan:
    """The scan of the shapes of the term at a place, `unit` being the scatter of whitened residuals."""
    rest = [term for k, term in enumerate(terms) if k != place]
    design, _ = design_of(prepared, rest)
    rows, _ = tethers(prepared, rest, unit)
    others = orthonormal(np.vstack([design, rows]))
    white = prepared.observed.whitened(prepared.observed.residual)
    target = np.concatenate([white, np.zeros(len(rows))])
    return Scan(prepared, terms[place].candidate, others, target - others @ (others.T @ target), unit)


def fitted_shapes(prepared: Prepared, terms: list[Term], unit: float) -> list[Term]:
    """The terms with their free shapes where they fit best, one after the other."""
    for _, place in itertools.product(range(_SWEEPS), range(len(terms))):
        candidate = terms[place].candidate
        for name in candidate.free_shapes:
            shapes = dict(terms[place].candidate.shapes)
            middle = np.log(shapes[name])

            left = partial(scan_of(prepared, terms, place, unit).at, shapes, name)
            most = parameter_of(EFFECTS[candidate.effect], name)
            reach = (max(middle - _REACH, np.log(max(most.lower, _TINY))), min(middle + _REACH, np.log(most.upper)))
            if most.threshold:
                best, least = least_of(left, between_loads(prepared.observed, candidate, reach))
            else:
                minimum = minimize_scalar(left, bounds=reach, method="bounded", options={"xatol": 0.01})
                best, least = float(minimum.x), float(minimum.fun)
            if least < left(middle):
                shapes[name] = float(np.exp(best))
                new = replace(candidate, shapes=MappingProxyType(shapes))
                columns = columns_of(prepared.observed, new)
                if columns is not None:
                    terms = [
                        t if k != place else term_at(prepared.observed, new, t.sizes, columns)
                        for k, t in enumerate(terms)
                    ]
    return terms
