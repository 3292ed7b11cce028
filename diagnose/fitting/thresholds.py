"""A shape that says from which load on something is so: its pattern changes only where it passes a load that was borne.

Between two neighbouring loads every value fits alike, and what is left is a staircase. A search for a smooth minimum
stops on any of its steps, so each is looked at once: all of them, or of many some, and then more about the best.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.loads.added_weights import bearing
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, parameter_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

_ALIKE = 1e-4
"""Loads that are nearer to each other in proportion are one: both readings of a visit, at the shape just fitted."""
_AT_ONCE = 24
"""Steps looked at in a turn."""
_LOOKED_AT = 60
"""Steps looked at for those that fit nearly as well."""
_FURTHEST = float(np.log(30.0))
"""How far from the best they are sought, in the logarithm."""
_REACH = 1.2
"""How far a threshold is sought about a value of the grid, in its logarithm: to the next and further."""


def between_loads(observed: Observed, candidate: Candidate, within: tuple[float, float]) -> Array:
    """The logarithms, between two ends, of one load (N*m or N) for each step: in the middle between two neighbours of
    those that the drives at a candidate's places bore, and beyond the least and the greatest within."""
    apart = _edges(observed, candidate, within)
    return 0.5 * (apart[1:] + apart[:-1])


def _edges(observed: Observed, candidate: Candidate, within: tuple[float, float]) -> Array:
    """Two ends, and the logarithms of the loads (N*m or N) that were borne between them, each once."""
    joints = bearing(observed.state).joints
    joints = [joints[index] for index in candidate.at] if candidate.at else joints
    borne = [np.abs(np.broadcast_to(joint.drive_load, (observed.rows,))) for joint in joints]
    loads = np.unique(np.concatenate(borne))
    low, high = within
    with np.errstate(divide="ignore"):
        logarithms = np.log(loads)
    inside = logarithms[(logarithms > low) & (logarithms < high)]
    return np.concatenate([[low], inside[np.diff(inside, prepend=-np.inf) > _ALIKE], [high]])


def no_worse_than(
    limit: float, left: Callable[[float], float], observed: Observed, candidate: Candidate, at: float
) -> tuple[float, float]:
    """Between which thresholds (N*m or N) all lie that leave no more than a limit, about the one `at` that leaves
    least: from the load that ends the lowest such step to that which ends the highest, other steps that leave more
    between them or not (a change point's likelihood has many peaks: D. V. Hinkley, Biometrika 57 (1970) 1,
    doi:10.1093/biomet/57.1.1). Of more than sixty steps as many are looked at, evenly, and those about the ends: a
    narrow peak far off may be missed. Nought and infinity where nothing beyond leaves more."""
    middle = float(np.log(at))
    edges = _edges(observed, candidate, (middle - _FURTHEST, middle + _FURTHEST))
    steps = 0.5 * (edges[1:] + edges[:-1])
    best = int(np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(steps) - 1))
    looked = np.unique(np.linspace(0, len(steps) - 1, min(_LOOKED_AT, len(steps))).round().astype(int))
    inside = [int(index) for index in looked if index != best and left(float(steps[index])) <= limit]

    def last_inside(within: int, outward: int) -> int:
        """The last step within the limit on the way from one that is to the next, outward, that was looked at."""
        beyond = [int(index) for index in looked if (index - within) * outward > 0]
        far = min(beyond, key=lambda index: abs(index - within)) if beyond else within
        while abs(far - within) > 1:
            between = (far + within) // 2
            within, far = (between, far) if left(float(steps[between])) <= limit else (within, between)
        return within

    low, high = last_inside(min([best, *inside]), -1), last_inside(max([best, *inside]), 1)
    least = 0.0 if low == 0 else float(np.exp(edges[low]))
    return least, float("inf") if high == len(steps) - 1 else float(np.exp(edges[high + 1]))


def least_of(left: Callable[[float], float], steps: Array) -> tuple[float, float]:
    """The step at which least is left, and how much: looked at evenly, then about the best until none is between."""
    first, last, best = 0, len(steps) - 1, 0
    seen: dict[int, float] = {}
    while True:
        evenly = np.linspace(first, last, min(_AT_ONCE, last - first + 1)).round().astype(int)
        at = sorted({*evenly.tolist(), *((best,) if seen else ())})
        new = [index for index in at if index not in seen]
        if not new:
            return float(steps[best]), seen[best]
        seen.update((index, left(float(steps[index]))) for index in new)
        best = min(seen, key=lambda index: seen[index])
        place = at.index(best)
        first, last = at[max(place - 1, 0)], at[min(place + 1, len(at) - 1)]


def at_best(
    observed: Observed,
    candidates: Sequence[Candidate],
    columns: Sequence[Array],
    beside: Array,
    weight: Array | None = None,
) -> list[tuple[Candidate, Array]]:
    """Candidates and their columns (N, C, d), m and rad, those with a threshold at that which leaves least of the
    residuals with all the others and what stands `beside` them (N, C, b): between the values of a search's grid sound
    readings would lie far off. Squares count by the rows' `weight` (N,), alike by default."""
    root = np.sqrt(np.ones(observed.rows) if weight is None else weight)

    def weighed(part: Array) -> Array:
        return (observed.scaled(part).reshape(observed.rows, -1) * root[:, None]).reshape(observed.residual.size, -1)

    shaped, others_columns, target = list(candidates), list(columns), weighed(observed.residual)[:, 0]
    sought = [(place, item, names) for place, item in enumerate(candidates) if (names := thresholds_of(item))]
    for place, candidate, names in sought:
        rest = [beside, *(part for k, part in enumerate(others_columns) if k != place)]
        others = orthonormal(weighed(np.concatenate(rest, axis=2)))
        left = target - others @ (others.T @ target)
        for name in names:
            middle = float(np.log(candidate.shapes[name]))
            lacks = partial(_lacks, observed, weighed, candidate, name, others, left)
            steps = between_loads(observed, candidate, (middle - _REACH, middle + _REACH))
            best, least = least_of(lacks, steps)
            there = _with(candidate, name, best)
            columns_there = columns_of(observed, there) if least < lacks(middle) else None
            if columns_there is not None:
                shaped[place], others_columns[place] = there, columns_there
    return list(zip(shaped, others_columns, strict=True))


def thresholds_of(candidate: Candidate) -> tuple[str, ...]:
    """Its shapes that say from which load on something is so."""
    if candidate.outside:
        return ()
    effect = EFFECTS[candidate.effect]
    return tuple(name for name in candidate.free_shapes if parameter_of(effect, name).threshold)


def _with(candidate: Candidate, name: str, logarithm: float) -> Candidate:
    return replace(candidate, shapes=MappingProxyType({**candidate.shapes, name: float(np.exp(logarithm))}))


def _lacks(
    observed: Observed,
    weighed: Callable[[Array], Array],
    candidate: Candidate,
    name: str,
    others: Array,
    left: Array,
    logarithm: float,
) -> float:
    """The sum of squares that a threshold leaves of what the others leave."""
    columns = columns_of(observed, _with(candidate, name, logarithm))
    if columns is None:
        return float(left @ left)
    white = weighed(columns)
    white = orthonormal(white - others @ (others.T @ white))
    return float(left @ left - np.sum((white.T @ left) ** 2))
