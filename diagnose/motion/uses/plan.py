"""A motion worth logging: of all within the limits that which tells named causes apart best."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.avoid.poses import Room
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.options import silent
from linkwright.core.sections.numeric import Array

from .expected import RATE, Expected, Indices, Patterns, Place, aliases, place_of
from .trajectory import Limits, limits_of, moved, random_series

_STARTS, _STEPS = 20, 300
"""Series that are drawn, and steps from the best of them."""
_WRITTEN = 100.0
"""Hz at which the best is sampled."""
_HARMONICS = 20
"""Of the whole motion's frequency that are tried: what goes by accelerations asks for more than motions at random
have."""


@dataclass(frozen=True)
class Apart:
    """Two causes and how well a motion tells them apart: `share` of the first's pattern in the torques that the second
    cannot take up (0: none, 1: all), and at motions at random, `random`; `left` is the RMS of that for its usual size,
    N*m (N) at the joint where it is most."""

    one: Place
    other: Place
    share: float
    random: float
    left: float


@dataclass(frozen=True)
class MotionPlan:
    """A motion that tells causes `apart`, the worst told first, how far it tells the size of each (`expected`), and how
    many were `tried` (none: it is that of a log). `unseen` are causes asked for that it cannot show."""

    arm: Arm
    motion: Motion
    limits: Limits
    apart: tuple[Apart, ...]
    expected: tuple[Expected, ...]
    unseen: tuple[Place, ...]
    tried: int
    seed: int
    interrupted: bool = False


class NothingToTell(Exception):
    """Nothing of what is asked for acts on this arm, or no two causes of it; the text is a clause that says so."""


def plan_motion(
    arm: Arm,
    wanted: Sequence[Place],
    room: Room,
    *,
    seconds: float = 20.0,
    seed: int = 1,
    progress: Callable[[str, float], None] | None = None,
) -> MotionPlan:
    """The motion that tells the sizes of causes best, and thereby tells causes apart.

    Of all motions tried it is that with the least product of the intervals (the determinant criterion of Swevers et
    al., see `trajectory`, of the sizes asked for alone).

    Args:
        arm: The arm; its joints' ranges, speeds and peak torques are kept.
        wanted: Causes by effect and place (empty: everywhere); none: all that act on torques. One alone is
            distinguished from what its effect's aliases name.
        room: Where the arm may be.
        seconds: How long the motion is.
        seed: The same seed gives the same motion.
        progress: Hears of the steps; KeyboardInterrupt ends the search with the best so far.

    Raises:
        NothingToTell: No two causes act on this arm.
        NoRoom: Regions to avoid, or the drives' torques, leave no room to move in.
    """
    draw, tell = np.random.default_rng(seed), progress or silent
    limits = limits_of(arm, room, draw)
    known = [joint.rating[1] for joint in arm.joints]
    limits = replace(limits, torque=np.array([np.inf if peak is None else peak for peak in known]))
    low = random_series(arm, draw, _STARTS)
    motions = [moved(arm, start, limits, seconds, RATE, room) for start in low]
    patterns = Patterns.of(arm, wanted, motions[0])
    pairs = _pairs(patterns, together=bool(wanted))
    if not pairs:
        raise NothingToTell("names no two causes that act on this arm's torques and could be taken for each other")
    grams = [patterns.gram(item) for item in motions]
    at_random = np.median([patterns.uncertain(gram) for gram in grams], axis=0)
    series = [np.pad(start, ((0, 0), (0, _HARMONICS - start.shape[1]), (0, 0))) for start in low]

    def tried(coefficients: Array) -> tuple[float, Array, Motion]:
        motion = moved(arm, coefficients, limits, seconds, RATE, room)
        gram = patterns.gram(motion)
        return float(np.log(patterns.uncertain(gram)).mean()), gram, motion

    series += [draw.standard_normal(series[0].shape) for _ in range(_STARTS)]
    step, count, interrupted = 0.5, len(series), False
    best = min(((*tried(item), item) for item in series), key=lambda item: item[0])
    try:
        for number in range(_STEPS):
            tell("choosing a motion", number / _STEPS)
            changed = best[3] + step * draw.standard_normal(best[3].shape) * np.abs(best[3]).mean()
            candidate, count = (*tried(changed), changed), count + 1
            # The rule of one fifth: I. Rechenberg, Evolutionsstrategie, Frommann-Holzboog 1973.
            step *= 1.22 if candidate[0] < best[0] else 0.95
            best = min(best, candidate, key=lambda item: item[0])
    except KeyboardInterrupt:
        interrupted = True
    _, gram, motion, chosen = best
    fine = moved(arm, chosen, limits, seconds, _WRITTEN, room)
    apart = _apart(patterns, pairs, motion, [*grams, gram])
    expected = patterns.expected(gram, at_random)
    return MotionPlan(arm, fine, limits, tuple(apart), expected, patterns.unseen, count, seed, interrupted)


def _pairs(patterns: Patterns, *, together: bool) -> list[tuple[int, int]]:
    """The groups that are to be told apart: those asked for `together`, or each from what could be taken for it."""
    asked, single = patterns.asked, patterns.single
    if together and len(asked) > 1:
        return list(itertools.permutations(asked, 2))
    pairs = {(one, other) for one in asked for other in aliases(patterns.pool.groups[one], single) if other != one}
    return sorted(pairs)


def _apart(patterns: Patterns, pairs: Sequence[tuple[int, int]], motion: Motion, grams: Sequence[Array]) -> list[Apart]:
    """How well the motion of the last of some Gram matrices tells pairs apart, beside the median of the others."""
    spans, groups = patterns.spans, patterns.pool.groups
    shares = np.array(
        [[_left(g, spans[a], spans[b]) / max(_whole(g, spans[a]), 1e-12) for a, b in pairs] for g in grams]
    )
    worked_out, made = patterns.worked_out(motion), list[Apart]()
    for number, (one, other) in enumerate(pairs):
        power = (patterns.pattern(motion, one, *worked_out) ** 2).sum(axis=(0, 2)) * patterns.sigma**2
        left = _left(grams[-1], spans[one], spans[other]) * patterns.sigma[np.argmax(power)] / np.sqrt(motion.size)
        figures = float(shares[-1, number]), float(np.median(shares[:-1, number])), float(left)
        made.append(Apart(place_of(groups[one]), place_of(groups[other]), *figures))
    return sorted(made, key=lambda item: item.share)


def _left(gram: Array, one: Indices, other: Indices) -> float:
    """The size of one pattern that the other cannot take up."""
    inner = gram[np.ix_(other, other)]
    inner = inner + 1e-9 * max(float(np.trace(inner)), 1e-30) * np.eye(len(other))
    shared = gram[np.ix_(one, other)]
    left = np.trace(gram[np.ix_(one, one)]) - np.trace(shared @ np.linalg.solve(inner, shared.T))
    return float(np.sqrt(max(left, 0.0)))


def _whole(gram: Array, one: Indices) -> float:
    return float(np.sqrt(np.trace(gram[np.ix_(one, one)])))
