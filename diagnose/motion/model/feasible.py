"""Numbers that can be: a set's held to the bounds of their parameters, and inertial ones to those of some body, by what
file and findings together may weigh.

(P. M. Wensing, S. Kim & J.-J. E. Slotine, Linear matrix inequalities for physically consistent inertial parameter
identification, IEEE Robotics and Automation Letters 3 (2018) 60-67, doi:10.1109/LRA.2017.2729659. That is a convex
problem, solved along its central path: S. Boyd & L. Vandenberghe, Convex Optimization, Cambridge 2004, sec. 11.3.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import lsq_linear

from linkwright.core.arm.motion.rigid import is_body, pseudo_inertia
from linkwright.core.sections.numeric import Array

from .evidence import Member, System

_INSIDE = 1e-4
"""Of the largest moment: how far within bodies, and of a usual size within bounds, the path begins."""
_GAP = 1e-2
"""Nats by which the end of the path may be worse than the best numbers."""
_UNSEEN = 1e6
"""Precision, by usual sizes, of what no motion shows of a link: it stays what the file has, which is read back."""
_SHRINKS = 0.05
"""How much less the barrier counts from one step along the path to the next."""
_ROUNDING = 1e-11
"""Of a curvature, what rounding may take off it; it shortens a step and moves no end."""
_STEPS = 40
"""Newton's steps at most for each of those."""
_SETTLED = 1e-3
"""Nats that a last one may still gain."""
_SHORT = 1e-9
"""The least part of a step that is tried."""
_ENOUGH = 0.1
"""Of what its slope promises: so much a part of a step must gain (Armijo's rule)."""


@dataclass(frozen=True)
class Feasible:
    """The likeliest `numbers` (k,) of a set, in usual sizes, that bodies can have, and how many nats they are `worse`
    than those that are likeliest of all."""

    numbers: Array
    worse: float


@dataclass(frozen=True)
class _Link:
    """What a link has, (10,) parameters: `had` by the arm file, and so much by the numbers `by` (10, k + h), of which h
    are what no motion shows of any link; the ten `decisive` numbers alone make it any body."""

    had: Array
    by: Array
    decisive: NDArray[np.int64]

    def pseudo(self, numbers: Array) -> Array:
        """The pseudo-inertia (4, 4)."""
        return pseudo_inertia(self.had + self.by @ numbers)


def feasible(system: System, members: Sequence[Member]) -> Feasible:
    """The numbers of a set within their bounds, by which every link that they change, with what the arm file has of it,
    is some body's."""
    best, at = system.numbers(members), system.places(members)
    ranks = [system.groups[member.group].rank for member in members]
    body = np.repeat(np.array([system.groups[m.group].body is not None for m in members], dtype=bool), ranks)
    lower, upper = (np.where(body, side * np.inf, system.bounds[k, at]) for k, side in ((0, -1.0), (1, 1.0)))
    within = bool(((lower <= best) & (best <= upper)).all())
    links = _links(system, members, len(best))
    numbers, inner = best, system.gram[np.ix_(at, at)] + np.diag(system.precision(members))
    if not within:
        values, vectors = np.linalg.eigh(inner)  # of a log without noise it is singular but for rounding
        factor = np.sqrt(np.maximum(values, _ROUNDING**2 * values[-1]))[:, None] * vectors.T
        numbers = np.asarray(lsq_linear(factor, factor @ best, (lower, upper)).x, dtype=float)
    hidden = sum(link.by.shape[1] for link in links[:1]) - len(best) if links else 0
    if not all(is_body(link.pseudo(np.append(numbers, np.zeros(hidden)))) for link in links):
        numbers = np.clip(_nearest(inner, best, (lower, upper), links), lower, upper)
    elif within:
        return Feasible(best, 0.0)
    more = numbers - best
    return Feasible(numbers, 0.5 * float(more @ inner @ more))


def _links(system: System, members: Sequence[Member], count: int) -> list[_Link]:
    """Each link that members change; what its first member does not hold may be anything."""
    shares: dict[int, list[tuple[int, int]]] = {}
    starts = np.cumsum([0, *(system.groups[member.group].rank for member in members)])
    for member, start in zip(members, starts[:-1].tolist(), strict=True):
        body = system.groups[member.group].body
        if body is not None:
            shares.setdefault(body.link, []).append((member.group, start))
    hidden = sum(10 - system.groups[places[0][0]].rank for places in shares.values())
    links, free = list[_Link](), count
    for places in shares.values():
        by = np.zeros((10, count + hidden))
        for number, start in places:
            group = system.groups[number]
            assert group.body is not None
            by[:, start : start + group.rank] = group.body.units[:, group.body.shown] * group.usual
        group = system.groups[places[0][0]]
        assert group.body is not None
        rest = np.setdiff1d(np.arange(10), group.body.shown)
        usual = [max(map(abs, group.effect.torque_sizes[number].typical)) for number in rest.tolist()]
        by[:, free : free + len(rest)] = group.body.units[:, rest] * usual
        ten = np.append(places[0][1] + np.arange(group.rank), free + np.arange(len(rest)))
        links.append(_Link(group.body.had, by, ten))
        free += len(rest)
    return links


