"""What a recording cannot tell from a finding, and which name of such a class goes first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .candidates import PLAUSIBLE, STANDS
from .fit import Fit, fit, typical
from .naming import Namer
from .search import gains, products

Array = NDArray[np.float64]

ALIKE = 0.98
"""Patterns whose correlation is above this are one class."""
CONFIDENT = 6.0
"""Names whose criterion is worse by no more than this (odds of 20 to 1) stay in the confidence set."""
REFUTED = 20.0
"""Of one class or not: a name whose criterion is worse by this is refuted by the data (odds of 20,000 to 1)."""
_TIED = 2.0


@dataclass(frozen=True)
class Rival:
    """A group that could stand in a member's place: how alike the patterns are, how much worse its criterion."""

    member: int
    likeness: float
    worse: float


def likenesses(namer: Namer, members: Sequence[int], member: int) -> tuple[Array, Array]:
    """How alike each group's pattern is to a member's, as fitted beside the other members (0 to 1), and what each
    explains beside them, in sum of squares; both (G,)."""
    pool = namer.pool
    others = [m for m in members if m != member]
    start = products(pool, namer.prepared.vector).beside(pool.columns(others))
    group = pool.groups[member]
    own = slice(group.start, group.stop)
    pattern = np.linalg.pinv(start.gram[own, own], rcond=1e-9) @ start.against[own]
    mixed = start.gram[:, own] @ pattern
    signal = max(float(pattern @ start.gram[own, own] @ pattern), 1e-300)
    shared = np.zeros(len(pool.groups))
    for number in np.flatnonzero(namer.library).tolist():
        part = slice(pool.groups[number].start, pool.groups[number].stop)
        block = np.linalg.pinv(start.gram[part, part], rcond=1e-9)
        shared[number] = np.sqrt(max(float(mixed[part] @ block @ mixed[part]), 0.0) / signal)
    return np.minimum(shared, 1.0), gains(pool, start)


def rivals(namer: Namer, members: Sequence[int], member: int) -> list[Rival]:
    """What cannot be told from a member, given the other groups, nearest first: the best variant of each family."""
    shared, gained = likenesses(namer, members, member)
    own_criterion = namer.criterion_of(members)
    taken = {namer.pool.groups[m].candidate.family for m in members}
    found: dict[object, Rival] = {}
    for number in np.flatnonzero(namer.library & ((shared >= ALIKE) | (gained >= 0.5 * gained[member]))).tolist():
        family = namer.pool.groups[number].candidate.family
        if family in taken:
            continue
        trial = [number if m == member else m for m in members]
        worse = namer.criterion_of(trial) - own_criterion
        if worse <= (REFUTED if shared[number] >= ALIKE else CONFIDENT) and namer.possible(trial):
            rival = Rival(number, float(shared[number]), worse)
            if family not in found or found[family].worse > worse:
                found[family] = rival
    return sorted(found.values(), key=lambda rival: (-round(rival.likeness, 6), rival.worse))


def preferred(namer: Namer, members: Sequence[int], member: int, others: Sequence[Rival]) -> int:
    """Which name of an alias class goes first: among those that fit equally well, one at a joint that moves before one
    that only shares its pattern, then the one with fewest coefficients, of a usual size, and the commonest cause."""

    travel = namer.prepared.observed.recording.q

    def order(number: int) -> tuple[bool, int, bool, int]:
        candidate = namer.pool.groups[number].candidate
        trial = [number if m == member else m for m in members]
        fitted: Fit = fit(namer.prepared, trial)
        sizes = fitted.sizes[trial.index(number)]
        rank = PLAUSIBLE.index(candidate.effect) if candidate.effect in PLAUSIBLE else len(PLAUSIBLE)
        still = len(candidate.at) == 1 and float(np.ptp(travel[:, candidate.at[0]])) < STANDS
        # Links of unknown weight give a drive's sag many coefficients, but masses are no free choice.
        unknown = len(sizes) != len(candidate.sizes)
        coefficients = min(namer.pool.groups[number].rank, 2) if unknown else namer.pool.groups[number].rank
        return (still, coefficients, not (unknown or typical(candidate, sizes)), rank)

    # A joint that never moves is not accused while one that does would do nearly as well.
    limit = REFUTED if order(member)[0] else _TIED
    tied = [member, *(rival.member for rival in others if rival.worse <= limit)]
    return min(tied, key=order)
