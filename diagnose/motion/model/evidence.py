"""Evidence of sets of causes in a Gaussian linear model, from products alone.

y = sum over groups of X_g b_g + noise, b_g ~ N(0, c^2 diag(usual_g)^2) with c averaged over a few values, so that a
size far from what is usual pays for it. What a group adds beside others is a Schur complement (C. E. Rasmussen & C. K.
I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006, sec. 2.3 and A.3).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from linkwright.core.arm.effects.effect import LAST_RANK
from linkwright.core.sections.numeric import Array

from .candidates import Candidates
from .groups import Group
from .products import Products

SCALES = (16.0, 4.0, 1.0, 0.25, 0.0625, 0.015625)
"""How large causes are beside the greatest usual size, each as likely as the others: usual sizes are of usual robots,
and tails are long."""

_MULTIPLES = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
"""How many times the least discrepancies are tried for what has no name."""

_SPARING = 1.0
"""Nats that anything but nothing must gain, as any number does by Akaike's criterion."""

_FREE = 1e3
"""Usual sizes in a standard deviation of a number that logs alone tell."""

LIKELY = 2.0
"""Nats by which what lies in a 95 % interval may be less likely than the best (half of chi-squared, 3.84)."""


@dataclass(frozen=True)
class Member:
    """A group that is taken (its number), and the scale of its prior."""

    group: int
    scale: float


@dataclass(frozen=True)
class Offer:
    """What each group would add beside a set: `evidence` (G,) in nats, its choice paid for, and the best `scale`."""

    evidence: Array
    scale: Array


