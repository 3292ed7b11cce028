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


def rivals(namer: Namer, members: Sequence[int], member: int) -> list[Rival]:
    """What cannot be told from a member, given the other groups, nearest first: the best variant of each family."""
    pool = namer.pool
    others = [m for m in members if m != member]
    start = products(pool, namer.prepared.vector).beside(pool.columns(others))
    gained = gains(pool, start)
    own_criterion = namer.criterion_of(members)
    group = pool.groups[member]
    own = slice(group.start, group.stop)
    pattern = np.linalg.pinv(start.gram[own, own], rcond=1e-9) @ start.against[own]
    mixed = start.gram[:, own] @ pattern
    signal = float(pattern @ start.gram[own, own] @ pattern)
    taken = {pool.groups[m].candidate.family for m in members}
    found: dict[object, Rival] = {}
    for number, other in enumerate(pool.groups):
        family = other.candidate.family
        if family in taken or not namer.library[number]:
            continue
        part = slice(other.start, other.stop)
        block = np.linalg.pinv(start.gram[part, part], rcond=1e-9)
        alike = float(np.sqrt(max(mixed[part] @ block @ mixed[part], 0.0) / max(signal, 1e-300)))
        trial = [number if m == member else m for m in members]
        if alike < ALIKE and gained[number] < 0.5 * gained[member]:
            continue
        worse = namer.criterion_of(trial) - own_criterion
        if worse <= (REFUTED if alike >= ALIKE else CONFIDENT) and namer.possible(trial):
            rival = Rival(number, min(alike, 1.0), worse)
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
