"""Effects of the library whose sizes step between parts of a motion: recordings given together, or stretches of one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.effects.drives.torque_offset import TORQUE_OFFSET
from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .candidates import Candidates
from .groups import Group
from .noise import covariance, noise, usual_sizes
from .products import Products

Parts = NDArray[np.bool_]

_OF_DRIVES = (FRICTION_COULOMB, FRICTION_VISCOUS, TORQUE_OFFSET)
_ROUNDING = 1e-5
"""Of a gain: what rounding makes of it where noise is next to nothing."""


@dataclass(frozen=True)
class Step:
    """A group that has sizes of its own in some `parts` (B,) of a motion: its `numbers` (d,) are so much more there,
    with their `covariance` (d, d); all parts share `common` (k,) of its columns. With it the motion is likelier by
    `gain` (nats, its choice not yet paid for)."""

    group: Group
    parts: Parts
    numbers: Array
    covariance: Array
    common: Array
    gain: float


@dataclass(frozen=True)
class SteppedFit:
    """The whole library fitted to a motion in parts, sizes held to what is usual, beside `steps`; joints are weighed by
    `weights` (n,). `sizes` (W + k,) and their `covariance` are those of the model's columns, then the steps' numbers.
    """

    motion: Products
    weights: Array
    steps: tuple[Step, ...]
    sizes: Array
    covariance: Array

    @property
    def common(self) -> Array:
        """The sizes (W,) of the model's columns that all parts share."""
        return self.sizes[: self.motion.width]

    def left(self) -> Array:
        """Sums of squares (n,) that are left of each joint's torque."""
        each = np.tile(self.common, (self.motion.blocks, 1))
        for step in self.steps:
            each[np.ix_(step.parts, step.group.columns)] += step.group.values(step.numbers)
        return np.sum([self.motion.left(sizes)[part] for part, sizes in enumerate(each)], axis=0)


@dataclass(frozen=True)
class Difference:
    """A step between recordings, what would be `left` (n,) N*m RMS without it, how many nats it gains, its choice
    `paid` for, and the other groups that explain as much there, with how many nats less likely they are."""

    step: Step
    left: Array
    paid: float
    alternatives: tuple[tuple[Group, float], ...]


def fitted(pool: Candidates, motion: Products, weights: Array, steps: Sequence[Step] = ()) -> SteppedFit:
    """The fit of the whole library beside steps, whose numbers and covariances are then those of this fit."""
    gram, against, _ = motion.whole(weights)
    for number, step in enumerate(steps):
        across, inner, score = _Products.of(motion, weights, steps[:number], step.parts).of_group(step.group)
        gram, against = np.block([[gram, across], [across.T, inner]]), np.concatenate((against, score))
    usual = np.concatenate([usual_sizes(pool), *(step.group.usual for step in steps)])
    spread = covariance(gram, usual) * usual[:, None] * usual
    sizes, made, start = spread @ against, list[Step](), motion.width
    for step in steps:
        span = slice(start, start + step.group.rank)
        made.append(replace(step, numbers=sizes[span], covariance=spread[span, span]))
        start = span.stop
    return SteppedFit(motion, weights, tuple(made), sizes, spread)


def tried(fit: SteppedFit, where: Iterable[Parts], groups: Sequence[Group]) -> Iterator[Step]:
    """Each group with sizes of its own in each of some sets of parts, beside the fit's steps."""
    for parts in where:
        held = _Products.of(fit.motion, fit.weights, fit.steps, parts)
        told = fit.covariance @ held.across
        inner, left = held.gram - held.across.T @ told, held.against - held.across.T @ fit.sizes
        for group in groups:
            at, mixing = group.columns, group.mixing
            score, information = mixing.T @ left[at], mixing.T @ inner[np.ix_(at, at)] @ mixing
            precision = np.diag(1.0 / group.usual**2)
            spread = np.asarray(np.linalg.inv(information + precision), dtype=float)
            widths = np.linalg.slogdet(information + precision)[1] - np.linalg.slogdet(precision)[1]
            numbers = spread @ score
            common = fit.sizes[at] - told[np.ix_(at, at)] @ mixing @ numbers
            yield Step(group, parts, numbers, spread, common, float(0.5 * (score @ numbers - widths)))


def may_step(pool: Candidates) -> list[Group]:
    """The groups that may have other sizes in some parts."""
    return [group for group in pool.groups if not (group.nuisance or group.tied)]


def may_differ(pool: Candidates) -> list[Group]:
    """The groups that may have other sizes in some recordings of one machine: a load at the tip, and the drives' plain
    friction and offsets. Anything else that only one recording shows is rather physics that the library lacks."""
    return [group for group in may_step(pool) if group.effect.place == "tip" or group.effect in _OF_DRIVES]


