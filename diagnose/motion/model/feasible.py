"""Numbers that can be: a set's held to the bounds of their parameters, and inertial ones to those of some body, by what
file and findings together may weigh.

(P. M. Wensing, S. Kim & J.-J. E. Slotine, Linear matrix inequalities for physically consistent inertial parameter
identification, IEEE Robotics and Automation Letters 3 (2018) 60-67, doi:10.1109/LRA.2017.2729659. The search goes by
the pseudo-inertia's triangular factor: C. Rucker & P. M. Wensing, IEEE Robotics and Automation Letters 7 (2022) 2556,
doi:10.1109/LRA.2022.3144517.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.optimize import least_squares, lsq_linear

from linkwright.core.arm.motion.rigid import pseudo_inertia
from linkwright.core.sections.numeric import Array

from .evidence import Member, System

_LOWER = np.tril_indices(4)
"""Where the ten numbers of a triangular factor stand."""
_STEPS = 30
"""Steps of a search at most."""


@dataclass(frozen=True)
class Feasible:
    """The likeliest `numbers` (k,) of a set, in usual sizes, that bodies can have, and how many nats they are `worse`
    than those that are likeliest of all."""

    numbers: Array
    worse: float


def feasible(system: System, members: Sequence[Member]) -> Feasible:
    """The numbers of a set within their bounds, by which every link that they change, with what the arm file has of it,
    is some body's."""
    best, lower, upper, worse = _bounded(system, members)
    carriers, mixing = _by_link(system, members)
    aim = mixing @ best
    # Only links that no body could be are searched, until no other has become one of them.
    sought: list[tuple[NDArray[np.int64], int]] = []
    whole, more_worse = aim, 0.0
    while True:
        more = [
            carrier
            for carrier in carriers
            if not _in(carrier, sought) and not _some_body(system, carrier[1], whole[carrier[0]])
        ]
        if not more:
            numbers = np.clip(np.linalg.solve(mixing, whole), lower, upper)
            return Feasible(np.asarray(numbers, dtype=float), worse + more_worse)
        sought += more
        whole, more_worse = _nearest(system, members, mixing, aim, sought)


def _bounded(system: System, members: Sequence[Member]) -> tuple[Array, Array, Array, float]:
    """The likeliest numbers (k,) of a set within the bounds of their parameters, those bounds in usual sizes (a body's
    have none), and how much worse (nats) that is than without bounds."""
    best, at = system.numbers(members), system.places(members)
    body = np.repeat(
        np.array([system.groups[member.group].body is not None for member in members], dtype=bool),
        [system.groups[member.group].rank for member in members],
    )
    lower, upper = (np.where(body, side * np.inf, system.bounds[k, at]) for k, side in ((0, -1.0), (1, 1.0)))
    if ((lower <= best) & (best <= upper)).all():
        return best, lower, upper, 0.0
    factor = np.linalg.cholesky(system.gram[np.ix_(at, at)] + np.diag(system.precision(members))).T
    held = lsq_linear(factor, factor @ best, (lower, upper))
    return np.asarray(held.x, dtype=float), lower, upper, float(held.cost)


def _nearest(
    system: System,
    members: Sequence[Member],
    mixing: Array,
    aim: Array,
    carriers: Sequence[tuple[NDArray[np.int64], int]],
) -> tuple[Array, float]:
    """The likeliest numbers in the carriers' coordinates by which their links are bodies, and how much worse (nats)
    they are than `aim`, the likeliest of all."""
    at = system.places(members)
    back = np.linalg.inv(mixing)
    inner = back.T @ (system.gram[np.ix_(at, at)] + np.diag(system.precision(members))) @ back
    held = np.concatenate([places for places, _ in carriers])
    rest = np.setdiff1d(np.arange(len(at)), held)
    follows = np.linalg.solve(inner[np.ix_(rest, rest)], inner[np.ix_(rest, held)])
    left = inner[np.ix_(held, held)] - inner[np.ix_(held, rest)] @ follows
    factor = np.asarray(np.linalg.cholesky(0.5 * (left + left.T)).T, dtype=float)
    maps = [_of_carrier(system, group) for _, group in carriers]
    had = [_had(system, group) for _, group in carriers]

    def misses(theta: Array) -> Array:
        each = zip(maps, had, theta.reshape(len(maps), -1), strict=True)
        numbers = np.concatenate([own @ (_body(own_theta) - file) for own, file, own_theta in each])
        return np.asarray(factor @ (numbers - aim[held]))

    def slopes(theta: Array) -> Array:
        each = zip(maps, theta.reshape(len(maps), -1), strict=True)
        return np.asarray(factor @ block_diag(*(own @ _slopes(own_theta) for own, own_theta in each)))

    start = np.concatenate([_factor(_parameters(system, group, aim[places])) for places, group in carriers])
    minimum = least_squares(misses, start, slopes, x_scale="jac", max_nfev=_STEPS)  # pyright: ignore[reportArgumentType]
    whole = aim.copy()
    whole[held] = np.linalg.solve(factor, misses(minimum.x)) + aim[held]
    whole[rest] -= follows @ (whole[held] - aim[held])
    return whole, float(minimum.cost)


