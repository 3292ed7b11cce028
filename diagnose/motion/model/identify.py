"""The set of causes that motion logs name: steady motion first, then what happens where joints turn round."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .candidates import Candidates, at_estimates, bent_sizes, beyond, refined
from .chance import Chance, chance
from .evidence import Member, System, discrepancies, small_causes, spreads, system
from .feasible import lost
from .noise import Noise, noise
from .products import Products, products
from .rows import LogRows, joint_rows, with_loads, with_sources
from .search import HeldOut, pruned, searched

_ROUNDS = 3
"""Times that shapes, and what goes by the drives' torque, are worked out anew for the model found."""
_MOST_ROUNDS = 8
"""The same where a size is not in proportion to its torque, which is then worked out about the size until it stands."""
_SETTLED = 0.02
"""Of such sizes, by how much they may still change."""
_FOLDS = 5
"""Parts into which one log is cut to hold motion out."""


@dataclass(frozen=True)
class Identified:
    """What was identified: `members` of the system over the rows that count; `fitted` are those and the nuisances,
    beside which columns' sizes have random effects of standard deviation `spread` (W,), and as causes `unnamed` of that
    scale. `gate_p` is how often chance would name anything; `folds` (B,) hold motion out, named by `split`; reversals
    count at the joints `turning` (n,); `torque` (n,) is the RMS of each joint's torque where it moves, N*m."""

    pool: Candidates
    rows: tuple[LogRows, ...]
    products: Products
    noise: Noise
    discrepancy: Array
    spread: Array
    unnamed: tuple[Member, ...]
    system: System
    held: HeldOut
    chance: Chance
    members: tuple[Member, ...]
    gate_p: float
    split: str
    folds: NDArray[np.int64]
    turning: NDArray[np.bool_]
    torque: Array

    @property
    def fitted(self) -> tuple[Member, ...]:
        """The members, then the nuisances."""
        return (*self.members, *self.system.nuisances)


@dataclass(frozen=True)
class _Fit:
    """Products of some rows, their noise, and the system of all groups over them."""

    products: Products
    noise: Noise
    discrepancy: Array
    system: System
    seed: int

    @cached_property
    def chance(self) -> Chance:
        """Draws of chance."""
        return chance(self.system, self.products, self.noise, self.discrepancy, self.seed)

    def gate(self) -> float:
        """How often chance would make any group as evident as the most evident is."""
        nuisances = self.system.nuisances
        evidence = float(self.system.offers(nuisances).evidence.max())
        return self.chance.p_value(self.system, nuisances, evidence)

    def held_out(self, pool: Candidates, folds: NDArray[np.int64]) -> HeldOut:
        """Fits that leave out a fold in turn."""
        systems = tuple(
            system(pool, self.products, self.noise.weights, self.discrepancy, folds != fold)
            for fold in np.unique(folds)
        )
        return HeldOut(self.products, folds, systems)


def _fit(pool: Candidates, made: Products, uncertain: Array, seed: int) -> _Fit:
    noise_ = noise(pool, made)
    discrepancy = discrepancies(pool, made, uncertain)
    return _Fit(made, noise_, discrepancy, system(pool, made, noise_.weights, discrepancy), seed)


def _in_steady_motion(
    pool: Candidates,
    rows: Sequence[LogRows],
    certain: Array,
    seed: int,
    progress: Callable[[str, float], None],
    rules: Rules,
) -> tuple[Candidates, list[LogRows], _Fit, list[Member]]:
    """What motion away from reversals names, its shapes refined, and what goes by the drives' torque or is not linear
    worked out about the model found: the candidates and rows by then, the fit, and the members."""
    current, given = list(rows), pool
    steady = _fit(pool, products(joint_rows(current), pool.width, near=False), certain, seed)
    members = searched(steady.system, rules=rules)
    turn, about = 0, dict[tuple[str, tuple[int, ...]], float]()
    while True:
        turn += 1
        sizes = steady.system.solved([*steady.system.nuisances, *members])
        bent = bent_sizes(pool, sizes)
        settled = all(abs(size - about.get(place, 0.0)) <= _SETTLED * abs(size) for place, size in bent.items())
        if turn >= _ROUNDS and (settled or turn >= _MOST_ROUNDS):
            return pool, current, steady, members
        # Half way: what grows faster than its size would swing to and fro about where it settles.
        about = {place: 0.5 * (size + about.get(place, size)) for place, size in bent.items()}
        progress("naming what is missing", 0.4 + 0.15 * min(turn, _ROUNDS - 1))
        chosen = [member.group for member in members] if turn < _ROUNDS else []
        finer = refined(given, chosen, rules=rules)
        more = finer.sources[len(given.sources) :]
        current = [with_sources(with_loads(item, pool, sizes, about), more) for item in current]
        given, pool = finer, at_estimates(finer, _apart(steady.system, members))
        steady = _fit(pool, products(joint_rows(current), pool.width, near=False), certain, seed)
        members = searched(steady.system, initial=members, exchange=True, rules=rules)


