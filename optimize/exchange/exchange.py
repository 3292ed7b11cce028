"""The exchange (Blankenship and Falk 1976, doi:10.1007/BF00934096): binding poses in, a better design out.

Solve the design for the poses found so far; look for poses at which that design is worse; add them; until the search,
and for planar arms its certificate, agrees that there are none. Every figure is judged on the real arm, never on the
program.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import ErrorModel, error_model
from linkwright.core.arm.figures import (
    Cut,
    DesignValues,
    Limit,
    OfDesign,
    OfKinds,
    OfLinks,
    PoseFamily,
    ThroughPoses,
    Totals,
    WorstError,
    families_of,
    shortfall,
)
from linkwright.core.arm.worst.coverage import reached
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.search import WorstCase, WorstPose, WorstSearch
from linkwright.core.arm.worst.workspace import Unreachable, climbing_bounds, pull
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .assembled import Compiled
from .binding_poses import Anchor, ErrorCut, Pool, Room
from .design import DesignSpace, arm_of, numeric_beams, starting_points, with_chosen_links
from .program import Ask, Program, Solution, cut_of, groups_of
from .rescue import LEAST_ERROR, solved
from .scenarios import Scenarios
from .totals import anchored, carried_mass

Log = Callable[[Iteration], None]

TOLERANCE = 2e-5
"""Relative violation at which the exchange stops; the certificate's gap is another 5e-5, so the whole is 1e-4."""
GAINED = 1e-7
"""A design that is better by less (relative) takes no other's place."""
CERTIFICATE_GAP = 3e-5
_MOST_ROUNDS = 40
_OTHER_STARTS = 2
"""Starting points of the sizes' own that are tried where a solver fails from the last design."""
_MOST_ADDED = 6
_BETWEEN = (1.0 / 3.0, 2.0 / 3.0)
"""Where poses between two stand that are farther apart (rad, m) than `_SAME` and nearer than `_NEAR`."""
_SAME, _NEAR = 1e-4, 0.6
_AT_END = 1e-9
"""How near (rad, m) to an end of its range a joint is at that end."""


@dataclass(frozen=True)
class Context:
    """What all combinations of a problem share: the error model, the search for worst poses, and the families of
    figures that hold a limit through poses, each with what it prepared."""

    problem: Problem
    model: ErrorModel
    search: WorstSearch
    families: tuple[tuple[PoseFamily[Any], Any], ...] = ()
    scenarios: Scenarios | None = None
    """What the error is held for instead of the arm as it is, as families of errors of load cases and points are; other
    figures are those of the arm as it is."""

    @property
    def error_groups(self) -> int:
        """How many load cases there are for the error: of each scenario, all."""
        return len(self.model.cases) * (1 if self.scenarios is None else len(self.scenarios.held))

    def worst(self, arm: Arm, p: Array, **settings: Any) -> WorstCase:
        """The worst error of a design, with its beam values, over the workspace and all scenarios; `settings` as in
        `WorstSearch.worst`."""
        if self.scenarios is None:
            return self.search.worst(p, **settings)
        return self.scenarios.worst(arm, self.problem.load_cases, **settings)

    def design(self, arm: Arm, p: Array) -> DesignValues:
        """A design, with its beam values, for its figures through poses."""
        return DesignValues(arm, self.problem.load_cases, self.search, p)

    @property
    def aim(self) -> int | None:
        """The number of the limit on the objective, where that is made as tight as it can be; None elsewhere."""
        return next((number for number, limit in enumerate(self.problem.limits) if limit.aim), None)

    @property
    def uses_error(self) -> bool:
        """Whether the error is minimised or limited."""
        return self.problem.minimize == "max_error" or bool(self.problem.limit("max_error"))


@dataclass(frozen=True)
class Exchanged:
    """The end of an exchange: the design, the pool, the last solution, the worst case and the log.

    `bounded_out` tells that it was given up because even the pool's poses alone are worse than what is known.
    """

    x: Array
    solution: Solution
    pool: Pool
    worst: WorstCase | None
    iterations: tuple[Iteration, ...]
    certified: bool
    converged: bool
    bounded_out: bool = False


