"""The finite problem of the exchange: the best design for the binding poses found so far, by IPOPT with exact
derivatives.

minimise y over (x, y) subject to log (|e(x; pose)|^2 + floor) <= 2 y for every pose of the pool: the worst error is
then sqrt(exp(2 y) - floor) mm plus the sum of the clearance discs' radii, which no design changes. Masses and errors
enter through their logarithms: where they are posynomials of the dimensions, the problem is convex. Poses, play,
materials and the values of limits are parameters, so one compiled program serves every round of the exchange, every
choice of materials and every point of a trade-off. Every limit has a slack, fixed at zero unless an infeasible problem
is to be explained, or that limit itself is pushed as far as it goes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.figures import Cut, Limit, PoseFamily
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.arm.worst.workspace import climbing_bounds, joint_box
from linkwright.core.optimize.problem import Problem

from .assembled import Compiled, assembled
from .binding_poses import ErrorCut, Pool, Room
from .compiled import Families, numbers_of
from .design import MATERIAL_FIELDS, DesignSpace
from .expressions import LINK_FIELDS
from .rows import FLOOR_MM2, MM, error_parameters, filled
from .scenarios import Scenarios
from .totals import anchored, drives_cost, fixed_error

Array = NDArray[np.float64]

_INSIDE = 1e-6
_ROUNDED = 1e-9
"""By how much a row that nothing moves may be broken: what a section may be off by, too."""
_FARTHEST = 30.0
"""How far (in its logarithm) a limit can be pushed, or can give way."""
_GIVEN = 0.5
"""Where the slacks of limits that may give way start."""
_PRESSING = 1e-7
"""A pose whose multiplier is below this does not hold the design."""
ROUNDINGS = (3e-2, 1e-3, 2e-5)
"""Of the corners between drives' zones, one solution after the other, as parts of the load at which a zone ends."""
_STRAYED = 1e-6
"""A pose that is farther (rad, m) beyond a joint's range is outside it."""


def ipopt_options() -> dict[str, Any]:
    """The options with which every finite problem is solved."""
    return {
        "print_time": False,
        "show_eval_warnings": False,  # a trial step may leave what a section can be; IPOPT goes back by itself
        # Prices of the parameters are not asked for, and their derivatives take long to set up.
        "no_nlp_grad": True,
        "calc_lam_p": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": 1e-9,
            "constr_viol_tol": 1e-10,
            "max_iter": 500,
            "mu_strategy": "adaptive",
            "bound_relax_factor": 0.0,
            "honor_original_bounds": "yes",
        },
    }


@dataclass(frozen=True)
class Ask:
    """What is asked of a finite problem beside its poses.

    `limits` are the problem's with other values. With `push` the limit of that number is made as tight as it can be
    instead of the objective: its slack is how far it went. `within` keeps the design so near (in each of the
    optimiser's numbers) to another one. `floor` (m) is that of the error rows: about the error itself where it may pass
    through zero. With `relax` the limits may give way and the least relaxation is sought instead of the objective. With
    `elastic` the sum of the limits' slacks, each times its number of those, is made least instead; a limit with 0 is
    kept.
    """

    limits: Sequence[Limit] | None = None
    push: int | None = None
    within: tuple[Array, float | Array] | None = None
    floor: float = 0.0
    relax: bool = False
    elastic: Sequence[float] | None = None


BEST = Ask()
"""The best design within the problem's limits."""


@dataclass(frozen=True)
class Solution:
    """What IPOPT found for a pool: the optimiser's numbers and the worst error over the pool (m).

    `limit_prices` holds a multiplier for each limit of the problem (d objective / d log limit), `bound_prices` those of
    the variables' bounds, `shape_prices` those of the sections' constraints by text. `slacks` are how far each
    limit (in its logarithm) had to be relaxed, `active` are the poses that hold the solution. `strayed`: one of these
    left a joint's range, so that its error may be none of the workspace's.
    """

    x: Array
    error: float
    solved: bool
    limit_prices: tuple[float, ...]
    bound_prices: Array
    shape_prices: tuple[tuple[str, float], ...]
    slacks: tuple[float, ...]
    message: str
    active: Pool
    strayed: bool = False
    infeasible: bool = False
    """Found without a design although limits might give way, or broken whatever the design is: more than a failure of
    the solver."""


def cut_of(model: ErrorModel, pose: WorstPose) -> ErrorCut:
    """The cut that a worst pose makes; where clearances add up whatever the pose, they stay out of it."""
    shift = np.array(pose.shifts).reshape(-1, 3).sum(axis=0) if fixed_error(model) == 0.0 else np.zeros(3)
    return ErrorCut(pose.q, pose.load_case, pose.signs, (float(shift[0]), float(shift[1]), float(shift[2])))


