"""Findings that mean something only together: singly others would take their place, or they only balance each other."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from linkwright.core.diagnose.fitting.fit import normal_solution
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.refit import Refit
from linkwright.core.diagnose.fitting.unknown_masses import CHANGE, SAG
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.diagnose.rules.answer_rules import AnswerRules
from linkwright.core.diagnose.rules.rules import RULES


def may_be_nothing(parameters: Sequence[FittedParameter], sizes: Sequence[str]) -> bool:
    """Whether the intervals of all sizes of a finding hold zero."""
    intervals = [parameter.interval for parameter in parameters if parameter.parameter in (*sizes, SAG, CHANGE)]
    return bool(intervals) and all(low <= 0.0 <= high for low, high in intervals)


def only_with(prepared: Prepared, refit: Refit, *, rules: AnswerRules = RULES.answer) -> Mapping[int, tuple[int, ...]]:
    """The places of findings that mean nothing singly, each with the places of those that would take its place: it may
    be nothing by itself, or all but cancels them and would be missed by little, or is more than the whole mismatch and
    would be missed by as little."""
    terms = refit.terms
    edges = np.cumsum([0, *(term.columns.shape[2] for term in terms)]).tolist()
    spans = [slice(a, b) for a, b in itertools.pairwise(edges)]
    if len(terms) < 2:
        return {}
    columns = np.concatenate([term.columns for term in terms], axis=2)
    beside, white = orthonormal(prepared.observed.whitened(prepared.beside)), prepared.observed.whitened(columns)
    white -= beside @ (beside.T @ white)
    most = prepared.observed.rules.search.balanced**2 * float(prepared.vector @ prepared.vector)
    gram, sizes = white.T @ white, np.concatenate([term.sizes for term in terms])
    together: dict[int, tuple[int, ...]] = {}
    for place, (term, parameters) in enumerate(zip(terms, refit.parameters, strict=True)):
        columns_here = np.arange(edges[-1])[spans[place]]
        rest = np.setdiff1d(np.arange(edges[-1]), columns_here)
        moved = gram[:, columns_here] @ sizes[columns_here]
        whole = float(sizes[columns_here] @ moved[columns_here])
        instead = np.zeros(edges[-1])
        instead[rest] = normal_solution(gram[np.ix_(rest, rest)], moved[rest])
        alone = whole - float(instead @ moved)
        nothing = may_be_nothing(parameters, term.candidate.sizes)
        if alone > (0.5 if nothing else rules.cancelled**2) * whole:
            continue
        others = [
            k
            for k, span in enumerate(spans)
            if k != place and float(instead[span] @ gram[span, span] @ instead[span]) > rules.takes_over**2 * whole
        ]
        both = np.zeros(edges[-1])
        for k in (place, *others):
            both[spans[k]] = sizes[spans[k]]
        cancels = float(both @ gram @ both) < rules.cancelled**2 * whole or whole > most
        if others and (nothing or cancels):
            together[place] = tuple(others)
    return together