def context_of(problem: Problem) -> Context:
    """The shared parts of a problem's exchanges; its arm has the drives that it has."""
    if problem.actuators is not None:
        message = "is settled by `optimize` alone; name the drives in the arm file for this"
        raise InputError(problem.file, "choose.actuator", message)
    if problem.motors:
        message = "is settled by `optimize` alone; say in the arm file where motors stand for this"
        raise InputError(problem.file, "choose.motor", message)
    if problem.sizes is not None:
        message = "is settled by `optimize` alone; leave it out for this"
        raise InputError(problem.file, "choose.sizes", message)
    if problem.base is not None:
        message = "is settled by `optimize` alone; shift the first joint (origin) in the arm file for this"
        raise InputError(problem.file, "choose.base", message)
    problem = with_chosen_links(problem).aimed
    model = error_model(problem.arm, problem.load_cases)
    search = worst_search(model, problem.workspace, gap=CERTIFICATE_GAP)
    limited = families_of({limit.name: limit.figure for limit in problem.limits})
    families = [family for family in families_of(problem.figures) if family in limited]
    return Context(problem, search.model, search, tuple((family, family.prepare(problem)) for family in families))


def objective_of(context: Context, program: Program, x: Array, materials: Array, error: float) -> float:
    """The value (SI) of what is minimised: the error as given, or a sum over the links."""
    follows = context.problem.objective.follows
    if not isinstance(follows, OfDesign):
        return error
    carried = carried_mass(context.problem) + program.space.hung(x)
    return follows.value(Totals(*program.mass_cost_reach(x, materials), carried))


def badness_of(context: Context, program: Program, x: Array, arm: Arm, materials: Array) -> float:
    """The badness of the objective of any design, optimal or not; infinite where it has none."""
    figure, p = context.problem.objective, numeric_beams(arm, context.problem.load_cases)
    match figure.follows:
        case WorstError() | OfDesign():
            error = context.worst(arm, p, certify=False).error if isinstance(figure.follows, WorstError) else math.nan
            return figure.badness(objective_of(context, program, x, materials, error))
        case OfLinks():
            value = figure.of_links(arm)
            return math.inf if value is None else figure.badness(value)
        case OfKinds():
            return figure.badness(figure.follows.count(arm))
        case ThroughPoses(family):
            prepared = next(each for item, each in context.families if item is family)
            worst = family.worst(prepared, context.problem, context.design(arm, p))
            return max((figure.badness(each.value) for each in worst if each.name == figure.name), default=math.inf)


