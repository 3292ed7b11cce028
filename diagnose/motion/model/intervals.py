"""Sizes of the named causes with their covariance: by the model and by blocks of time, the wider counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr
from scipy.stats import t as student

from linkwright.core.arm.effects.drives.torque_constant import TORQUE_CONSTANT
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .evidence import LIKELY, Member, System
from .feasible import feasible
from .products import Products


@dataclass(frozen=True)
class Estimates:
    """`numbers` (k,) of all members in SI, how far their 95 % intervals reach below and above them `half` (2, k),
    and whether the logs show each, `shown` (k,), rather than its prior; `sizes` (W,) of the model's columns. Numbers
    are the arm's; the torque that was logged holds each `gain` (k,) times, by what a torque constant is off at its
    joint."""

    numbers: Array
    half: Array
    shown: NDArray[np.bool_]
    gain: Array
    sizes: Array


def estimates(
    system: System,
    products: Products,
    weights: Array,
    members: Sequence[Member],
    unnamed: Array,
    *,
    sure: bool = False,
    rules: Rules,
) -> Estimates:
    """Sizes of a set with intervals: once causes are named, the logs say how large they are, not their prior.

    The covariance by blocks is the sandwich of K.-Y. Liang & S. L. Zeger, Biometrika 73 (1986) 13, with Student's t of
    the blocks' degrees of freedom. That by the model holds what random effects of the columns, of standard deviations
    `unnamed` (W,), move sizes by. Beside them counts how sizes change to other shapes that are as likely and, unless
    names are `sure`, beside other names.
    """
    at = system.places(members)
    if not len(at):
        empty = np.zeros(0)
        return Estimates(empty, np.zeros((2, 0)), empty.astype(bool), empty, np.zeros(products.width))
    wide = [Member(member.group, rules.fitting.usual * max(member.scale, 1.0)) for member in members]
    inverse = np.linalg.inv(system.gram[np.ix_(at, at)] + np.diag(system.precision(wide)))
    numbers = feasible(system, wide).numbers
    sizes = system.spread[:, at] @ numbers
    scores = products.scores(sizes, weights) @ system.seen[:, at]
    blocks = max(products.blocks, 2)
    by_blocks = inverse @ (scores.T @ scores) @ inverse * blocks / (blocks - 1)
    pulled = inverse @ system.seen[:, at].T @ products.whole(weights)[0] * unnamed
    unit = np.concatenate([system.groups[m.group].usual for m in members])
    gain, slopes = _gain(system, members, numbers * unit)
    # Of what a constant multiplies nobody knows more than of the constant.
    turned = (np.eye(len(at)) - (numbers * unit / gain)[:, None] * slopes) / gain[:, None] * unit
    model = np.sqrt(np.diagonal(turned @ inverse @ turned.T) + ((turned @ pulled) ** 2).sum(axis=1)) * 1.96
    robust = np.sqrt(np.maximum(np.diagonal(turned @ by_blocks @ turned.T), 0.0))
    robust *= float(student.ppf(0.975, blocks - 1))
    shown = np.sqrt(np.diagonal(inverse)) < rules.motion.shown
    # A shape and a size are one ellipse.
    others = _Others.of(system, wide)
    half = np.hypot(np.maximum(model, robust) * gain / unit, [-others.least, others.most])
    if not sure:
        half = np.stack((others.reversed().reach(half[0]), others.reach(half[1])))
    half = half * unit / gain
    return Estimates(numbers * unit / gain, half, shown, gain, np.asarray(sizes))


def _gain(system: System, members: Sequence[Member], numbers: Array) -> tuple[Array, Array]:
    """How many times the logged torque holds each number (k,), and that by the numbers (k, k): what acts at a joint
    goes by that joint's constant."""
    joints = system.moved.shape[1]
    excess, change = np.zeros((joints, len(numbers))), np.zeros((len(numbers), len(numbers)))
    groups = [system.groups[member.group] for member in members]
    ends = np.cumsum([group.rank for group in groups]).tolist()
    for group, end in zip(groups, ends, strict=True):
        if group.effect is TORQUE_CONSTANT:
            for (at, _), more in zip(group.labels, group.mixing, strict=True):
                excess[at[0] - 1, end - group.rank : end] += more
    for group, end in zip(groups, ends, strict=True):
        if group.effect.place == "joint" and not group.effect.recording.of_instrument and not group.tied:
            change[end - group.rank : end] += excess[group.at[0] - 1]
    return 1.0 + change @ numbers, change


