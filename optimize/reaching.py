"""Initial lengths where the given arm does not reach the box or path of the problem and its lengths are free.

Lengths spread over what `link_length` and `reach` allow are tried at places of the region, then in smaller and smaller
neighbourhoods of those that come nearest. Between the given lengths and lengths that reach the region, the start is the
first that reaches it and a little beyond, so that the arm is not fully stretched there. The start must reach the whole
region, because the exchange learns from it how each place is reached. Where no lengths within the limits do, the
problem is infeasible, and lengths beyond the limits that would do are reported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.worst.coverage import Unreached, unreached
from linkwright.core.arm.worst.workspace import by_differences, joint_box, pull, spread
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer

from .exchange.other_lengths import (
    REACHED,
    TRIES,
    allowed,
    few_places,
    free_links,
    length_bounds,
    moved,
    spread_lengths,
    sums_allowed,
)
from .problem import Problem

_TRIED, _CLOSER, _ROUNDS = 48, 24, 8
_FIRST = 3
"""So many of the lengths that reach all are gone towards."""
_HALVINGS = 10
_FURTHER = 0.1
"""How much of the rest of the way is gone beyond the first lengths that reach all."""
_PLACES_ADDED = 12
"""So many places are added to the few, one after another, where lengths that reach those miss others."""
_WIDER = 4.0
"""By how many times limits on lengths are widened to see what lengths would do."""


@dataclass(frozen=True)
class Start:
    """A problem whose arm has lengths that reach its box or path, and why it is not the arm as given."""

    problem: Problem
    why: str


def start_that_reaches(problem: Problem) -> Start | None:
    """The problem with other lengths to start from, where these are free and the arm as given does not reach what is
    asked; None where it does.

    Raises `NoAnswer` where no lengths were found that do.
    """
    if not problem.must_reach:
        return None
    missing = _missed(problem, problem.arm)
    values = np.array([problem.arm.lengths[k] for k in free_links(problem)])
    if missing is None and allowed(problem, values):
        return None
    finder = _Finder(problem)
    lengths = finder.reaching_lengths()
    if lengths is None:
        reason = "the arm as given reaches it all with lengths that are not allowed"
        if missing is not None:
            reason = f"{missing.where(problem.workspace.kind)} with the arm as given"
        raise NoAnswer(f"workspace: {reason}; {finder.in_vain()}; {_would_do(problem)}")
    if missing is None:
        return None
    arm = _with(problem, lengths)
    reason = missing.where(problem.workspace.kind)
    why = f"the arm as given does not reach it all ({reason}): the search began with links of {_in_mm(arm)} mm"
    return Start(replace(problem, arm=arm), why)


def _in_mm(arm: Arm) -> str:
    return " and ".join(f"{1e3 * length:.4g}" for length in arm.lengths)


def _missed(problem: Problem, arm: Arm) -> Unreached | None:
    return unreached(
        problem.workspace, by_differences(lambda q: tip_position(arm, q)), *joint_box(arm, problem.workspace)
    )


def _would_do(problem: Problem) -> str:
    """Lengths beyond the limits that reach everything, in words."""
    low, high = length_bounds(problem)
    free = tuple(limit for limit in problem.limits if limit.name != "reach")
    spans = ((low / _WIDER, high * _WIDER) for low, high in problem.length_spans)
    ranges = (
        link_ranges if link_ranges.link_length is None else replace(link_ranges, link_length=span)
        for link_ranges, span in zip(problem.ranges, spans, strict=True)
    )
    wider = replace(problem, ranges=tuple(ranges), limits=free)
    lengths = _Finder(wider).reaching_lengths()
    if lengths is None:
        ends = f"{1e3 * low.min() / _WIDER:.4g} to {1e3 * high.max() * _WIDER:.4g}"
        return f"nor from {ends} mm: other joint ranges may be needed"
    return f"links of {_in_mm(_with(wider, lengths))} mm would"


def _with(problem: Problem, lengths: Array) -> Arm:
    links = list(problem.arm.links)
    for index, length in zip(free_links(problem), lengths, strict=True):
        links[index] = replace(links[index], length=float(length))
    return problem.arm.with_links(tuple(links))


class _Finder:
    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.free = free_links(problem)
        self.low, self.high = length_bounds(problem)
        self.sums = sums_allowed(problem)
        self.places = few_places(problem)
        lower, upper = joint_box(problem.arm, problem.workspace)
        self.lower, self.upper = lower, upper
        self.starts = spread(lower, upper, TRIES)[:TRIES]
        self.best: tuple[float, Array, Array] = (math.inf, np.zeros(0), np.zeros(0))

    def reaching_lengths(self) -> Array | None:
        """Lengths that reach everything, or None."""
        for _ in range(_PLACES_ADDED):
            lengths = self._lengths_for_places()
            missed = None if lengths is None else _missed(self.problem, _with(self.problem, lengths))
            if lengths is None or missed is None:
                return lengths
            self.places = np.vstack([self.places, [*missed.point, 0.0][:3]])
        return None

    def _lengths_for_places(self) -> Array | None:
        """Lengths that reach the few places."""
        given = moved(np.array([self.problem.arm.lengths[k] for k in self.free]), self.low, self.high, self.sums)
        tried = [given, *spread_lengths(self.problem, _TRIED)]
        rows = np.array([item for item in tried if allowed(self.problem, item)])
        if not len(rows):
            return None
        misses = self._misses(rows)
        width = 0.25 * (self.high - self.low)
        generator = np.random.default_rng(3)
        for _ in range(_ROUNDS):
            if misses.max(axis=1).min() <= REACHED:
                break
            center = rows[int(misses.max(axis=1).argmin())]
            shifts = generator.uniform(-1.0, 1.0, (_CLOSER, len(center))) * width
            closer = [moved(center + shift, self.low, self.high, self.sums) for shift in shifts]
            more = np.array([item for item in closer if allowed(self.problem, item)]).reshape(-1, len(center))
            if len(more):
                rows, misses = np.vstack([rows, more]), np.vstack([misses, self._misses(more)])
            width = 0.5 * width
        order = np.argsort(misses.max(axis=1))
        self.best = (float(misses[order[0]].max()), rows[order[0]], misses[order[0]])
        whole = np.flatnonzero(misses.max(axis=1) <= REACHED)
        if len(whole):
            near = sorted(whole, key=lambda k: float(np.abs(rows[k] - given).max()))[:_FIRST]
            return min((self._first(given, rows[k]) for k in near), key=lambda item: float(np.abs(item - given).max()))
        return None

    def _first(self, given: Array, other: Array) -> Array:
        """Where on the way from lengths to others that reach all the places these are first reached, and a bit on."""
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reaches = self._misses((given + middle * (other - given))[None]).max() <= REACHED
            low, high = (low, middle) if reaches else (middle, high)
        for share in (high + _FURTHER * (1.0 - high), high, 1.0):
            lengths = given + share * (other - given)
            if _missed(self.problem, _with(self.problem, lengths)) is None:
                return lengths
        return other

    def _misses(self, rows: Array) -> Array:
        """How far (m) the tip stays from each place with each choice of lengths: (choices, places)."""
        count, places = len(rows), len(self.places)
        every = np.tile(np.array(self.problem.arm.lengths), (count, 1))
        every[:, self.free] = rows
        lengths = np.repeat(every, places * TRIES, axis=0)
        targets = np.tile(np.repeat(self.places, TRIES, axis=0), (count, 1))
        starts = np.tile(self.starts, (count * places, 1))

        def tip(q: Array) -> Array:
            at = place(self.problem.arm, list(q.T), list(lengths.T)).tip()
            return np.stack([np.broadcast_to(item, len(q)) for item in at], axis=1)

        used = np.array([1.0, 1.0, 0.0 if self.problem.workspace.in_plane else 1.0])
        _, miss = pull(by_differences(tip), starts, targets, self.lower, self.upper, used)
        return miss.reshape(count, places, TRIES).min(axis=2)

    def in_vain(self) -> str:
        """What is said where no lengths were found."""
        low, high = (f"{1e3 * item:.4g}" for item in (self.low.min(), self.high.max()))
        sums = [f", {limit.text}" for limit in self.problem.limit("reach")]
        limits = f"link_length {low} to {high} mm{''.join(sums)}"
        if not len(self.best[1]):
            return f"no lengths keep {limits}"
        missing, lengths, misses = self.best
        words = " and ".join(f"{1e3 * length:.4g}" for length in _with(self.problem, lengths).lengths)
        axes = 2 if self.problem.workspace.in_plane else 3
        point = ", ".join(f"{1e3 * item:.4g}" for item in self.places[int(misses.argmax())][:axes])
        return (
            f"no lengths were found within {limits} that reach all of it: the best, {words} mm, "
            f"keep the tip {1e3 * missing:.4g} mm away from ({point}) mm"
        )