@dataclass(frozen=True)
class System:
    """Products of all groups' numbers, each in units of its usual size, for weighed joints.

    Args:
        groups: The groups.
        gram: (M, M); `against` (M,) products with the target.
        starts: (G,) where each group's numbers begin.
        spread: (W, M) sizes of the model's columns by the numbers.
        moved: (W, n) the joints that each column of the model moves.
        seen: (W, M) from products with the model's columns to those with the numbers, discrepancies taken off.
    """

    groups: tuple[Group, ...]
    gram: Array
    against: Array
    starts: NDArray[np.int64]
    spread: Array
    moved: NDArray[np.bool_]
    seen: Array

    @cached_property
    def prior(self) -> Array:
        """(G,) ln of the prior probability of each group: families nearly alike, the commoner causes first, a family's
        variants alike; nuisances are no choice."""
        families = len({group.family for group in self.groups})
        return np.array(
            [
                -math.inf if group.nuisance else -math.log(families * group.variants) - group.effect.rank / LAST_RANK
                for group in self.groups
            ]
        )

    def beside_joints_of(self, number: int) -> NDArray[np.bool_]:
        """Groups (G,) that move some joint that a group (its number) moves."""
        touched = self.moved[self.groups[number].columns].any(axis=0)
        return np.array([bool((self.moved[group.columns].any(axis=0) & touched).any()) for group in self.groups])

    def as_likely(self, number: int, offered: Array) -> list[int]:
        """Variants of a group (its number) from the least shape to the greatest that is as likely by what is `offered`
        (G,), and the next ones: of two shapes that the true one lies between, logs take either. Of whole numbers, none
        lies between."""
        alike, first, last = self._likely(number, offered)
        next_ones = 0 if all(shape.whole for shape in self.groups[number].effect.torque_shapes) else 1
        return alike[max(first - next_ones, 0) : last + 1 + next_ones]

    def ends(self, number: int, offered: Array) -> tuple[bool, bool]:
        """Whether the least, and the greatest, shape that was tried of a group (its number) is as likely."""
        alike, first, last = self._likely(number, offered)
        return first == 0, last == len(alike) - 1

    def _likely(self, number: int, offered: Array) -> tuple[list[int], int, int]:
        """Variants of a group, the least shape first, and the places of the first and last that are as likely as the
        likeliest."""
        family = self.groups[number].family
        alike = [k for k, group in enumerate(self.groups) if group.family == family]
        alike.sort(key=lambda k: tuple(self.groups[k].shapes.values()))
        least = float(offered[alike].max()) - LIKELY
        likely = [place for place, k in enumerate(alike) if offered[k] >= least]
        return alike, likely[0], likely[-1]

    @cached_property
    def nuisances(self) -> tuple[Member, ...]:
        """What is fitted with any set."""
        return tuple(Member(k, 1.0) for k, group in enumerate(self.groups) if group.nuisance)

    @cached_property
    def bounds(self) -> Array:
        """(2, M) what the numbers cannot pass, in usual sizes."""
        return np.concatenate([group.bounds / group.usual for group in self.groups], axis=1)

    @cached_property
    def ranks(self) -> NDArray[np.int64]:
        """(G,) how many numbers each group has."""
        return np.array([group.rank for group in self.groups], dtype=np.int64)

    @cached_property
    def drives(self) -> tuple[Member, ...]:
        """The terms that every drive has."""
        return tuple(Member(k, SCALES[0]) for k, group in enumerate(self.groups) if group.plain)

    def plain_beside(self, number: int, members: Sequence[Member]) -> list[Member]:
        """The plain terms beside which a group (its number) counts, of the joints that it moves, where they are no
        members (J. A. Nelder, A reformulation of linear models, J. R. Stat. Soc. A 140 (1977) 48, doi:10.2307/2344517:
        a term is judged beside those that are marginal to it)."""
        group, taken = self.groups[number], {member.group for member in members}
        joints = self.moved[group.columns].any(axis=0)
        return [
            term
            for term in (self.drives if group.beside else ())
            if term.group not in taken
            and self.groups[term.group].effect in group.beside
            and (self.moved[self.groups[term.group].columns].any(axis=0) & joints).any()
        ]

    @cached_property
    def by_rank(self) -> tuple[tuple[NDArray[np.int64], NDArray[np.int64]], ...]:
        """Groups of one rank with their numbers' places (g, rank)."""
        ranks: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        for rank in np.unique(self.ranks).tolist():
            which = np.flatnonzero(self.ranks == rank)
            ranks.append((which, self.starts[which][:, None] + np.arange(rank)))
        return tuple(ranks)

    def places(self, members: Sequence[Member]) -> NDArray[np.int64]:
        """Where the members' numbers stand."""
        spans = [np.arange(self.starts[m.group], self.starts[m.group] + self.ranks[m.group]) for m in members]
        return np.concatenate(spans) if spans else np.zeros(0, dtype=np.int64)

    def precision(self, members: Sequence[Member]) -> Array:
        """The prior precisions of the members' numbers."""
        parts = [np.full(self.ranks[m.group], m.scale**-2) for m in members]
        return np.concatenate(parts) if parts else np.zeros(0)

    def beside(self, members: Sequence[Member]) -> tuple[Array, Array]:
        """The Gram matrix and products with the target that are left beside a set."""
        at = self.places(members)
        if not len(at):
            return self.gram, self.against
        factor = np.linalg.cholesky(self.gram[np.ix_(at, at)] + np.diag(self.precision(members)))
        mixed = np.linalg.solve(factor, np.column_stack((self.gram[at], self.against[at])))
        shared = mixed[:, :-1]
        return self.gram - shared.T @ shared, self.against - shared.T @ mixed[:, -1]

    def evidence(self, members: Sequence[Member]) -> float:
        """The evidence of a set in nats, its choice paid for."""
        at, precision = self.places(members), self.precision(members)
        factor = np.linalg.cholesky(self.gram[np.ix_(at, at)] + np.diag(precision))
        explained = solve_triangular(factor, self.against[at], lower=True)
        chosen = [self.prior[m.group] - math.log(len(SCALES)) for m in members if not self.groups[m.group].nuisance]
        return float(
            0.5 * explained @ explained
            - np.log(np.diagonal(factor)).sum()
            + 0.5 * np.log(precision).sum()
            + sum(chosen)
        )

    def offers(self, members: Sequence[Member]) -> Offer:
        """What each group would add beside a set."""
        gram, against = self.beside(members)
        return offered(self, gram, against[:, None], self.prior)

    def within(self, members: Sequence[Member]) -> NDArray[np.bool_]:
        """Whether each member's numbers are within their bounds in a fit of them all."""
        numbers, within_bounds, start = self.numbers(members), [], 0
        for member in members:
            group = self.groups[member.group]
            values = numbers[start : start + group.rank] * group.usual
            within_bounds.append(bool((values >= group.bounds[0]).all() and (values <= group.bounds[1]).all()))
            start += group.rank
        return np.array(within_bounds, dtype=bool)

    def solved(self, members: Sequence[Member]) -> Array:
        """The sizes (W,) of the model's columns under a set (posterior mean)."""
        return np.asarray(self.spread[:, self.places(members)] @ self.numbers(members))

    def numbers(self, members: Sequence[Member]) -> Array:
        """The members' numbers (k,) in usual sizes (posterior mean)."""
        at = self.places(members)
        if not len(at):
            return np.zeros(0)
        inner = self.gram[np.ix_(at, at)] + np.diag(self.precision(members))
        return np.asarray(np.linalg.solve(inner, self.against[at]), dtype=float)


