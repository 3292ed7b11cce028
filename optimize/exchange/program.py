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
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.prices import fixed_price, price_by_length
from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.evaluation import heaviest_carried
from linkwright.core.arm.figures import Cut, Held, Limit, OfDesign, PoseFamily, Totals
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.arm.worst.workspace import climbing_bounds, joint_box
from linkwright.core.optimize.problem import Problem
from linkwright.core.units.quantities import InputError

from .binding_poses import ErrorCut, Pool, Room
from .design import MATERIAL_FIELDS, DesignSpace, expressions
from .rows import (
    FLOOR_MM2,
    MM,
    Rows,
    error_parameters,
    error_rows,
    filled,
    limit_rows,
    pose_rows,
    shape_rows,
    symbol,
)
from .scenarios import Scenarios, scenario_column

Array = NDArray[np.float64]

_INSIDE = 1e-6
_ROUNDED = 1e-9
"""By how much a row that nothing moves may be broken: what a section may be off by, too."""
_FARTHEST = 30.0
"""How far (in its logarithm) a limit can be pushed, or can give way."""
_GIVEN, _SMOOTH = 0.5, 1e-7
"""Where the slacks of limits that may give way start, and what rounds the corner of one that may give either way."""
_PRESSING = 1e-7
"""A pose whose multiplier is below this does not hold the design."""
ROUNDINGS = (3e-2, 1e-3, 2e-5)
"""Of the corners between drives' zones, one solution after the other, as parts of the load at which a zone ends."""
_STRAYED = 1e-6
"""A pose that is farther (rad, m) beyond a joint's range is outside it."""
TURN = 0.5
"""An anchored pose may turn its joints by this (rad) in one round: further, it could flip to another way of reaching
its place, with another error."""


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
    instead of the objective: its slack is how far it went. `turn` is how far (rad) anchored poses may turn their
    joints. `within` keeps the design so near (in each of the optimiser's numbers) to another one. `floor` (m) is that
    of the error rows: about the error itself where it may pass through zero. With `relax` the limits may give way and
    the least relaxation is sought instead of the objective. With `elastic` the sum of the limits' slacks, each times
    its number of those, is made least instead; a limit with 0 is kept.
    """

    limits: Sequence[Limit] | None = None
    push: int | None = None
    turn: float = TURN
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
    limit (in its logarithm) had to be relaxed, `active` are the poses that hold the solution. `turned`: an anchored
    pose was held back from turning further, so that another round from here may do better. `strayed`: one that has
    joints to spare left a joint's range, so that its error may be none of the workspace's.
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
    turned: bool
    strayed: bool = False
    infeasible: bool = False
    """Found without a design although limits might give way, or broken whatever the design is: more than a failure of
    the solver."""
    multipliers: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    """The multipliers of the rows, block by block: `errors`, `own` and each family's; see `Program.slotted`."""


def carried_mass(problem: Problem) -> float:
    """The mass (kg) that counts in `total_mass` beside that of the links: joints, motors, what hangs on links, and the
    heaviest payload."""
    return heaviest_carried(problem.arm, problem.load_cases)


def drives_cost(problem: Problem) -> float:
    """What of the arm's cost (EUR) neither sections nor lengths decide: drives, rigid links, work by the part; raises
    `InputError` where the problem asks for a cost and one of these has no price."""
    total, lacking = fixed_price(problem.arm)
    if lacking and problem.needs("cost"):
        raise InputError(problem.file, "cost", f"{lacking}; `cost` in the arm file gives one")
    return 0.0 if lacking else total


def unchosen_cost(problem: Problem) -> float:
    """`drives_cost` with the work by the metre on links whose lengths stay as they are, EUR."""
    elastic = sum(link.length for link in problem.arm.links if link.section is not None)
    return drives_cost(problem) + price_by_length(problem.arm) * elastic


def anchored(space: DesignSpace) -> bool:
    """Whether poses must follow the design: the workspace is fixed in space and the lengths are free."""
    return space.free_lengths and space.problem.workspace.in_space


def fixed_error(model: ErrorModel) -> float:
    """The part of the worst error (m) that no design changes: in the plane the clearances add up, whatever the pose."""
    return float(model.cases[0].radii.sum()) if model.planar and model.arm.play == "worst" else 0.0


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


def _sizes(limits: Sequence[Limit], slack: Any) -> Any:
    """How far each limit gives way, smooth where it may give either way."""
    sizes = [
        ca.sqrt(slack[k] ** 2 + _SMOOTH**2) if limit.relation == "==" else slack[k] for k, limit in enumerate(limits)
    ]
    return ca.vertcat(*sizes) if sizes else ca.SX(0, 1)


class Program:
    """The compiled finite problem for one combination of shapes, with room for a number of poses."""

    def __init__(
        self,
        space: DesignSpace,
        model: ErrorModel,
        families: Sequence[tuple[PoseFamily[Any], Any]],
        room: Room,
        scenarios: Scenarios | None = None,
    ) -> None:
        """`families`: those that hold a limit, with what they prepared; `room`: how many binding poses of each kind
        there is room for; `scenarios`: what the error is held for instead of the arm as it is."""
        self.space, self.room = space, room
        self.model = model if scenarios is None else scenarios.model
        self._groups = len(model.cases) * (1 if scenarios is None else len(scenarios.held))
        self.pose_families = tuple(family for family, _ in families)
        problem = space.problem
        levels = symbol("level", len(problem.limits))
        limits = tuple(replace(limit, value=levels[k]) for k, limit in enumerate(problem.limits))
        self._anchored = anchored(space)
        self._cornered = any(case.zones for case in model.cases)
        x, y, slack = symbol("x", len(space.variables)), symbol("y"), symbol("slack", len(limits))
        materials, weights = symbol("material", len(MATERIAL_FIELDS) * problem.arm.size), symbol("weight", 2)
        pushed, elastic = symbol("pushed", len(limits)), symbol("elastic", len(limits))
        design = expressions(space, x, materials)
        design = replace(design, cost=design.cost + drives_cost(problem))
        self.fixed_error = fixed_error(model)
        floor = symbol("floor")
        worst = self.fixed_error + ca.exp(y) * ca.sqrt(ca.fmax(1.0 - floor * ca.exp(-2.0 * y), 1e-12)) / MM
        rounding = symbol("rounding")
        columns = [design.beam_column]
        if scenarios is not None:
            columns = [scenario_column(space.problem.arm, design, scenario) for scenario in scenarios.held]
        errors = error_rows(
            self.model, design, columns, y, room.errors, floor, rounding=rounding, anchored=self._anchored
        )
        held = Held(limits, slack)
        by_pose = {
            family.name: pose_rows(
                family, prepared, problem.arm.size, held, design, room.slots(family.name, family.groups(problem))
            )
            for family, prepared in families
        }
        of_design, equal = limit_rows(held, design, worst, carried_mass(problem) + design.hung)
        shapes = shape_rows(space, design)
        sides = Rows(errors.sides)
        blocks = {"errors": errors, **by_pose, "design": of_design, "shapes": shapes, "sides": sides}
        self._blocks = blocks
        rows = [row for block in blocks.values() for row in block.rows]
        self._lower = np.full(len(rows) + len(errors.equalities), -np.inf)
        self._lower[len(rows) :] = 0.0
        self._equal_from = len(rows)
        self._place: dict[str, slice] = {}
        start = 0
        for name, block in blocks.items():
            self._place[name] = slice(start, start + len(block.rows))
            start += len(block.rows)
        self._lower[self._place["design"]] = np.where(equal, 0.0, -np.inf)
        follows, objective = problem.objective.follows, y
        if isinstance(follows, OfDesign):
            totals = Totals(design.mass, design.cost, design.reach, carried_mass(problem) + design.hung)
            objective = ca.log(ca.SX(follows.value(totals)))
        parameters = [materials, weights, pushed, elastic, levels, floor, rounding, *errors.parameters]
        parameters += [parameter for block in by_pose.values() for parameter in block.parameters]
        every = [*rows, *errors.equalities]
        program = {
            "x": ca.vertcat(x, y, slack, *errors.unknowns),
            "p": ca.vertcat(*parameters),
            "f": weights[0] * objective
            + weights[1] * (ca.sumsqr(slack) + 1e-3 * ca.sum1(ca.fabs(slack)))
            + ca.dot(pushed, slack)
            + ca.dot(elastic, _sizes(limits, slack)),
            "g": ca.vertcat(*every) if every else ca.SX(0, 1),
        }
        self._solver = ca.nlpsol("design", "ipopt", program, ipopt_options())
        self._rows = self._solver.get_function("nlp_jac_g")
        self._moving = np.array(self._rows.sparsity_out("jac_g_x").get_triplet(), dtype=int)
        self._figures = ca.Function("figures", [x, materials], [design.beam_column, design.strength_column])
        squares = [ca.exp(row + 2.0 * y) - floor for row in errors.rows]
        self._squares = ca.Function(
            "squares",
            [x, ca.vertcat(*errors.unknowns), ca.vertcat(*parameters)],
            [ca.vertcat(*squares) if squares else ca.SX(0, 1)],
        )
        self._mass = ca.Function("mass", [x, materials], [design.mass, design.cost, design.reach])

    def figures(self, x: Array, materials: Array) -> tuple[Array, Array]:
        """Beam values and strength values of a design."""
        beam, strength = self._figures(x, materials)
        return np.array(beam).ravel(), np.array(strength).ravel()

    def mass_cost_reach(self, x: Array, materials: Array) -> tuple[float, float, float]:
        """The links' mass (kg), their cost (EUR) and the reach (m) of a design."""
        mass, cost, reach = self._mass(x, materials)
        return float(mass), float(cost), float(reach)

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
        least, most = self._turns(errors, np.array(unknowns), ask.turn)
        low, high = self._row_bounds(errors)
        x0 = np.array([*inside, y, *slack, *unknowns])
        p = [*materials, *weights, *pushed, *price, *(limit.value for limit in limits), squared, rounding, *values]
        lbx, ubx = np.array([*lower, -40.0, *equal, *least]), np.array([*upper, 40.0, *give, *most])
        settled = self._settled(lbx == ubx)
        broken = False
        if settled.any():
            # These rows are facts: a solver that has nothing to move stumbles over what they are off by in rounding.
            row = np.array(self._rows(x0, p)[0]).ravel()[settled]
            broken = not bool(np.all((row >= low[settled] - _ROUNDED) & (row <= high[settled] + _ROUNDED)))
            low, high = np.where(settled, -np.inf, low), np.where(settled, np.inf, high)
        result = self._solver(x0=x0, p=p, lbx=lbx, ubx=ubx, lbg=low, ubg=high)
        stats = self._solver.stats()
        point = np.array(result["x"]).ravel()
        multipliers = np.array(result["lam_g"]).ravel()
        size = len(lower)
        poses = point[size + 1 + count :]
        shapes = multipliers[self._place["shapes"]]
        return Solution(
            x=np.clip(point[:size], lower, upper),
            error=self.fixed_error + _without_floor(min(float(point[size]), 60.0), squared) / MM,
            solved=bool(stats["success"]) and not broken,
            limit_prices=tuple(self._limit_prices(multipliers)),
            bound_prices=np.array(result["lam_x"]).ravel()[:size],
            shape_prices=tuple(zip(self._blocks["shapes"].labels, shapes.tolist(), strict=True)),
            slacks=tuple(point[size + 1 : size + 1 + count].tolist()),
            active=self._active(multipliers, errors, held),
            message=str(stats["return_status"]),
            strayed=self._strayed(poses),
            infeasible=broken,
            turned=bool(np.any((np.abs(poses - unknowns) > 0.999 * ask.turn) & ~self._at_will(errors))),
            multipliers=MappingProxyType({name: multipliers[place] for name, place in self._place.items()}),
        )

    def _settled(self, fixed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which rows no number moves that is free: those that depend on the fixed ones alone."""
        settled = np.ones(len(self._lower), dtype=bool)
        rows, numbers = self._moving
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
        squares = np.array(self._squares(x, unknowns, [*fixed, *values])).ravel()
        return math.sqrt(max(float(squares.max(initial=0.0)), 0.0)) / MM

    def _turns(self, errors: Sequence[ErrorCut], q: Array, turn: float) -> tuple[Array, Array]:
        """Bounds of the anchored poses. Without a joint to spare a place is reached within the joints' ranges or not at
        all; an arm that has one may reach it in another way, which the next round finds, unless all that is asked is
        that some way is left."""
        arm = self.model.arm
        low, high = climbing_bounds(arm, *joint_box(arm, self.space.problem.workspace))
        times = len(q) // arm.size
        low, high = np.tile(low, times), np.tile(high, times)
        if arm.size > self._axes:
            will = self._at_will(errors)
            return np.where(will, low, q - turn), np.where(will, high, q + turn)
        return np.maximum(q - turn, low), np.minimum(q + turn, high)

    def _strayed(self, q: Array) -> bool:
        """Whether one of the anchored poses is outside the joint ranges."""
        low, high = climbing_bounds(self.model.arm, *joint_box(self.model.arm, self.space.problem.workspace))
        poses = q.reshape(-1, self.model.arm.size)
        return bool(np.any((poses < low - _STRAYED) | (poses > high + _STRAYED)))

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
        lower, upper = self._lower, np.zeros(len(self._lower))
        spare = self.model.arm.size - self._axes
        if not self._anchored or spare <= 0:
            return lower, upper
        lower = lower.copy()
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
        for name in ("design", *slopes):
            for number, value in zip(self._blocks[name].limits, multipliers[self._place[name]], strict=True):
                prices[number] += slopes.get(name, 1.0) * float(value)
        return prices
