"""What measured tips say of transformations: what the middle reading is off by under each, frame and tool as free as
they are."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.diagnose.instruments.placement import placed
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .library import Library
from .search import Judged
from .transformation import Transformation, composed

_POSES = 40
"""At which a search looks, spread evenly over all; all readings confirm what it finds."""
_LIKELY = 10
"""The most promising transformations, which all readings confirm or refuse."""
_ALIKE = 300
"""The same of single ones where the frame is free."""
_BEAM = 60
"""Pairs upon which a third is tried."""
_DEEP = 3
"""Transformations that are sought together, at most."""
_TOGETHER = 400
"""Transformations that are tried at once, for the memory that they take."""
_STEPS, _ZOOM_STEPS, _ZOOMS, _FAMILIES = 49, 9, 5, 5
"""Sizes of which the likeliest is looked for, how many and how often again between its neighbours, and of how many of
the most promising."""
_FINER = 0.2
"""Of a size that counts alone, the one that counts beside a ratio."""
_MOST_RATIO, _MOST_SAG = 3.0, 1.2
"""How far sizes are looked for: times what is told, and rad under the largest load."""
_SETTLES, _ROUNDS = 12, 6
"""Iterations until a joint that gives way stands where its load holds it, and several joints do."""


@dataclass(frozen=True)
class _Family:
    """Transformations of one number from `low` to `high`; `usual` are no transformations, or some of the library's, and
    `unit` is the number's own 1 (rad)."""

    make: Callable[[float], Transformation]
    low: float
    high: float
    usual: tuple[float, ...] = (0.0,)
    unit: float = 1.0

    def steps(self) -> list[float]:
        """Even ones over all."""
        return np.linspace(self.low, self.high, _STEPS).tolist()


