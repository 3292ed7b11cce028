"""Mistakes of convention in a motion log: joints that count the other way, from another zero or in another order,
degrees for radians, torques of the motor, of the other sign or another joint, gravity from another side.

One list of transformations, each judged by what it leaves of the torques once bodies of any weight explain what they
can: the inverse dynamics are linear in the links' bodies, which are the file's by any factor with point masses of no
negative weight about their ends, so that some body has them all; beside them stand friction, which takes power and
gives none, a spring, inertia of the joint's own and a constant. The file's masses are a prior, and no truth. Which
torques count the other way follows of itself under each transformation, joint by joint. A log is refused with the
settings that would put it right where they leave plainly less; what dynamics cannot tell apart is told beside it.

(C. L. Lawson & R. J. Hanson, Solving Least Squares Problems, SIAM 1995, ch. 23, for weights that are not negative.)
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import nnls

from linkwright.core.arm.bodies.bodies import Mass
from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics, link_parameters, parameters_of, regressor
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.reading.columns import formulas
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import refusal

from .smoothing import moving_average, smoothed

_QUARTER = math.pi / 2.0
_DEGREE = math.degrees(1.0)
_ANY_SIDE: tuple[FloatVector, ...] = tuple(
    tuple(sign * float(axis == k) for axis in range(3)) for k in (2, 1, 0) for sign in (-1.0, 1.0)
)  # pyright: ignore[reportAssignmentType]
_FINER = MappingProxyType({"ms": 1e3, "us": 1e6, "ns": 1e9})
_NAMED = ("x", "y", "z")
_BASES = ("q", "v", "tau", "current")
_TOLD = 2
"""Conventions that explain a log alike, of which so many are told."""
_BEST, _SAMPLES = 10, 100
"""Mistakes beside which one more is tried, and samples of a log by which they are judged."""
_ROUNDS, _AT_ONCE = 5, 32
"""Fits of the bodies, at most, until the torques' signs stay; mistakes whose dynamics are computed at once, in some
60 MB of an arm of twelve joints."""


@dataclass(frozen=True, eq=False)
class Mistake:
    """A mistake: coordinates are meant as `matrix` q + `offset`, torques as `torques` tau, gravity along `gravity`
    (None: as the arm has it). `said` tells what is wrong, `acts_on` what it changes: no two of the same are tried."""

    matrix: Array
    offset: Array
    torques: Array
    said: tuple[str, ...]
    gravity: FloatVector | None = None
    acts_on: frozenset[str] = frozenset()

    @property
    def often(self) -> bool:
        """Whether it is one of a joint's own sign or zero, which are made several at once."""
        return len(self.acts_on) == 1 and self.gravity is None

    def columns(self, arm: Arm, names: Mapping[str, str]) -> dict[str, str]:
        """The formulas that mend it, by header; `names` has the headers of what was logged."""
        columns: dict[str, str] = {}
        for base in _BASES:
            headers = [names[f"{base}{k + 1}"] for k in range(arm.size)]
            moves = base in ("q", "v")
            matrix, offset = self.matrix if moves else self.torques, self.offset if base == "q" else None
            columns |= formulas(headers, arm, matrix, offset)
        return columns

    def beside(self, other: Mistake) -> Mistake:
        """Both mistakes, which act on different things."""
        return Mistake(
            other.matrix @ self.matrix,
            self.offset + other.offset,
            other.torques @ self.torques,
            (*self.said, *other.said),
            self.gravity or other.gravity,
            self.acts_on | other.acts_on,
        )


def check_conventions(log: MotionLog, arm: Arm, headers: Mapping[str, str], rules: Rules) -> MotionLog:
    """Refuse a log whose torques are those of this arm under another convention.

    What no convention mends and is no torque of this arm for all that is said.

    Args:
        log: The log, its samples checked.
        arm: The arm; where a link's mass is not known, or nothing weighs, nothing can be told.
        headers: The header of each column by name (`q1`: `q1_rad`).
        rules: What counts as plainly wrong.

    Raises:
        InputError: A convention is plainly another, with what to write.
    """
    _refuse_speeds(log, headers, rules)
    _refuse_coordinates(log, arm, headers, rules)
    return _refuse_weights(log, arm, headers, rules)


