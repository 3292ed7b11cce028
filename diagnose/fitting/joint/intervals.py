"""Intervals of a joint fit's sizes and shapes, by profile likelihood: for sizes those of least squares with the shapes'
uncertainty in it, for a shape the values at which the likelihood, sizes fitted anew, falls by the t quantile's
square."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import bounds, t_quantile
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.room.active_bounds import at_active_bounds
from linkwright.core.diagnose.fitting.room.collinearity import collinear_with
from linkwright.core.diagnose.fitting.room.unnamed import Unnamed
from linkwright.core.diagnose.fitting.terms import Term
from linkwright.core.diagnose.fitting.thresholds import no_worse_than
from linkwright.core.diagnose.fitting.unknown_masses import hold_of, known_load, sag, steps_of
from linkwright.core.diagnose.patterns.library import columns_of, kind_of, parameter_of
from linkwright.core.diagnose.patterns.pool import orthonormal, triangle
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.sections.numeric import Array

from .shapes import scan_of
from .sizes import design_of, tether, tethers

_SCAN = 14
_TINY = 1e-30


@dataclass(frozen=True)
class Spread:
    """Standard errors of every term's sizes and their covariance, the errors by `noise` alone, whether the data tell
    each from the others, and for each of its shapes how many times as far as noise alone would have it lie."""

    errors: tuple[Array, ...]
    covariance: tuple[Array, ...]
    noise: tuple[Array, ...]
    determined: tuple[NDArray[np.bool_], ...]
    shapes: tuple[Mapping[str, float], ...]


def spread_of(prepared: Prepared, terms: Sequence[Term], variance: float, unnamed: Unnamed | None) -> Spread:
    """How well sizes and shapes are known: least squares of noise of that variance, beside what is unnamed."""
    design, spans = design_of(prepared, terms, through=True)
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
    rows, _ = tethers(prepared, terms, unit)
    together = steps_of(terms, spans, design.shape[1])
    slopes = np.eye(design.shape[1]) if together is None else together.slopes
    if together is not None:
        held, _ = together.held(hold_of(prepared, terms, unit))
        design, rows = design @ slopes, np.vstack([rows @ slopes, held])
    full = np.column_stack([design, *further]) if further else design
    held = np.hstack([rows, np.zeros((len(rows), full.shape[1] - rows.shape[1]))])
    whole = triangle(np.vstack([triangle(full), held]))
    size = np.linalg.norm(whole, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, vt = np.linalg.svd(whole / size, full_matrices=False)
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
    return Spread(
        tuple(error[span] for span in spans),
        tuple(slopes[span] @ covariance[:count, :count] @ slopes[span].T for span in spans),
        tuple(noise[span] for span in spans),
        tuple(sure[span] for span in spans),
        tuple(times),
    )


def parameters_of(
    prepared: Prepared,
    terms: Sequence[Term],
    place: int,
    spread: Spread,
    residual: Array,
    freedom: int,
    variance: float,
    unnamed: Unnamed | None,
) -> tuple[FittedParameter, ...]:
    """The parameters of the term at a place, each with its interval; `residual` (N, C) and `variance` are what the fit
    leaves, `freedom` its degrees of freedom."""
    arm, term, rules = prepared.observed.arm, terms[place], prepared.observed.rules.fitting
    errors, determined, times = spread.errors[place], spread.determined[place], spread.shapes[place]
    candidate = term.candidate
    factor = t_quantile(freedom)
    at = candidate.numbers
    ending = f"_{at[0]}" if len(at) == 1 else ""
    summed = _summed(prepared, terms, place, spread, factor, variance)
    if term.shared:
        kind = kind_of(arm, candidate, candidate.sizes[0])
        known = known_load(term, kind, errors, spread.noise[place], determined, factor, at, rules.telling)
        return (sag(prepared, term, factor, variance, at, unnamed, spread.covariance[place]), *known)
    parameters: list[FittedParameter] = []
    # What the data say next to nothing of is held at zero by its bounds, and is no part of the finding.
    held = tether(term, 1.0, rules=rules) * spread.noise[place] > rules.held
    seen = ~held if (~held).any() and len(held) <= rules.many_sizes else np.ones(len(held), dtype=bool)
    fitted = zip(candidate.sizes, term.sizes.tolist(), errors.tolist(), determined.tolist(), seen.tolist(), strict=True)
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
    prepared: Prepared, terms: Sequence[Term], place: int, spread: Spread, factor: float, variance: float
) -> tuple[FittedParameter, str] | None:
    """The sum of sizes by which a finding is reported where its effect has one, and the name of the size that is told
    beside it, which is none where it shows in the sum alone; None where the effect has no such sum."""
    term, candidate, arm = terms[place], terms[place].candidate, prepared.observed.arm
    effect = None if candidate.outside or candidate.share or term.shared else EFFECTS[candidate.effect]
    if effect is None or effect.recording.told_as is None or len(candidate.at) != 1:
        return None
    beams = [link.beam for link in prepared.observed.state.links]
    factors = effect.recording.told_as.factors(beams, candidate.at[0])
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
    name, at = effect.recording.told_as.name, candidate.numbers
    kind = kind_of(arm, candidate, name)
    total = FittedParameter(f"{name}_{at[0]}", name, at, kind, value, (value - reach, value + reach))
    beside = effect.recording.told_as.beside
    if white is None or moved is None or beside not in candidate.sizes:
        return total, ""
    others, number = [t for k, t in enumerate(terms) if k != place], whole.sizes.index(beside)
    known = abs(float(term.sizes[candidate.sizes.index(beside)]))
    unsure = factor * _error_beside(prepared, others, white, number, variance)
    return total, beside if unsure <= prepared.observed.rules.fitting.telling * known else ""


def _error_beside(prepared: Prepared, others: Sequence[Term], white: Array, place: int, variance: float) -> float:
    """The standard error of the size of one of a finding's columns (n, d) beside the rest and `others`, whose residual
    has this `variance`; infinite where these do all that it does."""
    basis = orthonormal(design_of(prepared, others)[0])
    alone = white - basis @ (basis.T @ white)
    # What others do as well leaves rounding.
    shown = np.linalg.norm(alone, axis=0) > 1e-9 * np.linalg.norm(white, axis=0)
    if not shown[place]:
        return np.inf
    size, place = float(np.linalg.norm(alone[:, place])), int(np.sum(shown[:place]))
    alone = alone[:, shown]
    _, singular, vt = np.linalg.svd(alone / np.linalg.norm(alone, axis=0), full_matrices=False)
    return float(np.sqrt(variance * np.sum((vt[:, place] / np.maximum(singular, 1e-9 * singular[0])) ** 2))) / size


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
    scan = scan_of(prepared, terms, place, float(np.sqrt(variance)))
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
