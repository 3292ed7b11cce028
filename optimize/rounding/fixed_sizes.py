"""The best of many designs of fixed sizes, exactly: bounds on a few poses first, the whole workspace for the best few.

A pose of the workspace bounds a design's worst error from below, and shows stresses and loads that break a limit. Every
design is scored on the poses known so far; the one with the best score is searched over its whole workspace; the poses
at which it turns out worse join the others. A design whose score does not beat the best one found needs no search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from arm.chain import Arm
from arm.drive_load import greatest_drive_loads, rated_torques
from arm.evaluation import least_frequency
from arm.model import beams_of
from arm.modes import first_frequencies
from arm.play import played
from arm.strength import STATIONS
from arm.workspace import Unreachable, pull

from .exchange import Context, strength_of
from .figures import KEPT_WITHIN, excess
from .problem import Limit
from .round_options import Rounding
from .round_table import Figures, Table

Array = NDArray[np.float64]
Integers = NDArray[np.intp]

CHUNK = 4096
"""Designs scored at once."""
MOST_SEARCHED = 600
"""Designs searched over their whole workspace before the search is given up as not exhaustive."""
_EXACT = ("mass", "total_mass", "cost", "reach")
_ADDED = 3
_SAME = 0.01
"""Poses whose joints differ by less (rad, m) bound a design alike."""


@dataclass(frozen=True)
class Pose:
    """A pose that bounds designs: joint coordinates, load case, and its tip (m) for a workspace fixed in space."""

    q: tuple[float, ...]
    load_case: int
    tip: tuple[float, float, float]


@dataclass
class _Scores:
    """Designs with their scores: `bound` on the objective (infinite where a limit is broken), from `seen` poses."""

    picks: Integers
    bound: Array
    seen: Integers
    figures: Figures = field(repr=False)


class RoundSearch:
    """Looks for the best design; `offer` designs, again and again."""

    def __init__(
        self, context: Context, table: Table, rounding: Rounding, heard: Callable[[int, int], None] | None = None
    ) -> None:
        """`context` is of the problem whose arm is the optimum; `heard` is told designs offered and searched."""
        self.context, self.table, self.problem, self.rounding = context, table, context.problem, rounding
        self.best: tuple[tuple[int, ...], float] | None = None
        self.offered, self.searched, self.complete = 0, 0, True
        self.least: dict[str, float] = {}
        """How near each limit came to being kept: the least excess over it, relative."""
        self.nearest: tuple[float, Limit] | None = None
        """The limit most broken by the design that breaks its worst one least."""
        self._poses: list[Pose] = []
        self._slow: list[tuple[Array, float]] = []
        self._moved: dict[tuple[int, int], Array | None] = {}
        self._done: set[tuple[int, ...]] = set()
        self._excluded: set[tuple[int, ...]] = set()
        self._heard = heard
        # Poses of a place in space turn with the lengths.
        self._turning = self.problem.workspace.kind != "joints" and self.problem.link_length is not None

    def add_poses(self, q: Array, load_cases: list[int], p: Array) -> None:
        """Poses (N, n) of a design p's workspace to bound others with."""
        tips = self.context.search.tip(q, p)
        for row, tip, case in zip(q.tolist(), tips.tolist(), load_cases, strict=True):
            known = (pose.q for pose in self._poses if pose.load_case == case)
            if any(max(abs(a - b) for a, b in zip(row, other, strict=True)) < _SAME for other in known):
                continue
            self._poses.append(Pose(tuple(row), case, (tip[0], tip[1], tip[2])))

    def offer(self, picks: Integers) -> bool:
        """Look at designs (rows of picks, see `Table`); whether one is better than the best so far."""
        picks = self.table.agreeing(picks)
        before = self.best
        scores = self._scored(picks)
        self.offered += len(picks)
        while len(picks):
            wanted = min(CHUNK, len(picks))
            front = np.argpartition(scores.bound, wanted - 1)[:wanted] if wanted < len(picks) else np.arange(len(picks))
            stale = front[(scores.seen[front] < len(self._poses)) & np.isfinite(scores.bound[front])]
            if len(stale):
                self._rescore(scores, stale)
                continue
            top = int(front[np.argmin(scores.bound[front])])
            objective = math.inf if self.best is None else self.best[1]
            if not scores.bound[top] < objective:
                break
            if self.searched >= MOST_SEARCHED:
                self.complete = False
                break
            pick = tuple(int(k) for k in picks[top])
            scores.bound[top] = math.inf
            if pick not in self._done:
                self._done.add(pick)
                self._search(pick)
        return self.best != before

    def exclude(self, pick: tuple[int, ...]) -> None:
        """Drop a design that turned out to break a limit after all."""
        self._excluded = self._excluded | {pick}
        self._done = set(self._excluded)
        self.best = None

    # ---- scores

    def _scored(self, picks: Integers) -> _Scores:
        """Designs with what is known of them without a pose."""
        parts = [self.table.figures(picks[k : k + CHUNK]) for k in range(0, len(picks), CHUNK)]
        joined = {name: [getattr(part, name) for part in parts] for name in ("mass", "cost", "reach")}
        mass, cost, reach = (np.concatenate(each) if each else np.zeros(0) for each in joined.values())
        empty = np.zeros((0, 0))
        figures = Figures(empty, empty, mass, cost, reach)
        values = {"mass": mass, "total_mass": mass + self.table.carried, "cost": cost, "reach": reach}
        bound = np.zeros(len(picks)) if self.problem.minimize == "max_error" else values[self.problem.minimize].copy()
        # Equal bounds are taken in the order of mass, so that ties do not hang on the order of the options.
        over = {limit: _excesses(limit, values[limit.name]) for limit in self.problem.limits if limit.name in _EXACT}
        bound[self._broken(over, np.isfinite(bound))] = math.inf
        return _Scores(picks, bound, np.zeros(len(picks), dtype=np.intp), figures)

    def _broken(self, over: Mapping[Limit, Array], alive: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which designs break a limit; how near each limit came to being kept is noted."""
        broken = np.zeros(len(alive), dtype=bool)
        worst = np.full(len(alive), -math.inf)
        which = np.zeros(len(alive), dtype=np.intp)
        for number, (limit, values) in enumerate(over.items()):
            if len(values):
                self._note(limit, float(np.nanmin(np.where(alive, values, np.inf))))
            which = np.where(values > worst, number, which)
            worst = np.fmax(worst, values)
            broken |= values > KEPT_WITHIN
        breaking = broken & alive
        if breaking.any():
            at = int(np.argmin(np.where(breaking, worst, math.inf)))
            self._note_nearest(float(worst[at]), list(over)[int(which[at])])
        return broken

    def _note(self, limit: Limit, over: float) -> None:
        self.least[limit.text] = min(self.least.get(limit.text, math.inf), over)

    def _note_nearest(self, over: float, limit: Limit) -> None:
        if self.nearest is None or over < self.nearest[0]:
            self.nearest = (over, limit)

    def _rescore(self, scores: _Scores, rows: Integers) -> None:
        """Bring some designs' scores up to date with the poses that came since."""
        picks = scores.picks[rows]
        figures = self.table.figures(picks)
        first = int(scores.seen[rows].min())
        bound = scores.bound[rows]
        for number in range(first, len(self._poses)):
            q = self._turned(number, picks[:, -1])
            bound = np.maximum(bound, self._bound(self._poses[number].load_case, q, picks, figures))
        scores.bound[rows] = bound
        scores.seen[rows] = len(self._poses)

    def _turned(self, number: int, lengths: Integers) -> Array:
        """The joint coordinates of a pose for each design (N, n): those that reach its place with the design's lengths;
        NaN where none do."""
        pose = self._poses[number]
        if not self._turning:
            return np.broadcast_to(np.array(pose.q), (len(lengths), len(pose.q)))
        found = np.full((len(lengths), len(pose.q)), np.nan)
        for choice in np.unique(lengths):
            key = (number, int(choice))
            if key not in self._moved:
                self._moved[key] = self._reaching(pose, int(choice))
            q = self._moved[key]
            if q is not None:
                found[lengths == choice] = q
        return found

    def _reaching(self, pose: Pose, lengths: int) -> Array | None:
        search = self.context.search
        p = self.table.figures(np.array([[*[0] * len(self.table.groups), lengths]])).p[0]
        used = np.array([1.0, 1.0, float(not self.context.model.planar)])
        target = np.array([pose.tip])
        q, miss = pull(lambda q: search.tip(q, p), np.array([pose.q]), target, search.lower, search.upper, used)
        return q[0] if miss[0] < 1e-7 else None

    def _bound(self, case: int, q: Array, picks: Integers, figures: Figures) -> Array:
        """A bound on the objective from one pose of each design: infinite where it breaks a limit."""
        there: NDArray[np.bool_] = np.asarray(np.isfinite(q).all(axis=1))
        q = np.where(there[:, None], q, 0.0)
        over: dict[Limit, Array] = {}
        error = np.zeros(len(q))
        if self.context.uses_error:
            model = self.context.model
            arrays = model.cases[case].arrays(q, figures.p)
            arm = self.context.problem.arm
            error = played(
                arrays, model.cases[case].radii, arm.play, planar=model.planar, statistics=arm.statistics
            ).error
        for limit in self.problem.limits:
            if limit.name == "max_error":
                over[limit] = _excesses(limit, error)
        if self.context.strengths:
            over |= self._strength(case, q, picks, figures)
        if self.context.drives:
            loads = np.abs(self.context.drives[case].vectorised(q, figures.p)[0])
            rated = np.array([math.inf if r is None else r for r in rated_torques(self.context.problem.arm)])
            over |= {x: _excesses(x, (loads / rated).max(axis=1)) for x in self.problem.limit("torque_use")}
        over = {limit: np.where(there, values, -1.0) for limit, values in over.items()}
        bound = np.where(there & (self.problem.minimize == "max_error"), error, 0.0)
        broken = self._broken(over, np.ones(len(q), dtype=bool)) if over else np.zeros(len(q), dtype=bool)
        return np.where(broken, math.inf, bound)

    def _strength(self, case: int, q: Array, picks: Integers, figures: Figures) -> dict[Limit, Array]:
        strength = self.context.strengths[case]
        stress, compression, _ = strength.vectorised(q, figures.p, figures.sections)
        greatest = np.reshape(stress, (len(q), len(strength.links), len(STATIONS))).max(axis=2)
        yields = self.table.yield_strengths(picks)[:, list(strength.links)]
        factor = (yields / np.maximum(greatest, 1e-300)).min(axis=1)
        with np.errstate(divide="ignore"):
            pressed = np.maximum(compression.max(axis=1), 0.0)
            buckling = np.where(pressed > 0.0, 1.0 / np.maximum(pressed, 1e-300), math.inf)
        found = {limit: _excesses(limit, factor) for limit in self.problem.limit("safety_factor")}
        return found | {limit: _excesses(limit, buckling) for limit in self.problem.limit("buckling")}

    # ---- one design over its whole workspace

    def _search(self, pick: tuple[int, ...]) -> None:
        """Search a design's workspace: it is the best so far, or its poses join the others."""
        self.searched += 1
        if self._heard is not None:
            self._heard(self.offered, self.searched)
        arm = self.table.arm_of(pick)
        figures = self.table.figures(np.array([pick]))
        p = figures.p[0]
        values = {"mass": float(figures.mass[0]), "cost": float(figures.cost[0]), "reach": float(figures.reach[0])}
        values["total_mass"] = values["mass"] + self.table.carried
        try:
            kept = self._keeps_frequency(arm, p) and self._keeps_rest(arm, p, values)
        except Unreachable:
            return
        if kept and (self.best is None or values[self.problem.minimize] < self.best[1]):
            self.best = (pick, values[self.problem.minimize])

    def _kept(self, name: str, value: float) -> bool:
        for limit in self.problem.limit(name):
            over = excess(limit, value)
            self._note(limit, over)
            if over > KEPT_WITHIN:
                self._note_nearest(over, limit)
                return False
        return True

    def _keeps_frequency(self, arm: Arm, p: Array) -> bool:
        if not self.problem.limit("first_frequency"):
            return True
        cases = self.problem.load_cases
        beams = beams_of(arm, cases)
        if not self._turning:
            for q, payload in self._slow:
                if not self._kept("first_frequency", float(first_frequencies(arm, beams, payload, q[None])[0])):
                    return False
        slowest = least_frequency(arm, self.context.search, beams, p, cases)
        if slowest is None:
            return True
        if self._kept("first_frequency", slowest.value):
            return True
        self._slow.append((np.array(slowest.q), cases[slowest.load_case].mass))
        return False

    def _keeps_rest(self, arm: Arm, p: Array, values: dict[str, float]) -> bool:
        kept = True
        if self.context.uses_error:
            known = np.array([pose.q for pose in self._poses]) if self._poses and not self._turning else None
            worst = self.context.search.worst(p, certify=False, extra=known)
            values["max_error"] = worst.error
            near = [pose for pose in worst.poses if pose.error > 0.98 * worst.error][:_ADDED]
            self.add_poses(np.array([pose.q for pose in near]), [pose.load_case for pose in near], p)
            kept = self._kept("max_error", worst.error)
        if kept and self.context.strengths:
            result = strength_of(self.context, arm, p)
            places = [*result.poses, *result.buckling_poses]
            kept = self._kept("safety_factor", result.least_safety_factor or math.inf)
            kept = self._kept("buckling", result.least_buckling or math.inf) and kept
            if not kept:
                self.add_poses(np.array([q for q, _ in places]), [case for _, case in places], p)
        if kept and self.context.drives:
            poses = self.context.search.poses(p, 1024)
            found = greatest_drive_loads(arm, self.context.drives, poses, p, self.context.search)
            kept = self._kept("torque_use", found.greatest_use or 0.0)
            if not kept:
                self.add_poses(np.array([q for q, _ in found.poses]), [case for _, case in found.poses], p)
        return kept


def _excesses(limit: Limit, values: Array) -> Array:
    """How far values (SI) are beyond a limit, relative to it."""
    ratio = values / limit.value - 1.0
    return np.abs(ratio) if limit.relation == "==" else -ratio if limit.relation == ">=" else ratio