def _refuse_weights(log: MotionLog, arm: Arm, headers: Mapping[str, str], rules: Rules) -> MotionLog:
    """Refuse torques that go against the arm's weights, and with them under another convention."""
    names = {f"{base}{k + 1}": headers.get(f"{base}{k + 1}", "") for base in _BASES for k in range(arm.size)}
    trial = _Trial.of(log, arm, names, rules)
    if trial is None:
        return log
    _refuse_motor_torques(trial, log, arm, names, rules)
    (given,) = trial.fits([()], turned=False)
    log = _of_little_torque(trial, log, names, rules)
    if given.total < rules.log.conventions_gain:
        return log
    tried = _tried(trial, list(_mistakes(arm, names, log)), given)
    best = [each for each in tried if each.total < given.total and (each.shares < rules.log.explains).all()]
    if not best:
        return log
    alike = [each.mistake for each in best if each.total - best[0].total < 2.0 * math.log(rules.mistakes.as_well)]
    told = sorted(alike, key=lambda each: each.gravity is not None)[:_TOLD]
    said = "; as well it could be that ".join(" and ".join(each.said) for each in told)
    remedies = [{"columns": columns} for each in told if (columns := each.columns(arm, names))]
    raise refusal(log.file, "", f"goes against the arm's weights: {said}", *remedies)


@dataclass(frozen=True, eq=False)
class _Tried:
    """Mistakes together, the shares (k,) of each torque's variance that bodies leave under them, and the sum of the
    logs of those beyond what no model explains, with what bodies unlike the file's and mistakes cost."""

    parts: tuple[Mistake, ...]
    mistake: Mistake
    shares: Array
    total: float


class _Turn(NamedTuple):
    """What counts the other way at a joint: its coordinate, its torque, or both."""

    coordinate: Mistake
    torque: Mistake
    both: Mistake


def _tried(trial: _Trial, singles: Sequence[Mistake], given: _Tried) -> list[_Tried]:
    """Mistakes alone, and more of a joint's own sign or zero with the likeliest as long as they gain; those first that
    leave least."""
    own = [*(each.coordinate for each in trial.turns), *singles]
    often = [each for each in own if each.often]
    results, beam = trial.fits([()]), [given]
    more: Sequence[Mistake] = own
    least = math.inf
    while beam:
        made = {
            tuple(sorted((*one.parts, each), key=own.index)) for one in beam for each in more if each not in one.parts
        }
        judged = sorted(trial.fits(parts for parts in made if _apart(parts)), key=lambda each: each.total)
        results += judged
        beam, more = judged[:_BEST] if judged and judged[0].total < least else [], often
        least = min((result.total for result in results), default=math.inf)
    return sorted(results, key=lambda result: result.total)


def _apart(parts: Sequence[Mistake]) -> bool:
    """Whether mistakes act on different things."""
    return sum(len(part.acts_on) for part in parts) == len(frozenset().union(*(part.acts_on for part in parts)))