@dataclass(frozen=True)
class TipEvidence:
    """Readings of a tip, and what is free.

    Args:
        library: The arm's transformations.
        q: (N, n) coordinates as recorded.
        tip: (N, D) tips as recorded, m.
        frame: Whether the measuring frame is free, and
        tool: the tool.
        reach: The arm's, m.
        limit: What is left of the middle distance, m, where a transformation explains it.
        gross: Whether the recording contradicts the arm as a whole: then several mistakes are sought together.
        rules: What counts.
    """

    library: Library
    q: Array
    tip: Array
    frame: bool
    tool: bool
    reach: float
    limit: float
    gross: bool
    rules: Rules

    @property
    def arm(self) -> Arm:
        """The arm as its file has it."""
        return self.library.arm

    def given(self, misfit: float) -> Judged:
        """The recording as it stands, its middle reading off by so much (m)."""
        return self._judged((), [misfit, *self.left([self.library.none])[0, 1:].tolist()])

    def judged(self, several: Sequence[tuple[Transformation, ...]]) -> list[Judged]:
        """Each of several sets by some readings, and the most promising of them by all."""
        made = [composed(parts, self.library.none) for parts in several]
        left = self._some().left(made)
        results = [self._judged(*each) for each in zip(several, left.tolist(), strict=True)]
        # Of those that do equally well (a wrist turned over, say) the one that is made most goes first.
        # What a free frame leaves at best tells no unit and no handedness from another.
        most = _ALIKE if self.frame and all(len(parts) == 1 for parts in several) else _LIKELY
        likely = np.argsort([each.total for each in results], kind="stable")[:most].tolist()
        for number, each in enumerate(results):
            if each.explains and number not in likely:
                results[number] = replace(each, explains=False, settled=False)
            elif each.explains:
                whole = self.confirmed(made[number])
                results[number] = self._judged(several[number], [whole, *left[number, 1:].tolist()])
        return self._first_of_alike(results)

    def sized(self, parts: tuple[Transformation, ...]) -> list[tuple[Transformation, ...]]:
        """`parts` beside a ratio, a coupling by the joint before, a droop under load or a zero of a joint, of the
        likeliest size; what the library's effects fit is none, but where other ratios are wrong too."""
        beside = composed(parts, self.library.none)
        taken = frozenset[str]().union(*(part.acts_on for part in parts))
        some, rules = self._some(), self.rules.mistakes
        free = [each for each in self._families(_weights(self.arm, some.q)) if not each.make(each.high).acts_on & taken]
        rough = [some.likeliest_size(family, beside, *family.steps()) for family in free]
        made: list[tuple[Transformation, ...]] = []
        ratios = sum(np.any(np.diag(part.matrix) != 1.0) and part.numbers for part in parts)
        least = rules.one_number * (_FINER if ratios else 1.0)
        for number in np.argsort([left for _, left in rough], kind="stable")[:_FAMILIES].tolist():
            family, (value, _) = free[number], rough[number]
            together_ = some._polished((*parts, family.make(value)), family.steps()[1] - family.steps()[0])
            value = together_[-1].size
            if min(abs(value - usual) for usual in family.usual) > least * family.unit:
                made.append(together_)
        return made

    def _polished(self, parts: tuple[Transformation, ...], step: float) -> tuple[Transformation, ...]:
        """The parts with the likeliest sizes, the last's sought within `step`, others' nearby."""
        polished = list(parts)
        step_of = [step if each is parts[-1] else 0.05 * abs(each.size) for each in parts]
        for _ in range(_ZOOMS):
            for number, part in reversed(list(enumerate(polished))):
                if part.resized is None:
                    continue
                beside = composed([each for each in polished if each is not part], self.library.none)
                sizes = np.linspace(part.size - step_of[number], part.size + step_of[number], _ZOOM_STEPS).tolist()
                some = [part.resized(size) for size in sizes]
                left = self.left([each.beside(beside) for each in some])[:, 0]
                polished[number] = some[int(np.argmin(left))]
                step_of[number] /= 0.5 * (_ZOOM_STEPS - 1) if len(parts) == 1 else 2.0
        return tuple(polished)

    def _families(self, weights: Array | None) -> list[_Family]:
        """What one number of each joint may be."""
        library, joints = self.library, self.arm.joints
        families: list[_Family] = []
        for k, joint in enumerate(joints):
            if not joint.driven:
                continue
            families.append(_Family(functools.partial(library.ratio, k), -_MOST_RATIO, _MOST_RATIO, (0.0, 1.0, -1.0)))
            if k and joint.revolute and joints[k - 1].revolute:
                families.append(_Family(functools.partial(library.coupled, k, k - 1), -1.5, 1.5, (0.0, 1.0, -1.0)))
            if joint.revolute and self.gross:
                quarters = (0.0, math.pi / 2.0, -math.pi / 2.0, math.pi, -math.pi)
                families.append(_Family(functools.partial(library.zero, k, fitted=True), -math.pi, math.pi, quarters))
            heaviest = 0.0 if weights is None else float(np.abs(weights[:, k]).max())
            if joint.revolute and joint.stiffness is None and heaviest > 0.0:
                unit = 1.0 / heaviest
                families.append(_Family(functools.partial(library.droop, k), 0.0, _MOST_SAG * unit, (0.0,), unit))
        return families

    def beam(self, depth: int, *, explained: bool, gained: bool) -> int:
        """All of one where nothing explains; a few where something does, which one more may explain better."""
        if depth >= (_DEEP if self.gross else 2) or not (explained or self.gross) or (explained and not gained):
            return 0
        return 3 if explained else (10**6 if depth == 1 else _BEAM)

    def confirmed(self, transformation: Transformation) -> float:
        """The middle distance by all readings, m."""
        q, tip = transformation.applied(self.q, self.tip)
        arm = transformation.read(self.arm)
        return placed(arm, sagged(arm, q, transformation.droop), tip, frame=self.frame, tool=self.tool).misfit

    def _judged(self, parts: tuple[Transformation, ...], left: Sequence[float]) -> Judged:
        """By the middle distance, and how far joints take the tip and the tip goes under the parts, m."""
        whole, rules = composed(parts, self.library.none), self.rules
        misfit, moved, went = left
        # Relative to the motion: in units that are small enough, everything is close to everything. What is free takes
        # a point to anywhere: a unit that shrinks the data to one explains nothing.
        near = rules.mistakes.whole * max(moved, 1e-3 * self.reach)
        near = min(near, rules.mistakes.whole * went)
        shrunk = 1.0 if self.frame else min(1.0, went / max(float(_spread(self.tip)), 1e-300))
        share = misfit / max(shrunk, 1e-300) / (rules.mistakes.exact * self.reach)
        cost = rules.log.conventions_gain * (len(parts) + 0.5 * whole.numbers)
        total = 2.0 * math.log(max(share, 1.0)) + cost
        explains = misfit < min(self.limit, near)
        settled = explains and misfit < rules.mistakes.noticed * self.reach
        return Judged(parts, whole, total, misfit, explains, settled)

    def _first_of_alike(self, results: list[Judged]) -> list[Judged]:
        """Of those that leave as little as the least, the first made is the likeliest."""
        good = [each for each in results if each.explains]
        if not good:
            return results
        least = min(each.total for each in good)
        first = next(each for each in good if each.total < least + 2.0 * math.log(self.rules.mistakes.as_well))
        return [replace(each, total=least - 1e-9) if each is first else each for each in results]

    def _some(self) -> TipEvidence:
        poses = np.sort(np.unique(np.round(self.q, 3), axis=0, return_index=True)[1])
        picked = poses[np.unique(np.linspace(0, len(poses) - 1, _POSES).astype(int))]
        return replace(self, q=self.q[picked], tip=self.tip[picked])

    def likeliest_size(self, family: _Family, beside: Transformation, *sizes: float) -> tuple[float, float]:
        """Which of several sizes of a transformation leaves least beside others, and how much, m."""
        left = self.left([family.make(size).beside(beside) for size in sizes])[:, 0]
        return sizes[int(np.argmin(left))], float(left.min())

    def left(self, transformations: Sequence[Transformation]) -> Array:
        """The middle distances of transformations in which no row is late, where frame or tool is free about what they
        leave at best, and how far the joints take the tip and the tip goes, (H, 3), m."""
        results = np.zeros((len(transformations), 3))
        for other_dh in (False, True):
            which = [number for number, each in enumerate(transformations) if each.other_dh == other_dh]
            for first in range(0, len(which), _TOGETHER):
                numbers = which[first : first + _TOGETHER]
                some = [transformations[number] for number in numbers]
                arm = some[0].read(self.arm)
                q = np.stack([self.q @ each.matrix.T + each.offset for each in some])
                tip = np.stack([self.tip @ each.tip.T for each in some])
                droops = np.repeat(np.stack([each.droop for each in some]), len(self.q), axis=0)
                tips, axes = nominal(arm, sagged(arm, q.reshape(-1, q.shape[2]), droops), tip.shape[2])
                tips, axes = tips.reshape(tip.shape), axes.reshape(*tip.shape, tip.shape[2])
                if self.frame or self.tool:
                    misfits = _affine_misfits(tips, axes, tip, frame=self.frame, tool=self.tool)
                else:
                    misfits = np.median(np.linalg.norm(tip - tips, axis=2), axis=1)
                results[numbers] = np.stack([misfits, _spread(tips), _spread(tip)], axis=1)
        return results