def identify(
    pool: Candidates,
    rows: Sequence[LogRows],
    seed: int,
    progress: Callable[[str, float], None],
    *,
    rules: Rules,
) -> Identified:
    """The causes that logs name among candidates."""
    progress("naming what is missing", 0.4)
    torque = _torque(rows)
    certain, uncertain = (0.25 * share * torque for share in (rules.motion.filters, rules.motion.turning))
    pool, current, steady, members = _in_steady_motion(pool, rows, certain, seed, progress, rules)
    progress("testing reversals", 0.85)
    near = _fit(pool, products(joint_rows(current), pool.width, near=True), uncertain, seed)
    gate_p = min(1.0, 2.0 * min(item.gate() for item in (steady, near)))
    split, folds = _folds(steady.products, current[0].length, rules)
    turning = _at_reversals(pool, steady.products, near.products)
    if gate_p > rules.residual.level:
        members = []
    else:
        members = _kept(pool, steady, folds, members, torque, rules=rules)
        members = _with_reversals(pool, near, turning, folds, members, torque, rules=rules)
    while True:
        joints = _turning_joints(pool, members, turning)
        pick = np.array([joint in joints for joint in range(len(torque))])
        final = _fit(pool, mixed(steady.products, near.products, pick), certain, seed)
        members = _kept(pool, final, folds, members, torque, rules=rules)
        if joints == _turning_joints(pool, members, turning):
            break
    named = {member.group for member in members}
    pool, current, final, members = _at_all_shapes(pool, current, final, members, pick, certain, seed, rules)
    if {member.group for member in members} != named:  # what stood beside another shape may not be needed any more
        members = _kept(pool, final, folds, members, torque, rules=rules)
    fitted = [*members, *final.system.nuisances]
    taken = final.system.spread[:, final.system.places(fitted)]
    spread = spreads(pool, final.products, final.noise.weights, taken, certain)
    return Identified(
        pool,
        tuple(current),
        final.products,
        final.noise,
        final.discrepancy,
        spread,
        small_causes(final.system, pool, final.products, final.noise.weights, fitted, spread),
        final.system,
        final.held_out(pool, folds),
        final.chance,
        tuple(members),
        gate_p,
        split,
        folds,
        pick,
        torque,
    )


def _at_all_shapes(
    pool: Candidates,
    rows: Sequence[LogRows],
    fit: _Fit,
    members: Sequence[Member],
    pick: NDArray[np.bool_],
    certain: Array,
    seed: int,
    rules: Rules,
) -> tuple[Candidates, Sequence[LogRows], _Fit, list[Member]]:
    """Members in their likeliest shapes, of all that are as likely: where the last one that was tried is, those beyond
    it are tried too, up to what the parameter may be. Joints `pick` (n,) count with their reversals."""
    for _ in range(_ROUNDS):
        members, likely = _likeliest(fit.system, members)
        wider = beyond(pool, likely, rules=rules)
        if wider.width == pool.width:
            break
        more = wider.sources[len(pool.sources) :]
        rows, pool = [with_sources(item, more) for item in rows], wider
        steady, near = (products(joint_rows(rows), pool.width, near=each) for each in (False, True))
        fit = _fit(pool, mixed(steady, near, pick), certain, seed)
    return pool, rows, fit, _likeliest(fit.system, members)[0]


def _likeliest(system: System, members: Sequence[Member]) -> tuple[list[Member], list[tuple[int, bool, bool]]]:
    """Members in the likeliest shapes that were tried, in turn until they stand; and of each (its group) whether the
    least, and the greatest, shape that was tried is as likely."""
    current, ends = list(members), list[tuple[int, bool, bool]]()
    for _ in range(_ROUNDS):
        before, ends = list(current), []
        for place, member in enumerate(before):
            if not system.groups[member.group].shapes:
                continue
            offer = system.offers([*system.nuisances, *current[:place], *current[place + 1 :]])
            family = system.groups[member.group].family
            alike = [k for k, group in enumerate(system.groups) if group.family == family]
            best = max(alike, key=lambda k: (offer.evidence[k], k == member.group))
            if best != member.group:
                current[place] = Member(best, float(offer.scale[best]))
            ends.append((best, *system.ends(best, offer.evidence)))
        if current == before:
            break
    return current, ends


def _with_reversals(
    pool: Candidates,
    near: _Fit,
    turning: NDArray[np.bool_],
    folds: NDArray[np.int64],
    members: Sequence[Member],
    torque: Array,
    *,
    rules: Rules,
) -> list[Member]:
    """What steady motion named, and what motion `near` reversals names beside it of the groups that act there."""
    taken = {m.group for m in members}
    allowed = turning | np.array([number in taken for number in range(len(pool.groups))])
    found = searched(near.system, allowed, initial=members, rules=rules)
    more = [m for m in _kept(pool, near, folds, found, torque, rules=rules) if turning[m.group]]
    # What steady motion named goes only where something at reversals stands for it.
    there = {joint for m in more for joint in _joints(pool, m)}
    still = {m.group for m in found}
    kept = [m for m in members if m.group in still or not _joints(pool, m) <= there]
    return [*kept, *(m for m in more if m.group not in taken)]