@dataclass(frozen=True)
class _Trial:
    """Samples of a log (M, n) as `smoothed` has them; which joints (k,) tell, and what may count the other way at each.
    The links' bodies are mixtures (g,) of `bodies` (n, 10, g / n), by the file `expected`, give
    or take 1."""

    arm: Arm
    q: Array
    velocity: Array
    acceleration: Array
    direction: Array
    torque: Array
    payload: Array | None
    free: bool
    joints: NDArray[np.int64]
    turns: Sequence[_Turn]
    bodies: Array
    expected: Array
    rigid: Array
    rules: Rules

    @staticmethod
    def of(log: MotionLog, arm: Arm, names: Mapping[str, str], rules: Rules) -> _Trial | None:
        """Samples evenly spread over a log; None where the rigid arm's torques are not known, or are nothing."""
        smooth, sound = smoothed(log, rules.log)
        picked = sound[np.unique(np.linspace(0, len(sound) - 1, _SAMPLES).astype(int))]
        payload = None if log.payload_mass is None else log.payload_mass[picked]
        told = np.isfinite(log.torque).all(axis=0) & (np.ptp(log.torque, axis=0) > 0.0)
        joints = np.flatnonzero(told).astype(np.int64)
        q, v, a, direction, torque = (each[picked] for each in smooth)
        try:
            rigid = inverse_dynamics(Motion(arm, np.zeros(len(q)), q, v, a, payload_mass=payload))
            mixtures = _mixtures(arm, rules)
        except (MissingProperty, InputError):
            return None
        if not len(joints) or float(np.ptp(rigid, axis=0).max()) <= 0.0:
            return None
        free, turns = log.torque_constants_free, _turns(arm, names, log)
        return _Trial(arm, q, v, a, direction, torque, payload, free, joints, turns, *mixtures, rigid, rules)

    def fits(self, several: Iterable[tuple[Mistake, ...]], *, turned: bool = True) -> list[_Tried]:
        """Each of several sets of mistakes, with the torques that then count the other way (none unless `turned`)."""
        made = [(parts, _together(parts, self.arm.size)) for parts in several]
        judged: list[_Tried] = []
        for gravity in dict.fromkeys(mistake.gravity for _, mistake in made):
            here = [each for each in made if each[1].gravity == gravity]
            for some in (here[k : k + _AT_ONCE] for k in range(0, len(here), _AT_ONCE)):
                rows = self._rows([mistake for _, mistake in some], gravity)
                judged += [
                    self._fit(parts, mistake, of, turned=turned)
                    for (parts, mistake), of in zip(some, rows, strict=True)
                ]
        return judged

    def _rows(self, mistakes: Sequence[Mistake], gravity: FloatVector | None) -> Iterator[_Rows]:
        """How torques go with bodies under each of several mistakes with one gravity."""
        arm, count = self.arm, len(mistakes)
        if gravity is not None:
            x, y, z = (math.hypot(*arm.gravity) * each for each in gravity)
            arm = replace(arm, gravity=(x, y, z))
        q = np.concatenate([self.q @ each.matrix.T + each.offset for each in mistakes])
        v, a = (np.concatenate([of @ each.matrix.T for each in mistakes]) for of in (self.velocity, self.acceleration))
        direction = np.concatenate([self.direction @ np.sign(each.matrix).T for each in mistakes])
        payload = None if self.payload is None else np.tile(self.payload, count)
        by = regressor(arm, q, v, a)
        mixed = np.concatenate([by[:, :, 10 * k : 10 * k + 10] @ of for k, of in enumerate(self.bodies)], axis=2)
        fixed = inverse_dynamics(Motion(arm, np.zeros(len(q)), q, v, a, payload_mass=payload)) - mixed @ self.expected
        own = np.stack([np.ones_like(v), -np.ones_like(v), q, -q, direction, v, a], axis=2)
        parts = (np.split(of, count) for of in (mixed, fixed, own))
        for mixed_here, fixed_here, own_here in zip(*parts, strict=True):
            yield _Rows(mixed_here, fixed_here, own_here, self.joints)

    def _fit(self, parts: tuple[Mistake, ...], mistake: Mistake, rows: _Rows, *, turned: bool) -> _Tried:
        """Bodies and the torques' signs in turn, from the file's bodies, until the signs stay."""
        torque = self.torque @ mistake.torques.T
        variance = np.var(torque, axis=0)
        variance = np.maximum(variance, 1e-9 * float(variance.max()))  # of a drive that was not logged
        may = np.array([turned and f"tau{k}" not in mistake.acts_on for k in range(self.arm.size)])
        mixture, gains = self.expected, self._gains(torque, rows, self.expected, may)
        for _ in range(_ROUNDS):
            mixture = self._mixture(rows, torque * gains, variance * gains**2)
            before, gains = gains, self._gains(torque, rows, mixture, may)
            if np.allclose(gains, before, rtol=0.1):
                break
        rules = self.rules
        shares = rows.left(torque * gains, mixture) / (variance * gains**2)[self.joints]
        whole = list(parts)
        for k in self.joints[gains[self.joints] < 0.0].tolist():
            turn = self.turns[k]
            if turn.coordinate in whole:
                whole[whole.index(turn.coordinate)] = turn.both
            else:
                whole.append(turn.torque)
        unlike = float(np.sum((mixture - self.expected) ** 2)) / rules.log.conventions_samples
        logs = np.log(np.maximum(shares / rules.log.unexplained, 1.0))
        total = float(logs.sum()) + unlike + rules.log.conventions_gain * len(whole)
        return _Tried(parts, _together(whole, self.arm.size), shares, total)

    def _mixture(self, rows: _Rows, torque: Array, variance: Array) -> Array:
        """The likeliest mixture (g,), none of it negative, by torques (M, n) of a variance (n,)."""
        m, _, g = rows.mixed.shape
        of = rows.own.shape[2]
        scale = np.sqrt(self.rules.log.conventions_samples / (m * self.rules.log.unexplained * variance))
        design = np.zeros((len(self.joints), m, g + of * self.arm.size))
        for row, joint in zip(design, self.joints.tolist(), strict=True):
            row[:, :g] = rows.mixed[:, joint] * scale[joint]
            row[:, g + of * joint : g + of * (joint + 1)] = rows.own[:, joint] * scale[joint]
        design = design.reshape(-1, design.shape[2])
        gram, right = design.T @ design, design.T @ ((torque - rows.fixed) * scale)[:, self.joints].T.ravel()
        gram[np.arange(g), np.arange(g)] += 1.0
        right[:g] += self.expected
        size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        factor = np.linalg.cholesky(gram / np.outer(size, size) + 1e-8 * np.eye(len(gram))).T
        weights, _ = nnls(factor, solve_triangular(factor, right / size, trans=1), maxiter=100 * len(gram))
        return np.asarray(weights / size)[:g]

    def _gains(self, torque: Array, rows: _Rows, mixture: Array, may: NDArray[np.bool_]) -> Array:
        """What each torque as logged is multiplied by (n,): less than 0 where it counts the other way and `may`; of
        drives whose constants are not known the size too."""
        size = np.ones(len(may))
        if self.free:
            logged, there = (each - each.mean(axis=0) for each in (torque, rows.fixed + rows.mixed @ mixture))
            size = np.abs(np.sum(logged * there, axis=0)) / np.maximum(np.sum(logged**2, axis=0), 1e-300)
            size = np.where(size > 0.0, size, 1.0)
        forth, back = (np.maximum(rows.left(each, mixture), 1e-300) for each in (torque * size, -torque * size))
        turned = np.zeros(len(may), dtype=np.bool_)
        turned[self.joints] = np.log(forth / back) > self.rules.log.conventions_gain
        return np.where(turned & may, -size, size)


