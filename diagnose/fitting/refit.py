"""The findings fitted together, non-linear ones too, with their intervals.

Sizes are solved for together (`joint.sizes`), shapes (a lag, a knee, a threshold) where these leave least
(`joint.shapes`), with profile-likelihood intervals of both (`joint.intervals`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.patterns.unknown_weights import Weight
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.sections.numeric import Array

from .fit import Fit, bounds, t_quantile, why_impossible
from .joint.intervals import parameters_of, spread_of
from .joint.shapes import fitted_shapes
from .joint.sizes import left_by, solved_together
from .prepare import Prepared
from .room.unnamed import Unnamed
from .shared_masses import Shared
from .terms import Term, linear, term_at
from .unknown_masses import hold_of, less_known, not_under_known_loads, under_one_set_of_weights


@dataclass(frozen=True)
class Refit:
    """The joint fit: its terms in the order of the members, their parameters, what is left (N, C) in m and rad, the sum
    of squares of that in whitened units, and its degrees of freedom. `weights` are those that nobody knows and that
    products among the sizes share, in their order (empty: those of the arm file, or none)."""

    terms: tuple[Term, ...]
    parameters: tuple[tuple[FittedParameter, ...], ...]
    residual: Array
    rss: float
    freedom: int
    weights: tuple[Weight, ...] = ()


def refit(
    prepared: Prepared,
    members: Sequence[int],
    outside: Sequence[int],
    fitted: Fit,
    unnamed: Unnamed | None = None,
    *,
    bounded: bool = False,
) -> Refit:
    """Fit the groups `members` of a linear fit together, from its sizes on, forms `outside` the library beside them;
    intervals leave room for what is `unnamed` (None: nothing is). What is `bounded` has every size that lies beyond its
    bounds at the bound, however far, with the rest refitted, and no parameters are worked out."""
    if outside:
        further = np.concatenate([prepared.beside, *(prepared.columns[m] for m in outside)], axis=2)
        prepared = replace(prepared, beside=further)
    terms = [
        _begun(prepared, prepared.pool.groups[m].candidate, fitted.sizes[fitted.members.index(m)], prepared.columns[m])
        for m in members
    ]
    if not terms:
        residual, rss, freedom = left_by(prepared, terms)
        return Refit((), (), residual, rss, freedom)
    unit = fitted.unit if unnamed is None else prepared.unit_of_sizes(fitted.unit)
    terms, weights = under_one_set_of_weights(prepared, terms, unit, bounded=bounded)
    terms = fitted_shapes(prepared, terms, unit)
    initial = prepared
    prepared, terms = solved_together(initial, terms, unit, bounded=bounded)
    while any(_below_zero(prepared, term) for term in terms):
        held = fitted_shapes(initial, [_bounded_at_zero(prepared, term) for term in terms], unit)
        prepared, terms = solved_together(initial, held, unit, bounded=bounded)
    residual, rss, freedom = left_by(prepared, terms)
    spread = spread_of(prepared, terms, rss / max(freedom, 1), unnamed)
    doubtful = not_under_known_loads(prepared, terms, spread.noise, spread.determined, freedom)
    if doubtful:
        prepared, terms = solved_together(
            initial,
            [less_known(t) if k in doubtful else t for k, t in enumerate(terms)],
            unit,
            bounded=bounded,
        )
        residual, rss, freedom = left_by(prepared, terms)
        spread = spread_of(prepared, terms, rss / max(freedom, 1), unnamed)
    at_bounds = _at_bounds(initial, prepared, terms, unit, spread.errors, bounded=bounded)
    if at_bounds is not None:
        prepared, terms = at_bounds
        residual, rss, freedom = left_by(prepared, terms)
    parameters = tuple(
        parameters_of(prepared, terms, place, spread, residual, freedom, rss / max(freedom, 1), unnamed)
        if not bounded
        else ()
        for place in range(len(terms))
    )
    return Refit(tuple(terms), parameters, residual, rss, freedom, weights)


def _at_bounds(
    initial: Prepared, prepared: Prepared, terms: list[Term], unit: float, errors: Sequence[Array], *, bounded: bool
) -> tuple[Prepared, list[Term]] | None:
    """The recording and the terms with sizes at the bounds beyond which they came out; None where none is beyond. What
    made up for the rest of them is fitted anew, which may take that to a bound too."""
    still, result = [np.zeros(len(term.sizes), dtype=bool) for term in terms], None
    while True:
        within = [_within_bounds(prepared, *item, bounded) for item in zip(terms, errors, strict=True)]
        beyond = [(one.sizes != other.sizes) & ~held for one, other, held in zip(within, terms, still, strict=True)]
        if not any(np.any(sizes) for sizes in beyond):
            return result
        still = [held | sizes for held, sizes in zip(still, beyond, strict=True)]
        prepared, terms = result = solved_together(initial, within, unit, still, bounded=bounded)


def _below_zero(prepared: Prepared, term: Term) -> tuple[str, ...]:
    """The sizes of a term that came out negative where nothing is: a drive that the arm file calls rigid would turn
    against its load, a wind-up push on."""
    candidate = term.candidate
    if term.shared or candidate.share or candidate.outside or candidate.only is not None:
        return ()
    if len(term.sizes) != len(candidate.sizes) or len(term.sizes) < 2:
        return ()
    values = zip(candidate.sizes, term.sizes.tolist(), strict=True)
    below = tuple(name for name, value in values if value < 0.0 and bounds(candidate, name, prepared)[0] == 0.0)
    return below if len(below) < len(candidate.sizes) else ()


def _bounded_at_zero(prepared: Prepared, term: Term) -> Term:
    """The term with such sizes held at zero, where physics ends."""
    below, candidate = _below_zero(prepared, term), term.candidate
    if not below:
        return term
    kept = [k for k, name in enumerate(candidate.sizes) if name not in below]
    less = replace(candidate, sizes=tuple(candidate.sizes[k] for k in kept))
    return term_at(prepared.observed, less, term.sizes[kept], term.columns[:, :, kept])


def _within_bounds(prepared: Prepared, term: Term, errors: Array, anyhow: bool) -> Term:
    """The term with sizes that lie beyond their bounds by no more than they are unsure of, or `anyhow`, at the bound,
    where physics ends and a file with them is read; what lies further out cannot be (see `impossible_term`)."""
    candidate = term.candidate
    if term.shared or candidate.outside or len(term.sizes) != len(candidate.sizes):
        return term
    low, high = np.array([bounds(candidate, name, prepared) for name in candidate.sizes]).T
    unsure = np.minimum(prepared.observed.rules.residual.beyond_chance * errors, high - low)
    inside = np.clip(term.sizes, low, high)
    sizes = np.where(anyhow | (np.abs(inside - term.sizes) <= unsure), inside, term.sizes)
    return term if (sizes == term.sizes).all() else term_at(prepared.observed, candidate, sizes, term.columns)


def impossible_term(prepared: Prepared, refit_result: Refit) -> tuple[int, str] | None:
    """The place of the term that cannot be physics, and why as a clause; of several the one that moves most, as the
    others may only balance it. None where all can be."""
    worst: tuple[float, int, str] | None = None
    factor = t_quantile(refit_result.freedom)
    for place, (term, parameters) in enumerate(zip(refit_result.terms, refit_result.parameters, strict=True)):
        reaches = {
            parameter.parameter: (parameter.interval[1] - parameter.interval[0]) / (2.0 * factor)
            for parameter in parameters
        }
        errors = np.array([reaches.get(name, np.inf) for name in term.candidate.sizes])
        white = prepared.pool.projected(prepared.observed.whitened(term.moved))
        moved = float(white @ white)
        reason = why_impossible(prepared, term.candidate, term.sizes, errors, moved)
        if reason is not None and (worst is None or moved > worst[0]):
            worst = (moved, place, reason)
    return None if worst is None else worst[1:]


def shared_of(prepared: Prepared, refit_result: Refit) -> Shared | None:
    """What a joint fit says of one set of weights, for fits to fewer readings; terms are parts from 1. None where fewer
    than two terms share them."""
    sizes = {1 + place: term.sizes for place, term in enumerate(refit_result.terms) if term.shared}
    unit = float(np.sqrt(refit_result.rss / max(refit_result.freedom, 1)))
    return Shared(sizes, hold_of(prepared, refit_result.terms, unit)) if len(sizes) > 1 else None


def refined_shapes(prepared: Prepared, members: Sequence[int], fitted: Fit) -> tuple[Candidate | None, ...]:
    """The members' candidates with their free shapes where they fit best, None for those that have none."""
    groups = [prepared.pool.groups[m] for m in members]
    if not any(group.candidate.free_shapes for group in groups):
        return (None,) * len(groups)
    terms = [
        _begun(prepared, group.candidate, sizes, prepared.columns[m])
        for m, group, sizes in zip(members, groups, fitted.sizes, strict=True)
    ]
    shapes = fitted_shapes(prepared, terms, fitted.unit)
    return tuple(term.candidate if term.candidate.free_shapes else None for term in shapes)


def _begun(prepared: Prepared, candidate: Candidate, slopes: Array, columns: Array) -> Term:
    """A term at the sizes that a linear fit found for its pattern."""
    if linear(candidate):
        return term_at(prepared.observed, candidate, slopes, columns)
    sizes = np.array(candidate.from_slopes(slopes.tolist()))
    if not np.isfinite(sizes).all():
        # A link that would have to give less than nothing has no finite modulus: begin at the stiffest there is.
        sizes = np.minimum(sizes, [bounds(candidate, name, prepared)[1] for name in candidate.sizes])
    return term_at(prepared.observed, candidate, sizes, columns)
