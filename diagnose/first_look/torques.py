"""What a log's torques say of transformations: what each leaves of them beside bodies of any weight.

The inverse dynamics are linear in the links' bodies, which are the file's by any factor with point masses of no
negative weight about their ends, so that some body has them all; beside them stand friction, which takes power and
gives none, a spring, inertia of the joint's own and a constant. The file's masses are a prior, and no truth. Which
torques count the other way follows of itself under each transformation, joint by joint.

(C. L. Lawson & R. J. Hanson, Solving Least Squares Problems, SIAM 1995, ch. 23, for weights that are not negative.)
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
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
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .library import Library
from .search import Judged
from .smoothing import smoothed
from .transformation import Transformation, composed

_BEST, _SAMPLES = 10, 100
"""Sets beside which one more transformation is tried, and samples of a log by which they are judged."""
_ROUNDS, _AT_ONCE = 5, 32
"""Fits of the bodies, at most, until the torques' signs stay; transformations whose dynamics are computed at once, in
some 60 MB of an arm of twelve joints."""

_LEAST = 1e-4
"""Of a current, what bodies make of it at least where its constant is not known."""


@dataclass(frozen=True)
class TorqueEvidence:
    """Samples of a log (M, n) as `smoothed` has them, and which joints (k,) tell. The links' bodies are mixtures (g,)
    of `bodies` (n, 10, g / n), by the file `expected`, give or take 1; `free`: torque constants are not known."""

    library: Library
    q: Array
    velocity: Array
    acceleration: Array
    direction: Array
    torque: Array
    payload: Array | None
    free: bool
    joints: NDArray[np.int64]
    bodies: Array
    expected: Array
    rigid: Array
    rules: Rules

    @staticmethod
    def of(log: MotionLog, library: Library, rules: Rules) -> TorqueEvidence | None:
        """Samples evenly spread over a log; None where the rigid arm's torques are not known, or are nothing."""
        smooth, sound = smoothed(log, rules.log)
        picked = sound[np.unique(np.linspace(0, len(sound) - 1, _SAMPLES).astype(int))]
        payload = None if log.payload_mass is None else log.payload_mass[picked]
        logged = np.isfinite(log.torque).any(axis=0)
        joints = np.flatnonzero(logged & (np.ptp(np.nan_to_num(log.torque), axis=0) > 0.0)).astype(np.int64)
        q, v, a, direction, torque = (each[picked] for each in smooth)
        try:
            rigid = inverse_dynamics(Motion(library.arm, np.zeros(len(q)), q, v, a, payload_mass=payload))
            mixtures = _mixtures(library.arm, rules)
        except (MissingProperty, InputError):
            return None
        if not len(joints) or float(np.ptp(rigid, axis=0).max()) <= 0.0:
            return None
        free = log.torque_constants_free
        return TorqueEvidence(library, q, v, a, direction, torque, payload, free, joints, *mixtures, rigid, rules)

    def given(self) -> Judged:
        """The log as it stands."""
        return self._fits([()], turned=False)[0]

    def of_bodies(self) -> Array:
        """How much bodies make of each torque's variance, with either sign (n,), nan of those that tell nothing."""
        rows = next(self._rows([self.library.none], None))
        mixture, gains = self._fitted(self.torque, rows, np.ones(self.library.arm.size, dtype=bool))
        shares = np.full(self.library.arm.size, np.nan)
        made, logged = (np.var(each, axis=0) for each in (rows.fixed + rows.mixed @ mixture, self.torque * gains))
        shares[self.joints] = (made / logged)[self.joints]
        return shares

    def judged(self, several: Sequence[tuple[Transformation, ...]]) -> list[Judged]:
        """Each of several sets, with the torques that then count the other way."""
        return self._fits(several, turned=True)

    def sized(self, parts: tuple[Transformation, ...]) -> list[tuple[Transformation, ...]]:
        """None: of torques every factor is fitted beside."""
        del parts
        return []

    def beam(self, depth: int, *, explained: bool, gained: bool) -> int:
        """A few, as long as one more gains."""
        del depth, explained
        return _BEST if gained else 0

    def _fits(self, several: Sequence[tuple[Transformation, ...]], *, turned: bool) -> list[Judged]:
        none, judged = self.library.none, dict[int, Judged]()
        made = [composed(parts, none) for parts in several]
        for gravity in dict.fromkeys(each.gravity for each in made):
            here = [number for number, each in enumerate(made) if each.gravity == gravity]
            for some in (here[k : k + _AT_ONCE] for k in range(0, len(here), _AT_ONCE)):
                rows = self._rows([made[number] for number in some], gravity)
                for number, of in zip(some, rows, strict=True):
                    judged[number] = self._fit(several[number], made[number], of, turned=turned)
        return [judged[number] for number in range(len(made))]

    def _rows(self, transformations: Sequence[Transformation], gravity: FloatVector | None) -> Iterator[_Rows]:
        """How torques go with bodies under each of several transformations with one gravity."""
        arm, count = self.library.arm, len(transformations)
        if gravity is not None:
            x, y, z = (math.hypot(*arm.gravity) * each for each in gravity)
            arm = replace(arm, gravity=(x, y, z))
        q = np.concatenate([self.q @ each.matrix.T + each.offset for each in transformations])
        v, a = (
            np.concatenate([of @ each.matrix.T for each in transformations])
            for of in (self.velocity, self.acceleration)
        )
        direction = np.concatenate([self.direction @ np.sign(each.matrix).T for each in transformations])
        payload = None if self.payload is None else np.tile(self.payload, count)
        by = regressor(arm, q, v, a)
        mixed = np.concatenate([by[:, :, 10 * k : 10 * k + 10] @ of for k, of in enumerate(self.bodies)], axis=2)
        fixed = inverse_dynamics(Motion(arm, np.zeros(len(q)), q, v, a, payload_mass=payload)) - mixed @ self.expected
        of_joint = np.stack([np.ones_like(v), -np.ones_like(v), q, -q, direction, v, a], axis=2)
        parts = (np.split(of, count) for of in (mixed, fixed, of_joint))
        for mixed_here, fixed_here, of_joint_here in zip(*parts, strict=True):
            yield _Rows(mixed_here, fixed_here, of_joint_here, self.joints)

    def _fit(
        self, parts: tuple[Transformation, ...], transformation: Transformation, rows: _Rows, *, turned: bool
    ) -> Judged:
        torque = self.torque @ transformation.torques.T
        may = np.full(self.library.arm.size, turned) & (transformation.torques >= 0.0).all(axis=1)
        mixture, gains = self._fitted(torque, rows, may)
        rules = self.rules.log
        shares = rows.left(torque * gains, mixture) / (_variance(torque) * gains**2)[self.joints]
        whole = list(parts)
        for k in self.joints[gains[self.joints] < 0.0].tolist():
            coordinate, force, both = self.library.turns[k]
            if coordinate in whole:
                whole[whole.index(coordinate)] = both
            else:
                whole.append(force)
        unlike = float(np.sum((mixture - self.expected) ** 2)) / rules.conventions_samples
        logs = np.log(np.maximum(shares / rules.conventions_exact, 1.0))
        total = float(logs.sum()) + unlike + rules.conventions_gain * len(whole)
        largest = float(shares.max())
        return Judged(parts, composed(whole, self.library.none), total, largest, largest < rules.explains)

    def _fitted(self, torque: Array, rows: _Rows, may: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Bodies and the torques' signs in turn, from the file's bodies, until the signs stay."""
        mixture, gains = self.expected, self._gains(torque, rows, self.expected, may)
        for _ in range(_ROUNDS):
            mixture = self._mixture(rows, torque * gains, _variance(torque) * gains**2)
            before, gains = gains, self._gains(torque, rows, mixture, may)
            if np.allclose(gains, before, rtol=0.1):
                break
        return mixture, gains

    def _mixture(self, rows: _Rows, torque: Array, variance: Array) -> Array:
        """The likeliest mixture (g,), none of it negative, by torques (M, n) of a variance (n,)."""
        m, _, g = rows.mixed.shape
        of = rows.of_joint.shape[2]
        scale = np.sqrt(self.rules.log.conventions_samples / (m * self.rules.log.unexplained * variance))
        design = np.zeros((len(self.joints), m, g + of * self.library.arm.size))
        for row, joint in zip(design, self.joints.tolist(), strict=True):
            row[:, :g] = rows.mixed[:, joint] * scale[joint]
            row[:, g + of * joint : g + of * (joint + 1)] = rows.of_joint[:, joint] * scale[joint]
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
        gains = np.ones(len(may))
        there = rows.fixed + rows.mixed @ mixture
        for k in self.joints.tolist():
            sizes, lefts = zip(
                *(self._scaled(sign * torque[:, k], there[:, k], rows.of_joint[:, k]) for sign in (1.0, -1.0)),
                strict=True,
            )
            turned = may[k] and math.log(lefts[0] / lefts[1]) > self.rules.log.conventions_gain
            gains[k] = -sizes[1] if turned else sizes[0]
        return gains

    def _scaled(self, torque: Array, there: Array, of_joint: Array) -> tuple[float, float]:
        """What a joint's torque (M,) is multiplied by so that bodies make it `there`, and what they leave of it beside
        what is of the joint's own (M, c)."""
        if not self.free:
            return 1.0, max(nnls(of_joint, torque - there)[1] ** 2, 1e-300)
        sizes, left = nnls(np.column_stack([there, of_joint]), torque)
        least = _LEAST * float(np.linalg.norm(torque)) / max(float(np.linalg.norm(there)), 1e-300)
        return 1.0 / max(sizes[0], least), max(left**2, 1e-300)


def _variance(torque: Array) -> Array:
    """Of torques (M, n), by column; a little where a drive was not logged."""
    variance = np.var(torque, axis=0)
    return np.asarray(np.maximum(variance, 1e-9 * float(variance.max())))


class _Rows(NamedTuple):
    """How torques go with bodies (M, n, g), what of them is `fixed` (M, n), and what is of each joint's own
    (M, n, c): a constant, a spring, friction and inertia; and which joints tell."""

    mixed: Array
    fixed: Array
    of_joint: Array
    joints: NDArray[np.int64]

    def left(self, torque: Array, mixture: Array) -> Array:
        """What bodies, and at each joint what is its own, leave of torques (M, n): mean squares (k,)."""
        rest = torque - self.fixed - self.mixed @ mixture
        return np.array([nnls(self.of_joint[:, k], rest[:, k])[1] ** 2 / len(rest) for k in self.joints.tolist()])


def _mixtures(arm: Arm, rules: Rules) -> tuple[Array, Array]:
    """Bodies of which each link is mixed (n, 10, c), its own as the file has it and point masses about its ends, each
    as large as it may differ from the file's; and the mixture (n c,) that is the file's."""
    file = link_parameters(arm)
    steps = [np.array(link.direction, dtype=float) * link.length for link in arm.links]
    around = rules.log.conventions_reach * sum(float(np.linalg.norm(each)) for each in steps)
    sides = around * np.vstack([np.eye(3), -np.eye(3)])
    factor, more, any_ = rules.log.conventions_masses
    bodies: list[Array] = []
    for step, link_body in zip(steps, file, strict=True):
        mass = more * link_body[0] + any_ * float(file[:, 0].sum())
        points = [parameters_of(Mass(mass, each, np.zeros((3, 3)))) for each in np.vstack([sides, sides + step])]
        bodies.append(np.column_stack([factor * link_body, *points]))
    return np.stack(bodies), np.tile(np.eye(len(bodies[0].T))[0] / factor, arm.size)