class _Rows(NamedTuple):
    """How torques go with bodies (M, n, g), what of them is `fixed` (M, n), and what is of each joint's own
    (M, n, c): a constant, a spring, friction and inertia; and which joints tell."""

    mixed: Array
    fixed: Array
    own: Array
    joints: NDArray[np.int64]

    def left(self, torque: Array, mixture: Array) -> Array:
        """What bodies, and at each joint what is its own, leave of torques (M, n): mean squares (k,)."""
        rest = torque - self.fixed - self.mixed @ mixture
        return np.array([nnls(self.own[:, k], rest[:, k])[1] ** 2 / len(rest) for k in self.joints.tolist()])


def _mixtures(arm: Arm, rules: Rules) -> tuple[Array, Array]:
    """Bodies of which each link is mixed (n, 10, c), its own as the file has it and point masses about its ends, each
    as large as it may differ from the file's; and the mixture (n c,) that is the file's."""
    file = link_parameters(arm)
    steps = [np.array(link.direction, dtype=float) * link.length for link in arm.links]
    around = rules.log.conventions_reach * sum(float(np.linalg.norm(each)) for each in steps)
    sides = around * np.vstack([np.eye(3), -np.eye(3)])
    factor, more, any_ = rules.log.conventions_masses
    bodies: list[Array] = []
    for step, own in zip(steps, file, strict=True):
        mass = more * own[0] + any_ * float(file[:, 0].sum())
        points = [parameters_of(Mass(mass, each, np.zeros((3, 3)))) for each in np.vstack([sides, sides + step])]
        bodies.append(np.column_stack([factor * own, *points]))
    return np.stack(bodies), np.tile(np.eye(len(bodies[0].T))[0] / factor, arm.size)


