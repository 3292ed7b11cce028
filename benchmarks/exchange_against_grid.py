"""The exchange against one program over a full grid of poses, for the same design problem.

Three diameters, three lengths and the epigraph's variable; 13^3 = 2,197 poses. Both sides are given the same physics
function, the same start and the same IPOPT options, build their program and solve it; derivatives are exact on both.
The grid is taken twice: as the same program that the exchange solves, with all 2,197 poses in its pool (the target's
side: one epigraph, the same code), and with the pose function mapped over them (CasADi's `map`), which builds and runs
faster than copies written out. The exchange's answer is certified over all poses between; the grid's holds at its own
poses only.
"""

from __future__ import annotations

import math
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from linkwright.core.optimize.choice.picks import Combination, combinations
from linkwright.core.optimize.exchange.binding_poses import ErrorCut, Pool
from linkwright.core.optimize.exchange.design import (
    DesignSpace,
    design_space,
    material_row,
    numeric_beams,
    starting_points,
)
from linkwright.core.optimize.exchange.design import arm_of as design_arm
from linkwright.core.optimize.exchange.exchange import Context, Exchange, context_of, first_pool
from linkwright.core.optimize.exchange.expressions import expressions
from linkwright.core.optimize.exchange.program import ipopt_options
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.sections.numeric import Array

TARGET = 200.0
AGREEMENT = 1e-3
EACH = 13
ARM = """
chain:
  - joint: {type: revolute, stiffness: 60 kN*m/rad, mass: 2 kg, range: [-30 deg, 30 deg]}
    link: {length: 400 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, stiffness: 60 kN*m/rad, mass: 2 kg, range: [40 deg, 140 deg]}
    link: {length: 420 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, stiffness: 60 kN*m/rad, mass: 1 kg, range: [30 deg, 150 deg]}
    link: {length: 420 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
payload: {mass: 3 kg}
"""
MASS, REACH = 10.0, 1.24
PROBLEM = """
arm: arm.yaml
subject_to: {mass: '<= 10 kg', reach: '== 1240 mm', link_length: [200 mm, 700 mm], section_size: [10 mm, 300 mm]}
"""


@dataclass(frozen=True)
class Side:
    """One side's answer: what it claims (m), what is true of its design (m), whether that is certified, seconds."""

    claimed: float
    true: float
    certified: bool
    seconds: float
    note: str


def compared(*, quick: bool) -> tuple[Side, Side, Side]:
    """The best of the rounds of the exchange, of the same program over the grid, and of the mapped one, their answers
    held against each other."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.yaml").write_text(ARM, encoding="utf-8")
        (Path(folder) / "problem.yaml").write_text(PROBLEM, encoding="utf-8")
        problem = read_problem(Path(folder) / "problem.yaml")
    context = context_of(problem)
    by_exchange(context, problem)
    ours, whole, mapped = [], [], []
    for _ in range(1 if quick else 3):
        whole.append(_by_full_pool(context, problem))
        mapped.append(_by_mapped_grid(context, problem))
        ours += [by_exchange(context, problem) for _ in range(5)]
    best, other, quicker = (min(sides, key=lambda side: side.seconds) for sides in (ours, whole, mapped))
    off = max(abs(side.true / best.true - 1.0) for side in (other, quicker))
    if not (off <= AGREEMENT and best.certified):
        raise SystemExit(f"the sides differ by {off:.1e}, or ours is not certified: there is nothing to compare")
    return best, other, quicker


def begun(problem: Problem) -> tuple[Combination, DesignSpace, Array, Array]:
    """The only combination of a problem, its variables, its materials' row, and where all sides start."""
    pick = combinations(problem)[0]
    space, materials = design_space(problem, pick.shapes), material_row(pick.materials, problem)
    return pick, space, materials, starting_points(space, materials, 1)[0]


def by_exchange(context: Context, problem: Problem) -> Side:
    """The exchange's side."""
    began = time.process_time()
    pick, space, materials, start = begun(problem)
    pool = first_pool(context, space, start, pick.materials)
    done = Exchange(context, space).run(materials, pick.materials, pool, start)
    seconds = time.process_time() - began
    if done is None or done.worst is None:
        raise SystemExit("the exchange found no design")
    note = f"{len(done.iterations)} rounds, {done.pool.size} poses"
    return Side(done.solution.error, done.worst.error, done.certified and done.converged, seconds, note)


def _by_full_pool(context: Context, problem: Problem) -> Side:
    began = time.process_time()
    pick, space, materials, start = begun(problem)
    pool = Pool(errors=tuple(ErrorCut(tuple(q.tolist()), 0, (), (0.0, 0.0, 0.0)) for q in grid(problem)))
    solution = Exchange(context, space).program(pool, spare=False).solve(start, materials, pool)
    seconds = time.process_time() - began
    if not solution.solved:
        raise SystemExit("the grid's program was not solved")
    beams = numeric_beams(design_arm(space, solution.x, pick.materials), problem.load_cases)
    return Side(solution.error, context.search.worst(beams).error, False, seconds, f"{pool.size} poses")


def grid(problem: Problem) -> np.ndarray:
    """The poses of the grid."""
    axes = [np.linspace(*joint.range, EACH) for joint in problem.arm.joints]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _by_mapped_grid(context: Context, problem: Problem) -> Side:
    began = time.process_time()
    pick, space, materials, start = begun(problem)
    poses = grid(problem)
    case = context.model.cases[0]
    xs, qs, ps = ca.SX.sym("x", len(space.variables)), ca.SX.sym("q", problem.arm.size), ca.SX.sym("p", case.p.numel())
    design = expressions(space, xs, ca.SX(ca.DM(materials)))
    figures = ca.Function("figures", [xs], [design.beam_column, ca.SX(design.mass), ca.SX(design.reach)])
    error = 1e3 * case.function(qs, ps)[0]
    pose = ca.Function("pose", [qs, ps], [ca.log(ca.dot(error, error) + 1e-14)])
    x, y = ca.MX.sym("x", len(space.variables)), ca.MX.sym("y")
    beams, mass, reach = figures(x)
    rows = pose.map(len(poses))(ca.DM(poses.T), ca.repmat(beams, 1, len(poses)))
    program = {
        "x": ca.vertcat(x, y),
        "f": y,
        "g": ca.vertcat(rows.T - 2.0 * y, ca.log(mass / MASS), ca.log(reach / REACH)),
    }
    solver = ca.nlpsol("grid", "ipopt", program, ipopt_options())
    lower, upper = space.bounds()
    count = len(poses)
    result = solver(
        x0=[*start, 0.0],
        lbx=[*lower, -40.0],
        ubx=[*upper, 40.0],
        lbg=[*([-np.inf] * (count + 1)), 0.0],
        ubg=[0.0] * (count + 2),
    )
    seconds = time.process_time() - began
    if not solver.stats()["success"]:
        raise SystemExit("the grid's program was not solved")
    found = np.array(result["x"]).ravel()
    beams_found = numeric_beams(design_arm(space, found[:-1], pick.materials), problem.load_cases)
    true = context.search.worst(beams_found).error
    return Side(math.exp(found[-1]) / 1e3, true, False, seconds, f"{solver.stats()['iter_count']} iterations of IPOPT")
