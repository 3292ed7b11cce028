"""What a recording cannot tell from a finding, and which name of such a class goes first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.effect import LAST_RANK
from linkwright.core.diagnose.fitting.fit import Fit, fit, typical
from linkwright.core.sections.numeric import Array

from .naming import Named, Namer


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
    products = namer.prepared.products.beside(pool.columns([m for m in members if m != member]))
    left, columns = products.against, pool.columns([member])
    gram = products.rows(columns).T
    pattern = np.linalg.pinv(gram[columns], rcond=1e-9, hermitian=True) @ left[columns]
    mixed = gram @ pattern
    signal = max(float(pattern @ mixed[columns]), 1e-300)
    shared, gained = np.zeros(len(pool.groups)), np.zeros(len(pool.groups))
    layout, (diagonal, blocks) = pool.layout, products.blocks
    singles = (layout.single_groups, layout.single_columns[:, None])
    for (groups, at), block in zip(
        (singles, *layout.wide), (diagonal[layout.single_columns, None, None], *blocks), strict=True
    ):
        inverse = np.linalg.pinv(block, rcond=1e-9, hermitian=True)
        shared[groups] = np.sqrt(np.maximum(np.einsum("gi,gij,gj->g", mixed[at], inverse, mixed[at]), 0.0) / signal)
        gained[groups] = np.einsum("gi,gij,gj->g", left[at], inverse, left[at])
    return np.where(namer.library, np.minimum(shared, 1.0), 0.0), gained


def rivals(namer: Namer, members: Sequence[int], member: int, judges: Sequence[Namer] = ()) -> list[Rival]:
    """What cannot be distinguished from a member, given the other groups, nearest first: the best variant of each
    family.

    `judges` search the same recording with room for what is not named (see `Namer.with_room`): what cannot be told by
    one of them cannot be told."""
    rules = namer.rules
    shared, gained = likenesses(namer, members, member)
    judged = [(judge, judge.criterion_of(members)) for judge in (namer, *judges)]
    taken = namer.families(members)
    rivals_: dict[object, Rival] = {}
    near = (shared >= rules.alike) | (gained >= rules.rivalling * gained[member])
    for number in np.flatnonzero(namer.library & near).tolist():
        family = namer.pool.groups[number].candidate.family
        if family in taken:
            continue
        trial = [number if m == member else m for m in members]
        worse = min(judge.criterion_of(trial) - value for judge, value in judged)
        if worse <= (rules.refuted if shared[number] >= rules.alike else rules.confident) and namer.possible(trial):
            rival = Rival(number, float(shared[number]), worse)
            if family not in rivals_ or rivals_[family].worse > worse:
                rivals_[family] = rival
    return sorted(rivals_.values(), key=lambda rival: (-round(rival.likeness, 6), rival.worse))


def stands(namer: Namer, number: int) -> bool:
    """Whether a group is of one joint, which stands still in the recording."""
    places, travel = namer.pool.groups[number].candidate.at, namer.prepared.observed.recording.q
    least = namer.prepared.observed.rules.patterns.stands
    return len(places) == 1 and float(np.ptp(travel[:, places[0]])) < least


def preferred(namer: Namer, members: Sequence[int], member: int, others: Sequence[Rival]) -> int:
    """Which name of an alias class goes first: among those that fit equally well, one at a joint that moves before one
    that only shares its pattern, then the one with fewest coefficients, of a usual size, of one thing before one that
    takes all places to be wrong alike, and the commonest cause."""

    whole = namer.prepared.observed.rules

    def order(number: int) -> tuple[bool, int, bool, bool, int]:
        candidate = namer.pool.groups[number].candidate
        effect = None if candidate.outside else EFFECTS[candidate.effect]
        trial = [number if m == member else m for m in members]
        fitted: Fit = fit(namer.prepared, trial)
        sizes = fitted.sizes[trial.index(number)]
        usual = typical(candidate, np.array(candidate.from_slopes(sizes.tolist())), rules=whole.fitting)
        rank = LAST_RANK if effect is None else effect.rank
        still = stands(namer, number)
        # Links of unknown weight give a drive's sag many coefficients, but masses are no free choice.
        unknown = len(sizes) != len(candidate.sizes)
        coefficients = min(namer.pool.groups[number].rank, 2) if unknown else namer.pool.groups[number].rank
        alike = effect is not None and any(size.of_all and size.name in candidate.sizes for size in effect.sizes)
        return (still, coefficients, not (unknown or usual), alike, rank)

    # A joint that never moves is not accused while one that does would do nearly as well.
    still, rules = order(member)[0], namer.rules
    tied = [
        rival.member
        for rival in others
        if rival.worse <= (rules.refuted if still and not stands(namer, rival.member) else rules.tied)
    ]
    return min([member, *tied], key=order)


def renamed(namer: Namer, named: Named) -> tuple[int, ...]:
    """The members of what was named under the name of each class that goes first."""
    members = list(named.members)
    for place, member in enumerate(members):
        whole = [*members, *named.outside]
        members[place] = preferred(namer, whole, member, rivals(namer, whole, member))
    return tuple(members)
