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

from arm.effects import EFFECTS
from diagnose.patterns.library import Candidate, columns_of, parameter_of
from diagnose.patterns.pool import orthonormal
from diagnose.residual.observed import Observed
from sections.numeric import Array

_ALIKE = 1e-4
"""Loads that are nearer to each other in proportion are one: both readings of a visit, at the shape just fitted."""
_AT_ONCE = 24
"""Steps looked at in a turn."""
_REACH = 1.2
"""How far a threshold is sought about a value of the grid, in its logarithm: to the next and further."""


def between_loads(observed: Observed, candidate: Candidate, within: tuple[float, float]) -> Array:
    """The logarithms, between two ends, of one load (N*m or N) for each step: in the middle between two neighbours of
    those that the drives at a candidate's places bore, and beyond the least and the greatest within."""
    joints = [observed.state.joints[index] for index in candidate.at] if candidate.at else observed.state.joints
    borne = [np.abs(np.broadcast_to(joint.drive_load, (observed.rows,))) for joint in joints]
    loads = np.unique(np.concatenate(borne))
    low, high = within
    with np.errstate(divide="ignore"):
        logarithms = np.log(loads)
    inside = logarithms[(logarithms > low) & (logarithms < high)]
    apart = np.concatenate([[low], inside[np.diff(inside, prepend=-np.inf) > _ALIKE], [high]])
    return 0.5 * (apart[1:] + apart[:-1])


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
    observed: Observed, candidates: Sequence[Candidate], columns: Sequence[Array], beside: Array
) -> list[Array]:
    """The columns (N, C, d) of candidates, m and rad, those with a threshold at that which leaves least of the
    residuals with all the others and what stands `beside` them (N, C, b): between the values of a search's grid sound
    readings would lie far off."""
    own, target = list(columns), observed.scaled(observed.residual).reshape(-1)
    sought = [(place, each, names) for place, each in enumerate(candidates) if (names := _thresholds(each))]
    for place, candidate, names in sought:
        rest = [beside, *(part for k, part in enumerate(own) if k != place)]
        others = orthonormal(observed.scaled(np.concatenate(rest, axis=2)).reshape(len(target), -1))
        left = target - others @ (others.T @ target)
        for name in names:
            middle = float(np.log(candidate.shapes[name]))
            lacks = partial(_lacks, observed, candidate, name, others, left)
            steps = between_loads(observed, candidate, (middle - _REACH, middle + _REACH))
            best, least = least_of(lacks, steps)
            found = columns_of(observed, _with(candidate, name, best)) if least < lacks(middle) else None
            own[place] = own[place] if found is None else found
    return own


def _thresholds(candidate: Candidate) -> tuple[str, ...]:
    if candidate.outside:
        return ()
    effect = EFFECTS[candidate.effect]
    return tuple(name for name in candidate.free_shapes if parameter_of(effect, name).threshold)


def _with(candidate: Candidate, name: str, logarithm: float) -> Candidate:
    return replace(candidate, shapes=MappingProxyType({**candidate.shapes, name: float(np.exp(logarithm))}))


def _lacks(observed: Observed, candidate: Candidate, name: str, others: Array, left: Array, logarithm: float) -> float:
    """The sum of squares that a threshold leaves of what the others leave."""
    columns = columns_of(observed, _with(candidate, name, logarithm))
    if columns is None:
        return float(left @ left)
    own = observed.scaled(columns).reshape(len(left), -1)
    own = orthonormal(own - others @ (others.T @ own))
    return float(left @ left - np.sum((own.T @ left) ** 2))