def _weights(arm: Arm, q: Array) -> Array | None:
    """Torques (N, n) that hold the arm at rest; None where its weights are not known."""
    still = np.zeros_like(q)
    try:
        return np.asarray(inverse_dynamics(Motion(arm, np.zeros(len(q)), q, still, still)))
    except (MissingProperty, InputError):
        return None


def sagged(arm: Arm, q: Array, droop: Array) -> Array:
    """Where joints stand that give way by `droop` (n,) or (N, n) under what holds the arm there.

    What holds a joint that turns goes with the sine and the cosine of its coordinate, the others at rest.
    """
    by_joint = np.broadcast_to(droop, q.shape)
    settled = q.copy()
    for _ in range(_ROUNDS if np.count_nonzero(np.any(by_joint, axis=0)) > 1 else 1):
        for k in np.flatnonzero(np.any(by_joint != 0.0, axis=0)).tolist():
            rows = by_joint[:, k] != 0.0
            others = settled[rows]
            others[:, k] = 0.0
            poses, which = np.unique(others, axis=0, return_inverse=True)
            turned = [poses + angle * np.eye(q.shape[1])[k] for angle in (0.0, math.pi / 2.0, math.pi)]
            weights = _weights(arm, np.concatenate(turned))
            if weights is None:
                return q
            front, up, back = (each[which.ravel()] for each in np.split(weights[:, k], 3))
            middle, cosine = 0.5 * (front + back), 0.5 * (front - back)
            sine, stated, by = up - middle, q[rows, k], by_joint[rows, k]
            at = stated
            for _ in range(_SETTLES):
                c, s = np.cos(at), np.sin(at)
                slope = 1.0 + by * (sine * c - cosine * s)
                at = at - (at + by * (middle + cosine * c + sine * s) - stated) / np.maximum(slope, 0.2)
            settled[rows, k] = at
    return settled


def _spread(points: Array) -> Array:
    """The middle distance (...) of points (..., R, D) from their middle, m."""
    return np.median(np.linalg.norm(points - np.median(points, axis=-2, keepdims=True), axis=-1), axis=-1)


def _affine_misfits(tips: Array, axes: Array, measured: Array, *, frame: bool, tool: bool) -> Array:
    """The middle distances that are left where the frame may be turned, stretched and mirrored and the tool be any: no
    more than a rigid frame leaves, and linear. For tips (H, R, D) and axes (H, R, D, D); bad rows are weighed down."""
    many, rows, width = tips.shape
    columns: list[Array] = []
    if frame:
        middle = measured.mean(axis=1, keepdims=True)
        size = np.maximum(np.linalg.norm(measured - middle, axis=2).mean(axis=1), 1e-300)[:, None, None]
        extended = np.concatenate([(measured - middle) / size, np.ones((many, rows, 1))], axis=2)
        spread = np.zeros((many, rows, width, width * (width + 1)))
        for axis in range(width):
            spread[:, :, axis, axis * (width + 1) : (axis + 1) * (width + 1)] = extended
        columns.append(spread)
    if tool:
        columns.append(-axes)
    goal = tips if frame else tips - measured
    matrix = np.concatenate(columns, axis=3)
    weight = np.ones((many, rows))
    distance = np.zeros((many, rows))
    tiny = 1e-9 * np.eye(matrix.shape[3])
    for _ in range(3):
        weighed = (matrix * weight[:, :, None, None]).reshape(many, rows * width, -1)
        target = (goal * weight[:, :, None]).reshape(many, rows * width, 1)
        turned = weighed.transpose(0, 2, 1)
        values = np.linalg.solve(turned @ weighed + tiny, turned @ target)
        distance = np.linalg.norm(goal - (matrix @ values[:, None])[..., 0], axis=2)
        center = np.median(distance, axis=1, keepdims=True)
        weight = np.minimum(1.0, 2.0 * center / np.maximum(distance, 1e-300))
    return np.median(distance, axis=1)
