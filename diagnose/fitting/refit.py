"""The findings fitted together, non-linear ones too, with their intervals.

Sizes that enter in proportion are solved for exactly; shapes (a lag, a knee, a threshold) are found by minimising what
is left once all sizes are fitted (variable projection, G. H. Golub & V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413,
doi:10.1137/0710036). Intervals are profile-likelihood ones: for sizes those of least squares with the shapes' own
uncertainty in it, for a shape the values at which the likelihood, sizes fitted anew, falls by the t quantile's square.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.patterns.flexibility import entry, through_flexibility
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, kind_of, parameter_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.patterns.unknown_weights import (
    Weight,
)
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .fit import Fit, beyond_nuisances, bounds, solved, t_quantile, why_impossible
from .prepare import Prepared, held_within
from .room.active_bounds import at_active_bounds
from .room.collinearity import collinear_with
from .room.unnamed import Unnamed
from .shared_masses import factors
from .terms import DIFFERENCE, Term, linear, term_at
from .thresholds import between_loads, least_of, no_worse_than
from .unknown_masses import (
    entries_of,
    hold_of,
    known_load,
    less_known,
    not_under_known_loads,
    sag,
    steps_of,
    under_one_set_of_weights,
)

_SWEEPS = 2
_SCAN = 14
_NEWTON = 6
_TOGETHER = 30
_SETTLED = 1e-9
"""A step that lowers the sum of squares by so small a share is the last."""
_REACH = 1.2
"""How far a shape is sought about where it is, in its logarithm."""
_TINY = 1e-30
_SHARES = (1.0, 0.5, 0.25, 0.125, 1.0 / 16.0, 1.0 / 64.0)
_ROUNDING = 1e-9


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
) -> Refit:
    """Fit the groups `members` of a linear fit together, from its sizes on, forms `outside` the library beside them;
    intervals leave room for what is `unnamed` (None: nothing is)."""
    if outside:
        further = np.concatenate([prepared.beside, *(prepared.columns[m] for m in outside)], axis=2)
        prepared = replace(prepared, beside=further)
    terms = [
        _begun(prepared, prepared.pool.groups[m].candidate, fitted.sizes[fitted.members.index(m)], prepared.columns[m])
        for m in members
    ]
    if not terms:
        residual, rss, freedom = _left(prepared, terms)
        return Refit((), (), residual, rss, freedom)
    unit = fitted.unit if unnamed is None else prepared.told_apart(fitted.unit)
    terms, weights = under_one_set_of_weights(prepared, terms, unit)
    terms = _shapes_found(prepared, terms, unit)
    initial = prepared
    prepared, terms = _solved(initial, terms, unit)
    while any(_below_nought(prepared, term) for term in terms):
        held = _shapes_found(initial, [_never_below_nought(prepared, term) for term in terms], unit)
        prepared, terms = _solved(initial, held, unit)
    residual, rss, freedom = _left(prepared, terms)
    spread = _spread(prepared, terms, rss / max(freedom, 1), unnamed)
    doubtful = not_under_known_loads(prepared, terms, spread.noise, spread.told, freedom)
    if doubtful:
        prepared, terms = _solved(initial, [less_known(t) if k in doubtful else t for k, t in enumerate(terms)], unit)
        residual, rss, freedom = _left(prepared, terms)
        spread = _spread(prepared, terms, rss / max(freedom, 1), unnamed)
    still = [np.zeros(len(term.sizes), dtype=bool) for term in terms]
    while True:
        within = [_within_bounds(prepared, *item) for item in zip(terms, spread.errors, strict=True)]
        beyond = [(one.sizes != other.sizes) & ~held for one, other, held in zip(within, terms, still, strict=True)]
        if not any(np.any(sizes) for sizes in beyond):
            break
        # What made up for the rest of a size that stands at its bound now is fitted anew beside it, which may take that
        # to a bound of its own.
        still = [held | sizes for held, sizes in zip(still, beyond, strict=True)]
        prepared, terms = _solved(initial, within, unit, still)
        residual, rss, freedom = _left(prepared, terms)
    parameters = tuple(
        _parameters(prepared, terms, place, spread, residual, freedom, rss / max(freedom, 1), unnamed)
        for place in range(len(terms))
    )
    return Refit(tuple(terms), parameters, residual, rss, freedom, weights)


def _below_nought(prepared: Prepared, term: Term) -> tuple[str, ...]:
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


def _never_below_nought(prepared: Prepared, term: Term) -> Term:
    """The term with such sizes held at nought, where physics ends."""
    below, candidate = _below_nought(prepared, term), term.candidate
    if not below:
        return term
    kept = [k for k, name in enumerate(candidate.sizes) if name not in below]
    less = replace(candidate, sizes=tuple(candidate.sizes[k] for k in kept))
    return _term(prepared, less, term.sizes[kept], term.columns[:, :, kept])


def _within_bounds(prepared: Prepared, term: Term, errors: Array) -> Term:
    """The term with sizes that lie beyond their bounds by no more than they are unsure of at the bound, where physics
    ends and a file with them is read; what lies further out cannot be (see `impossible_term`)."""
    candidate = term.candidate
    if term.shared or candidate.outside or len(term.sizes) != len(candidate.sizes):
        return term
    low, high = np.array([bounds(candidate, name, prepared) for name in candidate.sizes]).T
    unsure = np.minimum(prepared.observed.rules.residual.beyond_chance * errors, high - low)
    inside = np.clip(term.sizes, low, high)
    sizes = np.where(np.abs(inside - term.sizes) <= unsure, inside, term.sizes)
    return term if (sizes == term.sizes).all() else _term(prepared, candidate, sizes, term.columns)


def impossible_term(prepared: Prepared, found: Refit) -> tuple[int, str] | None:
    """The place of the term that cannot be physics, and why as a clause; of several the one that moves most, as the
    others may only balance it. None where all can be."""
    worst: tuple[float, int, str] | None = None
    factor = t_quantile(found.freedom)
    for place, (term, parameters) in enumerate(zip(found.terms, found.parameters, strict=True)):
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


def refined_shapes(prepared: Prepared, members: Sequence[int], fitted: Fit) -> tuple[Candidate | None, ...]:
    """The members' candidates with their free shapes where they fit best, None for those that have none."""
    groups = [prepared.pool.groups[m] for m in members]
    if not any(group.candidate.free_shapes for group in groups):
        return (None,) * len(groups)
    terms = [
        _begun(prepared, group.candidate, sizes, prepared.columns[m])
        for m, group, sizes in zip(members, groups, fitted.sizes, strict=True)
    ]
    shapes = _shapes_found(prepared, terms, fitted.unit)
    return tuple(term.candidate if term.candidate.free_shapes else None for term in shapes)


