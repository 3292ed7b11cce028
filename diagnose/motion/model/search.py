"""The search for the set of causes: stepwise with exchange by evidence, then by motion that was not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .evidence import Member, System
from .feasible import feasible
from .products import Products

_MOST = 40
"""Names that are sought at most."""
_MOST_FOR_ONE = 6
"""Names that are put in the place of one at most, before all are settled anew."""
_PROMISING = 10.0
"""Times the log odds by which a set may be worse before it is settled, for its search to go on."""


def searched(
    system: System,
    allowed: NDArray[np.bool_] | None = None,
    *,
    initial: Sequence[Member] = (),
    exchange: bool = False,
    rules: Rules,
) -> list[Member]:
    """The set of the greatest evidence that steps and, with `exchange`, exchanges reach from `initial` members.

    First, causes are chosen beside all that drives have anyway. Then each term of the drives is named only where its
    absence tells, and no cause comes in any more that varies such terms.
    """
    may = np.ones(len(system.groups), dtype=bool) if allowed is None else allowed
    plain = np.array([group.plain for group in system.groups])
    varied = np.array([bool(group.beside) for group in system.groups])
    beside = [*system.nuisances, *system.drives]
    found = [member for member in initial if not plain[member.group]]
    found = stepwise(system, beside, may & ~plain, initial=found, rules=rules)
    if exchange:
        found = exchanged(system, beside, may & ~plain, found, rules=rules)
    drives = [member for member in system.drives if may[member.group]]
    again = may & (~varied | _taken(system, found))
    return stepwise(system, system.nuisances, again, initial=[*found, *drives], rules=rules)


def stepwise(
    system: System,
    fixed: Sequence[Member],
    allowed: NDArray[np.bool_],
    *,
    initial: Sequence[Member] = (),
    rules: Rules,
) -> list[Member]:
    """The set of the greatest evidence that single additions, removals and exchanges reach, from `initial` members,
    beside `fixed` ones."""
    chosen, may = list(initial), allowed.copy()
    if chosen:
        chosen = _settled(system, fixed, chosen, may, rules.search.log_odds)
    for _ in range(2 * _MOST):
        offer = system.offers([*fixed, *chosen])
        value = np.where(may & ~_taken(system, [*fixed, *chosen]), offer.evidence, -np.inf)
        best = int(np.argmax(value))
        if value[best] < rules.search.log_odds:
            break
        chosen.append(Member(best, float(offer.scale[best])))
        if not system.within([*fixed, *chosen])[-1]:
            may[best] = False
            chosen.pop()
            continue
        settled = _settled(system, fixed, chosen, may, rules.search.log_odds)
        if all(m.group != best for m in settled):
            may[best] = False
        chosen = settled
    return chosen


def exchanged(
    system: System, fixed: Sequence[Member], may: NDArray[np.bool_], members: Sequence[Member], *, rules: Rules
) -> list[Member]:
    """The set of greatest evidence among this one and those that a search reaches with one of its members kept out.

    A cause that was taken early may stand for several that only together explain more.
    """
    current, untried = list(members), list(members)
    value = system.evidence([*fixed, *current])
    while untried:
        member = untried.pop()
        rest = [m for m in current if m is not member]
        family = system.groups[member.group].family
        allowed = may & np.array([group.family != family for group in system.groups])
        first = _grown(system, fixed, allowed, rest, rules.search.log_odds)
        if system.evidence([*fixed, *first]) < value - _PROMISING * rules.search.log_odds:
            continue
        other = stepwise(system, fixed, allowed, initial=rest, rules=rules)
        worth = system.evidence([*fixed, *other])
        if worth > value + rules.search.log_odds:
            current, untried, value = other, list(other), worth
    return current


def _grown(
    system: System, fixed: Sequence[Member], may: NDArray[np.bool_], members: Sequence[Member], alarm: float
) -> list[Member]:
    """A set with what is most evident beside it, one by one, all else as it was."""
    grown = list(members)
    for _ in range(_MOST_FOR_ONE):
        offer = system.offers([*fixed, *grown])
        value = np.where(may & ~_taken(system, [*fixed, *grown]), offer.evidence, -np.inf)
        best = int(np.argmax(value))
        if value[best] < alarm:
            break
        grown.append(Member(best, float(offer.scale[best])))
    return grown


def _taken(system: System, members: Sequence[Member]) -> NDArray[np.bool_]:
    families = {system.groups[m.group].family for m in members}
    return np.array([group.family in families for group in system.groups])


def _settled(
    system: System, fixed: Sequence[Member], chosen: Sequence[Member], may: NDArray[np.bool_], alarm: float
) -> list[Member]:
    """The set after each member has been left out in turn, and replaced where another does more."""
    current = list(chosen)
    for _ in range(3):
        changed = False
        for member in list(current):
            others = [m for m in current if m is not member]
            offer = system.offers([*fixed, *others])
            value = np.where(may & ~_taken(system, [*fixed, *others]), offer.evidence, -np.inf)
            best = int(np.argmax(value))
            if value[best] < alarm:
                current, changed = others, True
                continue
            # Of what is as evident the commoner cause is taken.
            similar = np.flatnonzero(value > value[best] - 0.5).tolist()
            keep = min(similar, key=lambda k: (system.groups[k].effect.rank, k != member.group, -value[k]))
            scale = float(offer.scale[keep])
            if keep != member.group or scale != member.scale:
                changed = changed or keep != member.group
                current = [Member(keep, scale) if m is member else m for m in current]
        if not changed:
            break
    return current


@dataclass(frozen=True)
class HeldOut:
    """Fits that have not seen a fold of blocks, in turn.

    Args:
        products: Products by block.
        folds: (B,) the fold of each block.
        systems: For each fold, the system of all other blocks.
    """

    products: Products
    folds: NDArray[np.int64]
    systems: tuple[System, ...]

    def left(self, members: Sequence[Member], *, bodies: bool = False) -> Array:
        """Sums of squares (B, n) that such fits leave in each block; with `bodies` those by which every link is some
        body, as what is written is."""
        rss = np.zeros((self.products.blocks, self.products.joints))
        for fold, system in zip(np.unique(self.folds).tolist(), self.systems, strict=True):
            out, numbers = self.folds == fold, feasible(system, members).numbers if bodies else system.numbers(members)
            rss[out] = self.products.left(system.spread[:, system.places(members)] @ numbers)[out]
        return rss

    def rms(self, members: Sequence[Member]) -> Array:
        """RMS (n,) that such fits leave, N*m."""
        return rms(self.left(members), self.products)

    def loss(self, members: Sequence[Member], other: Sequence[Member], weights: Array) -> float:
        """By how many nats motion that was not fitted is less likely by a set than by another, joints weighed by
        `weights` (n,), counted by what it scatters between blocks.

        The difference of two likelihoods has twice its mean for a variance where samples are independent; where blocks
        scatter more, fewer samples tell as much (R. E. Chandler & S. Bate, Inference for clustered data using the
        independence loglikelihood, Biometrika 94 (2007) 167, doi:10.1093/biomet/asm015).
        """
        each = 0.5 * (self.left(members) - self.left(other)) @ weights
        nats, scatter = float(each.sum()), len(each) * float(np.var(each, ddof=1))
        return nats if nats <= 0.0 or scatter <= 2.0 * nats else 2.0 * nats**2 / scatter


def rms(left: Array, products: Products) -> Array:
    """RMS (n,) by sums of squares (B, n)."""
    return np.asarray(np.sqrt(left.sum(axis=0) / np.maximum(products.rows.sum(axis=0), 1)))


def pruned(system: System, held: HeldOut, members: Sequence[Member], *, rules: Rules) -> list[Member]:
    """The members that each gain on motion that was not fitted and cut some joint's RMS, beside their plain terms;
    the least goes first. A nuisance of a member's own pattern, as a log's clock is of a delay's, does not stand in for
    it: how likely each is was weighed when the member was named."""
    current = list(members)

    def fixed_beside(member: Member) -> list[Member]:
        own = set(system.groups[member.group].columns.tolist())
        return [item for item in system.nuisances if own.isdisjoint(system.groups[item.group].columns.tolist())]

    def figures(members: Sequence[Member]) -> tuple[Array, Array]:
        return held.rms(members), rms(held.products.left(system.solved(members)), held.products)

    while current:
        whole = figures([*system.nuisances, *current])
        worth: list[float] = []
        for member in current:
            plain = system.plain_beside(member.group, current)
            beside = [*fixed_beside(member), *plain, *(m for m in current if m is not member)]
            with_it = figures([*beside, member]) if plain else whole
            gain, cut = (
                float(np.max(1.0 - one / np.maximum(other, 1e-12)))
                for one, other in zip(with_it, figures(beside), strict=True)
            )
            worth.append(min(gain / rules.motion.gain, cut / rules.motion.cut))
        least = int(np.argmin(worth))
        if worth[least] >= 1.0:
            break
        current.pop(least)
    return current
