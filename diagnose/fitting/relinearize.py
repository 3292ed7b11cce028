"""What was found, fitted about the arm as it makes it: the sizes at which finite motions, not first order, fit best.

A zero, a length or a compliance moves the tip by finite motions, and turns what the loads bend. To first order about
the arm file each size is off by a share of what lies beyond; that stays while standard errors fall with every reading.
So the readings are set against the arm with the sizes found, and the sizes fitted again, until no direction of them
moves by more than a small part of its standard error (Gauss-Newton; A. Bjorck, Numerical Methods for Least Squares
Problems, SIAM 1996, 9.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.patterns.flexibility import entry
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.patterns.packed import packed
from linkwright.core.diagnose.patterns.pool import length_along
from linkwright.core.diagnose.residual.observe import observed_about
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

from .corrected_arm import as_entry
from .fit import Fit, beyond_nuisances, fit
from .joint.sizes import side_by_side
from .prepare import Patterns, Prepared, set_up
from .refit import Refit, impossible_term, refit
from .terms import Term, term_at

_SETTLED = 0.05
"""Standard errors that finite motions still change of sizes: less than the last digit that is shown of an interval."""


@dataclass(frozen=True)
class Relinearized:
    """The readings set against the arm with what was found, the numbers that the groups have there, their linear fit
    and their joint fit."""

    prepared: Prepared
    members: tuple[int, ...]
    outside: tuple[int, ...]
    fitted: Fit
    refit: Refit


def relinearized(
    prepared: Prepared, members: Sequence[int], outside: Sequence[int], *, bounded: bool = False
) -> Relinearized:
    """Groups fitted together, `outside` being forms, about the arm as their sizes make it. Sizes that cannot be are
    left as they came out first, no arm being like that, or stand at their bounds (`bounded`, see `refit`)."""
    fitted, last = _fitted(prepared, members, outside, bounded), np.inf
    for _ in range(6 if members else 0):
        if not bounded and impossible_term(fitted.prepared, fitted.refit) is not None:
            break
        about = _about(fitted)
        patterns = _patterns_about(about, fitted)
        step = np.inf if patterns is None else _step(fitted, about, patterns)
        if patterns is None or step <= _SETTLED * fitted.fitted.unit or step >= last:
            break
        last = step
        again = set_up(about, patterns, prepared.rejected)
        again = replace(again, independent=prepared.independent, together=prepared.together, width=prepared.width)
        if len(again.pool.groups) < len(patterns):
            break
        count = len(members)
        del fitted  # of a long recording some hundred megabytes, of which nothing is needed any more
        fitted = _fitted(again, range(count), range(count, len(patterns)), bounded)
    return fitted


def entries_of_arm(terms: Sequence[Term]) -> tuple[EffectEntry, ...]:
    """Terms as entries of an arm file; what is a share of loads, acts in one recording alone, is no physics or is only
    known as a product stays out."""
    return tuple(
        as_entry(term.candidate, term.sizes.tolist())
        for term in terms
        if not (term.candidate.share or term.candidate.outside or term.shared) and term.candidate.only is None
    )


def _about(relinearized_: Relinearized) -> Observed:
    """The readings set against the arm with what is found; loads act through the flexibility found, and through what
    the search has assumed beside it (not through what was found and is no longer)."""
    observed, terms = relinearized_.prepared.observed, relinearized_.refit.terms
    softer = [
        entry_made
        for entry_made in (entry(term.candidate, term.sizes.tolist()) for term in terms)
        if entry_made is not None
    ]
    taken = {(entry_made.effect, entry_made.at) for entry_made in (*softer, *observed.about)}
    softer += [item for item in observed.softening if (item.effect, item.at) not in taken]
    return observed_about(observed, entries_of_arm(terms), softer)


def _fitted(prepared: Prepared, members: Sequence[int], outside: Sequence[int], bounded: bool) -> Relinearized:
    fitted = fit(prepared, [*members, *outside])
    joint = refit(prepared, members, outside, fitted, bounded=bounded)
    return Relinearized(prepared, tuple(members), tuple(outside), fitted, joint)


def _patterns_about(observed: Observed, relinearized_: Relinearized) -> Patterns | None:
    """What was found with its patterns about another shape, forms as they are; None where that shape is none, or one
    shows no more."""
    if not np.isfinite(observed.residual).all():
        return None
    patterns: Patterns = []
    for member, term in zip(relinearized_.members, relinearized_.refit.terms, strict=True):
        given = relinearized_.prepared.pool.groups[member].candidate
        candidate = term.candidate if len(term.sizes) == len(given.sizes) and not term.shared else given
        columns = columns_of(observed, candidate)
        if columns is None or not np.isfinite(columns).all():
            return None
        patterns.append((candidate, packed(columns)))
    groups, parts = relinearized_.prepared.pool.groups, relinearized_.prepared.columns.parts
    return [*patterns, *((groups[m].candidate, parts[m]) for m in relinearized_.outside)]


def _step(relinearized_: Relinearized, about: Observed, patterns: Patterns) -> float:
    """How far (in whitened units) sizes would move what they move, if what lies beyond first order about the present
    shape were allowed for: its length over the scatter is the largest change of any size, or sum of sizes, in standard
    errors."""
    terms, prepared = relinearized_.refit.terms, relinearized_.prepared
    change = about.residual - prepared.observed.residual
    for term, (candidate, columns) in zip(terms, patterns, strict=False):
        there = columns.whole() if candidate is term.candidate else None
        change = change + term.moved - _moved(about, term, there)
    columns = [
        prepared.beside,
        *(term.columns for term in terms),
        *(prepared.columns[m] for m in relinearized_.outside),
    ]
    beyond = prepared.observed.whitened(beyond_nuisances(prepared, change))
    return length_along(side_by_side(prepared.observed, columns), beyond)


def _moved(observed: Observed, term: Term, columns: Array | None) -> Array:
    """What a term moves (N, C), m and rad, about another shape, its columns there given or not; products with unknown
    weights, which are none of that shape, as before."""
    if term.shared:
        return term.moved
    columns = columns_of(observed, term.candidate) if columns is None else columns
    return term.moved if columns is None else term_at(observed, term.candidate, term.sizes, columns).moved