class Exchange:
    """The exchange for one combination of shapes; materials and starts may differ from call to call."""

    def __init__(self, context: Context, space: DesignSpace, compiled: Compiled | None = None) -> None:
        """`compiled`: what exchanges of the same problem have compiled, to which this one adds."""
        self.context, self.space = context, space
        self.compiled = Compiled() if compiled is None else compiled
        self._anchors = anchored(space)
        self._program: Program | None = None
        self._reached: Array | None = None
        self.room: Room | None = None
        """That of the program, which is compiled when it is needed."""
        self.infeasible = False
        """Whether the last failure was for limits that no design near kept, not for the solver's."""

    def program(self, pool: Pool, *, spare: bool = True) -> Program:
        """A compiled program with room for the pool (with `spare`, for some more)."""
        families = [family for family, _ in self.context.families]
        room = pool.room(self.context.error_groups, groups_of(self.context.problem, families))
        if self.room is None or not self.room.holds(room):
            # Each slot takes its time to compile; most designs are held by fewer poses than these.
            self.room = room.spare(1 if self._anchors else 4) if spare else room
        if self._program is None or self._program.room != self.room:
            context = self.context
            self._program = Program(
                self.space, context.model, context.families, self.room, context.scenarios, self.compiled
            )
        return self._program

    def set_limits(self, limits: tuple[Limit, ...]) -> None:
        """Give the problem's limits other values; what is compiled stays."""
        self.context = replace(self.context, problem=replace(self.context.problem, limits=limits))

    def bound(
        self, materials: Array, pool: Pool, start: Array, *, push: int | None = None
    ) -> tuple[Solution, float] | None:
        """The solution for the pool alone, and its objective: no design near it does better; minus infinity where a
        pose that holds it strayed, which proves nothing. None where infeasible.

        `push` as for `run`.
        """
        push = self.context.aim if push is None else push
        program = self.program(pool, spare=False)
        ask = Ask(self.context.problem.limits, push)
        solution = solved(program, start, materials, pool, ask)
        if not solution.solved:
            self.infeasible = solution.infeasible
            return None
        bound = -math.inf if solution.strayed else self.objective(program, solution, materials, push)
        return solution, bound

    def breach(self, materials: Array, pool: Pool, start: Array) -> Solution:
        """The solution for the pool alone in which the limits give way as little as they must."""
        program = self.program(pool, spare=False)
        return program.solve(start, materials, pool, Ask(self.context.problem.limits, relax=True))

    def objective(self, program: Program, solution: Solution, materials: Array, push: int | None) -> float:
        """What a solution makes least: the objective (SI), or the badness of the limit that is pushed."""
        if push is None:
            return objective_of(self.context, program, solution.x, materials, solution.error)
        limit = self.context.problem.limits[push]
        scale = 1.0 / limit.value if limit.relation == ">=" else limit.value
        return scale * math.exp(solution.slacks[push])

    def run(
        self,
        materials: Array,
        chosen: Sequence[Material | None],
        pool: Pool,
        start: Array,
        *,
        give_up_above: float = math.inf,
        log: Log | None = None,
        push: int | None = None,
        within: float | Array | None = None,
    ) -> Exchanged | None:
        """The exchange from a start; None where the finite problem has no solution, or none was found (`infeasible`
        tells which).

        `give_up_above`: an objective that is known to be reached by other choices. With `push` the limit of that number
        is made as tight as it can be: the objective is then its value, or the reciprocal where more is better.
        `within` keeps the design that near to the start, in each of the optimiser's numbers.
        """
        push = self.context.aim if push is None else push
        ask = Ask(self.context.problem.limits, push, within=None if within is None else (start, within))
        iterations: list[Iteration] = []
        last, error = start, 1e-3
        best: Exchanged | None = None
        for number in range(1, _MOST_ROUNDS + 1):
            program = self.program(pool)
            solution = solved(program, last, materials, pool, ask, error=error)
            for other in self._others(last, start, materials, ask):
                if solution.solved or (solution.infeasible and other is not start):
                    break
                solution = solved(program, other, materials, pool, ask, error=error)
            if not solution.solved:
                self.infeasible = solution.infeasible
                return None
            objective = self.objective(program, solution, materials, push)
            change = _change(self.space, last, solution.x) if number > 1 else math.nan
            last, error = solution.x, solution.error
            if objective > give_up_above * (1.0 + 1e-9) and not solution.strayed:
                return Exchanged(last, solution, pool, None, tuple(iterations), False, False, bounded_out=True)
            try:
                judged = self._judge(last, solution, chosen, pool, push, worth=give_up_above)
            except Unreachable as missing:
                # The new lengths miss a place that the arm as given reaches: from now on a pose holds on to it.
                grown = pool.with_errors(self._reaching(missing.point)) if self._anchors else pool
                if grown.size == pool.size:
                    raise
                pool, last = grown, start
                continue
            iterations.append(Iteration(number, objective, change, pool.size, judged.violation, judged.certified))
            if log is not None:
                log(iterations[-1])
            # Poses that strayed out of the joint ranges are brought back into them: another round may do better.
            agreed = judged.violation <= TOLERANCE and not solution.strayed
            best = Exchanged(last, solution, pool, judged.worst, tuple(iterations), judged.certified, agreed)
            if agreed or not (judged.added or solution.strayed):
                break
            pool = judged.pool
        return best

    def _others(self, last: Array, start: Array, materials: Array, ask: Ask) -> Iterator[Array]:
        """Where a solver may begin that failed from the last design: the start, and the space's own starting points."""
        if not np.array_equal(last, start):
            yield start
        if ask.within is None:
            yield from starting_points(self.space, materials, _OTHER_STARTS)

    def _reaching(self, point: tuple[float, ...]) -> tuple[ErrorCut, ...]:
        """A pose of the arm as given with its tip at a point (m); none where that arm does not reach it either."""
        search = self.context.search
        p = numeric_beams(self.context.problem.arm, self.context.problem.load_cases)
        place = np.array([*point, 0.0][:3])
        used = np.array([1.0, 1.0, float(not self.context.model.arm.flat)])
        starts = search.poses(p, 64)
        places = np.tile(place, (len(starts), 1))
        q, miss = pull(lambda q: search.motion(q, p), starts, places, search.lower, search.upper, used)
        if miss.min() > 1e-7:
            return ()
        nearest = q[[int(np.argmin(miss))]]
        pose = search.worst_poses_at(nearest, p, search.case_at(nearest[0], p, 0))[0]
        cut = error_cut(self.context, pose, p, self.space)
        assert cut.anchor is not None
        return (replace(cut, anchor=replace(cut.anchor, free=True)),)

    def _hold_on(self, p: Array) -> None:
        """Raises `Unreachable` with the place of a box or path that a design, with its beam values, misses by most."""
        search = self.context.search
        self._reached, missed = reached(
            search.workspace, lambda q: search.motion(q, p), search.lower, search.upper, near=self._reached
        )
        if missed is not None:
            raise Unreachable(missed.point, missed.missing)

    def worse_poses(self, solution: Solution, chosen: Sequence[Material | None], pool: Pool) -> Pool:
        """The pool with the poses at which a solution breaks the problem's limits; the same where there are none."""
        judged = self._judge(solution.x, solution, chosen, pool)
        return judged.pool if judged.violation > TOLERANCE else pool

    def _judge(
        self,
        x: Array,
        solution: Solution,
        chosen: Sequence[Material | None],
        pool: Pool,
        push: int | None = None,
        *,
        worth: float = math.inf,
    ) -> _Judged:
        """How much worse the design is than its program believes, with the poses that show it. An objective that is not
        below `worth` needs no certificate: a worse pose would only make it greater."""
        context = self.context if push is None else _pushed(self.context, push, solution.slacks[push])
        arm = arm_of(self.space, x, chosen)
        p = numeric_beams(arm, context.problem.load_cases)
        violation, certified, worst = -math.inf, True, None
        if self._anchors:
            self._hold_on(p)
        grown = _anchored_again(context, pool, p) if self._anchors else pool
        size_before = grown.size
        if context.uses_error:
            known = np.array([cut.q for cut in pool.errors])
            allowed = solution.error
            limit = min((item.value for item in context.problem.limit("max_error")), default=math.inf)
            if context.problem.minimize != "max_error":
                allowed = limit
            enough = allowed * (1.0 + TOLERANCE)
            if context.problem.minimize == "max_error" and push is None:
                enough = min(enough, worth * (1.0 - GAINED))
            worst = context.worst(arm, p, extra=known, certify_up_to=enough)
            certified = worst.certified
            violation = worst.error / max(allowed, LEAST_ERROR) - 1.0
            worse = [pose for pose in worst.poses if pose.error > allowed * (1.0 + 0.1 * TOLERANCE)]
            results = [error_cut(context, pose, p, self.space) for pose in worse[:_MOST_ADDED]]
            grown = grown.with_errors(tuple(results)).with_errors(tuple(self._between(results, grown)))
        for family, prepared in context.families:
            cuts: list[Cut] = []
            for each in family.worst(prepared, context.problem, context.design(arm, p)):
                limits = context.problem.limits if each.limit is None else (context.problem.limits[each.limit],)
                short = [shortfall(limit, each.value) for limit in limits if limit.name == each.name]
                violation = max([violation, *short])
                if max(short, default=0.0) > TOLERANCE:
                    cuts.append(each.cut)
            grown = grown.with_cuts(family.name, cuts)
        return _Judged(max(violation, 0.0), certified, worst, grown, grown.size > size_before)

    def _between(self, cuts: Sequence[ErrorCut], pool: Pool) -> list[ErrorCut]:
        """Poses between those found and the nearest of the pool, as many as the program has room for.

        A worst pose that moves with the design is closed in on from both sides: the next design has its own between
        these two, so that more of them at once save rounds. Any pose of the workspace may be in a pool.
        """
        problem = self.context.problem
        if problem.workspace.kind != "joints" or self._program is None:
            return []
        vacant = [
            have - sum(cut.load_case == case for cut in (*pool.errors, *cuts))
            for case, have in enumerate(self._program.room.errors)
        ]
        added: list[ErrorCut] = []
        for cut in cuts:
            if any(cut.shift) or (cut.signs and problem.arm.play != "worst"):
                continue  # where the play stands is the pose's own
            similar = [error for error in pool.errors if (error.load_case, error.signs) == (cut.load_case, cut.signs)]
            near = min(similar, key=lambda item: _apart(item.q, cut.q), default=cut)
            if not _SAME < _apart(near.q, cut.q) < _NEAR:
                continue
            for share in _BETWEEN[: max(vacant[cut.load_case], 0)]:
                q = tuple(share * a + (1.0 - share) * b for a, b in zip(near.q, cut.q, strict=True))
                added.append(replace(cut, q=q))
                vacant[cut.load_case] -= 1
        return added