def _nearest(inner: Array, best: Array, bounds: tuple[Array, Array], links: Sequence[_Link]) -> Array:
    """The likeliest numbers within bounds by which links are bodies, along the central path."""
    count, width = len(best), links[0].by.shape[1]
    whole, aim = _UNSEEN * np.eye(width), np.zeros(width)
    whole[:count, :count], aim[:count] = inner, best
    lower, upper = (
        np.append(side, np.full(width - count, sign * np.inf)) for side, sign in zip(bounds, (-1, 1), strict=True)
    )
    units = np.stack([pseudo_inertia(unit) for unit in np.eye(10)])
    numbers = _start(aim, lower, upper, links)
    walls = 4 * len(links) + int(np.isfinite(lower).sum() + np.isfinite(upper).sum())
    weight = max(0.5 * float((numbers - aim) @ whole @ (numbers - aim)) / walls, _GAP / walls)

    had, by = np.stack([link.had for link in links]), np.concatenate([link.by for link in links])

    def pseudo(x: Array) -> Array:
        return np.asarray(np.tensordot(had + (by @ x).reshape(had.shape), units, 1))

    def barrier(x: Array) -> float:
        if not ((x > lower) & (x < upper)).all():
            return np.inf
        try:
            roots = np.linalg.cholesky(pseudo(x))
        except np.linalg.LinAlgError:
            return np.inf
        logs = 2.0 * np.log(np.einsum("kii->ki", roots)).sum()
        near = np.concatenate(((x - lower)[np.isfinite(lower)], (upper - x)[np.isfinite(upper)]))
        return float(0.5 * (x - aim) @ whole @ (x - aim) - weight * (logs + np.log(near).sum()))

    while True:
        value = barrier(numbers)
        for _ in range(_STEPS):
            below, above = 1.0 / (numbers - lower), 1.0 / (upper - numbers)
            turned = np.linalg.solve(pseudo(numbers)[:, None], units)
            slope = whole @ (numbers - aim) - weight * (np.einsum("ukii->uk", turned).reshape(-1) @ by + below - above)
            curved = np.einsum("ukij,ulji->ukl", turned, turned) @ by.reshape(len(links), 10, width)
            bend = whole + weight * (by.T @ curved.reshape(by.shape) + np.diag(below**2 + above**2))
            scale = 1.0 / np.sqrt(np.diagonal(bend))
            step = -scale * cho_solve(
                cho_factor(bend * scale[:, None] * scale + _ROUNDING * np.eye(len(bend))), scale * slope
            )
            falls, length = float(-slope @ step), 1.0
            while (tried := barrier(numbers + length * step)) > value - _ENOUGH * length * falls and length > _SHORT:
                length *= 0.5
            if length > _SHORT:
                numbers, value = numbers + length * step, tried
            if length <= _SHORT or falls < _SETTLED * max(1.0, walls * weight):
                break
        if walls * weight <= _GAP:
            return numbers[:count]
        weight *= _SHRINKS


def _start(aim: Array, lower: Array, upper: Array, links: Sequence[_Link]) -> Array:
    """Numbers next to `aim` that lie within all bounds and bodies."""
    least = _INSIDE * np.minimum(upper - lower, 1.0)
    numbers = np.clip(aim, lower + least, upper - least)
    for link in links:
        values, vectors = np.linalg.eigh(link.pseudo(numbers))
        values = np.maximum(values, _INSIDE * max(float(values.max()), _INSIDE))
        whole = (vectors * values) @ vectors.T
        tensor = np.trace(whole[:3, :3]) * np.eye(3) - whole[:3, :3]
        wanted = np.array([whole[3, 3], *whole[:3, 3], *tensor[np.triu_indices(3)]])
        places = link.decisive
        numbers[places] += np.linalg.solve(link.by[:, places], wanted - link.had - link.by @ numbers)
    return numbers


def lost(system: System, beside: Sequence[Member], member: Member) -> float:
    """By how many nats less a member adds beside a set where both must be some bodies'."""
    if system.groups[member.group].body is None:
        return 0.0
    return feasible(system, [*beside, member]).worse - feasible(system, beside).worse