def _together(parts: Sequence[Mistake], size: int) -> Mistake:
    return functools.reduce(Mistake.beside, parts, _none(size))


def _none(size: int) -> Mistake:
    return Mistake(np.eye(size), np.zeros(size), np.eye(size), ())


def _mistakes(arm: Arm, names: Mapping[str, str], log: MotionLog) -> Iterator[Mistake]:
    """Every single mistake but signs of single joints, those that are made most first."""
    size = arm.size
    none = _none(size)
    base = "current" if log.from_current else "tau"
    everywhere = tuple(range(size))
    if size > 1:
        yield from _turned(everywhere, names, base, none)
    for k, joint in enumerate(arm.joints):
        for angle in (_QUARTER, -_QUARTER, 2.0 * _QUARTER) if joint.revolute and names[f"q{k + 1}"] else ():
            yield _zero(none, k, angle, names[f"q{k + 1}"])
    for one, other in itertools.combinations(everywhere, 2):
        if arm.joints[one].revolute == arm.joints[other].revolute:
            yield from _swapped(none, one, other, names, base)
    if size > 2:
        reverse = np.eye(size)[::-1]
        said = ("the joints stand in the opposite order",)
        acts = frozenset(f"{item}{k}" for k in everywhere for item in ("q", "tau"))
        yield replace(none, matrix=reverse, torques=reverse, said=said, acts_on=acts)
    turning = np.array([joint.revolute for joint in arm.joints])
    if turning.any():
        for factor, unit in ((1.0 / _DEGREE, "deg"), (_DEGREE, "rad")):
            scale = np.diag(np.where(turning, factor, 1.0))
            names_here = [names[f"q{k + 1}"] for k in np.flatnonzero(turning).tolist()]
            said = (f"{', '.join(names_here)} seem to be in {unit}",)
            acts = frozenset(f"q{k}" for k in everywhere)
            yield replace(none, matrix=scale, said=said, acts_on=acts)
    if any(arm.gravity):
        size_of = math.hypot(*arm.gravity)
        for side in _ANY_SIDE:
            if math.dist(side, [item / size_of for item in arm.gravity]) > 0.5:
                axis = next(k for k, item in enumerate(side) if item)
                vector = ", ".join(f"{size_of * item:.4g} m/s^2" if item else "0 m/s^2" for item in side)
                said = f"gravity acts along {'-' if side[axis] < 0.0 else ''}{_NAMED[axis]} of the base frame (write "
                said += f"`gravity: [{vector}]` in the arm file)"
                yield replace(none, gravity=side, said=(said,), acts_on=frozenset({"gravity"}))


def _turns(arm: Arm, names: Mapping[str, str], log: MotionLog) -> list[_Turn]:
    """What can count the other way at each joint."""
    base = "current" if log.from_current else "tau"
    return [_turned((k,), names, base, _none(arm.size)) for k in range(arm.size)]


