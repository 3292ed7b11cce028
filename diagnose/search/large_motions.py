"""Findings so large that first order does not hold about the arm file: a zero off by degrees, a tool by centimetres.

What they move beyond first order would be named for something else. So it is worked out by finite motions, taken off
the residual (`observe(..., about=...)`), and the search is made again until that no longer changes: Gauss-Newton, with
the search as its step. Zeros and lengths are allowed for before the first search (`fitting.geometry`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.fitting.corrected_arm import as_entry
from linkwright.core.diagnose.fitting.fit import beyond_nuisances, fit
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.residual.observe import beyond_first_order
from linkwright.core.diagnose.residual.observed import Observed, rms_length

from .naming import Named, Namer

Entries = tuple[EffectEntry, ...]
ROUNDS = 4
"""Of search, or of a fit, about large findings, until they no longer change."""
Search = Callable[[Entries, Sequence[Candidate]], tuple[Namer, Named]]
"""A search about some motions, on from what was named before."""


def about_large(namer: Namer, named: Named, search: Search) -> tuple[Namer, Named]:
    """The search made again about what it found, by `search`, as long as that is so large that it matters."""
    for _ in range(ROUNDS):
        motions = _motions(namer, _members(namer, named))
        if not _matters(namer, motions):
            break
        namer, named = search(motions, candidates_of(namer, named.members))
    return namer, named


def _members(namer: Namer, named: Named) -> Sequence[int]:
    """What was named; the library's best answer where nothing of it was."""
    return named.members or min(namer.best_of_library().values(), key=lambda subset: subset.criterion).members


def candidates_of(namer: Namer, members: Sequence[int]) -> list[Candidate]:
    """The candidates that some groups are."""
    return [namer.pool.groups[m].candidate for m in members]


def _scatter(observed: Observed) -> float:
    return float(np.sqrt(np.sum(observed.scale[: observed.components] ** 2)))


def _matters(namer: Namer, entries: Entries) -> bool:
    """Whether what lies beyond first order is another than that allowed for, by more than the nuisances take up."""
    observed = namer.prepared.observed
    width = observed.components
    change = np.zeros(observed.residual.shape)
    change[:, :width] = beyond_first_order(observed, entries) - beyond_first_order(observed, observed.about)
    return rms_length(beyond_nuisances(namer.prepared, change)[:, :width]) > namer.rules.motion_matters * _scatter(
        observed
    )


def _motions(namer: Namer, members: Sequence[int]) -> Entries:
    """Some groups as entries of an arm file, as fitted; what is a share of loads or lacks a size stays out."""
    fitted = fit(namer.prepared, members)
    pairs = [(namer.pool.groups[m].candidate, s.tolist()) for m, s in zip(fitted.members, fitted.sizes, strict=True)]
    return tuple(
        as_entry(candidate, candidate.from_slopes(sizes))
        for candidate, sizes in pairs
        if not candidate.share and candidate.only is None and len(sizes) == len(candidate.sizes)
    )
