"""The rivals of a diagnosis of motion logs, each as the arm that its file would hold, judged on motion held out.

Sizes are bounded least squares of what the arm with its entries leaves, linearised about that arm (Gauss-Newton). What
is told of a rival is what `predict` tells of its file, on the samples that count there.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects.loads.link_inertial import LINK_INERTIAL
from linkwright.core.arm.effects.torques import Bent
from linkwright.core.diagnose.judge.needed import Needed, needed
from linkwright.core.diagnose.judge.rivals import Name, Rival, Rivals, chosen
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .corrected import completed
from .model.candidates import Candidates
from .model.evidence import Member, System, system
from .model.feasible import feasible
from .model.groups import PLAIN, Group
from .model.identify import Identified, mixed
from .model.intervals import Estimates
from .model.products import Products, products
from .model.rows import LogRows, about, joint_rows
from .model.search import HeldOut, rms

_TEXTBOOK = (LINK_INERTIAL, *PLAIN)
"""What everybody fits: W. Khalil & E. Dombre, Modeling, Identification and Control of Robots (2002), ch. 12."""
_STEPS = 12
"""Times that a model is linearised about the arm as it would be written, at most."""
_SETTLED = 1e-3
"""Of the noise, by how much a last step may still change torques."""
_WORSE = 2.0
"""Times the least that a step has left so far, which no step may leave."""


@dataclass(frozen=True)
class Filed:
    """A set of causes as a file holds them: `numbers` (k,) of all `members` in SI, `sizes` (W,) of the model's columns,
    the `arm` with its entries. `rows` are linearised about it; `left` and `held_out` (B, n) are sums of squares that
    it leaves where `predict` counts, and that fits to the other folds leave. `held` makes such fits. `beside` are both
    where entries of one log alone stand beside it in that log. `more` are entries of the arm that are no members'."""

    members: tuple[Member, ...]
    numbers: Array
    sizes: Array
    arm: Arm
    rows: tuple[LogRows, ...]
    left: Array
    held_out: Array
    held: HeldOut
    beside: tuple[Array, Array]
    more: tuple[EffectEntry, ...] = ()

    def of_folds(self, arm: Arm, pool: Candidates) -> tuple[Arm, ...]:
        """The arm as it would be written by fits to all but one fold, for each in turn; as it is where none is fitted.
        `arm` is the one as given."""
        if not self.members:
            return tuple(self.arm for _ in self.held.systems)
        groups = [pool.groups[member.group] for member in self.members]
        usual = np.concatenate([group.usual for group in groups])
        alone = [Member(number, member.scale) for number, member in enumerate(self.members)]
        fits = (feasible(item, alone).numbers * usual for item in self.held.systems)
        return tuple(completed(arm, groups, _parts(groups, numbers), self.more) for numbers in fits)


@dataclass(frozen=True)
class Judged:
    """The rivals, what each would write (`filed`, by name), and what counts: `rows` (B, n) samples of each block."""

    rivals: Rivals
    filed: tuple[tuple[Name, Filed], ...]
    counts: Array

    @property
    def written(self) -> Filed:
        """What is written."""
        return dict(self.filed)[self.rivals.written]

    @property
    def given(self) -> Filed:
        """The arm as given."""
        return dict(self.filed)["nominal"]

    @property
    def named(self) -> Filed:
        """The arm with what was named."""
        return dict(self.filed)["named"]

    def needed(self, names: Sequence[int], pool: Candidates, *, rules: Rules) -> Needed:
        """Which of some names (numbers of groups) motion held out needs: RMS (n,), N*m."""
        before = np.maximum(rms(self.given.left, self.named.held.products), 1e-30)
        moves = [float(np.max(self.added_by([pool.groups[name].family], pool) / before)) for name in names]

        def left(out: Sequence[int]) -> Array:
            apart = {names[place] for place in out}
            rest = [Member(k, m.scale) for k, m in enumerate(self.named.members) if m.group not in apart]
            return rms(self.named.held.left(rest), self.named.held.products)

        return needed(moves, left, rules=rules)

    def added_by(self, names: Collection[tuple[str, tuple[int, ...]]], pool: Candidates) -> Array:
        """RMS (n,) N*m of what some names, by effect and joints or links (from 1), add at each joint together."""
        sizes, start = np.zeros(pool.width), 0
        for member in self.named.members:
            group = pool.groups[member.group]
            if group.family in names:
                sizes[group.columns] += group.values(self.named.numbers[start : start + group.rank])
            start += group.rank
        return self.named.held.products.explained(sizes)


