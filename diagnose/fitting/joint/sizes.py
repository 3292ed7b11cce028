"""Sizes of all findings solved for together: Gauss-Newton, loads acting through the flexibility among them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import beyond_nuisances, solved
from linkwright.core.diagnose.fitting.prepare import Prepared, held_within
from linkwright.core.diagnose.fitting.shared_masses import Steps, factors
from linkwright.core.diagnose.fitting.terms import DIFFERENCE, Term, linear, term_at
from linkwright.core.diagnose.fitting.unknown_masses import entries_of, hold_of, steps_of
from linkwright.core.diagnose.patterns.flexibility import entry, through_flexibility
from linkwright.core.diagnose.patterns.library import columns_of, parameter_of
from linkwright.core.diagnose.patterns.pool import triangle
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

_NEWTON = 6
_TOGETHER = 30
_SETTLED = 1e-9
"""A step that lowers the sum of squares by so small a share is the last."""
_SHARES = (1.0, 0.5, 0.25, 0.125, 1.0 / 16.0, 1.0 / 64.0)
_ROUNDING = 1e-9


def design_of(
    prepared: Prepared, terms: Sequence[Term], *, through: bool = False, held: Array | None = None
) -> tuple[Array, list[slice]]:
    """Whitened columns of the nuisances and of all terms, and where each term's are; with `through`, what flexibility
    does for the loads among the terms counts as its own. Rows by which sizes are `held` stand below."""
    columns = [term.columns if term.through is None or not through else term.columns + term.through for term in terms]
    parts = [prepared.beside, *columns]
    edges = np.cumsum([0, *(part.shape[2] for part in parts)]).tolist()
    spans = [slice(a, b) for a, b in itertools.pairwise(edges)]
    return side_by_side(prepared.observed, parts, held), spans[1:]


def side_by_side(observed: Observed, parts: Sequence[Array], below: Array | None = None) -> Array:
    """Whitened columns of some parts (N, C, d), with rows below. One after the other: copies of all columns of a long
    recording are hundreds of megabytes."""
    count, edges = observed.residual.size, np.cumsum([0, *(part.shape[2] for part in parts)]).tolist()
    design = np.empty((count + (0 if below is None else len(below)), edges[-1]))
    for (start, end), part in zip(itertools.pairwise(edges), parts, strict=True):
        design[:count, start:end] = observed.whitened(part)
    if below is not None:
        design[count:] = below
    return design


def tether(term: Term, unit: float, width: float = np.inf, *, rules: FittingRules = RULES.fitting) -> Array:
    """What holds a finding's sizes (d,) within their physical bounds, and what badly known ones are near the usual:
    `unit`, the scatter of whitened residuals, over a fifth of the bound or the largest that is usual, whichever is
    less. What the data tell ten times as well as that it leaves where they put it."""
    bound = held_within(term.candidate, term.columns, width, rules=rules)
    return np.zeros(len(term.sizes)) if bound is None else unit * rules.tether / bound


def tethers(prepared: Prepared, terms: Sequence[Term], unit: float) -> tuple[Array, Array]:
    """Rows that hold each size (see `tether`): weights (k, b + k) and what they ask for (k,), for the step from the
    present sizes."""
    beside, rules = prepared.beside.shape[2], prepared.observed.rules.fitting
    weight = np.concatenate([np.zeros(0), *(tether(term, unit, prepared.width, rules=rules) for term in terms)])
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
        coupled_terms[k] = term_at(
            now.observed, terms[k].candidate, terms[k].sizes, terms[k].columns if columns is None else columns
        )
    for place, entry_here in enumerate(entries):
        if entry_here is None:
            continue
        parts: list[Array] = []
        for name, value in entry_here.parameters.items():
            step = DIFFERENCE * parameter_of(EFFECTS[entry_here.effect], name).typical[1]
            further = replace(entry_here, parameters=MappingProxyType({**entry_here.parameters, name: value + step}))
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


def solved_together(
    prepared: Prepared,
    terms: list[Term],
    unit: float,
    still: Sequence[NDArray[np.bool_]] = (),
    *,
    bounded: bool = False,
) -> tuple[Prepared, list[Term]]:
    """Gauss-Newton over all sizes but those of each term that stand `still` (d,), with steps halved as long as they
    make things worse; the recording with the flexibility found in it beside the terms. Where they are `bounded`,
    compliances under unknown weights stop at zero."""
    prepared, terms = _coupled(prepared, terms)
    value = _to_be_least(prepared, terms, unit)
    for _ in range(_TOGETHER if any(term.shared for term in terms) else _NEWTON):
        target = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
        rows, wanted = tethers(prepared, terms, unit)
        design, spans = design_of(prepared, terms, through=True, held=rows)
        white = np.concatenate([prepared.observed.whitened(target), wanted])
        stand = [k for span, item in zip(spans, still, strict=False) for k in np.arange(span.start, span.stop)[item]]
        design[:, stand] = 0.0
        together = steps_of(terms, spans, design.shape[1])
        if together is not None:
            held, asked = together.held(hold_of(prepared, terms, unit))
            design, white = np.vstack([design @ together.slopes, held]), np.concatenate([white, asked])
        step, before = _step(design, white, together if bounded else None), value
        for share in _SHARES:
            moved = share * step if together is None else together.taken(step, share, bounded=bounded)
            moved[stand] = 0.0
            new = [
                replace(
                    term_at(prepared.observed, term.candidate, term.sizes + moved[span], term.columns),
                    weights=term.weights,
                )
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


def _step(design: Array, white: Array, together: Steps | None) -> Array:
    """A step by least squares; where steps go `together` under weights, those that would take a compliance below zero
    stand, one after the other."""
    step, below = solved(design, white), set[int]()
    while together is not None and (more := together.at_zero(step) - below):
        below |= more
        design[:, sorted(below)] = 0.0
        step = solved(design, white)
        step[sorted(below)] = 0.0
    return step


def _to_be_least(prepared: Prepared, terms: Sequence[Term], unit: float) -> float:
    """The sum of squares, in whitened units, of what terms and nuisances leave, and of what the tethers hold."""
    left = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
    white = prepared.observed.whitened(beyond_nuisances(prepared, left))
    _, wanted = tethers(prepared, terms, unit)
    shared = [term.sizes[:-1] for term in terms if term.shared]
    held = hold_of(prepared, terms, unit) * (factors(np.stack(shared)).weight if shared else np.zeros(0))
    return float(white @ white) + float(wanted @ wanted) + float(held @ held)


def left_by(prepared: Prepared, terms: Sequence[Term]) -> tuple[Array, float, int]:
    """What terms and nuisances leave (N, C), its sum of squares in whitened units, and its degrees of freedom."""
    design, spans = design_of(prepared, terms)
    together = steps_of(terms, spans, design.shape[1])
    if together is not None:
        design = design @ together.slopes
    left = prepared.observed.residual - sum((term.moved for term in terms), np.zeros(1))
    left = beyond_nuisances(prepared, left)
    white = prepared.observed.whitened(left)
    shapes = sum(len(term.candidate.free_shapes) for term in terms)
    values = np.linalg.svd(triangle(design), compute_uv=False)
    rank = int(np.sum(values > max(design.shape) * np.finfo(float).eps * values.max(initial=0.0)))
    return left, float(white @ white), len(white) - rank - shapes
