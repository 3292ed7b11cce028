"""Other lengths of the links to start from, where a box or a path stays where it is while lengths are free.

Of a long and a short link either may be the first, and all lengths between that reach the same places may be worse than
both: a descent from one arm never comes to the other. Lengths spread over what is allowed are looked at with the
sections of a design that is known; descents go from the best of them that are no neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import islice, permutations

import numpy as np

from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.worst.coverage import unreached
from linkwright.core.arm.worst.workspace import Unreachable, path_points, pull, spread
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .design import LENGTH, DesignSpace, arm_of, numeric_beams
from .exchange import Context
from .totals import anchored

_LOOKED_AT = 24
"""Lengths spread over those allowed, beside the design's own in other orders."""
_ORDERS = 5
_POSES = 256
_APART = 0.15
"""Lengths of which no logarithm differs by more are neighbours."""
_HOPEFUL = 2.0
"""Lengths with which the sections known do worse than this many times the design are no start."""
_ROUNDS = 50
_SUM = 1e-9
_PLACES = 60
_ACROSS = 5
"""Places along each side of a box."""
TRIES, REACHED = 8, 1e-7
"""Poses from which a place is tried, and how near (m) the tip must come."""


def other_lengths(
    context: Context, space: DesignSpace, x: Array, chosen: Sequence[Material | None], most: int = 4
) -> list[Array]:
    """Designs like `x` with other lengths, the most promising first, at most so many; none where the places to reach
    move with the lengths."""
    if not anchored(space) or context.scenarios is not None or not context.uses_error:
        return []
    at = np.flatnonzero([variable.name == LENGTH for variable in space.variables])
    values = np.exp(x[at])
    orders = [values[list(order)] for order in islice(permutations(reversed(range(len(at)))), _ORDERS)]
    known, reached = _score(context, space, x, chosen), _reached(context, space, x, chosen)
    candidates: list[tuple[float, Array]] = []
    for lengths in (*orders, *spread_lengths(space.problem, _LOOKED_AT)):
        if not allowed(space.problem, lengths) or _near(lengths, values):
            continue
        trial = x.copy()
        trial[at] = np.log(lengths)
        score = _score(context, space, trial, chosen)
        if score < _HOPEFUL * known and _reached(context, space, trial, chosen) >= reached:
            candidates.append((score, trial))
    starts: list[Array] = []
    for _, trial in sorted(candidates, key=lambda candidate: candidate[0]):
        if len(starts) == most:
            break
        apart = not any(_near(np.exp(trial[at]), np.exp(start[at])) for start in starts)
        if apart and share_unreached(context, space, trial, chosen) == 0.0:
            starts.append(trial)
    return starts


def share_unreached(context: Context, space: DesignSpace, x: Array, chosen: Sequence[Material | None]) -> float:
    """The share of a box or a path that a design does not reach."""
    p = numeric_beams(arm_of(space, x, chosen), context.problem.load_cases)
    search = context.search
    missed = unreached(search.workspace, lambda q: search.motion(q, p), search.lower, search.upper)
    return 0.0 if missed is None else missed.share


def _reached(context: Context, space: DesignSpace, x: Array, chosen: Sequence[Material | None]) -> int:
    """How many of a few places in a box a design reaches; all points looked at of a path are reached anyway."""
    if context.problem.workspace.kind != "box":
        return 0
    search, places = context.search, few_places(context.problem)
    p = numeric_beams(arm_of(space, x, chosen), context.problem.load_cases)
    starts = spread(search.lower, search.upper, TRIES)[:TRIES]
    targets, used = (
        np.repeat(places, TRIES, axis=0),
        np.array([1.0, 1.0, float(not context.problem.workspace.in_plane)]),
    )
    start = np.tile(starts, (len(places), 1))
    _, miss = pull(lambda q: search.motion(q, p), start, targets, search.lower, search.upper, used)
    return int((miss.reshape(len(places), -1).min(axis=1) <= REACHED).sum())