def _begun(prepared: Prepared, candidate: Candidate, slopes: Array, columns: Array) -> Term:
    """A term at the sizes that a linear fit found for its pattern."""
    if linear(candidate):
        return _term(prepared, candidate, slopes, columns)
    sizes = np.array(candidate.from_slopes(slopes.tolist()))
    if not np.isfinite(sizes).all():
        # A link that would have to give less than nothing has no finite modulus: begin at the stiffest there is.
        sizes = np.minimum(sizes, [bounds(candidate, name, prepared)[1] for name in candidate.sizes])
    return _term(prepared, candidate, sizes, columns)


def _term(prepared: Prepared, candidate: Candidate, sizes: Array, columns: Array) -> Term:
    return term_at(prepared.observed, candidate, sizes, columns)


def _design(prepared: Prepared, terms: Sequence[Term], *, through: bool = False) -> tuple[Array, list[slice]]:
    """Whitened columns of the nuisances and of all terms, and where each term's are; with `through`, what flexibility
    does for the loads among the terms counts as its own."""
    columns = [term.columns if term.through is None or not through else term.columns + term.through for term in terms]
    parts = [prepared.beside, *columns]
    edges = np.cumsum([0, *(part.shape[2] for part in parts)]).tolist()
    spans = [slice(a, b) for a, b in itertools.pairwise(edges)]
    # One after the other: copies of all columns of a long recording are hundreds of megabytes.
    design = np.empty((prepared.observed.residual.size, edges[-1]))
    for span, part in zip(spans, parts, strict=True):
        design[:, span] = prepared.observed.whitened(part)
    return design, spans[1:]


def tether(term: Term, unit: float, *, rules: FittingRules = RULES.fitting) -> Array:
    """What holds a finding's sizes (d,) within their physical bounds, and what badly known ones are near the usual:
    `unit`, the scatter of whitened residuals, over a fifth of the bound or the largest that is usual, whichever is
    less. What the data tell ten times as well as that it leaves where they put it."""
    bound = held_within(term.candidate, term.columns, rules=rules)
    return np.zeros(len(term.sizes)) if bound is None else unit * rules.tether / bound


