"""What a size of a finding may hold of another effect that does exactly the same at the same place.

Friction winds a drive up by a constant and by a share of its load. Play that friction holds on the side of approach
does what the constant does: half of it is in the constant, and no recording of sides tells how much. Where a finding
has one size, that is a matter of its name, for which its alternatives stand; where it has several, of that size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.terms import Term
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, parameter_of

_ALIKE = 1e-6
"""Patterns that differ by a smaller share are one."""


@dataclass(frozen=True)
class Collinear:
    """An effect that a size may hold some of, and how far the size alone may be below and above for that, SI."""

    effect: str
    below: float
    above: float


def collinear_with(prepared: Prepared, terms: Sequence[Term], place: int) -> dict[str, Collinear]:
    """By the name of a size what it may hold of what is not among the findings, each of those at most as large as is
    usual."""
    term = terms[place]
    candidate = term.candidate
    if not _whole_with_several_sizes(term):
        return {}
    named = {item.candidate.effect for item in terms if item.candidate.at == candidate.at}
    white = prepared.observed.whitened(term.columns)
    collinear: dict[str, Collinear] = {}
    for other in (group.candidate for group in prepared.pool.groups):
        if other.outside or other.share or other.at != candidate.at or other.effect in named or len(other.sizes) != 1:
            continue
        columns = columns_of(prepared.observed, other) if _usual(other, prepared.observed.rules.fitting.usual) else None
        if columns is None or columns.shape[2] != 1:
            continue
        column = prepared.observed.whitened(columns)[:, 0]
        for name, one in zip(candidate.sizes, white.T, strict=True):
            along = float(column @ one) / max(float(one @ one), 1e-300)
            if np.linalg.norm(column - along * one) <= _ALIKE * np.linalg.norm(column):
                size = parameter_of(EFFECTS[other.effect], other.sizes[0])
                most = max(abs(end) for end in size.typical)
                ends = [along * max(size.lower, -most), along * min(size.upper, most)]
                collinear[name] = Collinear(other.effect, max(0.0, *ends), max(0.0, *(-end for end in ends)))
    return collinear


def _whole_with_several_sizes(term: Term) -> bool:
    """Whether it is an effect in the arm at a separate place, with all of its sizes, of which there are several."""
    candidate = term.candidate
    part = candidate.outside or candidate.share or term.shared or candidate.only is not None
    return not part and bool(candidate.at) and len(candidate.sizes) >= 2


def _usual(candidate: Candidate, times: float) -> bool:
    """Whether no shape of a candidate is so many times beyond what is usual: play under a load that no friction holds
    is seated."""
    parameters = [(parameter_of(EFFECTS[candidate.effect], name), at) for name, at in candidate.shapes.items()]
    return all(abs(at) <= times * max(abs(end) for end in parameter.typical) for parameter, at in parameters)
