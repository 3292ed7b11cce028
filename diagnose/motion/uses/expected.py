"""How far a motion tells each name: the intervals to be expected of a diagnosis, by the patterns of the names alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics, link_parameters, regressor
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.model.candidates import Candidates, acting, candidates
from linkwright.core.diagnose.motion.model.groups import Group
from linkwright.core.diagnose.motion.model.noise import covariance
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

RATE = 20.0
"""Hz at which motions are compared: samples this far apart tell apart what the low-pass lets through."""
_CLOCK = 3e-3
"""s by which torques may be late to coordinates in the log to come."""
_NOISE = 0.02
"""What torques scatter by, as a share of what the drive gives: it weighs joints against each other."""

Indices = NDArray[np.int64]
Place = tuple[str, tuple[int, ...]]
"""An effect by its id, and the joints or links at which it acts (from 1)."""


@dataclass(frozen=True)
class Expected:
    """A name and how far a motion tells its size: half the 95 % interval `half` of its first `parameter` (SI, of a
    `kind`), and the `share` of the usual size that is; `random` is that share at motions at random (nan: none was
    tried). Where it is not `shown`, it goes with `beside`, or nothing of it acts (None)."""

    name: Place
    parameter: str
    kind: str
    half: float
    share: float
    random: float
    shown: bool
    beside: Place | None


@dataclass(frozen=True)
class Patterns:
    """The groups of a pool that a motion is to show: numbers `asked` for, and all that are `used`, those that could be
    taken for them and the terms that every drive has among them. `sigma` (n,) N*m is the noise of each joint; `unseen`
    is what was asked for and does not act on this arm."""

    pool: Candidates
    asked: tuple[int, ...]
    used: tuple[int, ...]
    sigma: Array
    unseen: tuple[Place, ...] = ()

    @classmethod
    def of(cls, arm: Arm, wanted: Sequence[Place], motion: Motion, sigma: Array | None = None) -> Patterns:
        """What is asked for (nothing: all that acts on torques), on this arm."""
        named = {effect for effect, _ in wanted}
        effects = acting(voltages=any(EFFECTS[each].recording.of_voltage for each in EFFECTS if each in named))
        pool = candidates(arm, effects, motion, link_parameters(arm), _CLOCK, rules=RULES)
        single = {place_of(item): k for k, item in reversed(list(enumerate(pool.groups))) if len(item.at) < 2}
        asked, unseen = set[int](), list[Place]()
        for effect, at in wanted or [(effect.id, ()) for effect in effects]:
            numbers = {k for place, k in single.items() if place[0] == effect and (not at or place[1] == at)}
            asked |= numbers
            unseen += [] if numbers else [(effect, at)]
        plain = {k for k in single.values() if pool.groups[k].plain}
        others = {other for k in asked for other in aliases(pool.groups[k], single)} if wanted else set[int]()
        torque = inverse_dynamics(motion)
        usual = np.maximum(_NOISE * np.sqrt((torque**2).mean(axis=0)), 1e-3 + _NOISE * np.abs(torque).max() / 50.0)
        noise: Array = np.asarray(usual) if sigma is None else sigma
        return cls(pool, tuple(sorted(asked)), tuple(sorted(asked | plain | others)), noise, tuple(unseen))

    @property
    def single(self) -> dict[Place, int]:
        """The groups that are used, by effect and place."""
        return {place_of(self.pool.groups[k]): k for k in self.used}

    @property
    def spans(self) -> dict[int, Indices]:
        """Where the numbers of each group that is used stand."""
        ends = np.cumsum([0, *(self.pool.groups[k].rank for k in self.used)])
        return {k: np.arange(a, b) for k, a, b in zip(self.used, ends[:-1], ends[1:], strict=True)}

    def gram(self, motion: Motion) -> Array:
        """The Gram matrix of all patterns at their usual sizes, in units of the noise."""
        patterns = (self.pattern(motion, k, *made) for made in (self.worked_out(motion),) for k in self.used)
        table = np.concatenate([each.reshape(-1, each.shape[-1]) for each in patterns], axis=1)
        return table.T @ table

    def worked_out(self, motion: Motion) -> tuple[Array, Array]:
        """Torque (N, n) of the links of a motion, and regressor (N, n, 10 n), by which patterns are worked out."""
        return inverse_dynamics(motion), regressor(motion.arm, motion.q, motion.velocity, motion.acceleration)

    def pattern(self, motion: Motion, group: int, torque: Array, by_parameter: Array) -> Array:
        """A group's patterns (N, n, d) at usual sizes, in units of the noise, where the joints move."""
        each, motion = self.pool.groups[group], replace(motion, torque=torque)
        patterns = np.zeros((*motion.q.shape, len(each.columns)))
        place = {int(column): k for k, column in enumerate(each.columns)}
        for source in self.pool.sources:
            if source.columns[0] in place:
                at = [place[int(column)] for column in source.columns]
                for joint, values in source.torques(motion, by_parameter).items():
                    patterns[:, joint, at] += values
        moves = np.abs(motion.velocity) > RULES.motion.slow
        return (patterns @ each.mixing) * each.usual * (moves / self.sigma)[:, :, None]

    def uncertain(self, gram: Array) -> Array:
        """Half the 95 % intervals (K,) of the first number of each group asked for, over its usual size, beside the
        others and what every drive has: what could be taken for it is told apart, and widens no interval."""
        cov, at = self._covariance(gram)
        return 1.96 * np.sqrt(np.array([cov[at[k][0], at[k][0]] for k in self.asked]))

    def _covariance(self, gram: Array) -> tuple[Array, dict[int, Indices]]:
        """Covariance over usual sizes of what is asked for and what every drive has, and where each group's stands."""
        kept = [k for k in self.used if k in self.asked or self.pool.groups[k].plain]
        spans = [self.spans[k] for k in kept]
        at = np.concatenate(spans)
        ends = np.cumsum([0, *(len(span) for span in spans)])
        places = {k: np.arange(a, b) for k, a, b in zip(kept, ends[:-1], ends[1:], strict=True)}
        return covariance(gram[np.ix_(at, at)], np.ones(len(at))), places

    def expected(self, gram: Array, random: Array | None = None) -> tuple[Expected, ...]:
        """How far each name asked for is told, the worst first; `random` (K,) are the figures of motions at random."""
        half = self.uncertain(gram)
        random = np.full(len(half), np.nan) if random is None else random
        made: list[Expected] = []
        for k, share, before in zip(self.asked, half.tolist(), random.tolist(), strict=True):
            group, at = self.pool.groups[k], int(self.spans[k][0])
            deviation, size = share / 1.96, group.sizes[0]
            shown = deviation < RULES.motion.shown
            beside = None if shown or gram[at, at] < 1.0 else self._beside(gram, k)
            half_si = share * float(group.usual[0])
            made.append(Expected(place_of(group), size.name, size.kind, half_si, share, before, shown, beside))
        return tuple(sorted(made, key=lambda item: -item.share))

    def _beside(self, gram: Array, group: int) -> Place:
        """The other group by which a group's first number is uncertain: with which it goes most."""
        cov, places = self._covariance(gram)
        at, size = int(places[group][0]), np.sqrt(np.diagonal(cov))
        alike = {
            other: float(np.abs(cov[at, span] / (size[at] * size[span])).max())
            for other, span in places.items()
            if other != group
        }
        return place_of(self.pool.groups[max(alike, key=lambda other: alike[other])])