def _tethers(prepared: Prepared, terms: Sequence[Term], unit: float) -> tuple[Array, Array]:
    """Rows that hold each size (see `tether`): weights (k, b + k) and what they ask for (k,), for the step from the
    present sizes."""
    beside, rules = prepared.beside.shape[2], prepared.observed.rules.fitting
    weight = np.concatenate([np.zeros(0), *(tether(term, unit, rules=rules) for term in terms)])
    sizes = np.concatenate([np.zeros(0), *(term.sizes for term in terms)])
    rows = np.hstack([np.zeros((len(weight), beside)), np.diag(weight)])
    return rows, -weight * sizes


def _coupled(prepared: Prepared, terms: Sequence[Term]) -> tuple[Prepared, list[Term]]:
    """The terms with loads acting through the flexibility among them as it now is, and the recording with it."""
    entries = [_entry(term) for term in terms]
    loads = [k for k, term in enumerate(terms) if through_flexibility(term.candidate)]
    products = entries_of(terms)
    if not loads or not (any(entries) or products):
        return prepared, list(terms)

    def under(changed: Sequence[EffectEntry | None]) -> Prepared:
        softer = prepared.observed.softened([*(item for item in changed if item is not None), *products])
        return replace(prepared, observed=softer)

    now = under(entries)
    coupled_terms = list(terms)
    for k in loads:
        columns = columns_of(now.observed, terms[k].candidate)
        coupled_terms[k] = _term(
            now, terms[k].candidate, terms[k].sizes, terms[k].columns if columns is None else columns
        )
    for place, own in enumerate(entries):
        if own is None:
            continue
        parts: list[Array] = []
        for name, value in own.parameters.items():
            step = DIFFERENCE * parameter_of(EFFECTS[own.effect], name).typical[1]
            further = replace(own, parameters=MappingProxyType({**own.parameters, name: value + step}))
            other = under([further if k == place else item for k, item in enumerate(entries)])
            moved = np.zeros(prepared.observed.residual.shape)
            for k in loads:
                columns = columns_of(other.observed, terms[k].candidate)
                moved += 0.0 if columns is None else columns @ terms[k].sizes - coupled_terms[k].moved
            parts.append(moved / step)
        coupled_terms[place] = replace(coupled_terms[place], through=np.stack(parts, axis=2))
    return now, coupled_terms


def _entry(term: Term) -> EffectEntry | None:
    return entry(term.candidate, term.sizes.tolist())


def _solved(
    prepared: Prepared, terms: list[Term], unit: float, still: Sequence[NDArray[np.bool_]] = ()
) -> tuple[Prepared, list[Term]]:
    """Gauss-Newton over all sizes but those of each term that stand `still` (d,), with steps halved as long as they
    make things worse; the recording with the flexibility found in it beside the terms."""
    prepared, terms = _coupled(prepared, terms)
    value = _to_be_least(prepared, terms, unit)
    for _ in range(_TOGETHER if any(term.shared for term in terms) else _NEWTON):
        design, spans = _design(prepared, terms, through=True)
        target = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
        rows, wanted = _tethers(prepared, terms, unit)
        design, white = np.vstack([design, rows]), np.concatenate([prepared.observed.whitened(target), wanted])
        stand = [k for span, item in zip(spans, still, strict=False) for k in np.arange(span.start, span.stop)[item]]
        design[:, stand] = 0.0
        together = steps_of(terms, spans, design.shape[1])
        if together is not None:
            held, asked = together.held(hold_of(prepared, terms, unit))
            design, white = np.vstack([design @ together.slopes, held]), np.concatenate([white, asked])
        step, before = solved(design, white), value
        for share in _SHARES:
            moved = share * step if together is None else together.taken(step, share)
            moved[stand] = 0.0
            new = [
                replace(_term(prepared, term.candidate, term.sizes + moved[span], term.columns), weights=term.weights)
                for term, span in zip(terms, spans, strict=True)
            ]
            trial = _coupled(
                prepared, [replace(one, through=term.through) for one, term in zip(new, terms, strict=True)]
            )
            reached = _to_be_least(*trial, unit)
            if reached <= value * (1.0 + _ROUNDING):
                break
        else:
            break
        (prepared, terms), value = trial, reached
        plain = all(linear(term.candidate) and term.through is None and not term.shared for term in terms)
        if plain or value > before * (1.0 - _SETTLED):
            break
    return prepared, terms