def _apart(one: Sequence[float], other: Sequence[float]) -> float:
    return float(np.abs(np.subtract(one, other)).max())


@dataclass(frozen=True)
class _Judged:
    violation: float
    certified: bool
    worst: WorstCase | None
    pool: Pool
    added: bool


def _pushed(context: Context, number: int, slack: float) -> Context:
    """The context with one limit moved by the slack of its logarithm."""
    limits = list(context.problem.limits)
    limit = limits[number]
    limits[number] = replace(limit, value=limit.value * math.exp(-slack if limit.relation == ">=" else slack))
    return replace(context, problem=replace(context.problem, limits=tuple(limits)))


def _change(space: DesignSpace, old: Array, new: Array) -> float:
    before, after = np.array(space.values(list(old)), dtype=float), np.array(space.values(list(new)), dtype=float)
    sizes = np.maximum(
        np.abs(before), [1e-6 * max(abs(variable.lower), abs(variable.upper)) for variable in space.variables]
    )
    return float((np.abs(after - before) / sizes).max(initial=0.0))


def error_cut(context: Context, pose: WorstPose, p: Array, space: DesignSpace) -> ErrorCut:
    """The cut that a worst pose makes, held at its place where lengths are free and the workspace is fixed in space."""
    anchor = _anchor(context, np.array(pose.q), p) if anchored(space) else None
    return replace(cut_of(context.model, pose), anchor=anchor)