def _without_floor(y: float, floor: float) -> float:
    """The error (mm) that y stands for."""
    return math.exp(y) if floor == FLOOR_MM2 else math.sqrt(max(math.exp(2.0 * y) - floor, FLOOR_MM2))


def groups_of(problem: Problem, families: Sequence[PoseFamily[Any]]) -> dict[str, int]:
    """How many groups of poses each family has, by its name."""
    return {family.name: family.groups(problem) for family in families}


class Program:
    """The compiled finite problem for one combination of shapes, with room for a number of poses."""

    def __init__(
        self,
        space: DesignSpace,
        model: ErrorModel,
        families: Families,
        room: Room,
        scenarios: Scenarios | None = None,
        compiled: Compiled | None = None,
    ) -> None:
        """`families`: those that hold a limit, with what they prepared; `room`: how many binding poses of each kind
        there is room for; `scenarios`: what the error is held for instead of the arm as it is; `compiled`: what other
        combinations of the same problem have compiled."""
        compiled = Compiled() if compiled is None else compiled
        self.space, self.room = space, room
        self.model = model if scenarios is None else scenarios.model
        self.pose_families = tuple(family for family, _ in families)
        self._anchored = anchored(space)
        self._cornered = any(case.zones for case in model.cases)
        self.fixed_error = fixed_error(model)
        self._problem = assembled(compiled, space, model, families, room, scenarios, ipopt_options())
        core, self.solver = self._problem.core, self._problem.solver
        self._kinds, self._numbers = self._problem.kinds(space.shapes), self._problem.places(space)
        self.moving = self._problem.moving(space.shapes)
        """Which rows which numbers move: (2, M), rows above numbers."""
        self._links = [of_link[shape] for of_link, shape in zip(self._problem.links, space.shapes, strict=True)]
        self._limits = {name: block.limits for name, block in core.blocks.items()}
        self._place: dict[str, slice] = {}
        start = 0
        for name, block in core.blocks.items():
            self._place[name] = slice(start, start + len(block.rows))
            start += len(block.rows)
        count = int(self.solver.size1_out("g"))
        self._lower, self._upper = np.full(count, -np.inf), np.zeros(count)
        self._lower[self._place["design"]] = np.where(core.equal, 0.0, -np.inf)
        self._equal_from = start
        self._lower[start : start + core.equalities] = 0.0
        start += core.equalities
        self._of_links: list[int] = []
        self._shapes: dict[str, int] = {}
        """Which rows are limits on links, with `_limits`, and which make sections possible."""
        self._limits["links"] = []
        for link, (functions, height) in enumerate(zip(self._links, self._problem.heights, strict=True)):
            self._limits["links"] += functions.limits
            held = len(functions.limits)
            self._of_links += range(start, start + held)
            for number, text in enumerate(functions.labels, start=start + held):
                self._shapes[f"link {link + 1}: {text}"] = number
            # Other shapes have rows that this one has not.
            self._upper[start + held + len(functions.labels) : start + height] = np.inf
            start += height

    def mass_cost_reach(self, x: Array, materials: Array) -> tuple[float, float, float]:
        """The links' mass (kg), their cost (EUR) and the reach (m) of a design."""
        column = LINK_FIELDS.index
        slacks, width = np.zeros(len(self.space.problem.limits)), len(MATERIAL_FIELDS)
        totals = np.array([0.0, drives_cost(self.space.problem), 0.0])
        for link, functions in enumerate(self._links):
            own = np.concatenate([np.asarray(x)[numbers_of(self.space, link)], slacks])
            brought = np.array(functions.value(own, materials[width * link : width * (link + 1)], slacks + 1.0)[0])
            totals += brought.ravel()[[column("mass"), column("cost"), column("length")]]
        return float(totals[0]), float(totals[1]), float(totals[2])

    def solve(self, start: Array, materials: Array, pool: Pool, ask: Ask = BEST, *, error: float = 1e-3) -> Solution:
        """The best design for a pool of poses, from a start with about that error (m), or what else is asked for.

        Where drives have zones of stiffness an optimum is often at the corner between two, where the error has no
        derivative: their corners are rounded, less and less, each time from the solution before.
        """
        best: Solution | None = None
        for rounding in ROUNDINGS if self._cornered else ROUNDINGS[-1:]:
            near, size = (start, error) if best is None else (best.x, best.error)
            solution = self._solve(near, materials, pool, ask, size, rounding)
            best = solution if solution.solved or best is None or not best.solved else best
        assert best is not None
        return best

    def _solve(self, start: Array, materials: Array, pool: Pool, ask: Ask, error: float, rounding: float) -> Solution:
        lower, upper = self.space.bounds()
        if ask.within is not None:
            center, room = ask.within
            lower, upper = np.maximum(lower, center - room), np.minimum(upper, center + room)
        limits = self.space.problem.limits if ask.limits is None else ask.limits
        limits = [limit if number == ask.push else limit.loosened for number, limit in enumerate(limits)]
        count = len(limits)
        squared = max(FLOOR_MM2, (ask.floor * MM) ** 2)
        y = math.log(max(error - self.fixed_error, 1e-12) * MM)
        if ask.floor > 0.0:
            y = 0.5 * math.log(math.exp(2.0 * y) + squared)
        errors, held = self.slotted(pool)
        values, unknowns = self._pose_values(errors, held)
        give = np.full(count, 10.0 if ask.relax else 0.0)
        equal = np.array([-item if x.relation == "==" else 0.0 for x, item in zip(limits, give, strict=True)])
        slack, pushed = 0.05 * give, np.zeros(count)
        if ask.push is not None:
            give[ask.push], equal[ask.push], pushed[ask.push] = _FARTHEST, -_FARTHEST, 1.0
        price = np.zeros(count)
        if ask.elastic is not None:
            price = np.array(ask.elastic)
            give = np.where(price > 0.0, _FARTHEST, 0.0)
            equal = np.array([-item if x.relation == "==" else 0.0 for x, item in zip(limits, give, strict=True)])
            slack = np.where(price > 0.0, _GIVEN, 0.0)
        weights = (0.0, 1.0) if ask.relax else (0.0 if ask.push is not None or ask.elastic is not None else 1.0, 0.0)
        # Sizes that start on a bound leave IPOPT no interior: start a hair inside.
        inside = np.clip(start, lower + _INSIDE * (upper - lower), upper - _INSIDE * (upper - lower))
        least, most = self._joint_bounds(errors, len(unknowns))
        low, high = self._row_bounds(errors)
        x0 = np.array([*self._among_all(inside), y, *slack, *unknowns])
        p = [*materials, *weights, *pushed, *price, *(limit.value for limit in limits), squared, rounding, *values]
        p += self._kinds
        lbx = np.array([*self._among_all(lower), -40.0, *equal, *least])
        ubx = np.array([*self._among_all(upper), 40.0, *give, *most])
        settled = self._settled(lbx == ubx)
        broken = False
        if settled.any():
            # These rows are facts: a solver that has nothing to move stumbles over what they are off by in rounding.
            row = np.array(self._problem.rows(x0, p)[0]).ravel()[settled]
            broken = not bool(np.all((row >= low[settled] - _ROUNDED) & (row <= high[settled] + _ROUNDED)))
            low, high = np.where(settled, -np.inf, low), np.where(settled, np.inf, high)
        result = self.solver(x0=x0, p=p, lbx=lbx, ubx=ubx, lbg=low, ubg=high)
        stats = self.solver.stats()
        point = np.array(result["x"]).ravel()
        multipliers = np.array(result["lam_g"]).ravel()
        size = self._problem.count
        poses = point[size + 1 + count :]
        return Solution(
            x=np.clip(point[self._numbers], lower, upper),
            error=self.fixed_error + _without_floor(min(float(point[size]), 60.0), squared) / MM,
            solved=bool(stats["success"]) and not broken,
            limit_prices=tuple(self._limit_prices(multipliers)),
            bound_prices=np.array(result["lam_x"]).ravel()[self._numbers],
            shape_prices=tuple((label, float(multipliers[place])) for label, place in self._shapes.items()),
            slacks=tuple(point[size + 1 : size + 1 + count].tolist()),
            active=self._active(multipliers, errors, held),
            message=str(stats["return_status"]),
            strayed=self._strayed(poses, multipliers),
            infeasible=broken,
        )

    def _among_all(self, x: Array) -> Array:
        """A combination's numbers among those of all that share the problem; what its shapes lack is zero."""
        every = np.zeros(self._problem.count)
        every[self._numbers] = x
        return every

    def _settled(self, fixed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which rows no number moves that is free: those that depend on the fixed ones alone."""
        settled = np.ones(len(self._lower), dtype=bool)
        rows, numbers = self.moving
        settled[rows[~fixed[numbers]]] = False
        return settled

    def slotted(self, pool: Pool) -> tuple[list[ErrorCut], dict[str, list[Cut]]]:
        """The poses in their slots: those of the error, and those of each family by its name."""
        problem = self.space.problem
        slots = {family.name: self.room.slots(family.name, family.groups(problem)) for family in self.pose_families}
        held = {name: filled(pool.of(name), slot) for name, slot in slots.items()}
        return filled(pool.errors, self.room.errors), held

    def _pose_values(self, errors: list[ErrorCut], held: Mapping[str, list[Cut]]) -> tuple[list[float], list[float]]:
        """The poses' parameters, and where anchored poses start."""
        values, unknowns = error_parameters(self.model, errors, anchored=self._anchored)
        for cuts in held.values():
            for cut in cuts:
                values += [*cut.q, *cut.more]
        return values, unknowns

    def greatest_error(self, x: Array, materials: Array, pool: Pool) -> float:
        """The worst error (m) of a design over a pool, the radii that no design changes left out; 0 without poses."""
        values, unknowns = self._pose_values(*self.slotted(pool))
        count = len(self.space.problem.limits)
        fixed = [*materials, 1.0, 0.0, *[0.0] * (2 * count), *[1.0] * count, FLOOR_MM2, ROUNDINGS[-1]]
        numbers = [*self._among_all(x), 0.0, *[0.0] * count, *unknowns]
        rows = self._problem.rows(numbers, [*fixed, *values, *self._kinds])[0]
        squares = np.exp(np.array(rows).ravel()[self._place["errors"]]) - FLOOR_MM2
        return math.sqrt(max(float(squares.max(initial=0.0)), 0.0)) / MM

    def _joint_bounds(self, errors: Sequence[ErrorCut], count: int) -> tuple[Array, Array]:
        """Bounds of the anchored poses. Without a joint to spare a place is reached within the joints' ranges or not at
        all; an arm that has one may reach it in another way, which the next round finds, unless all that is asked is
        that some way is left."""
        size = self.model.arm.size
        low, high = (np.tile(end, count // size) for end in self._ends)
        if size > self._axes:
            will = self._at_will(errors)
            return np.where(will, low, -np.inf), np.where(will, high, np.inf)
        return low, high

    def _strayed(self, q: Array, multipliers: Array) -> bool:
        """Whether an anchored pose that holds the solution is outside the joint ranges."""
        low, high = self._ends
        poses = q.reshape(-1, self.model.arm.size)
        outside = np.any((poses < low - _STRAYED) | (poses > high + _STRAYED), axis=1)
        return bool(np.any(outside & (np.abs(multipliers[self._place["errors"]])[: len(poses)] > _PRESSING)))

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """The ends of the joints' ranges."""
        return climbing_bounds(self.model.arm, *joint_box(self.model.arm, self.space.problem.workspace))

    @property
    def _axes(self) -> int:
        """How many coordinates of the tip count."""
        return 2 if self.model.arm.flat else 3

    def _at_will(self, errors: Sequence[ErrorCut]) -> NDArray[np.bool_]:
        """Which joints of the anchored poses move as they like."""
        free = [cut.anchor is not None and cut.anchor.free for cut in errors] if self._anchored else []
        return np.repeat(np.array(free, dtype=bool), self.model.arm.size)

    def _row_bounds(self, errors: Sequence[ErrorCut]) -> tuple[Array, Array]:
        """What each row lies between: nothing holds a pose that is free on its side or in its joints to spare."""
        lower, upper = self._lower, self._upper
        spare = self.model.arm.size - self._axes
        if not self._anchored or spare <= 0:
            return lower, upper
        lower, upper = lower.copy(), upper.copy()
        for slot, cut in enumerate(errors):
            if cut.anchor is not None and cut.anchor.free:
                upper[self._place["sides"].start + slot] = np.inf
                first = self._equal_from + slot * self.model.arm.size + self._axes
                lower[first : first + spare], upper[first : first + spare] = -np.inf, np.inf
        return lower, upper

    def _active(self, multipliers: Array, errors: list[ErrorCut], held: Mapping[str, list[Cut]]) -> Pool:
        """The poses that hold the solution."""

        def pressing(name: str, count: int) -> Array:
            rows = np.abs(multipliers[self._place[name]])
            return (
                rows.reshape(count, -1).max(axis=1) > _PRESSING if count and len(rows) else np.zeros(count, dtype=bool)
            )

        active = pressing("errors", len(errors))
        pool = Pool().with_errors(tuple(cut for cut, holds in zip(errors, active, strict=True) if holds))
        for name, cuts in held.items():
            # Every pose of a family has equally many rows.
            active = pressing(name, len(cuts))
            pool = pool.with_cuts(name, [cut for cut, holds in zip(cuts, active, strict=True) if holds])
        return pool

    def _limit_prices(self, multipliers: Array) -> list[float]:
        prices = [0.0] * len(self.space.problem.limits)
        slopes = {family.name: family.slope for family in self.pose_families}
        places = {**self._place, "links": self._of_links}
        for name in ("design", "links", *slopes):
            for number, value in zip(self._limits[name], multipliers[places[name]], strict=True):
                prices[number] += slopes.get(name, 1.0) * float(value)
        return prices