def place_of(group: Group) -> Place:
    """A group by its effect and where it acts."""
    return group.effect.id, group.at


def aliases(group: Group, single: dict[Place, int]) -> list[int]:
    """The groups that what an effect names as aliases is, at the same joint or link, or wherever they act."""
    names = group.effect.aliases
    numbers = [
        k for (effect, at), k in single.items() if effect in names and (at == group.at or not at or not group.at)
    ]
    return numbers or [k for (effect, _), k in single.items() if effect in names]


def expected_by(
    arm: Arm, log: MotionLog, wanted: Sequence[Place] = ()
) -> tuple[Motion, Patterns, tuple[Expected, ...]]:
    """How far a log tells names (none: all), before any diagnosis of it, with its motion and what was compared.

    The noise is what its torques hold above the low-pass, and no less than filters leave. Raises `InputError`
    where no stretch of it is longer than a second.
    """
    prepared = prepare(arm, log, rules=RULES)
    every = max(1, round(prepared.rate / RATE))
    motion = prepared.piece(slice(prepared.stretches[0].start, prepared.stretches[-1].stop, every))
    heard, torque = prepared.noise(), np.sqrt((prepared.measured**2).mean(axis=0))
    sigma = np.maximum(np.where(np.isfinite(heard), heard, _NOISE * torque), RULES.motion.filters * torque)
    patterns = Patterns.of(arm, wanted, motion, np.maximum(sigma, 1e-6))
    return motion, patterns, patterns.expected(patterns.gram(motion))