def _to_be_least(prepared: Prepared, terms: Sequence[Term], unit: float) -> float:
    """The sum of squares, in whitened units, of what terms and nuisances leave, and of what the tethers hold."""
    left = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
    white = prepared.observed.whitened(beyond_nuisances(prepared, left))
    _, wanted = _tethers(prepared, terms, unit)
    shared = [term.sizes[:-1] for term in terms if term.shared]
    held = hold_of(prepared, terms, unit) * (factors(np.stack(shared)).weight if shared else np.zeros(0))
    return float(white @ white) + float(wanted @ wanted) + float(held @ held)


def _left(prepared: Prepared, terms: Sequence[Term]) -> tuple[Array, float, int]:
    design, spans = _design(prepared, terms)
    together = steps_of(terms, spans, design.shape[1])
    if together is not None:
        design = design @ together.slopes
    left = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
    left = beyond_nuisances(prepared, left)
    white = prepared.observed.whitened(left)
    shapes = sum(len(term.candidate.free_shapes) for term in terms)
    return left, float(white @ white), len(white) - int(np.linalg.matrix_rank(design)) - shapes


@dataclass(frozen=True)
class _Scan:
    """What is left with other shapes of one term, all sizes fitted anew: everything else is projected out once."""

    prepared: Prepared
    candidate: Candidate
    others: Array
    left: Array
    unit: float

    def __call__(self, shapes: Mapping[str, float]) -> float:
        candidate = replace(self.candidate, shapes=MappingProxyType(dict(shapes)))
        columns = columns_of(self.prepared.observed, candidate)
        if columns is None:
            return float("inf")
        white = self.prepared.observed.whitened(columns)
        rules = self.prepared.observed.rules.fitting
        bound = held_within(candidate, columns, rules=rules)
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


def _scan(prepared: Prepared, terms: Sequence[Term], place: int, unit: float) -> _Scan:
    rest = [term for k, term in enumerate(terms) if k != place]
    design, _ = _design(prepared, rest)
    rows, _ = _tethers(prepared, rest, unit)
    others = orthonormal(np.vstack([design, rows]))
    white = prepared.observed.whitened(prepared.observed.residual)
    target = np.concatenate([white, np.zeros(len(rows))])
    return _Scan(prepared, terms[place].candidate, others, target - others @ (others.T @ target), unit)


def _shapes_found(prepared: Prepared, terms: list[Term], unit: float) -> list[Term]:
    for _, place in itertools.product(range(_SWEEPS), range(len(terms))):
        candidate = terms[place].candidate
        for name in candidate.free_shapes:
            shapes = dict(terms[place].candidate.shapes)
            middle = np.log(shapes[name])

            left = partial(_scan(prepared, terms, place, unit).at, shapes, name)
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
                    terms = [t if k != place else _term(prepared, new, t.sizes, columns) for k, t in enumerate(terms)]
    return terms


@dataclass(frozen=True)
class _Spread:
    """Standard errors of every term's sizes and their covariance, the errors by `noise` alone, whether the data tell
    each from the others, and for each of its shapes how many times as far as noise alone would have it lie."""

    errors: tuple[Array, ...]
    covariance: tuple[Array, ...]
    noise: tuple[Array, ...]
    told: tuple[NDArray[np.bool_], ...]
    shapes: tuple[Mapping[str, float], ...]