@dataclass(frozen=True)
class _Others:
    """How far the numbers (k,) of a set are from these in other sets that are as likely: the `least` and `most` (k,) in
    other shapes; beside other names, member by member, the `shifts` (m, k) and how likely each is, `odds` (m,)."""

    least: Array
    most: Array
    shifts: tuple[Array, ...]
    odds: tuple[Array, ...]

    @classmethod
    def of(cls, system: System, members: Sequence[Member]) -> _Others:
        """Those of members."""
        numbers = system.numbers(members)
        beside = np.maximum(system.offers(members).evidence, 0.0)
        taken = {system.groups[member.group].family for member in members}
        in_shapes, shifts, odds = [np.zeros(len(numbers))], list[Array](), list[Array]()
        start = 0
        for place, member in enumerate(members):
            group, end = system.groups[member.group], start + system.groups[member.group].rank
            offered = system.offers([*members[:place], *members[place + 1 :]]).evidence
            if not np.isfinite(offered[member.group]):
                start = end  # what is fitted with any set has no other name
                continue
            # What is as evident beside all of them is something of its own, and stands for none.
            worse = offered[member.group] - offered + beside
            alike = [k for k in np.flatnonzero(worse <= LIKELY).tolist() if system.groups[k].family not in taken]
            named = [(np.zeros(len(numbers)), 1.0)]
            for other in (*(system.as_likely(member.group, offered) if group.shapes else ()), *alike):
                changed = [*members[:place], Member(other, member.scale), *members[place + 1 :]]
                values, more = system.numbers(changed), end + system.groups[other].rank - group.rank
                if other not in alike:
                    in_shapes.append(values - numbers)
                elif system.within(changed)[place]:
                    values = np.concatenate((values[:start], numbers[start:end], values[more:]))
                    named.append((values - numbers, float(np.exp(-max(worse[other], 0.0)))))
            shifts.append(np.stack([shift for shift, _ in named]))
            odds.append(np.array([weight for _, weight in named]))
            start = end
        return cls(np.min(in_shapes, axis=0), np.max(in_shapes, axis=0), tuple(shifts), tuple(odds))

    def reach(self, half: Array) -> Array:
        """How far (k,) 95 % intervals reach upwards that reach `half` beside the names taken: names are one or another,
        each with its own interval (J. A. Hoeting et al., Bayesian model averaging, Statist. Sci. 14 (1999) 382)."""
        each = (_above(shift, odds, half) for shift, odds in zip(self.shifts, self.odds, strict=True))
        return np.max([half, *each], axis=0)

    def reversed(self) -> _Others:
        """The same of the numbers' negatives."""
        return _Others(-self.most, -self.least, tuple(-shift for shift in self.shifts), self.odds)


def _above(shifts: Array, odds: Array, half: Array) -> Array:
    """What one in forty (k,) is above, of normal numbers about `shifts` (m, k) with 95 % within `half` (k,), of which
    each is as likely as `odds` (m,)."""
    least, most = half.copy(), half + np.maximum(shifts.max(axis=0), 0.0)
    least = np.minimum(least + np.minimum(shifts.min(axis=0), 0.0), most)
    sigma, outside = np.maximum(half, 1e-300) / 1.96, float(ndtr(-1.96) * odds.sum())
    for _ in range(60):
        middle = 0.5 * (least + most)
        beyond = odds @ ndtr((shifts - middle) / sigma) > outside
        least, most = np.where(beyond, middle, least), np.where(beyond, most, middle)
    return np.maximum(most, half)
