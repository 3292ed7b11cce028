"""What a joint fit does about links that nobody has weighed: one set of weights under all that gives, what known loads
tell of a compliance beside it, and how far that sags."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.joint_compliance import file_compliance
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.patterns.unknown_weights import (
    Weight,
    columns_under_weights,
    levers,
    only_products,
    product_entry,
    turned_under_weights,
    unknown_weights,
    weight_entries,
    weights_given,
)
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.sections.numeric import Array

from .fit import solved, t_quantile
from .prepare import Prepared
from .room.unnamed import Unnamed
from .shared_masses import Steps, factors, steps, under_one
from .terms import Term

SAG, CHANGE = "sag", "sag_change"
"""The parameters that stand for a compliance under weights that nobody knows: the most that something sags over a
recording, and where the frame is free the most that its sag changes."""


def under_one_set_of_weights(
    prepared: Prepared, terms: list[Term], unit: float, *, bounded: bool = False
) -> tuple[list[Term], tuple[Weight, ...]]:
    """The terms, those that give under unknown weights with a column for each weight that any of them shows, as they
    fit best under one set of weights, `bounded` or not (see `under_one`); `unit` is the scatter of whitened
    residuals."""
    observed = prepared.observed
    places = [k for k, t in enumerate(terms) if _only_products(observed, t.candidate)]
    if not places or weights_given(observed):
        return [replace(t, weights=() if k in places else None) for k, t in enumerate(terms)], ()
    masses = any(EFFECTS[terms[k].candidate.effect].recording.under_forces for k in places)
    weights, merged = unknown_weights(observed, masses=masses), list(terms)
    for k in places:
        candidate = terms[k].candidate
        columns = columns_under_weights(observed, candidate.effect, candidate.at, weights)
        sizes = solved(observed.whitened(columns), observed.whitened(terms[k].moved))
        merged[k] = Term(candidate, sizes, columns, columns @ sizes, weights=weights)
    shared = [merged[k] for k in places]
    others = [term for k, term in enumerate(terms) if k not in places]
    target = observed.residual - sum((item.moved - item.columns @ item.sizes for item in others), np.zeros(1))
    rest = orthonormal(observed.whitened(np.concatenate([prepared.beside, *(item.columns for item in others)], axis=2)))
    tall = np.hstack([*(observed.whitened(item.columns) for item in shared), observed.whitened(target)[:, None]])
    small = np.linalg.qr(tall - rest @ (rest.T @ tall))[1]
    begun = np.stack([item.sizes for item in shared])
    sizes = under_one(
        small[:, :-1].reshape(len(small), *begun.shape),
        small[:, -1],
        begun,
        _hold(prepared, weights, unit),
        bounded=bounded,
    )
    for k, sizes_here in zip(places, sizes, strict=True):
        merged[k] = replace(merged[k], sizes=sizes_here, moved=merged[k].columns @ sizes_here)
    return merged, weights


def _only_products(observed: Observed, candidate: Candidate) -> bool:
    inside = not (candidate.outside or candidate.share)
    return inside and only_products(observed, EFFECTS[candidate.effect], candidate.at)


def not_under_known_loads(
    prepared: Prepared,
    terms: Sequence[Term],
    errors: Sequence[Array],
    determined: Sequence[NDArray[np.bool_]],
    freedom: int,
) -> set[int]:
    """The places of the terms under unknown weights whose own size the known loads do not tell, or would make what
    cannot be."""
    factor, doubtful = t_quantile(freedom), set[int]()
    for k, term in enumerate(terms):
        if not term.shared or not term.columns[:, :, -1].any():
            continue
        candidate, value = term.candidate, float(term.sizes[-1])
        least = -file_compliance(prepared.observed.arm, candidate.at[0]) if candidate.of_drives else 0.0
        telling = prepared.observed.rules.fitting.telling
        if value <= least or not determined[k][-1] or factor * float(errors[k][-1]) > telling * abs(value):
            doubtful.add(k)
    return doubtful


def less_known(term: Term) -> Term:
    """A term under unknown weights that known loads do not move."""
    columns, sizes = term.columns.copy(), term.sizes.copy()
    columns[:, :, -1], sizes[-1] = 0.0, 0.0
    return replace(term, columns=columns, sizes=sizes, moved=columns @ sizes)


def steps_of(terms: Sequence[Term], spans: Sequence[slice], count: int) -> Steps | None:
    """The coordinates of a fit's steps where terms share unknown weights, None where none do (or the file has them)."""
    shared = [span for term, span in zip(terms, spans, strict=True) if term.shared]
    if not shared:
        return None
    return steps(count, shared, factors(np.stack([term.sizes[:-1] for term in terms if term.shared])))


