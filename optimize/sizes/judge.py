"""The best of many designs of fixed sizes, exactly: bounds on a few poses first, the whole workspace for the best few.

A pose of the workspace bounds a design's worst error from below, and shows stresses and loads that break a limit. Every
design is scored on the poses known so far; the one with the best score is searched over its whole workspace; the poses
at which it turns out worse join the others. A design whose score does not beat the best one found needs no search.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.figures import (
    KEPT_WITHIN,
    Cut,
    Designs,
    Limit,
    OfDesign,
    OfLinks,
    PoseFamily,
    ThroughPoses,
    Worst,
    excess,
)
from linkwright.core.arm.worst.coverage import reached
from linkwright.core.arm.worst.workspace import Unreachable, pull
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.exchange.program import cut_of
from linkwright.core.sections.numeric import Array

from .designs_at_once import Figures, Table
from .rows import Integers

CHUNK = 4096
"""Designs scored at once."""
MOST_SEARCHED = 600
"""Designs searched over their whole workspace before the search is given up as not exhaustive."""
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


class Judge:
    """Finds the best of the designs that it is offered, again and again; `pool` holds the poses that told."""

    def __init__(self, context: Context, table: Table, heard: Callable[[int, int], None] | None = None) -> None:
        """`heard` is told designs offered and searched."""
        self.context, self.table, self.problem = context, table, context.problem
        self.pool = Pool()
        self.best: tuple[tuple[int, ...], float] | None = None
        self.offered, self.searched, self.complete = 0, 0, True
        self.least: dict[str, float] = {}
        """How near each limit came to being kept: the least excess over it, relative."""
        self.nearest: tuple[float, Limit] | None = None
        """The limit most broken by the design that breaks its worst one least."""
        self._poses: list[Pose] = []
        self._cuts: dict[str, list[Cut]] = {}
        """Poses that broke a limit of a family that looks at designs one by one."""
        self._moved: dict[tuple[int, int], Array | None] = {}
        self._whole: dict[int, bool] = {}
        """Which choices of lengths reach all that they must."""
        self._near: Array | None = None
        self._done: set[tuple[int, ...]] = set()
        self._excluded: set[tuple[int, ...]] = set()
        self._heard = heard
        # Poses of a place in space turn with the lengths.
        self._turning = self.problem.workspace.in_space and self.problem.free_lengths

    def learn(self, arm: Arm, p: Array) -> None:
        """Add the poses that a design shows, whatever it is worth."""
        if self.context.uses_error:
            worst = self.context.search.worst(p, certify=False)
            near = [pose for pose in worst.poses if pose.error > 0.9 * worst.error][:_ADDED]
            self.add_poses(np.array([pose.q for pose in near]), [pose.load_case for pose in near], p)
        for family, prepared in self.context.families:
            result = family.worst(prepared, self.problem, self.context.design(arm, p))
            self.pool = self.pool.with_cuts(family.name, family.first(result))

    def cuts(self) -> Pool:
        """All poses that told, those of families that look at designs one by one among them."""
        for name, cuts in self._cuts.items():
            self.pool = self.pool.with_cuts(name, cuts)
        return self.pool

    def add_poses(self, q: Array, load_cases: list[int], p: Array) -> None:
        """Poses (N, n) of a design p's workspace to bound others with, and for rows of the error and of each family
        that bounds many."""
        search = self.context.search
        for row, load_case in zip(q, load_cases, strict=True):
            if self.context.uses_error:
                pose = search.worst_poses_at(row[None], p, search.case_at(row, p, load_case))[0]
                self.pool = self.pool.with_errors((cut_of(self.context.model, pose),))
            for family, prepared in self.context.families:
                if family.bounds_many and family.more(prepared) == 0:
                    self.pool = self.pool.with_cuts(family.name, [Cut(tuple(row.tolist()), load_case)])
        tips = search.tip(q, p)
        cases = [search.case_at(row, p, case) for row, case in zip(q, load_cases, strict=True)]
        for row, tip, case in zip(q.tolist(), tips.tolist(), cases, strict=True):
            known = (pose.q for pose in self._poses if pose.load_case == case)
            if any(max(abs(a - b) for a, b in zip(row, other, strict=True)) < _SAME for other in known):
                continue
            self._poses.append(Pose(tuple(row), case, (tip[0], tip[1], tip[2])))

    def offer(self, picks: Integers) -> bool:
        """Look at designs (rows of picks, see `Table`); whether one is better than the best so far."""
        if self._heard is not None:
            self._heard(self.offered, self.searched)
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
            if not self._reaches(pick[-1]):
                scores.bound[picks[:, -1] == pick[-1]] = math.inf
                continue
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

    def exceeded(self, picks: Integers) -> dict[Limit, Array]:
        """How far designs exceed each limit at least (relative to it), by what is known without a search of their
        workspaces; NaN where nothing is."""
        figures = self.table.figures(picks)
        over = self._known(picks)[1]
        for number, pose in enumerate(self._poses):
            there = self._at_pose(pose.load_case, self._turned(number, picks[:, -1]), picks, figures)[1]
            over |= {limit: np.fmax(over.get(limit, values), values) for limit, values in there.items()}
        return over

    def objective_of(self, picks: Integers) -> Array:
        """What is minimised (SI) of designs (N) where it takes no search of their workspaces; 0 where it does."""
        return self._known(picks)[0]

    # ---- scores

    def _scored(self, picks: Integers) -> _Scores:
        """Designs with what is known of them without a pose."""
        parts = [self._known(picks[k : k + CHUNK]) for k in range(0, len(picks), CHUNK)]
        bound = np.concatenate([part[0] for part in parts]) if parts else np.zeros(0)
        over = {limit: np.concatenate([part[1][limit] for part in parts]) for limit in (parts[0][1] if parts else ())}
        bound[self._broken(over, np.isfinite(bound))] = math.inf
        return _Scores(picks, bound, np.zeros(len(picks), dtype=np.intp))

    def _known(self, picks: Integers) -> tuple[Array, dict[Limit, Array]]:
        """A bound on the objective (0 where it is the error), and how far each limit that takes no search of the
        workspace is exceeded, of designs."""
        figures = self.table.figures(picks)
        over: dict[Limit, Array] = {}
        for limit in self.problem.limits:
            values = self._exactly(limit, picks, figures)
            if values is not None:
                over[limit] = _excesses(limit, values)
        follows = self.problem.objective.follows
        totals = self.table.totals(figures)
        objective = follows.value(totals) if isinstance(follows, OfDesign) else np.zeros(len(picks))
        return np.array(objective), over

    def _exactly(self, limit: Limit, picks: Integers, figures: Figures) -> Array | None:
        """The figure (N) that a limit is on, of designs; None where it takes a search of their workspaces."""
        follows = limit.figure.follows
        if isinstance(follows, OfDesign):
            return follows.value(self.table.totals(figures))
        if isinstance(follows, OfLinks):
            return self.table.of_links(limit, follows, picks)
        if isinstance(follows, ThroughPoses):
            prepared = next(item for family, item in self.context.families if family is follows.family)
            return follows.family.exactly(prepared, limit, self._designs(picks, figures))
        return None

    def _designs(self, picks: Integers, figures: Figures) -> Designs:
        return Designs(
            figures.p, figures.sections, self.table.allowed_stresses(picks), partial(self.table.wall_modes, picks)
        )

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
        turned = np.full((len(lengths), len(pose.q)), np.nan)
        for choice in np.unique(lengths):
            key = (number, int(choice))
            if key not in self._moved:
                self._moved[key] = self._reaching(pose, int(choice))
            q = self._moved[key]
            if q is not None:
                turned[lengths == choice] = q
        return turned

    def _reaching(self, pose: Pose, lengths: int) -> Array | None:
        search, p = self.context.search, self._with_lengths(lengths)
        used = np.array([1.0, 1.0, float(not self.context.model.arm.flat)])
        target = np.array([pose.tip])
        q, miss = pull(lambda q: search.motion(q, p), np.array([pose.q]), target, search.lower, search.upper, used)
        return q[0] if miss[0] < 1e-7 else None

    def _bound(self, case: int, q: Array, picks: Integers, figures: Figures) -> Array:
        """A bound on the objective from one pose of each design: infinite where it breaks a limit."""
        error, over = self._at_pose(case, q, picks, figures)
        broken = self._broken(over, np.ones(len(q), dtype=bool)) if over else np.zeros(len(q), dtype=bool)
        return np.where(broken, math.inf, error if self.problem.minimize == "max_error" else 0.0)

    def _at_pose(self, case: int, q: Array, picks: Integers, figures: Figures) -> tuple[Array, dict[Limit, Array]]:
        """The error (m) at one pose of each design, and how far each limit is exceeded there; where a design has no
        such pose, 0 and kept."""
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
        designs = self._designs(picks, figures)
        for family, prepared in self.context.families:
            values = family.at_pose(prepared, self.context.search.load_case(case), q, designs)
            over |= {x: _excesses(x, values[x.name]) for x in self.problem.limits if x.name in values and not x.poses}
        return np.where(there, error, 0.0), {limit: np.where(there, values, -1.0) for limit, values in over.items()}

    # ---- one design over its whole workspace

    def _search(self, pick: tuple[int, ...]) -> None:
        """Search a design's workspace: it is the best so far, or its poses join the others."""
        self.searched += 1
        if self._heard is not None:
            self._heard(self.offered, self.searched)
        arm = self.table.arm_of(pick)
        figures = self.table.figures(np.array([pick]))
        p = figures.p[0]
        values = {"objective": float(self._known(np.array([pick]))[0][0])}
        try:
            feasible = self._keeps_one_by_one(arm, p) and self._keeps_rest(arm, p, values)
        except Unreachable:
            return
        if feasible and (self.best is None or values["objective"] < self.best[1]):
            self.best = (pick, values["objective"])
            return
        # What it shows of figures whose poses say more than where joints stand joins the rows.
        for family, prepared in self.context.families:
            if family.bounds_many and family.more(prepared) > 0:
                worst = family.worst(prepared, self.problem, self.context.design(arm, p))
                self.pool = self.pool.with_cuts(family.name, [item.cut for item in worst])

    def _reaches(self, lengths: int) -> bool:
        if self.problem.must_reach and lengths not in self._whole:
            search, p = self.context.search, self._with_lengths(lengths)
            self._near, missed = reached(
                search.workspace, lambda q: search.motion(q, p), search.lower, search.upper, near=self._near
            )
            self._whole[lengths] = missed is None
        return self._whole.get(lengths, True)

    def _with_lengths(self, lengths: int) -> Array:
        return self.table.figures(np.array([[*[0] * len(self.table.lists), lengths]])).p[0]

    def _kept(self, name: str, value: float, number: int | None = None) -> bool:
        limits = self.problem.limit(name) if number is None else (self.problem.limits[number],)
        for limit in limits:
            over = excess(limit, value)
            self._note(limit, over)
            if over > KEPT_WITHIN:
                self._note_nearest(over, limit)
                return False
        return True

    def _keeps(self, worst: Sequence[Worst]) -> bool:
        """Whether the worst of each figure keeps its limits; each is noted."""
        values: dict[tuple[str, int | None], list[float]] = {}
        for item in worst:
            values.setdefault((item.name, item.limit), []).append(item.value)
        figures = self.problem.figures
        feasible = [
            self._kept(name, figures[name].worst(values_there), limit) for (name, limit), values_there in values.items()
        ]
        return all(feasible)

    def _keeps_one_by_one(self, arm: Arm, p: Array) -> bool:
        """The limits of families that look at designs one by one, first at the poses that others failed at."""
        for family, prepared in self.context.families:
            if family.bounds_many:
                continue
            for cut in () if self._turning else self._cuts.get(family.name, ()):
                for limit in self._through(family):
                    value = family.at_cut(prepared, self.problem, arm, cut)
                    if value is not None and not self._kept(limit.name, value):
                        return False
            for item in family.worst(prepared, self.problem, self.context.design(arm, p)):
                if not self._kept(item.name, item.value, item.limit):
                    self._cuts.setdefault(family.name, []).append(item.cut)
                    return False
        return True

    def _through(self, family: PoseFamily[Any]) -> list[Limit]:
        follow = ((limit, limit.figure.follows) for limit in self.problem.limits)
        return [limit for limit, item in follow if isinstance(item, ThroughPoses) and item.family is family]

    def _keeps_rest(self, arm: Arm, p: Array, values: dict[str, float]) -> bool:
        feasible = True
        if self.context.uses_error:
            known = np.array([pose.q for pose in self._poses]) if self._poses and not self._turning else None
            worst = self.context.search.of_loads(self.context.search.worst(p, certify=False, extra=known))
            if self.problem.minimize == "max_error":
                values["objective"] = worst.error
            near = [pose for pose in worst.poses if pose.error > 0.98 * worst.error][:_ADDED]
            self.add_poses(np.array([pose.q for pose in near]), [pose.load_case for pose in near], p)
            feasible = self._kept("max_error", worst.error)
        for family, prepared in self.context.families:
            if not feasible:
                break
            if family.bounds_many:
                result = family.worst(prepared, self.problem, self.context.design(arm, p))
                feasible = self._keeps(result)
                if not feasible:
                    cases = [family.load_case(item.cut) for item in result]
                    self.add_poses(np.array([item.cut.q for item in result]), cases, p)
        return feasible


def _excesses(limit: Limit, values: Array) -> Array:
    """How far values (SI) are beyond a limit, relative to it."""
    ratio = values / limit.value - 1.0
    return np.abs(ratio) if limit.relation == "==" else -ratio if limit.relation == ">=" else ratio