def lost(system: System, beside: Sequence[Member], member: Member) -> float:
    """By how many nats less a member adds beside a set where both must be some bodies'."""
    if system.groups[member.group].body is None:
        return 0.0
    return feasible(system, [*beside, member]).worse - feasible(system, beside).worse


def _by_link(system: System, members: Sequence[Member]) -> tuple[list[tuple[NDArray[np.int64], int]], Array]:
    """For each link that members change the places of the numbers that carry it, and their group; and the matrix (k, k)
    from a set's numbers to those in which carriers hold all that their link has."""
    carriers: dict[int, tuple[NDArray[np.int64], int]] = {}
    ranks = [system.groups[member.group].rank for member in members]
    mixing, start = np.eye(sum(ranks)), 0
    for member, rank in zip(members, ranks, strict=True):
        group, places = system.groups[member.group], np.arange(start, start + rank)
        start += rank
        if group.body is None:
            continue
        if group.body.link not in carriers:
            carriers[group.body.link] = (places, member.group)
            continue
        carried, first = carriers[group.body.link]
        of_link = group.body.units[:, group.body.shown] * group.usual
        mixing[np.ix_(carried, places)] = _of_carrier(system, first) @ of_link
    return list(carriers.values()), mixing


def _of_carrier(system: System, group: int) -> Array:
    """A group's numbers (r, 10), in usual sizes, by what its link has more."""
    group_ = system.groups[group]
    assert group_.body is not None
    return np.linalg.inv(group_.body.units)[group_.body.shown] / group_.usual[:, None]


def _had(system: System, group: int) -> Array:
    body = system.groups[group].body
    assert body is not None
    return body.had


def _in(one: tuple[NDArray[np.int64], int], several: Sequence[tuple[NDArray[np.int64], int]]) -> bool:
    return any(one[1] == other for _, other in several)


def _some_body(system: System, group: int, numbers: Array) -> bool:
    """Whether a link is some body by a group's numbers, as far as rounding tells."""
    values = np.linalg.eigvalsh(pseudo_inertia(_parameters(system, group, numbers)))
    return bool(values[0] >= -1e-6 * abs(values[-1]))


def _parameters(system: System, group: int, numbers: Array) -> Array:
    """A link's parameters (10,) by a group's numbers; what that does not hold is as in the file."""
    group_ = system.groups[group]
    assert group_.body is not None
    return group_.body.had + group_.body.units[:, group_.body.shown] @ (group_.usual * numbers)


def _factor(parameters: Array) -> Array:
    """The triangular factor (10,) of the pseudo-inertia next to parameters that no body need have."""
    values, vectors = np.linalg.eigh(pseudo_inertia(parameters))
    values = np.maximum(values, 1e-4 * max(float(values.max()), 1e-3))
    return np.linalg.cholesky((vectors * values) @ vectors.T)[_LOWER]


def _body(theta: Array) -> Array:
    """Inertial parameters (10,) by the triangular factor of the pseudo-inertia."""
    lower = _triangle(theta)
    whole = lower @ lower.T
    spread = whole[:3, :3]
    tensor = np.trace(spread) * np.eye(3) - spread
    return np.array([whole[3, 3], *whole[:3, 3], *tensor[np.triu_indices(3)]])


def _slopes(theta: Array) -> Array:
    """The derivative (10, 10) of the parameters by that factor."""
    units = np.zeros((10, 4, 4))
    units[np.arange(10), *_LOWER] = 1.0
    half = units @ _triangle(theta).T
    whole = half + half.transpose(0, 2, 1)
    spread = whole[:, :3, :3]
    tensor = np.trace(spread, axis1=1, axis2=2)[:, None, None] * np.eye(3) - spread
    return np.column_stack((whole[:, 3, 3], whole[:, :3, 3], tensor[:, *np.triu_indices(3)])).T


def _triangle(theta: Array) -> Array:
    lower = np.zeros((4, 4))
    lower[_LOWER] = theta
    return lower
