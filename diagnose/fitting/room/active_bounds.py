"""How far sizes of a finding may be off for further sizes of its effect that were left at zero.

Friction winds a drive up by a constant and by a share of its load, always by both. A recording whose loads differ
little tells their sum, and the finding that one of them makes is chosen, since the other is not told beside it. But
not told is not zero: it may be as large as the recording allows, up to what is usual, and what it takes is missing
from the size that was fitted in its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.effects import EFFECTS, Parameter
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.terms import Term
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.sections.numeric import Array

_ALIKE = 1e-9
"""Of a pattern's length, what rounding leaves beside another that is the same."""


def at_active_bounds(
    prepared: Prepared, terms: Sequence[Term], place: int, left: Array, reach: float
) -> dict[str, tuple[float, float]]:
    """By the name of each size of a finding how far it may lie below and above what was fitted, SI, for what its effect
    has besides. `left` (n,) is the whitened remainder of the fit, `reach` half an interval in whitened units."""
    term = terms[place]
    candidate = term.candidate
    if candidate.outside or candidate.share or term.shared or candidate.only is not None:
        return {}
    effect, held = EFFECTS[candidate.effect], prepared.observed.state.conditions
    further = [
        size
        for size in (effect.sizes_here(prepared.observed.arm, candidate.at) if effect.recording.told_as is None else ())
        if size.name not in candidate.sizes
        and (
            size.optional
            or all(other_size.optional for other_size in effect.sizes if other_size.name in candidate.sizes)
        )
        and all(getattr(held, condition) is not None for condition in size.requires)
    ]
    active = dict.fromkeys(candidate.sizes, (0.0, 0.0))
    if not further:
        return {}
    white = prepared.observed.whitened
    others = [item.columns for k, item in enumerate(terms) if k != place]
    beside = orthonormal(white(np.concatenate([prepared.beside, *others], axis=2)))
    white_columns = white(term.columns)
    white_columns = white_columns - beside @ (beside.T @ white_columns)
    for parameter in further:
        columns = columns_of(prepared.observed, replace(candidate, sizes=(parameter.name,)))
        if columns is None:
            continue
        pattern = white(columns)[:, 0]
        seen = pattern - beside @ (beside.T @ pattern)
        taken = np.linalg.lstsq(white_columns, seen, rcond=None)[0]
        low, high = _between(parameter, seen - white_columns @ taken, pattern, left, reach)
        for name, slope in zip(candidate.sizes, (-taken).tolist(), strict=True):
            ends = (slope * low, slope * high)
            below, above = active[name]
            active[name] = (below + max(0.0, -min(ends)), above + max(0.0, *ends))
    return active


def _between(parameter: Parameter, alone: Array, whole: Array, left: Array, reach: float) -> tuple[float, float]:
    """The least and the greatest that a size may be, about zero, by what it does alone (n,) and what is left: within
    what is usual and what is possible."""
    usual = max(abs(end) for end in parameter.typical)
    low, high = max(parameter.lower, -usual), min(parameter.upper, usual)
    norm = float(np.linalg.norm(alone))
    if norm > _ALIKE * float(np.linalg.norm(whole)):
        best = float(alone @ left) / norm**2
        low, high = max(low, best - reach / norm), min(high, best + reach / norm)
    return min(low, 0.0), max(high, 0.0)