@dataclass(frozen=True)
class _Linearised:
    """Products of rows about an arm: to fit, with reversals where they count; `beside` what one log alone has, on the
    samples that `predict` counts; and `counted` as `predict` does, like the `rows`."""

    rows: tuple[LogRows, ...]
    fit: Products
    beside: Products
    counted: Products


def judged(arm: Arm, identified: Identified, start: Array, more: Sequence[EffectEntry], *, rules: Rules) -> Judged:
    """The rivals of what was identified.

    Args:
        arm: The arm as given.
        identified: The search's result.
        start: (k,) its members' numbers in SI, first of all numbers, to begin with.
        more: Entries beside them.
        rules: How wide sizes may be.
    """
    nothing = np.zeros(identified.pool.width)
    bare = _about(identified, arm, nothing)
    given = _filed(identified, bare, (), arm, np.zeros(0), nothing)
    named = _settled(arm, identified, _wide(identified.members, rules), start, more)
    named = _without_harm(arm, identified, given, named, more)
    textbook = _settled(arm, identified, _textbook(identified), None, (), bare)
    filed: list[tuple[Name, Filed]] = [("nominal", given), ("named", named), ("textbook", textbook)]
    rest = _with_rest(identified, named.members)
    if len(rest) > len(named.members):
        filed.append(("ridge", _settled(arm, identified, rest, None, more)))
    counts = bare.counted.rows.astype(float)
    # What one log alone has tells nothing of what all share: rivals are chosen beside it, and shown as their files are.
    best = chosen([_rival(name, *item.beside, item, counts) for name, item in filed], rules=rules)
    shown = tuple(_rival(name, item.left, item.held_out, item, counts) for name, item in filed)
    return Judged(replace(best, table=shown), tuple(filed), counts)


def _wide(members: Sequence[Member], rules: Rules) -> tuple[Member, ...]:
    """Once causes are named, the logs say how large they are, not their prior."""
    return tuple(Member(member.group, rules.fitting.usual * max(member.scale, 1.0)) for member in members)


def _textbook(identified: Identified) -> tuple[Member, ...]:
    """Inertial parameters of each link, friction, offset and rotor of each drive, as far as something shows them."""
    shown = identified.products.rms.max(axis=0)
    return tuple(
        Member(number, 100.0)
        for number, group in enumerate(identified.pool.groups)
        if group.effect in _TEXTBOOK and not group.tied and not group.nuisance and shown[group.columns].any()
    )


def _with_rest(identified: Identified, members: Sequence[Member]) -> tuple[Member, ...]:
    """What was named, and what is too small for a name. What lasts no longer than a recording foretells no other, and
    what is not in proportion to its size acts otherwise in motion that is faster."""
    groups = identified.pool.groups
    families = {groups[member.group].family for member in members}
    rest = (
        member
        for member in identified.unnamed
        if groups[member.group].effect.watch.lasts != "a recording"
        and not isinstance(groups[member.group].effect.torques, Bent)
        and groups[member.group].family not in families
    )
    return (*members, *rest)


def _about(identified: Identified, arm: Arm, sizes: Array) -> _Linearised:
    pool, own = identified.pool, [bool(row.prepared.entries) for row in identified.rows]
    rows = tuple(about(row, pool, arm, sizes) for row in identified.rows)
    by_joint = joint_rows(rows)
    fit = beside = counted = products(by_joint, pool.width, near=False)
    if identified.turning.any():
        fit = mixed(beside, products(by_joint, pool.width, near=True), identified.turning)
    if any(own):
        shared = [replace(row, prepared=replace(row.prepared, entries=())) for row in identified.rows]
        rows = tuple(
            about(bare, pool, arm, sizes) if has else row for bare, has, row in zip(shared, own, rows, strict=True)
        )
        counted = products(joint_rows(rows), pool.width, near=False)
    return _Linearised(rows, fit, beside, counted)


def _settled(
    arm: Arm,
    identified: Identified,
    members: tuple[Member, ...],
    start: Array | None,
    more: Sequence[EffectEntry],
    given: _Linearised | None = None,
) -> Filed:
    """A set with sizes by which its arm, as it would be written, leaves least."""
    pool = identified.pool
    groups = [pool.groups[member.group] for member in members]
    usual = np.concatenate([np.zeros(0), *(group.usual for group in groups)])
    numbers = np.zeros(len(usual)) if start is None else start[: len(usual)]
    spread = identified.system.spread[:, identified.system.places(members)] / usual
    weights = identified.noise.weights
    written = completed(arm, groups, _parts(groups, numbers), more)
    rows = _about(identified, written, spread @ numbers) if given is None else given
    alone = [Member(number, member.scale) for number, member in enumerate(members)]
    least = np.inf
    for _ in range(_STEPS if members else 0):
        better = feasible(_system(identified, rows.fit, members), alone).numbers * usual
        if (rows.fit.explained(spread @ (better - numbers)) * np.sqrt(weights) < _SETTLED).all():
            break
        corrected = completed(arm, groups, _parts(groups, better), more)
        about_it = _about(identified, corrected, spread @ better)
        left = float((about_it.fit.left(spread @ better).sum(axis=0) * weights).sum())
        if not left < _WORSE * least:  # its numbers run away, as they can where torque constants follow the weights
            break
        numbers, written, rows, least = better, corrected, about_it, min(least, left)
    return _filed(identified, rows, members, written, numbers, spread @ numbers, more)