def hold_of(prepared: Prepared, terms: Sequence[Term], unit: float) -> Array:
    """How strongly unknown weights (K,) are held to zero where data do not show them: `unit`, the scatter of whitened
    residuals, over how large one may be against the largest. A first moment is a mass, no more than all of them, times
    a lever, no longer than what lies beyond the joint."""
    weights = next((term.weights for term in terms if term.weights is not None), None)
    if not weights:
        return np.zeros(0 if weights is None else 1)
    return _hold(prepared, weights, unit)


def _hold(prepared: Prepared, weights: Sequence[Weight], unit: float) -> Array:
    return unit / levers(prepared.observed.arm, weights, prepared.observed.rules.fitting.least_lever)


def entries_of(terms: Sequence[Term]) -> tuple[EffectEntry, ...]:
    """What gives under unknown weights among the terms, with those weights, as entries."""
    shared = [term for term in terms if term.weights is not None]
    if not shared:
        return ()
    shared_factors = factors(np.stack([term.sizes[:-1] for term in shared]))
    giving = zip(shared, shared_factors.compliance.tolist(), strict=True)
    return (
        *weight_entries(shared[0].weights or (), shared_factors.weight.tolist() if shared[0].weights else ()),
        *(product_entry(term.candidate.effect, term.candidate.numbers, product) for term, product in giving),
    )


def known_load(
    term: Term,
    kind: str,
    errors: Array,
    noise: Array,
    determined: NDArray[np.bool_],
    factor: float,
    at: tuple[int, ...],
    telling: float,
) -> tuple[FittedParameter, ...]:
    """The compliance where links weigh an unknown amount but another load (the payload's) is known and changes:
    its column, the last, tells it. Nothing where the data hardly do."""
    value, error = float(term.sizes[-1]), float(errors[-1])
    if not determined[-1] or factor * float(noise[-1]) > telling * abs(value):
        return ()
    interval = (value - factor * error, value + factor * error)
    name = term.candidate.sizes[0]
    return (FittedParameter("_".join([name, *map(str, at)]), name, at, kind, value, interval),)


def sag(
    prepared: Prepared,
    term: Term,
    factor: float,
    variance: float,
    at: tuple[int, ...],
    unnamed: Unnamed | None,
    covariance: Array,
) -> FittedParameter:
    """Where the links' masses are unknown, a compliance cannot be had by itself: the most that something sags under
    their weight over the recording stands for it, with the relative error of the whole displacement. A frame that is
    free takes up most of what is there at all readings, so that only the change from one to another is known then, as
    well as the products' `covariance` tells how they share it."""
    observed, candidate = prepared.observed, term.candidate
    slides = candidate.of_drives and not observed.arm.joints[candidate.at[0]].revolute
    change = observed.recording.frame == "free"
    turn = _turned(observed, term, term.sizes)
    first = _furthest(turn - turn.mean(axis=0)) if change else None
    seen = turn if first is None else turn - turn[first]
    last = _furthest(seen)
    most = seen[last]
    value = float(most[0]) if candidate.of_drives and not change else float(np.linalg.norm(most))
    shown = prepared.pool.projected(observed.whitened(term.moved))
    length = max(float(shown @ shown), 1e-300)
    if unnamed is not None:
        variance = unnamed.variance + float(unnamed.beside(shown[None, :])[0, 0]) / length
    error = abs(value) * float(np.sqrt(variance / length))
    if first is not None and value > 0.0:
        units = [_turned(observed, term, unit) for unit in np.eye(len(term.sizes))[: len(covariance)]]
        slopes = np.array([float((unit[last] - unit[first]) @ most) / value for unit in units])
        error = max(error, float(np.sqrt(slopes @ covariance @ slopes)))
    interval = (value - factor * error, value + factor * error)
    name = CHANGE if change else SAG
    return FittedParameter("_".join([name, *map(str, at)]), name, at, "length" if slides else "angle", value, interval)


def _turned(observed: Observed, term: Term, sizes: Array) -> Array:
    """How far (N, 1 or 3), rad or m, something turns or slides under unknown weights with these sizes of its term."""
    candidate = term.candidate
    if not candidate.of_drives:
        return turned_under_weights(observed, candidate.effect, candidate.at, term.weights or (), sizes[:-1])
    unit = observed.drive_moved(candidate.at[0])
    reach = np.sum(unit**2, axis=1)
    return (np.sum((term.columns @ sizes) * unit, axis=1) / np.where(reach > 0.0, reach, 1.0))[:, None]


def _furthest(turn: Array) -> int:
    """The reading of the longest of some turns (N, k)."""
    return int(np.argmax(np.linalg.norm(turn, axis=1)))