def offered(system: System, gram: Array, against: Array, prior: Array) -> Offer:
    """Evidence of each group by products left (M, M) and (M, D); of several targets D the greatest of any group is not
    taken: arrays are (G,) for one target, (G, D) for more."""
    count = against.shape[1]
    evidence = np.full((len(system.groups), count), -np.inf)
    scale = np.ones((len(system.groups), count))
    for which, at in system.by_rank:
        block = gram[at[:, :, None], at[:, None, :]]
        values, vectors = np.linalg.eigh(block)
        values = np.maximum(values, 0.0)
        along = np.einsum("gij,gid->gjd", vectors, against[at]) ** 2
        wide = np.square(SCALES)[:, None, None]
        grown = 1.0 + wide * values
        table = 0.5 * np.einsum("gjd,sgj->sgd", along, wide / grown) - 0.5 * np.log(grown).sum(axis=2)[:, :, None]
        best = table.max(axis=0)
        evidence[which] = best + np.log(np.mean(np.exp(table - best), axis=0)) + prior[which][:, None]
        scale[which] = np.array(SCALES)[table.argmax(axis=0)]
        if at.shape[1] == 1 and count == 1:
            mean = against[at[:, 0], 0] / (values[:, 0] + scale[which, 0] ** -2)
            beyond = (mean < system.bounds[0, at[:, 0]]) | (mean > system.bounds[1, at[:, 0]])
            evidence[which[beyond]] = -np.inf
    return Offer(evidence[:, 0], scale[:, 0]) if count == 1 else Offer(evidence, scale)


def spread_of(pool: Candidates) -> tuple[Array, NDArray[np.int64]]:
    """The sizes of the model's columns by all groups' numbers (W, M), each in units of its usual size, and where each
    group's numbers begin."""
    starts = np.cumsum([0, *(group.rank for group in pool.groups)])
    spread = np.zeros((pool.width, int(starts[-1])))
    for group, start in zip(pool.groups, starts[:-1].tolist(), strict=True):
        spread[group.columns, start : start + group.rank] = group.mixing * group.usual
    return spread, starts[:-1].astype(np.int64)


def discrepancies(pool: Candidates, products: Products, torque: Array) -> Array:
    """The standard deviation (W,) of each column's size that is no cause: of what filters, clocks and the forms of
    patterns leave uncertain, `torque` (n,) N*m at each joint for each family of patterns that moves it.

    (M. C. Kennedy & A. O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63 (2001) 425,
    doi:10.1111/1467-9868.00294: a model's discrepancy is a separate term beside noise.)
    """
    shown = (products.rms / torque[:, None]).max(axis=0)
    tried = Counter(source.place for source in pool.sources)
    factors = np.ones(pool.width)
    for source in pool.sources:
        factors[source.columns] = tried[source.place]
    return np.where(shown > 0.0, 1.0 / np.maximum(shown, 1e-300) / np.sqrt(factors), 0.0)


def small_causes(
    whole: System, pool: Candidates, products: Products, weights: Array, fitted: Sequence[Member], spread: Array
) -> tuple[Member, ...]:
    """Causes too small for a name, beside those that are `fitted`: as large as what motion leaves says, `spread` (W,)
    of `spreads`, in the shape that explains most of it."""
    loud, taken = np.diagonal(products.whole(weights)[0]), {pool.groups[member.group].family for member in fitted}
    offered_, best = whole.offers(fitted).evidence, dict[tuple[str, tuple[int, ...]], Member]()
    for number in np.argsort(-offered_, kind="stable").tolist():
        group = pool.groups[number]
        if group.tied or group.nuisance or group.family in taken or not spread[group.columns].any():
            continue
        usual = np.square(group.mixing @ group.usual) @ loud[group.columns]
        scale = math.sqrt(float(np.square(spread[group.columns]) @ loud[group.columns] / max(usual, 1e-300)))
        best.setdefault(group.family, Member(number, scale))
    return tuple(best.values())