def _parts(groups: Sequence[Group], numbers: Array) -> list[Array]:
    """A set's numbers group by group."""
    ends = np.cumsum([group.rank for group in groups])
    return np.split(numbers, ends[:-1]) if groups else []


def _system(
    identified: Identified, made: Products, members: Sequence[Member], blocks: NDArray[np.bool_] | None = None
) -> System:
    """The system of a set alone, its members numbered as they stand in it."""
    pool = replace(identified.pool, groups=tuple(identified.pool.groups[member.group] for member in members))
    return system(pool, made, identified.noise.weights, np.zeros(pool.width), blocks)


def _filed(
    identified: Identified,
    rows: _Linearised,
    members: tuple[Member, ...],
    arm: Arm,
    numbers: Array,
    sizes: Array,
    more: Sequence[EffectEntry] = (),
) -> Filed:
    folds = identified.folds
    systems = tuple(_system(identified, rows.fit, members, folds != fold) for fold in np.unique(folds))
    alone = [Member(number, member.scale) for number, member in enumerate(members)]

    def judged_on(made: Products) -> tuple[HeldOut, Array, Array]:
        held, left = HeldOut(made, folds, systems), made.left(sizes)
        held_out = held.left(alone, bodies=True) if members else left
        # Motion that was not fitted is foretold no better than what was: such a linearised fit has not settled.
        return held, left, np.where(held_out.sum(axis=0) < left.sum(axis=0), left, held_out)

    held, left, held_out = judged_on(rows.counted)
    beside = (left, held_out) if rows.beside is rows.counted else judged_on(rows.beside)[1:]
    return Filed(members, numbers, sizes, arm, rows.rows, left, held_out, held, beside, tuple(more))


def _without_harm(arm: Arm, identified: Identified, given: Filed, named: Filed, more: Sequence[EffectEntry]) -> Filed:
    """The names without those that move only joints of which held-out motion is then foretold worse than as given."""
    worse = set(np.flatnonzero(named.beside[1].sum(axis=0) > given.beside[1].sum(axis=0)).tolist())
    moved = identified.system.moved
    kept = tuple(
        member
        for member in named.members
        if not set(np.flatnonzero(moved[identified.pool.groups[member.group].columns].any(axis=0)).tolist()) <= worse
    )
    return named if len(kept) == len(named.members) else _settled(arm, identified, kept, None, more)


def _rival(name: Name, left: Array, held_out: Array, filed: Filed, counts: Array) -> Rival:
    figures = rms_together(left, counts), rms_together(held_out, counts)
    return Rival(name, len(filed.numbers), *figures, held_out, counts)


def rms_together(left: Array, counts: Array) -> float:
    """RMS of all joints: the root of the mean over those that move of their mean squares, N*m."""
    rows = counts.sum(axis=0)
    moves = rows > 0
    return float(np.sqrt(np.mean(left.sum(axis=0)[moves] / rows[moves]))) if moves.any() else float("nan")


def as_written(sizes: Estimates, identified: Identified, judge: Judged) -> Estimates:
    """The estimates with the numbers that the arm's file holds, or would hold of the names alone where it holds none.
    Intervals stay where they were, and reach as far as these: a file holds no nuisance, whose place a size may take."""
    named = judge.written if judge.rivals.written == "ridge" else judge.named
    numbers, place = sizes.numbers.copy(), 0
    of_group, start = {}, 0
    for member in named.members:
        rank = identified.pool.groups[member.group].rank
        of_group[member.group] = named.numbers[start : start + rank]
        start += rank
    for member in identified.members:
        rank = identified.pool.groups[member.group].rank
        if member.group in of_group:
            numbers[place : place + rank] = of_group[member.group]
        place += rank
    low = np.minimum(sizes.numbers - sizes.half[0], numbers)
    high = np.maximum(sizes.numbers + sizes.half[1], numbers)
    return replace(sizes, numbers=numbers, half=np.stack((numbers - low, high - numbers)))
