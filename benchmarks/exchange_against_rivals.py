"""The exchange against general optimisers.

Two problems, each of three diameters and three lengths, the worst error over the joint ranges, a mass and a reach: the
small one of `benchmarks.exchange_against_grid`, with one load case and no play, and the same arm with backlash in every
joint under three load cases, where play has eight corners at each pose. All rivals share one vectorised evaluator of
the error at 13^3 poses, exact gradients included, and the exchange's start and bounds.

- SLSQP (SciPy), exact gradients: the epigraph with a row for each pose, load case and corner of play.
- SLSQP, finite differences: the same without gradients.
- SLSQP, few poses: the poses that are worst at the start and those that turn out worst at its answers, until the grid
  has none worse. This is an exchange itself, with exact gradients but no certificate and nothing but error, mass and
  reach: what ours costs beyond that is said, and has no target.

All sides set their model up anew, and that counts. Each answer is held against the certified worst error over all poses
between. Seconds are of CPU.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import casadi as ca
import numpy as np
from scipy.optimize import minimize

from benchmarks.exchange_against_grid import MASS, REACH, Side, begun, by_exchange, grid
from linkwright.core.arm.compiled.vectorise import vectorise
from linkwright.core.arm.errors.lost_motion import sign_vertices
from linkwright.core.optimize.exchange.design import arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.exchange.expressions import expressions
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.sections.numeric import Array

TARGETS = {"SLSQP, exact gradients": 5.0, "SLSQP, finite differences": 20.0}
_WORST = 24
"""Poses that a round of SLSQP begins with and adds at most."""


@dataclass(frozen=True)
class Answer:
    """The optimiser's numbers, and seconds."""

    x: Array
    seconds: float