def spreads(pool: Candidates, products: Products, weights: Array, named: Array, least: Array) -> Array:
    """The standard deviation (W,) of each column's size beyond the discrepancies of torques `least` (n,) N*m: random
    effects, for causes too small for a name and for what no form of a pattern holds.

    What each effect does at each place has a separate variance, for most of them none: that of greatest likelihood
    (M. E. Tipping & A. C. Faul, Fast marginal likelihood maximisation for sparse Bayesian models, AISTATS 2003),
    restricted to what the columns `named` (W, k) of the numbers that are fitted leave (H. D. Patterson & R. Thompson,
    Biometrika 58 (1971) 545, doi:10.1093/biomet/58.3.545).
    """
    whole, against, _ = products.whole(weights)
    unit = discrepancies(pool, products, least)
    known = np.column_stack((np.diag(unit), _FREE * named))
    lower = np.linalg.cholesky(known.T @ whole @ known + np.eye(known.shape[1]))
    mixed = solve_triangular(lower, known.T @ np.column_stack((whole * unit, against)), lower=True)
    gram = unit[:, None] * whole * unit - mixed[:, :-1].T @ mixed[:, :-1]
    left = unit * against - mixed[:, :-1].T @ mixed[:, -1]
    families: dict[tuple[str, tuple[int, ...]], list[int]] = {}
    for source in pool.sources:
        families.setdefault((source.effect.id, source.at), []).extend(source.columns.tolist())
    # Other shapes of what is named are alternatives to it, not beside it.
    others = [at for at in families.values() if not named[at].any()]
    variance = np.zeros(pool.width)
    while True:
        offers = [(*_likelier(gram, left, variance, at), at) for at in others]
        gain, more, at = max(offers, default=(0.0, 0.0, []))
        if gain < 1e-6:  # what rounding leaves
            return unit * np.sqrt(variance)
        taken = more * np.linalg.solve(np.eye(len(at)) + more * gram[np.ix_(at, at)], gram[at])
        gram, left = gram - gram[:, at] @ taken, left - taken.T @ left[at]
        variance[at] += more


def _likelier(gram: Array, left: Array, variance: Array, at: Sequence[int]) -> tuple[float, float]:
    """By how many nats the columns `at` are likelier with the best other variance, and how much more that is."""
    values, vectors = np.linalg.eigh(gram[np.ix_(at, at)])
    more = np.square(_MULTIPLES) - variance[at[0]]
    scaled = 1.0 + more[:, None] * values
    gains = 0.5 * (more[:, None] * (vectors.T @ left[at]) ** 2 / scaled - np.log(scaled)).sum(axis=1)
    gains -= np.where(more == 0.0, np.inf, _SPARING * (np.sign(_MULTIPLES) - np.sign(variance[at[0]])))
    best = int(np.argmax(gains))
    return float(gains[best]), float(more[best])


def system(
    pool: Candidates,
    products: Products,
    weights: Array,
    discrepancy: Array,
    blocks: NDArray[np.bool_] | None = None,
) -> System:
    """The system of a pool by products of some blocks (all by default), joints weighed by `weights` (n,); each column's
    size may be off by the standard deviation `discrepancy` (W,) without a cause."""
    spread, starts = spread_of(pool)
    gram, against, _ = products.whole(weights, blocks)
    scaled = gram * discrepancy
    inner = discrepancy[:, None] * scaled
    inner[np.diag_indices_from(inner)] += 1.0
    seen = spread - discrepancy[:, None] * np.linalg.solve(inner, scaled.T @ spread)
    whole = spread.T @ gram @ seen
    moved = np.zeros((pool.width, products.joints), dtype=bool)
    for joint, at in enumerate(products.columns):
        moved[at, joint] = True
    return System(pool.groups, 0.5 * (whole + whole.T), seen.T @ against, starts, spread, moved, seen)
