"""The finite problem of the exchange: the best design for the binding poses found so far, by IPOPT with exact
derivatives.

minimise y over (x, y) subject to log |e(x; pose)|^2 <= 2 y for every pose of the pool: the worst error is then exp(y)
mm
plus the sum of the clearance discs' radii, which no design changes. Masses and errors enter through their logarithms:
where they are posynomials of the dimensions, the problem is convex. Poses, play, materials and the values of limits are
parameters, so one compiled program serves every round of the exchange, every choice of materials and every point of a
trade-off. Every limit has a slack, fixed at zero unless an infeasible problem is to be explained, or that limit itself
is pushed as far as it goes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from arm.drive_load import DriveCase
from arm.model import ErrorModel
from arm.strength import StrengthCase
from arm.workspace import climbing_bounds, joint_box
from materials.quantities import InputError

from .design import MATERIAL_FIELDS, DesignSpace, expressions
from .pool import ErrorCut, ModeCut, Pool, Room, StrengthCut
from .problem import Limit, Problem
from .rows import (
    MM,
    OWN_ROWS,
    Rows,
    error_parameters,
    error_rows,
    filled,
    limit_rows,
    mode_rows,
    shape_rows,
    strength_rows,
    symbol,
    torque_rows,
)

Array = NDArray[np.float64]

_INSIDE = 1e-6
_FARTHEST = 30.0
"""How far (in its logarithm) a limit can be pushed."""
_PRESSING = 1e-7
"""A pose whose multiplier is below this does not hold the design."""
TURN = 0.5
"""An anchored pose may turn its joints by this (rad) in one round: further, it could flip to another way of reaching
its place, with another error."""


def ipopt_options() -> dict[str, Any]:
    """The options with which every finite problem is solved."""
    return {
        "print_time": False,
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
class Solution:
    """What IPOPT found for a pool: the optimiser's numbers and the worst error over the pool (m).

    `limit_prices` holds a multiplier for each limit of the problem (d objective / d log limit), `bound_prices` those of
    the variables' bounds, `shape_prices` those of the sections' own constraints by text. `slacks` are how far each
    limit (in its logarithm) had to be relaxed, `active` are the poses that hold the solution. `turned`: an anchored
    pose was held back from turning further, so that another round from here may do better.
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


def carried_mass(problem: Problem) -> float:
    """The mass (kg) that counts in `total_mass` beside the links': joints and the heaviest payload."""
    return sum(joint.mass for joint in problem.arm.joints) + max(case.mass for case in problem.load_cases)


def drives_cost(problem: Problem) -> float:
    """What the arm's actuators cost together (EUR); raises `InputError` where the problem asks for a cost and the
    price of one is not known."""
    total = 0.0
    for number, joint in enumerate(problem.arm.joints, start=1):
        if joint.actuator is not None and joint.actuator.cost is None:
            if problem.minimize != "cost" and not problem.limit("cost"):
                return 0.0
            message = f"no price is known of {joint.actuator.name} (joint {number}); give one in your own file"
            raise InputError(problem.file, "cost", message)
        total += 0.0 if joint.actuator is None else joint.actuator.cost or 0.0
    return total


def anchored(space: DesignSpace) -> bool:
    """Whether poses must follow the design: the workspace is fixed in space and the lengths are free."""
    return space.free_lengths and space.problem.workspace.kind != "joints"


def fixed_error(model: ErrorModel) -> float:
    """The part of the worst error (m) that no design changes: in the plane the clearances add up, whatever the pose."""
    return float(model.cases[0].radii.sum()) if model.planar and model.arm.play == "worst" else 0.0


