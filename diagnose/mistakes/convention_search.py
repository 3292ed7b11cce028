"""Mistakes of convention: joints that count the other way, from another zero or together with a neighbour, columns that
changed places, a mirrored frame, rows of dh in the other convention, tips that stand beside other rows' joints.

They throw the tip by much more than any physics of an arm, and each is exact: with the right convention the middle
reading comes back to where small errors leave it. One to three of them are sought together.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.residual.placement import placed
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

from .conventions import Slip, no_slip, single_slips, zero_slip

_POSES = 40
"""At which a search looks, spread evenly over all; all readings confirm what it finds."""
_LATE = 5
"""Rows by which tips may stand beside their joints, at most."""
_DEEP = 3
"""Mistakes that are sought together, at most."""
_LIKELY = 10
"""The most promising mistakes, which all readings confirm or refuse."""
_BEAM = 60
"""Pairs of mistakes upon which a third is tried."""
_ZERO_STEPS = 72
"""Of a turn where a zero is first looked for: every 5 deg."""
_TOGETHER = 400
"""Mistakes that are tried at once, for the memory that they take."""


@dataclass(frozen=True)
class Explained:
    """A mistake that explains a mismatch, and the middle distance that is left, m."""

    slip: Slip
    misfit: float

    def sentence(self) -> str:
        """What seems to be wrong: `q3_deg counts the other way`."""
        return " and ".join(self.slip.said)


@dataclass(frozen=True)
class _Search:
    arm: Arm
    q: Array
    tip: Array
    frame: bool
    tool: bool
    rules: Rules

    def misfit(self, slip: Slip) -> float:
        """The middle distance (m) with a mistake mended; where frame or tool is free, about what they leave at best."""
        q, tip = slip.applied(self.q, self.tip)
        return float(self._misfits(slip.read(self.arm), q[None], tip[None])[0])

    def misfits(self, slips: Sequence[Slip]) -> Array:
        """The same of many mistakes in which no row is late, (H,), m."""
        misfits_ = np.zeros(len(slips))
        for other_dh in (False, True):
            which = [number for number, slip in enumerate(slips) if slip.other_dh == other_dh]
            for first in range(0, len(which), _TOGETHER):
                numbers = which[first : first + _TOGETHER]
                some = [slips[number] for number in numbers]
                q = np.stack([self.q @ slip.matrix.T + slip.offset for slip in some])
                tip = np.stack([self.tip @ slip.axes.T for slip in some])
                misfits_[numbers] = self._misfits(some[0].read(self.arm), q, tip)
        return misfits_

    def _misfits(self, arm: Arm, q: Array, tip: Array) -> Array:
        """For joints (H, R, n) and tips (H, R, D)."""
        many, rows, width = tip.shape
        tips, axes = nominal(arm, q.reshape(many * rows, -1), width)
        tips, axes = tips.reshape(many, rows, width), axes.reshape(many, rows, width, width)
        if not (self.frame or self.tool):
            return np.median(np.linalg.norm(tip - tips, axis=2), axis=1)
        return _affine_misfits(tips, axes, tip, frame=self.frame, tool=self.tool)

    def confirmed(self, slip: Slip) -> float:
        """The middle distance with a mistake mended, m."""
        q, tip = slip.applied(self.q, self.tip)
        return placed(slip.read(self.arm), q, tip, frame=self.frame, tool=self.tool).misfit


def explained_by_convention(
    arm: Arm,
    q: Array,
    tip: Array,
    headers: Mapping[str, str],
    misfit: float,
    *,
    frame: bool,
    tool: bool,
    gross: bool,
    rules: Rules = RULES,
) -> Explained | None:
    """The mistake that explains why the middle reading is `misfit` (m) off, None where none does.

    `q` (N, n), `tip` (N, D) and `headers` as recorded; `frame` and `tool` say what is free. Where the mismatch
    is `gross`, a joint's zero may be off by any angle, and tips may stand beside other rows' joints.
    """
    whole = _Search(arm, q, tip, frame, tool, rules)
    spread = float(np.median(np.linalg.norm(tip - np.median(tip, axis=0), axis=1)))
    limit = min(rules.mistakes.better * misfit, rules.mistakes.whole * spread)
    # Readings taken on the move lag by a row or two as well; what they are off by is small beside the motion.
    if gross and (late := _late_rows(whole, limit)) is not None:
        return late
    poses = np.sort(np.unique(np.round(q, 3), axis=0, return_index=True)[1])
    if len(poses) < rules.search.least_observations:
        return None  # frame, tool and a wrong convention together fit a few points by chance
    picked = poses[np.unique(np.linspace(0, len(poses) - 1, _POSES).astype(int))]
    search = replace(whole, q=q[picked], tip=tip[picked])
    singles = list(single_slips(arm, tip.shape[1], headers, frame=frame))
    explanation = _deepening(search, whole, singles, limit, _DEEP if gross else 1)
    if explanation is None and gross:
        explanation = _any_zero(search, whole, headers, limit)
    return explanation


def _deepening(search: _Search, whole: _Search, singles: list[Slip], limit: float, deep: int) -> Explained | None:
    """The fewest mistakes that explain the mismatch: every one, every two, and a third upon the most promising."""
    beam: list[Slip] = [no_slip(search.arm.size, search.tip.shape[1])]
    for _ in range(deep):
        tried: list[Slip] = []
        known: set[frozenset[int]] = set()
        for kept in beam:
            for number, single in enumerate(singles):
                parts = kept.parts | {number}
                if not kept.acts_on & single.acts_on and parts not in known:
                    known.add(parts)
                    tried.append(replace(kept.beside(single), parts=parts))
        bounds = search.misfits(tried)
        # Of those that do equally well (a wrist turned over, say) the one that is made most goes first.
        order = np.argsort(bounds, kind="stable")
        likely = sorted(int(number) for number in order[:_LIKELY] if bounds[number] < limit)
        left = {number: whole.confirmed(tried[number]) for number in likely}
        least = min(left.values(), default=math.inf)
        if least < limit:
            number = next(number for number in likely if left[number] <= search.rules.mistakes.as_well * least)
            return Explained(tried[number], left[number])
        beam = [tried[number] for number in (order if len(beam) == 1 else order[:_BEAM])]
    return None


def _late_rows(search: _Search, limit: float) -> Explained | None:
    """Tips that stand some rows beside their joints, or in the opposite or any other order."""
    none = no_slip(search.arm.size, search.tip.shape[1])
    for rows in range(1, min(_LATE, len(search.q) // 4) + 1):
        for late in (rows, -rows):
            which = "later" if late > 0 else "earlier"
            count_text = f"{rows} row{'s' if rows > 1 else ''}"
            sentence = f"the tips stand {count_text} {which} than the joints that they belong to"
            slip = replace(none, late=late, said=(sentence,))
            if search.misfit(slip) < limit and (left := search.confirmed(slip)) < limit:
                return Explained(slip, left)
    turned = replace(search, tip=search.tip[::-1])
    backwards = replace(none, said=("the tips stand in the opposite order",))
    if turned.misfit(backwards) < limit and (left := turned.confirmed(backwards)) < limit:
        return Explained(backwards, left)
    if search.frame or search.tool:
        return None
    from scipy.spatial import KDTree

    tips, _ = nominal(search.arm, search.q, search.tip.shape[1])
    nearest = KDTree(tips).query(search.tip)[0]
    left = float(np.median(nearest))
    # By chance the nearest of N tips is about N^(-1/D) of their spread away.
    if left < min(limit, search.rules.mistakes.better * _by_chance(tips)):
        return Explained(replace(none, said=("the tips stand in another order than the joints",)), left)
    return None


def _by_chance(tips: Array) -> float:
    size = float(np.linalg.norm(tips.std(axis=0)))
    return size * len(tips) ** (-1.0 / tips.shape[1])


def _any_zero(search: _Search, whole: _Search, headers: Mapping[str, str], limit: float) -> Explained | None:
    """One joint whose zero stands anywhere."""
    none = no_slip(search.arm.size, search.tip.shape[1])
    best: tuple[float, int, float] | None = None
    for k, joint in enumerate(search.arm.joints):
        if not joint.revolute:
            continue
        name = headers.get(f"q{k + 1}", f"q{k + 1}")

        def left(angle: float, k: int = k, name: str = name) -> float:
            return search.misfit(zero_slip(none, k, float(angle), name))

        step = 2.0 * math.pi / _ZERO_STEPS
        start = min((number * step for number in range(_ZERO_STEPS)), key=left)
        for _ in range(14):  # each pass halves the step: 5 deg down to 0.3 mdeg
            step /= 2.0
            start = min((start - step, start, start + step), key=left)
        if best is None or left(start) < best[0]:
            best = (left(start), k, math.remainder(start, 2.0 * math.pi))
    if best is None or best[0] >= limit:
        return None
    slip = zero_slip(none, best[1], best[2], headers.get(f"q{best[1] + 1}", f"q{best[1] + 1}"))
    misfit = whole.confirmed(slip)
    return Explained(slip, misfit) if misfit < limit else None


def _affine_misfits(tips: Array, axes: Array, measured: Array, *, frame: bool, tool: bool) -> Array:
    """The middle distances that are left where the frame may be turned, stretched and mirrored and the tool be any: no
    more than a rigid frame leaves, and linear. For tips (H, R, D) and axes (H, R, D, D); bad rows are weighed down."""
    many, rows, width = tips.shape
    columns: list[Array] = []
    if frame:
        middle = measured.mean(axis=1, keepdims=True)
        size = np.linalg.norm(measured - middle, axis=2).mean()
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