def _anchor(context: Context, q: Array, p: Array) -> Anchor:
    """Where the tip stands, and in which directions the joints stay while lengths change."""
    axes = 2 if context.model.arm.flat else 3
    step = 1e-6
    tip = context.search.tip(q[None], p)[0]
    moved = [context.search.tip(q[None] + step * row, p)[0] for row in np.eye(len(q))]
    jacobian = np.stack([(place - tip)[:axes] / step for place in moved], axis=1)
    low, high = climbing_bounds(context.search.arm, context.search.lower, context.search.upper)
    held = _held_directions(jacobian, (q <= low + _AT_END) | (q >= high - _AT_END))
    square = np.vstack([jacobian, held])
    side = -1.0 if square.shape[0] == square.shape[1] and np.linalg.det(square) < 0.0 else 1.0
    return Anchor((float(tip[0]), float(tip[1]), float(tip[2])), tuple(tuple(row) for row in held.tolist()), side)


def _held_directions(jacobian: Array, at_end: NDArray[np.bool_]) -> Array:
    """The directions (rows) in which a pose stays as lengths change, as many as there are joints to spare: those of
    joints at an end of their range, which a worst pose presses against, then those that leave the tip where it is."""
    joints = jacobian.shape[1]
    held = np.empty((0, joints))
    for _ in range(joints - len(jacobian)):
        free = np.linalg.svd(np.vstack([jacobian, held]))[2][len(jacobian) + len(held) :]
        moving = np.where(at_end & ~held.any(axis=0), np.linalg.norm(free, axis=0), 0.0)
        joint = int(np.argmax(moving))
        if moving[joint] == 0.0:
            return np.vstack([held, free])
        held = np.vstack([held, np.eye(joints)[joint]])
    return held


def _anchored_again(context: Context, pool: Pool, p: Array) -> Pool:
    """The pool's poses for the lengths that the design now has, so that they reach the same places."""
    search = context.search
    used = np.array([1.0, 1.0, float(not context.model.arm.flat)])
    kept: list[ErrorCut] = []
    for cut in pool.errors:
        if cut.anchor is None:
            continue
        q, miss = pull(
            lambda q: search.motion(q, p),
            np.array([cut.q]),
            np.array([cut.anchor.tip]),
            search.lower,
            search.upper,
            used,
        )
        if miss[0] < 1e-7:
            anchor = replace(_anchor(context, q[0], p), free=cut.anchor.free)
            kept.append(replace(cut, q=tuple(q[0].tolist()), anchor=anchor))
    # A place that the new lengths do not reach is dropped.
    return replace(pool, errors=tuple(kept))


def first_pool(context: Context, space: DesignSpace, x: Array, chosen: Sequence[Material | None]) -> Pool:
    """The binding poses of a first design: the worst of each load case, each link's most stressed, the slowest mode.

    Raises `Unreachable` where the workspace holds points that this design cannot reach.
    """
    arm = arm_of(space, x, chosen)
    p = numeric_beams(arm, context.problem.load_cases)
    pool = Pool()
    if context.uses_error:
        worst = context.worst(arm, p, certify=False)
        poses = [pose for pose in worst.poses if pose.error > 0.9 * worst.error][:4]
        pool = pool.with_errors(tuple(error_cut(context, pose, p, space) for pose in poses))
    for family, prepared in context.families:
        result = family.worst(prepared, context.problem, context.design(arm, p))
        pool = pool.with_cuts(family.name, family.first(result))
    return pool