def _turned(joints: Sequence[int], names: Mapping[str, str], base: str, none: Mistake) -> _Turn:
    """Joints that count the other way, all of them or one."""
    flip = np.diag([-1.0 if k in joints else 1.0 for k in range(len(none.offset))])
    whole = len(joints) > 1

    def made(bases: Sequence[str], said: str, acts: Sequence[str]) -> Mistake:
        moves, pushes = (flip if kind in bases else np.eye(len(flip)) for kind in ("q", base))
        # All of them are told as what they are, and not joint by joint.
        on = frozenset(f"{item}{k}" for k in joints for item in (("q", "tau") if whole else acts))
        return replace(none, matrix=moves, torques=pushes, said=(said,), acts_on=on)

    what = "all joints count" if whole else f"{names[f'q{joints[0] + 1}']} counts"
    force = "all torques count" if whole else f"{names[f'{base}{joints[0] + 1}']} counts"
    return _Turn(
        made(("q", "v"), f"{what} the other way", ("q",)),
        made((base,), f"{force} the other way", ("tau",)),
        made(("q", "v", base), f"{what} the other way, its torque too", ("q", "tau")),
    )


def _zero(none: Mistake, k: int, angle: float, name: str) -> Mistake:
    offset = none.offset.copy()
    offset[k] = angle
    sentence = f"{name} counts from another zero, {math.degrees(angle):.4g} deg away"
    return replace(none, offset=offset, said=(sentence,), acts_on=frozenset({f"q{k}"}))


def _swapped(none: Mistake, one: int, other: int, names: Mapping[str, str], base: str) -> Iterator[Mistake]:
    """Two joints that changed places, with their torques or without, and torques alone."""
    swap = np.eye(len(none.offset))
    swap[[one, other]] = swap[[other, one]]
    acts = frozenset(f"{item}{k}" for k in (one, other) for item in ("q", "tau"))
    unit = np.eye(len(none.offset))
    for matrix, torques, bases in ((swap, swap, ("q", "v", base)), (swap, unit, ("q", "v")), (unit, swap, (base,))):
        pairs = [(names[f"{item}{one + 1}"], names[f"{item}{other + 1}"]) for item in bases]
        pairs = [(a, b) for a, b in pairs if a and b]
        if not pairs or not all(pairs[0]):
            continue  # neither of them was logged
        said = (f"{' and '.join(pairs[0])} have changed places",)
        yield replace(none, matrix=matrix, torques=torques, said=said, acts_on=acts)


def _refuse_motor_torques(trial: _Trial, log: MotionLog, arm: Arm, names: Mapping[str, str], rules: Rules) -> None:
    """Refuse torques that follow the arm's weights, all by a factor that is a gear's, or a unit's."""
    if trial.free:
        return
    rigid = trial.rigid
    factors: dict[int, float] = {}
    spread = np.std(rigid, axis=0)
    for k in trial.joints.tolist():
        if spread[k] < rules.log.heavy * float(spread[trial.joints].max()):
            continue
        y, m = (item - item.mean() for item in (trial.torque[:, k], rigid[:, k]))
        correlation = float(y @ m) / max(math.sqrt(float(y @ y) * float(m @ m)), 1e-300)
        if abs(correlation) > rules.fitting.same_way:
            factors[k] = float(m @ m) / float(y @ m)
    sizes = [abs(factor) for factor in factors.values()]
    if not sizes or (min(sizes) < rules.log.least_gear and max(sizes) * rules.log.least_gear > 1.0):
        return
    if min(sizes) >= rules.log.least_gear:
        # Nobody has gears at some joints alone: what bears too little to tell is taken for alike.
        usual = float(np.median(sizes))
        ratios = [float(f"{abs(factors.get(k, usual)):.3g}") for k in range(arm.size)]
        by = ", ".join(f"{abs(factor):.3g} at joint {k + 1}" for k, factor in factors.items())
        message = f"torques are less than the arm's weights make by factors of {by}: they seem to be of the motors"
        better = "better than these are the gears' own figures, of all joints"
        raise refusal(log.file, "", f"{message}; {better}", {"gear_ratios": ratios})
    message = f"torques are more than the arm's weights make by a factor of {1.0 / max(sizes):.3g}"
    columns = {name: f"{name}/1000" for k in range(arm.size) if (name := names[f"tau{k + 1}"])}
    raise refusal(log.file, "", f"{message}; are they in another unit (N*mm)?", {"columns": columns})


