"""A motion worth logging: of all within the limits that which tells named causes apart best."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.avoid.poses import Room
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics, link_parameters
from linkwright.core.diagnose.motion.model.candidates import Candidates, Group, candidates
from linkwright.core.diagnose.options import silent
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .trajectory import Limits, limits_of, moved, random_series

_STARTS, _STEPS = 20, 160
"""Series that are drawn, and steps from the best of them."""
_RATE, _WRITTEN = 20.0, 100.0
"""Hz at which motions are compared, and at which the best is sampled."""
_CLOCK = 3e-3
"""s by which torques may be late to coordinates in the log to come."""
_NOISE = 0.02
"""What torques scatter by, as a share of what the drive gives: it weighs joints against each other."""

Indices = NDArray[np.int64]
Place = tuple[str, tuple[int, ...]]
"""An effect by its id, and the joints or links at which it acts (from 1)."""


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
    """A motion that tells causes `apart`, the worst told first, and how many were `tried`. `unseen` are causes asked
    for that it cannot show."""

    arm: Arm
    motion: Motion
    limits: Limits
    apart: tuple[Apart, ...]
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
    """The motion that tells pairs of causes apart best.

    Args:
        arm: The arm; its joints' ranges and speeds are kept.
        wanted: Causes by effect and place (empty: everywhere); none: all that act on torques. One alone is
        distinguished from
            what its effect's aliases name.
        room: Where the arm may be.
        seconds: How long the motion is.
        seed: The same seed gives the same motion.
        progress: Hears of the steps; KeyboardInterrupt ends the search with the best so far.

    Raises:
        NothingToTell: No two causes act on this arm.
        NoRoom: Regions to avoid leave no room to move in.
    """
    draw, tell = np.random.default_rng(seed), progress or silent
    limits = limits_of(arm, room, draw)
    starts = random_series(arm, draw, _STARTS)
    motions = [moved(arm, start, limits, seconds, _RATE, room) for start in starts]
    model = _Compared.of(arm, wanted, motions[0])
    scores = [model.score(item) for item in motions]
    best, least, motion = starts[int(np.argmax(scores))], max(scores), motions[int(np.argmax(scores))]
    at_random = np.median([model.shares(item) for item in motions], axis=0)
    step, tried, interrupted = 0.5, len(starts), False
    try:
        for number in range(_STEPS):
            tell("choosing a motion", number / _STEPS)
            series = best + step * draw.standard_normal(best.shape) * np.abs(best).mean()
            candidate = moved(arm, series, limits, seconds, _RATE, room)
            score, tried = model.score(candidate), tried + 1
            # The rule of one fifth: I. Rechenberg, Evolutionsstrategie, Frommann-Holzboog 1973.
            step *= 1.22 if score > least else 0.95
            if score > least:
                best, least, motion = series, score, candidate
    except KeyboardInterrupt:
        interrupted = True
    shares, left = model.shares(motion), model.left(motion)
    apart = [
        Apart(one, other, float(share), float(random), float(rms))
        for (one, other), share, random, rms in zip(model.names, shares, at_random, left, strict=True)
    ]
    fine = moved(arm, best, limits, seconds, _WRITTEN, room)
    ordered = tuple(sorted(apart, key=lambda item: item.share))
    return MotionPlan(arm, fine, limits, ordered, model.unseen, tried, seed, interrupted)


@dataclass(frozen=True)
class _Compared:
    """The pairs of groups of a pool that are to be distinguished; `sigma` (n,) weighs the joints."""

    pool: Candidates
    pairs: tuple[tuple[int, int], ...]
    sigma: Array
    unseen: tuple[Place, ...]

    @classmethod
    def of(cls, arm: Arm, wanted: Sequence[Place], motion: Motion) -> _Compared:
        """What is asked for, on this arm. Raises `NothingToTell`."""
        effects = [effect for effect in (EFFECTS[name] for name in EFFECTS) if effect.torques is not None]
        pool = candidates(arm, effects, motion, link_parameters(arm), _CLOCK, rules=RULES)
        single = {_place(item): k for k, item in reversed(list(enumerate(pool.groups))) if len(item.at) < 2}
        places = wanted or [(effect.id, ()) for effect in effects]
        chosen, unseen = list[int](), list[Place]()
        for effect, at in places:
            numbers = [k for place, k in single.items() if place[0] == effect and (not at or place[1] == at)]
            chosen += numbers
            unseen += [] if numbers else [(effect, at)]
        chosen = sorted(set(chosen))
        others = {k: [] if len(chosen) > 1 and wanted else _aliases(pool.groups[k], single) for k in chosen}
        pairs = {(one, other) for one in chosen for other in others[one] if other != one}
        if wanted and len(chosen) > 1:
            pairs = set(itertools.permutations(chosen, 2))
        torque = inverse_dynamics(motion)
        sigma = np.maximum(_NOISE * np.sqrt((torque**2).mean(axis=0)), 1e-3 + _NOISE * np.abs(torque).max() / 50.0)
        if not pairs:
            raise NothingToTell("names no two causes that act on this arm's torques and could be taken for each other")
        return cls(pool, tuple(sorted(pairs)), sigma, tuple(unseen))

    @property
    def names(self) -> list[tuple[Place, Place]]:
        """The pairs by effect and place."""
        groups = self.pool.groups
        return [(_place(groups[one]), _place(groups[other])) for one, other in self.pairs]

    def score(self, motion: Motion) -> float:
        """The smallest separation of any pair, in units of what torques scatter by."""
        gram, size = self._gram(motion)
        return min(_left(gram, *span) for span in self._spans()) / np.sqrt(size)

    def shares(self, motion: Motion) -> Array:
        """What of each pair's first pattern the second cannot take up."""
        gram, _ = self._gram(motion)
        return np.array([_left(gram, one, other) / max(_whole(gram, one), 1e-12) for one, other in self._spans()])

    def left(self, motion: Motion) -> Array:
        """The same as a torque at usual size (N*m), at the joint where the first acts most."""
        gram, size = self._gram(motion)
        weigh = [self._of(motion, one)[1] for one, _ in self.pairs]
        spans = zip(self._spans(), weigh, strict=True)
        return np.array([_left(gram, *item) * sigma / np.sqrt(size) for item, sigma in spans])

    def _spans(self) -> list[tuple[Indices, Indices]]:
        starts = np.cumsum([0, *(self.pool.groups[k].rank for k in self._used())])
        at = {k: np.arange(a, b) for k, a, b in zip(self._used(), starts[:-1], starts[1:], strict=True)}
        return [(at[one], at[other]) for one, other in self.pairs]

    def _used(self) -> list[int]:
        return sorted({k for pair in self.pairs for k in pair})

    def _gram(self, motion: Motion) -> tuple[Array, int]:
        """The Gram matrix of all patterns at their usual sizes, joints weighed; and how many instants there are."""
        loaded = Motion(
            motion.arm, motion.time, motion.q, motion.velocity, motion.acceleration, torque=inverse_dynamics(motion)
        )
        table = np.concatenate([self._of(loaded, k)[0] for k in self._used()], axis=1)
        return table.T @ table, motion.size

    def _of(self, motion: Motion, group: int) -> tuple[Array, float]:
        """A group's patterns (N n, d) at usual sizes, joints weighed, and the weight of the joint where it is most."""
        each, n = self.pool.groups[group], motion.q.shape[1]
        patterns_by_joint = np.zeros((motion.size, n, len(each.columns)))
        place = {int(column): k for k, column in enumerate(each.columns)}
        for source in self.pool.sources:
            if source.columns[0] in place:
                at = [place[int(column)] for column in source.columns]
                for joint, values in source.torques(motion).items():
                    patterns_by_joint[:, joint, at] += values
        patterns = (patterns_by_joint @ each.mixing) * each.usual / self.sigma[None, :, None]
        most = int(np.argmax((patterns**2).sum(axis=(0, 2)) * self.sigma**2))
        return patterns.reshape(-1, each.rank), float(self.sigma[most])


def _place(group: Group) -> Place:
    return group.effect.id, group.at


def _aliases(group: Group, single: dict[Place, int]) -> list[int]:
    """The groups that what an effect names as aliases is, at the same joint or link, or wherever they act."""
    names = group.effect.aliases
    numbers = [
        k for (effect, at), k in single.items() if effect in names and (at == group.at or not at or not group.at)
    ]
    return numbers or [k for (effect, _), k in single.items() if effect in names]


def _left(gram: Array, one: Indices, other: Indices) -> float:
    """The size of one pattern that the other cannot take up."""
    inner = gram[np.ix_(other, other)]
    inner = inner + 1e-9 * max(float(np.trace(inner)), 1e-30) * np.eye(len(other))
    shared = gram[np.ix_(one, other)]
    left = np.trace(gram[np.ix_(one, one)]) - np.trace(shared @ np.linalg.solve(inner, shared.T))
    return float(np.sqrt(max(left, 0.0)))


def _whole(gram: Array, one: Indices) -> float:
    return float(np.sqrt(np.trace(gram[np.ix_(one, one)])))
