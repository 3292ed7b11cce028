"""Which visits to choose: those from which the causes asked for can be seen small, and told from their rivals.

A candidate's parameter shows by v = c' (I - P) c, with c its whitened displacements over the readings and P the
projection onto the nuisances and, where it is to be distinguished from a rival, onto that rival too: the non-centrality
of the test of that parameter at the middle of its usual sizes, and the smallest size goes with 1/sqrt(v). The score is
the mean logarithm of those over all parameters asked for, alone, so that each counts by how many times smaller it is
seen, and a share of the mean of log(1 + t/v) over all pairs, where t is what it takes to refuse a wrong name: what is
told anyhow counts no more. So it is a compound Ds-optimal design (A. C. Atkinson, A. N. Donev & R. D. Tobias, Optimum
Experimental Designs, with SAS, Oxford 2007, ch. 10 and 21). Visits are taken greedily by the slope of the score, then
exchanged one at a time (V. V. Fedorov, Theory of Optimal Experiments, Academic Press 1972).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.plan_rules import PlanRules
from linkwright.core.sections.numeric import Array

_CLOSEST = 8
"""Visits whose gain is worked out exactly, of all tried the best by its slope."""
_SETTLED = 0.005
"""A pass whose sizes (logarithm) gain no more is the last."""


@dataclass(frozen=True)
class Patterns:
    """What the score goes by: whitened rows of all visits tried, `rows` (V, m, M), the first `nuisances` columns of
    which are nuisances; `known` (M, M) is what other readings tell already. `rivals` are the columns of each cause,
    `asked` the columns whose sizes are to be seen, `against` (asked, rivals) which rival each is to be distinguished
    from, and `enough` the non-centrality that does."""

    rows: Array
    nuisances: int
    known: Array
    asked: NDArray[np.int64]
    rivals: tuple[slice, ...]
    against: NDArray[np.bool_]
    enough: float


def chosen_visits(
    patterns: Patterns,
    count: int,
    returns: Callable[[int], Sequence[int]],
    rules: PlanRules,
    rng: np.random.Generator,
    tell: Callable[[float], None],
    never: Sequence[int] = (),
    unwanted: Callable[[Sequence[int], Sequence[int]], Sequence[int]] = lambda _, __: (),
) -> tuple[list[int], list[int], bool]:
    """The numbers of `count` visits, and of those to return to: all that `returns` gives for the first, which are
    taken beside; none of `never`, nor what is `unwanted` beside those taken, where others are left. A visit is
    taken once, so that other poses are looked at as well. Once there are `count` an interrupt leaves those that
    stand then; last is said whether one did."""
    score = _Score(patterns, rules)
    work, done = count * (1 + rules.passes), 0
    first = score.best(score.beforehand, never)
    back = list(returns(first))
    total = score.beforehand + score.of(back)
    chosen: list[int] = []
    barred = {*back, *never}

    def without(taken: Sequence[int]) -> set[int]:
        all_ = {*taken, *barred, *unwanted(taken, back)}
        return all_ if len(all_) < len(patterns.rows) else {*taken, *barred}

    for _ in range(count):
        chosen.append(score.best(total, without(chosen)))
        total = total + score.of(chosen[-1:])
        done += 1
        tell(done / work)
    try:
        value = score(total)
        for _ in range(rules.passes):
            before = value
            for place in rng.permutation(count).tolist():
                rest = total - score.of([chosen[place]])
                others = [visit for k, visit in enumerate(chosen) if k != place]
                other = score.best(rest, without(others))
                trial = rest + score.of([other])
                reached = score(trial)
                if reached < value:
                    chosen[place], total, value = other, trial, reached
                done += 1
                tell(done / work)
            if value > before - _SETTLED:
                break
    except KeyboardInterrupt:
        return chosen, back, True
    return chosen, back, False


class _Score:
    """The score of an information matrix (M, M): the less, the smaller are the sizes that it shows."""

    def __init__(self, patterns: Patterns, rules: PlanRules) -> None:
        self.patterns, self.rules = patterns, rules
        rows = patterns.rows
        usual = np.einsum("vmi,vmi->i", rows, rows) / max(len(rows), 1)
        self.beforehand = patterns.known + np.diag(rules.known * np.maximum(usual, 1e-300))

    def of(self, visits: Sequence[int]) -> Array:
        """What some visits tell (M, M)."""
        flat = self.patterns.rows[list(visits)].reshape(-1, self.patterns.rows.shape[2])
        return flat.T @ flat

    def best(self, total: Array, taken: Collection[int]) -> int:
        """The visit that betters a matrix most: of those of the steepest slope, by the score itself."""
        slope = self._slopes(total)
        slope[list(taken)] = -np.inf
        closest = np.argsort(-slope, kind="stable")[:_CLOSEST].tolist()
        closest = [visit for visit in closest if slope[visit] > -np.inf] or closest
        reached = [self(total + self.of([visit])) for visit in closest]
        return int(closest[int(np.argmin(reached))])

    def __call__(self, total: Array) -> float:
        alone, separation, _, _ = self._shown(total)
        against = self.patterns.against
        value = float(np.mean(-0.5 * np.log(alone)))
        return value + (
            self.rules.pairs * float(np.mean(np.log1p(self.patterns.enough / separation[against])))
            if against.any()
            else 0.0
        )

    def _projected(self, total: Array) -> tuple[Array, Array]:
        """A matrix without its nuisances, and the coefficients (b, M - b) by which they are taken off."""
        b = self.patterns.nuisances
        off = np.asarray(np.linalg.solve(total[:b, :b], total[:b, b:]), dtype=np.float64)
        return total[b:, b:] - total[b:, :b] @ off, off

    def _shown(self, total: Array) -> tuple[Array, Array, list[Array], Array]:
        """What shows of each parameter asked for (A,), and beside each rival (A, R), with the coefficients of rivals
        (R of them, (A, d)) and those of the nuisances."""
        patterns = self.patterns
        left, off = self._projected(total)
        asked = patterns.asked
        alone = left[asked, asked]
        separation = np.empty(patterns.against.shape)
        coefficients: list[Array] = []
        for number, rival in enumerate(patterns.rivals):
            mixed = left[asked, rival]
            by = np.asarray(np.linalg.solve(left[rival, rival], mixed.T).T, dtype=np.float64)
            separation[:, number] = alone - np.einsum("ad,ad->a", by, mixed)
            coefficients.append(by)
        least = 1e-9 * alone
        return alone, np.maximum(separation, least[:, None]), coefficients, off

    def _slopes(self, total: Array) -> Array:
        """By how much each visit tried betters the score, to first order (V,)."""
        patterns = self.patterns
        alone, separation, coefficients, off = self._shown(total)
        asked, b = patterns.asked, patterns.nuisances
        size = total.shape[0] - b
        weight = np.zeros((size, size))
        weight[asked, asked] = 0.5 / (alone * len(asked))
        share = self.rules.pairs / max(int(patterns.against.sum()), 1)
        for number, (rival, by) in enumerate(zip(patterns.rivals, coefficients, strict=True)):
            shown = separation[:, number]
            steep = patterns.enough / (shown * (shown + patterns.enough))
            slopes = np.where(patterns.against[:, number], share * steep, 0.0)
            if not slopes.any():
                continue
            # The rows of (1, -coefficients), weighed: what is left of an asked column beside the rival.
            weight[asked, asked] += slopes
            weight[asked, rival] -= slopes[:, None] * by
            weight[rival, asked] -= (slopes[:, None] * by).T
            weight[rival, rival] += by.T @ (slopes[:, None] * by)
        rows = patterns.rows[:, :, b:] - patterns.rows[:, :, :b] @ off
        flat = rows.reshape(-1, size)
        return np.einsum("ij,ij->i", flat @ weight, flat).reshape(rows.shape[:2]).sum(axis=1)
