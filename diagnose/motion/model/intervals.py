"""Sizes of the named causes with their covariance: by the model and by blocks of time, the wider counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
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
    # A shape and a size are one ellipse; names are one or another, each with its own interval.
    by_shapes, by_names = (item * unit / gain for item in _by_others(system, wide, numbers))
    half = np.hypot(np.maximum(model, robust), by_shapes) + (0.0 if sure else by_names)
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


def _by_others(system: System, members: Sequence[Member], numbers: Array) -> tuple[Array, Array]:
    """How much less and more (2, k) the numbers are by the shapes that are as likely as those taken, and beside other
    names that are as likely: an amplitude that goes with its shape is larger or smaller by that, and not of the other
    sign."""
    by_shapes, by_names = np.zeros((2, len(numbers))), np.zeros((2, len(numbers)))
    beside = np.maximum(system.offers(members).evidence, 0.0)
    taken = {system.groups[member.group].family for member in members}
    start = 0
    for place, member in enumerate(members):
        group, end = system.groups[member.group], start + system.groups[member.group].rank
        offered = system.offers([*members[:place], *members[place + 1 :]]).evidence
        # What is as evident beside all of them is something of its own, and stands for none.
        alike = np.flatnonzero(offered - beside >= offered[member.group] - LIKELY).tolist()
        names = [] if group.nuisance else [k for k in alike if system.groups[k].family not in taken]
        shapes = system.as_likely(member.group, offered) if group.shapes else []
        for other in (*shapes, *names):
            changed = [*members[:place], Member(other, member.scale), *members[place + 1 :]]
            values, more = system.numbers(changed), end + system.groups[other].rank - group.rank
            if other in shapes:
                by_shapes = np.maximum(by_shapes, [numbers - values, values - numbers])
            elif system.within(changed)[place]:
                shift = np.concatenate((values[:start], numbers[start:end], values[more:])) - numbers
                by_names = np.maximum(by_names, [-shift, shift])
        start = end
    return by_shapes, by_names