class Model:
    """The vectorised evaluator: log of the error (mm) at poses, mass and reach, each with its gradient."""

    def __init__(self, context: Context, problem: Problem) -> None:
        self.pick, self.space, materials, self.start = begun(problem)
        self.problem, self.context = problem, context
        self.lower, self.upper = (np.array(bound) for bound in self.space.bounds())
        x, q = ca.SX.sym("x", len(self.space.variables)), ca.SX.sym("q", problem.arm.size)
        design = expressions(self.space, x, ca.SX(ca.DM(materials)))
        sizes: list[ca.SX] = []
        for case in context.model.cases:
            outputs = case.function(q, design.beam_column)
            plays = len(case.error.intervals)
            for signs in sign_vertices(plays):
                corner = sum((signs[k] * outputs[1][3 * k : 3 * k + 3] for k in range(plays)), outputs[0])
                sizes.append(0.5 * ca.log(1e6 * ca.dot(corner, corner) + 1e-14))
        self.rows = len(sizes)
        size = ca.vertcat(*sizes)
        sums = ca.vertcat(ca.log(design.mass / MASS), ca.log(design.reach / REACH))
        self._size = vectorise([q, x], [size])
        self._gradient = vectorise([q, x], [ca.vec(ca.jacobian(size, x).T)])
        self._sums = vectorise([x], [sums])
        self._slopes = ca.Function("slopes", [x], [ca.jacobian(sums, x)])
        self.poses = grid(problem)

    def sizes(self, x: Array, rows: Array | None = None) -> Array:
        """Logarithm of the error (mm) at each pose in each case and corner, pose after pose, or at some of those."""
        if rows is None:
            return self._size(self.poses, x)[0].ravel()
        poses, place = np.unique(rows // self.rows, return_inverse=True)
        return self._size(self.poses[poses], x)[0][place, rows % self.rows]

    def gradients(self, x: Array, rows: Array) -> Array:
        """Its gradient in some of those rows, (N, n)."""
        poses, place = np.unique(rows // self.rows, return_inverse=True)
        result = self._gradient(self.poses[poses], x)[0].reshape(len(poses), self.rows, len(x))
        return result[place, rows % self.rows]

    def sums(self, x: Array) -> Array:
        """Logarithms of mass and reach over what they should be, (N, 2) for designs (N, n)."""
        return self._sums(np.atleast_2d(x))[0]

    def slopes(self, x: Array) -> Array:
        """Their gradients, (2, n)."""
        return np.array(self._slopes(x))

    def true(self, x: Array) -> float:
        """The certified worst error over all poses, mm."""
        beams = numeric_beams(arm_of(self.space, x, self.pick.materials), self.problem.load_cases)
        return 1e3 * self.context.search.worst(beams).error


def by_slsqp(model: Model, *, exact: bool, few: bool = False) -> Array:
    """The epigraph over all poses, or over few and more of them round by round until the grid has none worse."""
    x = model.start
    sizes = model.sizes(x)
    kept = np.argsort(-sizes)[: _WORST if few else len(sizes)]
    y = float(sizes.max())
    count = len(x)
    for _ in range(20):
        constraints = [
            {"type": "ineq", "fun": lambda z, kept=kept: z[-1] - model.sizes(z[:-1], kept)},
            {"type": "ineq", "fun": lambda z: -model.sums(z[:-1])[0, :1]},
            {"type": "eq", "fun": lambda z: model.sums(z[:-1])[0, 1:]},
        ]
        if exact:

            def rows(z: Array, kept: Array = kept) -> Array:
                return np.hstack([-model.gradients(z[:-1], kept), np.ones((len(kept), 1))])

            constraints[0]["jac"] = rows
            constraints[1]["jac"] = lambda z: np.append(-model.slopes(z[:-1])[0], 0.0)[None]
            constraints[2]["jac"] = lambda z: np.append(model.slopes(z[:-1])[1], 0.0)[None]
        result = minimize(
            lambda z: z[-1],
            np.append(x, y),
            jac=(lambda _: np.eye(count + 1)[-1]) if exact else None,
            bounds=[*zip(model.lower, model.upper, strict=True), (-40.0, 40.0)],
            constraints=constraints,
            method="SLSQP",
            options={"ftol": 1e-9, "maxiter": 200},
        )
        x = np.clip(result.x[:-1], model.lower, model.upper)
        sizes = model.sizes(x)
        y = float(sizes.max())
        if y <= result.x[-1] + 1e-5:
            break
        kept = np.union1d(kept, np.argsort(-sizes)[:_WORST])
    return x


def _timed(way: Callable[[Model], Array], context: Context, problem: Problem) -> Answer:
    began = time.process_time()
    result = way(Model(context, problem))
    return Answer(result, time.process_time() - began)


@dataclass(frozen=True)
class Rival:
    """A rival's answer: how much worse (%) its true worst error is than ours, whether it keeps the limits, its seconds
    of CPU and how many times ours that is."""

    name: str
    worse: float
    kept: bool
    seconds: float
    ratio: float


def played_problem(arm: str, problem: str) -> tuple[str, str]:
    """The same with backlash in every joint, under three load cases."""
    cases = "{payload: {mass: 3 kg}}, {payload: {mass: 0 kg}, force: [43 N, 0 N, 0 N]}, "
    cases += "{payload: {mass: 1 kg}, force: [-60 N, 60 N, 0 N]}"
    return arm.replace("stiffness:", "backlash: 0.2 arcmin, stiffness:"), f"{problem}load_cases: [{cases}]\n"


def compared(arm: str, problem_text: str, rounds: int) -> tuple[Side, list[Rival]]:
    """Our side and all rivals on one problem."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.yaml").write_text(arm, encoding="utf-8")
        (Path(folder) / "problem.yaml").write_text(problem_text, encoding="utf-8")
        problem = read_problem(Path(folder) / "problem.yaml")
    context = context_of(problem)
    model = Model(context, problem)
    ways: dict[str, tuple[Callable[[Model], Array], int]] = {
        "SLSQP, exact gradients": (partial(by_slsqp, exact=True), rounds),
        "SLSQP, finite differences": (partial(by_slsqp, exact=False), rounds),
        "SLSQP, few poses": (partial(by_slsqp, exact=True, few=True), rounds),
    }
    ours = min((by_exchange(context, problem) for _ in range(rounds + 1)), key=lambda side: side.seconds)
    rivals: list[Rival] = []
    for name, (way, times) in ways.items():
        answer = min((_timed(way, context, problem) for _ in range(times)), key=lambda answer: answer.seconds)
        heavy, off = model.sums(answer.x)[0]
        worse = 100.0 * (model.true(answer.x) / (1e3 * ours.true) - 1.0)
        rivals.append(Rival(name, worse, max(heavy, abs(off)) <= 1e-6, answer.seconds, answer.seconds / ours.seconds))
    return ours, rivals