def differences(
    pool: Candidates, blocks: Products, known: Sequence[Difference], *, rules: Rules
) -> tuple[tuple[Difference, ...], Array]:
    """What differs between recordings before anything is named in all of them: what is `known`, by the numbers that are
    still lacking, and at most one more; and the RMS (n,) N*m of what all sizes together, free in each recording, would
    explain beyond what is known.

    A step must pay for having been chosen, halve what shared sizes leave of some joint's torque (less is rather physics
    that the library lacks, and would take out of the file what predicts), and explain half of what free sizes would
    explain there. Of steps that are alike the commonest is taken, payload and friction first.
    """
    motion = blocks.by_log()
    weights, best, least = _apart(pool, blocks, motion)
    rows = np.maximum(motion.rows.sum(axis=0), 1)
    fit = fitted(pool, motion, weights, [item.step for item in known])
    differences = [replace(item, step=step) for item, step in zip(known, fit.steps, strict=True)]
    left = fit.left()
    further = np.sqrt(np.maximum(left - best, 0.0) / rows)
    items = sorted(tried(fit, _some(motion.blocks), may_differ(pool)), key=lambda step: -step.gain)
    choice = float(np.log(max(len(items), 1)))
    enough = choice + rules.search.margin
    near = max(rules.search.refuted_odds, _ROUNDING * items[0].gain) if items else 0.0
    likely = [item for item in items if item.gain > max(enough, items[0].gain - near)]
    for step in sorted(likely, key=lambda step: _uncommon(fit, step)):
        more = fitted(pool, motion, weights, (*fit.steps, step))
        taken = left - more.left()
        cut = taken > (1.0 - HALF**2) * left
        if (cut & (taken > HALF * (left - least))).any():
            without, alike = np.sqrt(left / rows), _alternatives(step, items, rules)
            differences = [replace(item, step=renewed) for item, renewed in zip(differences, more.steps, strict=False)]
            return (*differences, Difference(more.steps[-1], without, step.gain - choice, alike)), further
    return tuple(differences), further


def _alternatives(step: Step, items: Sequence[Step], rules: Rules) -> tuple[tuple[Group, float], ...]:
    """Other groups that explain as much in the same parts, the likeliest of each family, and how much less likely."""
    best: dict[tuple[str, tuple[int, ...]], tuple[Group, float]] = {}
    for other in items:
        worse, group = step.gain - other.gain, other.group
        alike = worse < rules.search.log_odds and (other.parts == step.parts).all()
        if alike and group.family != step.group.family and not _same_body(group, step.group):
            best.setdefault(group.family, (group, max(worse, 0.0)))
    return tuple(best.values())


@dataclass(frozen=True)
class _Products:
    """Products of the model's columns in some parts: `gram` (W, W), `against` (W,) with the target, and those `across`
    (W + k, W) with the columns and the numbers of some steps."""

    gram: Array
    against: Array
    across: Array

    @classmethod
    def of(cls, motion: Products, weights: Array, steps: Sequence[Step], parts: Parts) -> _Products:
        """The products in some parts beside steps."""
        gram, against, _ = motion.whole(weights, parts)
        beside = [
            step.group.mixing.T @ motion.whole(weights, parts & step.parts)[0][step.group.columns] for step in steps
        ]
        return cls(gram, against, np.concatenate([gram, *beside]))

    def of_group(self, group: Group) -> tuple[Array, Array, Array]:
        """Products of a group's numbers with the model's columns and the steps' numbers (W + k, d), with themselves
        (d, d), and with the target (d,)."""
        at, mixing = group.columns, group.mixing
        return self.across[:, at] @ mixing, mixing.T @ self.gram[np.ix_(at, at)] @ mixing, mixing.T @ self.against[at]


def _apart(pool: Candidates, blocks: Products, motion: Products) -> tuple[Array, Array, Array]:
    """Weights (n,) of the joints' rows by the noise that the library leaves where each recording has sizes of its own,
    the sums of squares (n,) that it leaves, and those that it would leave had it been fitted to other motion."""
    each = [noise(pool, blocks.of_log(number)) for number in range(motion.blocks)]
    rows = np.maximum(motion.rows.sum(axis=0), 1)
    squares, repeats = (
        sum((of_row * value for of_row, value in zip(motion.rows, values, strict=True)), np.zeros(motion.joints))
        for values in ([item.sigma**2 for item in each], [item.repeats for item in each])
    )
    repeats = np.maximum(repeats / rows, 1.0)
    variance = np.maximum(squares / rows, 1e-24)  # of a joint that never moves there is none
    left = np.sum([motion.left(item.sizes)[number] for number, item in enumerate(each)], axis=0)
    return 1.0 / (variance * repeats), left, np.maximum(squares, left)


def _some(count: int) -> list[Parts]:
    """Each recording alone, all from one on, and all before it."""
    number = np.arange(count)
    sets = [number == one for one in range(count)]
    for first in range(1, count):
        sets += [number >= first, number < first]
    return list({item.tobytes(): item for item in sets if not item.all()}.values())


def _same_body(one: Group, other: Group) -> bool:
    """Whether two groups are loads on one link, which are one load."""
    return one.body is not None and other.body is not None and one.body.link == other.body.link


def _uncommon(fit: SteppedFit, step: Step) -> tuple[int, int, float]:
    """What sorts steps that are alike: a load, friction, or the rest by how common they are; the recordings that do not
    step being as the arm file says."""
    effect, common = step.group.effect, np.zeros(fit.motion.width)
    common[step.group.columns] = step.common
    kind = 0 if effect.place == "tip" else 1 if effect.cause.startswith("friction") else 2
    return kind, effect.rank, float(np.sum(np.square(fit.motion.explained(common))))