def _of_little_torque(trial: _Trial, log: MotionLog, names: Mapping[str, str], rules: Rules) -> MotionLog:
    """The log, with a sentence on torques that are next to nothing beside what the arm's weights make."""
    logged, made = (np.sqrt(np.mean(np.square(each), axis=0)) for each in (trial.torque, trial.rigid))
    little = [k for k in trial.joints.tolist() if logged[k] * rules.log.least_gear < made[k]]
    if trial.free or not little:
        return log
    base = "current" if log.from_current else "tau"
    each = ", ".join(f"{names[f'{base}{k + 1}']} {logged[k]:.2g} for {made[k]:.2g}" for k in little)
    sentence = (
        f"Torques are next to nothing beside those of the arm file's weights (RMS: {each}): not logged, or currents?"
    )
    return replace(log, warnings=(*log.warnings, sentence))


def _refuse_speeds(log: MotionLog, headers: Mapping[str, str], rules: Rules) -> None:
    """Refuse speeds that are not those of the coordinates: the other way, in another unit."""
    if log.velocity is None:
        return
    interval = float(np.median(np.diff(log.time)))
    width = max(1, round(rules.log.convention_window / interval))
    steps = np.gradient(moving_average(log.q, width), log.time, axis=0)
    speeds = moving_average(log.velocity, width)
    for k in range(log.q.shape[1]):
        size = math.sqrt(float(steps[:, k] @ steps[:, k]) * float(speeds[:, k] @ speeds[:, k]))
        if size <= 0.0 or abs(float(steps[:, k] @ speeds[:, k])) / size < rules.fitting.same_way:
            continue
        factor = float(speeds[:, k] @ steps[:, k]) / float(steps[:, k] @ steps[:, k])
        if rules.log.slowest < factor < 1.0 / rules.log.slowest:
            continue
        speed, place = headers.get(f"v{k + 1}", f"v{k + 1}"), headers.get(f"q{k + 1}", f"q{k + 1}")
        message = f"is {factor:.3g} times what {place} goes by in a second"
        unit = next((unit for unit, by in _FINER.items() if math.isclose(factor, by, rel_tol=0.2)), "")
        if interval > rules.log.convention_window and not unit:
            continue  # poses, from which no speed follows
        if math.isclose(factor, _DEGREE, rel_tol=0.05):
            factor = _DEGREE
        remedies = [{speed: f"{speed}/{factor:.7g}" if factor > 0.0 else f"-{speed}"}]
        if unit:
            message += f", as by a clock that counts {unit}"
            clock = headers.get("time", "time")
            remedies.insert(0, {"t_s": f"{clock}/{_FINER[unit]:.0f}"})
        if math.isclose(abs(factor), 1.0 / _DEGREE, rel_tol=0.2):
            message += ", as of angles in degrees"
            remedies.insert(0, {place: f"{place}/{_DEGREE:.7g}"})
        raise refusal(log.file, speed, message, *({"columns": remedy} for remedy in remedies))


def _refuse_coordinates(log: MotionLog, arm: Arm, headers: Mapping[str, str], rules: Rules) -> None:
    """Refuse coordinates that go through several times what their joints can: of motors, or in another unit. What can
    turn a whole turn may turn on."""
    low, high = np.quantile(log.q, [0.01, 0.99], axis=0)
    for k, joint in enumerate(arm.joints):
        through, whole = float(high[k] - low[k]), joint.range[1] - joint.range[0]
        if through < rules.log.beyond_range * whole or (joint.revolute and whole > math.tau - rules.residual.turned):
            continue
        name, by = headers.get(f"q{k + 1}", f"q{k + 1}"), _DEGREE if joint.revolute else 1e3
        unit = "rad" if joint.revolute else "m"
        message = f"goes through {through:.3g} {unit}, and joint {k + 1} by {arm.name!r} through {whole:.3g} at most: "
        message += f"is it in {'degrees' if joint.revolute else 'mm'} or of the motor? Write `columns: {{{name}: "
        raise InputError(log.file, name, f"{message}{name}/{by:.7g}}}` in recording.yaml, or its gear's ratio there")
