"""The exchange against a full grid, SciPy's optimisers, and Bonmin on a discrete choice."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import casadi as ca
import numpy as np

from benchmarks.exchange_against_grid import ARM, EACH, MASS, PROBLEM, REACH, TARGET
from benchmarks.exchange_against_grid import compared as against_grid
from benchmarks.exchange_against_rivals import TARGETS, played_problem
from benchmarks.exchange_against_rivals import compared as against_rivals
from linkwright.core.optimize.choice.picks import combinations
from linkwright.core.optimize.exchange.design import (
    MATERIAL_FIELDS,
    design_space,
    material_row,
    starting_points,
)
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.exchange.expressions import expressions
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.run import optimise

from .row import Row, at_least

MATERIALS = ("aluminium-6061-t6", "steel-s355", "titanium-ti-6al-4v")
_BONMIN_EACH = 5
"""Poses along each joint in Bonmin's program: with 13 its B-BB takes far longer still."""


def grid(*, quick: bool) -> list[Row]:
    """Ratios of CPU time to one program over a grid of poses."""
    ours, same, mapped = against_grid(quick=quick)
    return [
        at_least(
            f"one IPOPT program over {EACH}^3 poses, the same code",
            same.seconds / ours.seconds,
            TARGET,
            f"the exchange takes {1e3 * ours.seconds:.0f} ms, certified; the grid's answer is "
            f"{100 * (same.true / same.claimed - 1):.2f} % worse than it claims",
        ),
        at_least("the same, the pose function mapped over the poses", mapped.seconds / ours.seconds, None),
    ]


def optimisers(*, quick: bool) -> list[Row]:
    """Ratios of CPU time to general optimisers, all answers held against the certified worst error."""
    rows: list[Row] = []
    for what, (arm, text) in {
        "one load case, no play": (ARM, PROBLEM),
        "three load cases, backlash": played_problem(ARM, PROBLEM),
    }.items():
        own, rivals = against_rivals(arm, text, 1 if quick else 3)
        for rival in rivals:
            kept = "" if rival.kept else "; it breaks a limit"
            seconds = f"{1e3 * rival.seconds:.0f} ms to {1e3 * own.seconds:.0f} ms"
            note = f"{seconds}, its answer {rival.worse:+.3f} %{kept}"
            rows.append(at_least(f"{rival.name} ({what})", rival.ratio, TARGETS.get(rival.name), note))
    return [*rows, _bonmin()]


def _bonmin() -> Row:
    """A material of three for each of three links, with free diameters and lengths."""
    name = f"Bonmin's B-BB, a material of {len(MATERIALS)} for each link, {_BONMIN_EACH}^3 poses"
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.yaml").write_text(ARM, encoding="utf-8")
        chosen = f"choose: {{material: [{', '.join(MATERIALS)}]}}\n"
        (Path(folder) / "problem.yaml").write_text(PROBLEM + chosen, encoding="utf-8")
        problem = read_problem(Path(folder) / "problem.yaml")
        began = time.process_time()
        ours = optimise(problem).after.worst.error
        seconds = time.process_time() - began
    began = time.process_time()
    result = _by_bonmin(problem)
    other = time.process_time() - began
    if result is None:
        return Row(name, "no answer", note=f"it failed after {other:.1f} s; ours took {seconds:.2f} s, certified")
    worse = 100.0 * (result / ours - 1.0)
    note = f"{other:.1f} s to {seconds:.2f} s, its answer {worse:+.2f} %, both held over all poses"
    return at_least(name, other / seconds, None, note)


def _by_bonmin(problem: Problem) -> float | None:
    """The true worst error (m) of Bonmin's design."""
    context = context_of(problem)
    picks = combinations(problem)
    space = design_space(problem, picks[0].shapes)
    size = problem.arm.size
    table = np.array(
        [material_row((pick.materials[0],) * size, problem)[: len(MATERIAL_FIELDS)] for pick in _each(picks)]
    )
    x, z, y = ca.MX.sym("x", len(space.variables)), ca.MX.sym("z", len(table) * size), ca.MX.sym("y")
    xs, zs = ca.SX.sym("x", x.numel()), ca.SX.sym("z", z.numel())
    shares = ca.reshape(zs, len(table), size)
    materials = ca.vec(ca.mtimes(ca.DM(table.T), shares))
    design = expressions(space, xs, materials)
    figures = ca.Function("figures", [xs, zs], [design.beam_column, ca.SX(design.mass), ca.SX(design.reach)])
    case = context.model.cases[0]
    qs, ps = ca.SX.sym("q", size), ca.SX.sym("p", case.p.numel())
    error = 1e3 * case.function(qs, ps)[0]
    pose = ca.Function("pose", [qs, ps], [ca.log(ca.dot(error, error) + 1e-14)])
    axes = [np.linspace(*joint.range, _BONMIN_EACH) for joint in problem.arm.joints]
    poses = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, size)
    beams, mass, reach = figures(x, z)
    rows = pose.map(len(poses))(ca.DM(poses.T), ca.repmat(beams, 1, len(poses)))
    sums = ca.sum1(ca.reshape(z, len(table), size)).T - 1.0
    program = {
        "x": ca.vertcat(x, y, z),
        "f": y,
        "g": ca.vertcat(rows.T - 2.0 * y, ca.log(mass / MASS), ca.log(reach / REACH), sums),
    }
    options = {"discrete": [False] * (x.numel() + 1) + [True] * z.numel(), "print_time": False}
    options["bonmin"] = {"algorithm": "B-BB", "bb_log_level": 0, "nlp_log_level": 0, "print_level": 0, "sb": "yes"}
    solver = ca.nlpsol("bonmin", "bonmin", program, options)
    lower, upper = space.bounds()
    start = starting_points(space, material_row(picks[0].materials, problem), 1)[0]
    guess = np.eye(len(table))[[0] * size].ravel()
    result = solver(
        x0=[*start, 0.0, *guess],
        lbx=[*lower, -40.0, *[0.0] * z.numel()],
        ubx=[*upper, 40.0, *[1.0] * z.numel()],
        lbg=[*[-np.inf] * (len(poses) + 1), *[0.0] * (size + 1)],
        ubg=[0.0] * (len(poses) + 2 + size),
    )
    if not solver.stats()["success"]:
        return None
    point = np.array(result["x"]).ravel()
    weights = np.round(point[len(start) + 1 :])
    beam_values = np.array(figures(point[: len(start)], weights)[0]).ravel()
    return context.search.worst(beam_values).error


def _each(picks: list) -> list:  # type: ignore[type-arg]
    """One combination for each material, all links alike."""
    return [pick for pick in picks if len({material.name for material in pick.materials}) == 1]