def few_places(problem: Problem) -> Array:
    """Places (N, 3) of the region, m: along a path those that are looked at, in a box a grid with its corners."""
    points = np.array(problem.workspace.points)
    if problem.workspace.kind == "path":
        every = path_points(problem.workspace)
        few = every if len(every) <= _PLACES else every[:: math.ceil(len(every) / _PLACES)]
        return np.unique(np.vstack([points, few]), axis=0)
    low, high = points.min(axis=0), points.max(axis=0)
    sides = [np.linspace(a, b, _ACROSS) if b > a else np.array([a]) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)


def with_lengths(space: DesignSpace, x: Array, lengths: Sequence[float]) -> Array:
    """The optimiser's numbers `x` with the lengths (m) of those links whose lengths are free."""
    moved_x = x.copy()
    for number, variable in enumerate(space.variables):
        if variable.name == LENGTH:
            moved_x[number] = variable.to_x(lengths[variable.link])
    return moved_x


def _near(one: Array, other: Array) -> bool:
    return float(np.abs(np.log(one / other)).max(initial=0.0)) < _APART


def _score(context: Context, space: DesignSpace, x: Array, chosen: Sequence[Material | None]) -> float:
    """About the error (m) times the mass (kg): what sections as heavy as another design's would have of it, as loads
    bend solid sections."""
    arm = arm_of(space, x, chosen)
    p = numeric_beams(arm, context.problem.load_cases)
    search = context.search
    try:
        q = search.poses(p, _POSES)
    except Unreachable:
        return np.inf
    error = max(float(search.errors(q, p, case).error.max()) for case in range(len(context.model.cases)))
    beams = beams_of(arm, context.problem.load_cases)
    return error * max(sum(float(beam.mass_per_length * beam.length) for beam in beams), 1e-9)


def free_links(problem: Problem) -> list[int]:
    """The links (from 0) whose lengths are free."""
    return [k for k, link_ranges in enumerate(problem.ranges) if link_ranges.link_length is not None]


def length_bounds(problem: Problem) -> tuple[Array, Array]:
    """The least and the greatest of each free length (m)."""
    low, high = np.array([problem.length_spans[k] for k in free_links(problem)]).reshape(-1, 2).T
    return low, high


def sums_allowed(problem: Problem) -> tuple[float, float]:
    """The least and the greatest sum (m) of the free lengths that `reach` and `link_length` allow."""
    free = free_links(problem)
    rest = sum(link.length for link in problem.arm.links) - sum(problem.arm.links[k].length for k in free)
    low, high = (float(bound.sum()) for bound in length_bounds(problem))
    for limit in problem.limit("reach"):
        low = max(low, limit.value - rest) if limit.relation in (">=", "==") else low
        high = min(high, limit.value - rest) if limit.relation in ("<=", "==") else high
    return low, high


def allowed(problem: Problem, lengths: Array) -> bool:
    """Whether free lengths (m) keep their bounds and those of the reach."""
    least, most = sums_allowed(problem)
    low, high = length_bounds(problem)
    inside = bool(np.all(lengths >= low * (1.0 - _SUM)) and np.all(lengths <= high * (1.0 + _SUM)))
    return inside and least * (1.0 - _SUM) <= float(lengths.sum()) <= most * (1.0 + _SUM)


def spread_lengths(problem: Problem, count: int) -> list[Array]:
    """About `count` choices of the free lengths (m), spread over what bounds and reach allow; none where these leave
    nothing."""
    size = len(free_links(problem))
    least, most = sums_allowed(problem)
    if size == 0 or least > most * (1.0 + _SUM):
        return []
    low, high = length_bounds(problem)
    lengths = [moved(row, low, high, (least, most)) for row in spread(low, high, count)[:count]]
    return [length for length in lengths if allowed(problem, length)]


def moved(lengths: Array, low: Array, high: Array, sums: tuple[float, float]) -> Array:
    """The lengths (m) with their sum brought between two others, all by the same as far as their bounds allow."""
    out = np.clip(lengths, low, high)
    for _ in range(_ROUNDS):
        missing = min(max(float(out.sum()), sums[0]), sums[1]) - float(out.sum())
        if abs(missing) <= 1e-12:
            break
        movable = (out < high) if missing > 0.0 else (out > low)
        if not movable.any():
            break
        out = np.clip(out + movable * missing / movable.sum(), low, high)
    return out