def _spread(prepared: Prepared, terms: Sequence[Term], variance: float, unnamed: Unnamed | None) -> _Spread:
    """How well sizes and shapes are known: least squares of noise of that variance, beside what is unnamed."""
    design, spans = _design(prepared, terms, through=True)
    further: list[Array] = []
    shaped: list[tuple[int, str]] = []
    for place, term in enumerate(terms):
        for name in term.candidate.free_shapes:
            shapes = dict(term.candidate.shapes)
            shapes[name] *= 1.0 + 1e-3
            other = columns_of(prepared.observed, replace(term.candidate, shapes=MappingProxyType(shapes)))
            if other is not None:
                change = (other @ term.sizes - terms[place].columns @ term.sizes) / 1e-3
                further.append(prepared.observed.whitened(change))
                shaped.append((place, name))
    unit = float(np.sqrt(variance))
    rows, _ = _tethers(prepared, terms, unit)
    together = steps_of(terms, spans, design.shape[1])
    slopes = np.eye(design.shape[1]) if together is None else together.slopes
    if together is not None:
        held, _ = together.held(hold_of(prepared, terms, unit))
        design, rows = design @ slopes, np.vstack([rows @ slopes, held])
    full = np.column_stack([design, *further]) if further else design
    held = np.hstack([rows, np.zeros((len(rows), full.shape[1] - rows.shape[1]))])
    triangle = np.linalg.qr(np.vstack([np.linalg.qr(full, mode="r"), held]), mode="r")
    size = np.linalg.norm(triangle, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, vt = np.linalg.svd(triangle / size, full_matrices=False)
    good = singular > 1e-9 * singular[0]
    turned = vt[good].T / singular[good] / size[:, None]
    plain = covariance = (turned @ turned.T) * variance
    if unnamed is not None:
        covariance = turned @ turned.T * unnamed.variance + unnamed.beside_fit(turned, full)
    count = slopes.shape[1]
    error, noise = (
        np.sqrt(np.einsum("ij,jk,ik->i", slopes, item[:count, :count], slopes)) for item in (covariance, plain)
    )
    blurred = np.diag(vt[good].T @ vt[good])[:count] <= 1.0 - 1e-6
    sure = ~((slopes != 0.0) @ blurred.astype(float) > 0.0)
    times = [dict[str, float]() for _ in terms]
    for k, (place, name) in enumerate(shaped, start=count):
        times[place][name] = float(np.sqrt(covariance[k, k] / plain[k, k])) if plain[k, k] > 0.0 else 1.0
    return _Spread(
        tuple(error[span] for span in spans),
        tuple(slopes[span] @ covariance[:count, :count] @ slopes[span].T for span in spans),
        tuple(noise[span] for span in spans),
        tuple(sure[span] for span in spans),
        tuple(times),
    )


def _parameters(
    prepared: Prepared,
    terms: Sequence[Term],
    place: int,
    spread: _Spread,
    residual: Array,
    freedom: int,
    variance: float,
    unnamed: Unnamed | None,
) -> tuple[FittedParameter, ...]:
    arm, term, rules = prepared.observed.arm, terms[place], prepared.observed.rules.fitting
    errors, told, times = spread.errors[place], spread.told[place], spread.shapes[place]
    candidate = term.candidate
    factor = t_quantile(freedom)
    at = candidate.numbers
    ending = f"_{at[0]}" if len(at) == 1 else ""
    summed = _summed(prepared, terms, place, spread, factor, variance)
    if term.shared:
        kind = kind_of(arm, candidate, candidate.sizes[0])
        known = known_load(term, kind, errors, spread.noise[place], told, factor, at, rules.telling)
        return (sag(prepared, term, factor, variance, at, unnamed, spread.covariance[place]), *known)
    parameters: list[FittedParameter] = []
    # What the data say next to nothing of is held at nought by its bounds, and is no part of the finding.
    held = tether(term, 1.0, rules=rules) * spread.noise[place] > rules.held
    seen = ~held if (~held).any() and len(held) <= rules.many_sizes else np.ones(len(held), dtype=bool)
    fitted = zip(candidate.sizes, term.sizes.tolist(), errors.tolist(), told.tolist(), seen.tolist(), strict=True)
    if summed is not None:
        total, beside = summed
        parameters.append(total)
        fitted = [item for item in fitted if item[0] == beside]
    others = collinear_with(prepared, terms, place)
    # Room for what is not named makes all of a finding as much less sure.
    less_sure = float(np.max(errors / np.maximum(spread.noise[place], _TINY), initial=1.0))
    left = prepared.observed.whitened(residual)
    besides = at_active_bounds(prepared, terms, place, left, factor * less_sure * float(np.sqrt(variance)))
    for name, value, error, sure, shown in fitted:
        if not shown:
            continue
        low, high = bounds(candidate, name, prepared)
        reach = factor * error if sure else float("inf")
        below, above = besides.get(name, (0.0, 0.0))
        least, most = value - reach, value + reach
        interval = (min(least, max(low, least - below)), max(most, min(high, most + above)))
        kind = kind_of(arm, candidate, name)
        also = others.get(name)
        # What another effect may be of it ends where the size itself would be impossible.
        ends = (
            (max(low, interval[0] - also.below), min(high, interval[1] + also.above)) if also is not None else interval
        )
        parameters.append(
            FittedParameter(
                f"{name}{ending}",
                name,
                at,
                kind,
                value,
                interval,
                not low < value < high or math.isclose(value, low) or math.isclose(value, high),
                "" if also is None else also.effect,
                None if also is None else (min(interval[0], ends[0]), max(interval[1], ends[1])),
            )
        )
    for name in candidate.free_shapes:
        kind = kind_of(arm, candidate, name)
        value = candidate.shapes[name]
        interval = _profile(prepared, terms, place, name, factor * times.get(name, 1.0), freedom, variance)
        parameters.append(FittedParameter(f"{name}{ending}", name, at, kind, value, interval))
    for name, value in candidate.shapes.items():
        if name in candidate.whole_shapes:
            kind = kind_of(arm, candidate, name)
            parameters.append(FittedParameter(f"{name}{ending}", name, at, kind, value, (value, value)))
    return tuple(parameters)


def _summed(
    prepared: Prepared, terms: Sequence[Term], place: int, spread: _Spread, factor: float, variance: float
) -> tuple[FittedParameter, str] | None:
    """The sum of sizes by which a finding is told where its effect has one, and the name of the size that is told
    beside it, which is none where it shows in the sum alone; None where the effect has no such sum."""
    term, candidate, arm = terms[place], terms[place].candidate, prepared.observed.arm
    effect = None if candidate.outside or candidate.share or term.shared else EFFECTS[candidate.effect]
    if effect is None or effect.told_as is None or len(candidate.at) != 1:
        return None
    beams = [link.beam for link in prepared.observed.state.links]
    factors = effect.told_as.factors(beams, candidate.at[0])
    if factors is None:
        return None
    whole = replace(candidate, sizes=tuple(factors))
    columns = columns_of(prepared.observed, whole)
    white = None if columns is None else prepared.observed.whitened(columns)
    moved = None if white is None else np.linalg.norm(white, axis=0)
    if moved is not None and np.min(moved) <= 1e-12 * np.max(moved):
        return None  # nothing below gives, and the link itself bends as if a lump were spread: no place shows
    along = np.array([factors[name] for name in candidate.sizes])
    value = float(along @ term.sizes)
    reach = factor * float(np.sqrt(max(along @ spread.covariance[place] @ along, 0.0)))
    name, at = effect.told_as.name, candidate.numbers
    kind = kind_of(arm, candidate, name)
    total = FittedParameter(f"{name}_{at[0]}", name, at, kind, value, (value - reach, value + reach))
    if white is None or moved is None or effect.told_as.beside not in candidate.sizes:
        return total, ""
    others = orthonormal(_design(prepared, [t for k, t in enumerate(terms) if k != place])[0])
    alone = white - others @ (others.T @ white)
    shown = np.linalg.norm(alone, axis=0) > 1e-9 * moved  # what others do as well leaves rounding
    beside = whole.sizes.index(effect.told_as.beside)
    if not shown[beside]:
        return total, ""
    size, beside = float(np.linalg.norm(alone[:, beside])), int(np.sum(shown[:beside]))
    alone = alone[:, shown]
    _, singular, vt = np.linalg.svd(alone / np.linalg.norm(alone, axis=0), full_matrices=False)
    error = float(np.sqrt(variance * np.sum((vt[:, beside] / np.maximum(singular, 1e-9 * singular[0])) ** 2))) / size
    known = float(term.sizes[candidate.sizes.index(effect.told_as.beside)])
    telling = factor * error <= prepared.observed.rules.fitting.telling * abs(known)
    return total, effect.told_as.beside if telling else ""


def _profile(
    prepared: Prepared,
    terms: Sequence[Term],
    place: int,
    name: str,
    factor: float,
    freedom: int,
    variance: float,
) -> tuple[float, float]:
    """The values of a shape between which the likelihood falls by less than the t quantile allows."""
    shapes = dict(terms[place].candidate.shapes)
    best = shapes[name]
    scan = _scan(prepared, terms, place, float(np.sqrt(variance)))
    limit = scan(shapes) * (1.0 + factor**2 / max(freedom, 1))
    candidate = terms[place].candidate
    if parameter_of(EFFECTS[candidate.effect], name).threshold:
        return no_worse_than(limit, partial(scan.at, shapes, name), prepared.observed, candidate, best)
    ends: list[float] = []
    for direction in (-1.0, 1.0):
        inside, end = 0.0, float("inf")
        for step in np.geomspace(0.005, np.log(30.0), _SCAN).tolist():
            if scan.at(shapes, name, np.log(best) + direction * step) > limit:
                end = step
                break
            inside = step
        if np.isfinite(end):
            for _ in range(10):
                middle = 0.5 * (inside + end)
                over = scan.at(shapes, name, np.log(best) + direction * middle) > limit
                inside, end = (inside, middle) if over else (middle, end)
            ends.append(best * float(np.exp(direction * end)))
        else:
            ends.append(0.0 if direction < 0.0 else float("inf"))
    return ends[0], ends[1]