class Program:
    """The compiled finite problem for one combination of shapes, with room for a number of poses."""

    def __init__(
        self,
        space: DesignSpace,
        model: ErrorModel,
        strengths: Sequence[StrengthCase],
        room: Room,
        drives: Sequence[DriveCase] = (),
    ) -> None:
        """`room`: how many binding poses of each kind there is room for."""
        self.space, self.model, self.room = space, model, room
        problem = space.problem
        levels = symbol("level", len(problem.limits))
        limits = tuple(replace(limit, value=levels[k]) for k, limit in enumerate(problem.limits))
        self._anchored = anchored(space)
        x, y, slack = symbol("x", len(space.variables)), symbol("y"), symbol("slack", len(limits))
        materials, weights = symbol("material", len(MATERIAL_FIELDS) * problem.arm.size), symbol("weight", 2)
        pushed = symbol("pushed", len(limits))
        design = expressions(space, x, materials)
        design = replace(design, cost=design.cost + drives_cost(problem))
        self.fixed_error = fixed_error(model)
        worst = self.fixed_error + ca.exp(y) / MM
        errors = error_rows(model, design, y, room.errors, anchored=self._anchored)
        stress = strength_rows(limits, strengths, design, materials, slack, room.strengths)
        modes = mode_rows(space, limits, design, slack, room.modes)
        own, equal = limit_rows(limits, design, worst, carried_mass(problem), slack)
        shapes = shape_rows(space, design)
        sides = Rows(errors.sides)
        families = {"errors": errors, "stress": stress, "modes": modes, "own": own, "shapes": shapes, "sides": sides}
        families["torque"] = torque = torque_rows(space, limits, drives, design, slack, room.torques)
        self._families = families
        rows = [row for family in families.values() for row in family.rows]
        self._lower = np.full(len(rows) + len(errors.equalities), -np.inf)
        self._lower[len(rows) :] = 0.0
        self._place: dict[str, slice] = {}
        start = 0
        for name, family in families.items():
            self._place[name] = slice(start, start + len(family.rows))
            start += len(family.rows)
        self._lower[self._place["own"]] = np.where(equal, 0.0, -np.inf)
        objective = {
            "max_error": y,
            "mass": ca.log(design.mass),
            "total_mass": ca.log(design.mass + carried_mass(problem)),
            "cost": ca.log(ca.SX(design.cost)),
        }[problem.minimize]
        parameters = [materials, weights, pushed, levels, *errors.parameters, *stress.parameters, *modes.parameters]
        parameters += torque.parameters
        every = [*rows, *errors.equalities]
        program = {
            "x": ca.vertcat(x, y, slack, *errors.unknowns),
            "p": ca.vertcat(*parameters),
            "f": weights[0] * objective
            + weights[1] * (ca.sumsqr(slack) + 1e-3 * ca.sum1(ca.fabs(slack)))
            + ca.dot(pushed, slack),
            "g": ca.vertcat(*every) if every else ca.SX(0, 1),
        }
        self._solver = ca.nlpsol("design", "ipopt", program, ipopt_options())
        self._figures = ca.Function("figures", [x, materials], [design.beam_column, design.strength_column])
        self._mass = ca.Function("mass", [x, materials], [design.mass, design.cost, design.reach])

    def figures(self, x: Array, materials: Array) -> tuple[Array, Array]:
        """Beam values and strength values of a design."""
        beam, strength = self._figures(x, materials)
        return np.array(beam).ravel(), np.array(strength).ravel()

    def mass_cost_reach(self, x: Array, materials: Array) -> tuple[float, float, float]:
        """The links' mass (kg), their cost (EUR) and the reach (m) of a design."""
        mass, cost, reach = self._mass(x, materials)
        return float(mass), float(cost), float(reach)

    def holds(self, pool: Pool) -> bool:
        """Whether the program has room for a pool."""
        return self.room.holds(pool.room(len(self.model.cases)))

    def solve(
        self,
        start: Array,
        materials: Array,
        pool: Pool,
        *,
        error: float = 1e-3,
        relax: bool = False,
        turn: float = TURN,
        limits: Sequence[Limit] | None = None,
        push: int | None = None,
    ) -> Solution:
        """The best design for a pool of poses, from a start with about that error (m).

        With `relax` the limits may give way and the least relaxation is sought instead of the objective. `turn` is how
        far (rad) anchored poses may turn their joints. `limits` are the problem's with other values. With `push` the
        limit of that number is made as tight as it can be instead of the objective: its slack is how far it went.
        """
        lower, upper = self.space.bounds()
        own = self.space.problem.limits if limits is None else limits
        count = len(own)
        y = math.log(max(error - self.fixed_error, 1e-12) * MM)
        errors, strengths = filled(pool.errors, self.room.errors), filled(pool.strengths, self.room.strengths)
        modes = [pool.modes[min(slot, len(pool.modes) - 1)] for slot in range(self.room.modes)]
        values, unknowns = error_parameters(self.model, errors, anchored=self._anchored)
        for cut in strengths:
            values += list(cut.q)
        for mode in modes:
            values += [*mode.q, mode.payload, *mode.shape]
        torques = filled(pool.torques, self.room.torques)
        for cut in torques:
            values += list(cut.q)
        give = np.full(count, 10.0 if relax else 0.0)
        equal = np.array([-each if x.relation == "==" else 0.0 for x, each in zip(own, give, strict=True)])
        slack, pushed = 0.05 * give, np.zeros(count)
        if push is not None:
            give[push], equal[push], pushed[push] = _FARTHEST, -_FARTHEST, 1.0
        weights = (0.0, 1.0) if relax else (0.0 if push is not None else 1.0, 0.0)
        # Sizes that start on a bound leave IPOPT no interior: start a hair inside.
        inside = np.clip(start, lower + _INSIDE * (upper - lower), upper - _INSIDE * (upper - lower))
        least, most = self._turns(np.array(unknowns), turn)
        result = self._solver(
            x0=[*inside, y, *slack, *unknowns],
            p=[*materials, *weights, *pushed, *(limit.value for limit in own), *values],
            lbx=[*lower, -40.0, *equal, *least],
            ubx=[*upper, 40.0, *give, *most],
            lbg=self._lower,
            ubg=np.zeros(len(self._lower)),
        )
        stats = self._solver.stats()
        point = np.array(result["x"]).ravel()
        multipliers = np.array(result["lam_g"]).ravel()
        size = len(lower)
        shapes = multipliers[self._place["shapes"]]
        return Solution(
            x=np.clip(point[:size], lower, upper),
            error=self.fixed_error + math.exp(min(float(point[size]), 60.0)) / MM,
            solved=bool(stats["success"]),
            limit_prices=tuple(self._limit_prices(multipliers)),
            bound_prices=np.array(result["lam_x"]).ravel()[:size],
            shape_prices=tuple(zip(self._families["shapes"].labels, shapes.tolist(), strict=True)),
            slacks=tuple(point[size + 1 : size + 1 + count].tolist()),
            active=self._active(multipliers, errors, strengths, modes, torques),
            message=str(stats["return_status"]),
            turned=bool(np.any(np.abs(point[size + 1 + count :] - unknowns) > 0.999 * turn)),
        )

    def _turns(self, q: Array, turn: float) -> tuple[Array, Array]:
        """Bounds of the anchored poses. Without a joint to spare a place is reached within the joints' ranges or not at
        all; an arm that has one may reach it in another way, which the next round finds."""
        arm = self.model.arm
        if arm.size > (2 if self.model.planar else 3):
            return q - turn, q + turn
        low, high = climbing_bounds(arm, *joint_box(arm, self.space.problem.workspace))
        times = len(q) // arm.size
        return np.maximum(q - turn, np.tile(low, times)), np.minimum(q + turn, np.tile(high, times))

    def _active(
        self,
        multipliers: Array,
        errors: list[ErrorCut],
        strengths: list[StrengthCut],
        modes: list[ModeCut],
        torques: list[StrengthCut],
    ) -> Pool:
        """The poses that hold the solution."""

        def pressing(name: str, count: int) -> Array:
            rows = np.abs(multipliers[self._place[name]])
            return (
                rows.reshape(count, -1).max(axis=1) > _PRESSING if count and len(rows) else np.zeros(count, dtype=bool)
            )

        pool = Pool()
        held = pressing("errors", len(errors))
        pool = pool.with_errors(tuple(cut for cut, holds in zip(errors, held, strict=True) if holds))
        held = pressing("stress", len(strengths))
        pool = pool.with_strengths(tuple(cut for cut, holds in zip(strengths, held, strict=True) if holds))
        held = pressing("torque", len(torques))
        pool = pool.with_torques(tuple(cut for cut, holds in zip(torques, held, strict=True) if holds))
        held = pressing("modes", len(modes))
        return pool.with_modes(tuple(dict.fromkeys(m for m, holds in zip(modes, held, strict=True) if holds)))

    def _limit_prices(self, multipliers: Array) -> list[float]:
        """A multiplier for each limit: its own row's, or the sum over the poses through which it holds."""
        sums: dict[str, float] = {}
        for family in ("stress", "modes", "torque"):
            for label, value in zip(self._families[family].labels, multipliers[self._place[family]], strict=True):
                sums[label] = sums.get(label, 0.0) + float(value)
        own = iter(multipliers[self._place["own"]].tolist())
        prices: list[float] = []
        for limit in self.space.problem.limits:
            if limit.name in OWN_ROWS:
                prices.append(next(own))
            else:
                # The frequency enters squared: one per cent of it is two per cent of its row.
                prices.append(sums.get(limit.name, 0.0) * (2.0 if limit.name == "first_frequency" else 1.0))
        return prices