def _turning_joints(pool: Candidates, members: Sequence[Member], turning: NDArray[np.bool_]) -> set[int]:
    """The joints (from 0) of members that act at reversals."""
    return {joint for m in members if turning[m.group] for joint in _joints(pool, m)}


def _apart(system: System, members: Sequence[Member]) -> Array:
    """The sizes (W,) of the model's columns by what each place has of its own."""
    together = [*system.nuisances, *members]
    untied = np.repeat([not system.groups[m.group].tied for m in together], [system.ranks[m.group] for m in together])
    return np.asarray(system.spread[:, system.places(together)] @ (untied * system.numbers(together)))


def _kept(
    pool: Candidates,
    fit: _Fit,
    folds: NDArray[np.int64],
    members: Sequence[Member],
    torque: Array,
    *,
    rules: Rules,
) -> list[Member]:
    """The members that are no trifle of the torque, gain on motion that was not fitted, and that chance does not make
    as evident."""
    sizes = fit.system.numbers([*members, *fit.system.nuisances])
    large: list[Member] = []
    start = 0
    for member in members:
        rank = pool.groups[member.group].rank
        alone = fit.system.spread[:, fit.system.places([member])] @ sizes[start : start + rank]
        start += rank
        if float(np.max(fit.products.explained(alone) / torque)) > rules.motion.turning:
            large.append(member)
    useful = pruned(fit.system, fit.held_out(pool, folds), large, rules=rules)
    return _beyond_chance(fit.system, fit.chance, useful, rules.residual.level)


def _torque(rows: Sequence[LogRows]) -> Array:
    """RMS (n,) of the measured torque where joints move, N*m."""
    square, count = np.zeros(len(rows[0].columns)), np.zeros(len(rows[0].columns))
    for row in rows:
        square += (row.measured[row.prepared.kept] ** 2 * row.prepared.moving).sum(axis=0)
        count += row.prepared.moving.sum(axis=0)
    return np.maximum(np.sqrt(square / np.maximum(count, 1.0)), 1e-12)


def mixed(steady: Products, near: Products, pick: NDArray[np.bool_]) -> Products:
    """Each joint by the rows that hold nothing unnamed: with reversals (n,) where something was named for them."""
    return replace(
        near,
        gram=tuple((near if item else steady).gram[joint] for joint, item in enumerate(pick)),
        rows=np.where(pick, near.rows, steady.rows),
    )


def _beyond_chance(whole: System, draws: Chance, members: Sequence[Member], level: float) -> list[Member]:
    """The members that chance does not make as evident beside the others; the least evident goes first."""
    current, fixed = list(members), whole.nuisances
    while current:
        doubtful: list[tuple[float, int]] = []
        for number in range(len(current)):
            others = [*fixed, *current[:number], *current[number + 1 :]]
            others += whole.plain_beside(current[number].group, others)
            evidence = float(whole.offers(others).evidence[current[number].group]) - lost(
                whole, others, current[number]
            )
            if draws.p_value(whole, others, evidence, whole.beside_joints_of(current[number].group)) > level:
                doubtful.append((evidence, number))
        if not doubtful:
            break
        current.pop(min(doubtful)[1])
    return current


def _folds(made: Products, length: float, rules: Rules) -> tuple[str, NDArray[np.int64]]:
    """What is held out, and the fold of each block, of `length` s: no fold of one log is shorter than what motion
    depends on itself, as poses that are close by are foretold by any fit."""
    if len(np.unique(made.log)) > 1:
        return "logs", np.unique(made.log, return_inverse=True)[1].astype(np.int64)
    most = max(2, min(_FOLDS, int(made.blocks * length / rules.motion.block)))
    return "time blocks", (np.arange(made.blocks) * min(most, made.blocks)) // made.blocks


def _at_reversals(pool: Candidates, steady: Products, near: Products) -> NDArray[np.bool_]:
    """Groups whose pattern lies mostly where joints turn round (G,)."""
    energy = np.zeros((2, pool.width))
    for which, made in enumerate((steady, near)):
        for joint, at in enumerate(made.columns):
            energy[which, at] += np.diagonal(made.of_joint(joint))[:-1]
    outside = energy[0] < 0.5 * energy[1]
    return np.array([bool(outside[group.columns].all()) for group in pool.groups])


def _joints(pool: Candidates, member: Member) -> set[int]:
    columns = set(pool.groups[member.group].columns.tolist())
    return {joint for source in pool.sources if columns & set(source.columns.tolist()) for joint in source.joints}
