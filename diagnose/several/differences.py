"""What differs from one recording to the other: the sizes that each recording has of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.fitting.fit import t_quantile
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.refit import Refit
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, kind_of, of_one
from linkwright.core.diagnose.result import Difference, FittedParameter
from linkwright.core.sections.numeric import Array


def differences(
    prepared: Prepared, refit: Refit, outside: Sequence[int], p_values: Sequence[float]
) -> tuple[Difference, ...]:
    """Of each finding that acts in one recording alone, its sizes in every recording, all else fitted with them.

    `outside` are the forms beside the findings (their groups), `p_values` those of the findings' tests.
    """
    places: dict[tuple[str, tuple[int, ...]], list[int]] = {}
    for place, term in enumerate(refit.terms):
        if term.candidate.only is not None:
            places.setdefault((term.candidate.effect, term.candidate.at), []).append(place)
    differing: list[Difference] = []
    for (effect, at), places_here in places.items():
        candidate = replace(refit.terms[places_here[0]].candidate, only=None)
        rest = [t for t in refit.terms if (t.candidate.effect, t.candidate.at) != (effect, at)]
        forms = [prepared.columns[m] for m in outside]
        beside = np.concatenate([prepared.beside, *(t.columns for t in rest), *forms], axis=2)
        target = prepared.observed.residual - sum((t.moved - t.columns @ t.sizes for t in rest), np.zeros(1))
        p = max((p_values[place] for place in places_here if place < len(p_values)), default=float("nan"))
        differing += _of_one(prepared, candidate, beside, target, refit, p)
    return tuple(differing)


def _of_one(
    prepared: Prepared, candidate: Candidate, beside: Array, target: Array, refit: Refit, p_value: float
) -> list[Difference]:
    observed = prepared.observed
    columns, which = columns_of(observed, candidate), observed.which
    if columns is None:
        return []
    recordings = range(int(which.max()) + 1)
    design = np.concatenate([*(of_one(observed, columns, one) for one in recordings), beside], axis=2)
    white = observed.whitened(design)
    size = np.linalg.norm(white, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, vt = np.linalg.svd(white / size, full_matrices=False)
    good = singular > 1e-9 * singular[0]
    inverse = (vt[good].T / singular[good] ** 2) @ vt[good]
    values = inverse @ ((white / size).T @ observed.whitened(target)) / size
    determined = np.diag(vt[good].T @ vt[good]) > 1.0 - 1e-6
    errors = np.sqrt(np.diag(inverse) * refit.rss / max(refit.freedom, 1)) / size
    errors = np.where(determined & (np.linalg.norm(white, axis=0) > 0.0), errors, np.inf)
    reach = t_quantile(refit.freedom) * errors
    count, at = columns.shape[2], candidate.numbers
    ending = f"_{at[0]}" if len(at) == 1 else ""
    made: list[Difference] = []
    for place, name in enumerate(candidate.sizes):
        kind = kind_of(observed.arm, candidate, name)
        fitted: list[FittedParameter] = []
        for one in recordings:
            value, half = float(values[one * count + place]), float(reach[one * count + place])
            fitted.append(FittedParameter(f"{name}{ending}", name, at, kind, value, (value - half, value + half)))
        made.append(Difference(candidate.effect, at, tuple(fitted), p_value))
    return made
