"""Many combinations whose lengths are free: rows against the model, the bound against every pair by beam formulas."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from linkwright.core.arm.errors.model import BEAM_FIELDS
from linkwright.core.optimize.choice.at_once.cells import COLUMNS, LENGTH
from linkwright.core.optimize.choice.at_once.lengths import LengthRows
from linkwright.core.optimize.choice.pose_products import features_of
from linkwright.core.optimize.exchange.binding_poses import ErrorCut, Pool
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many
from tests.optimize.choice.test_many_combinations import materials, named

GRAVITY = 9.81


def test_rows_are_the_error_at_any_lengths(tmp_path: Path) -> None:
    """At bent poses, under a force, with drives that give and with backlash to both sides."""
    joints = ranged("-90 90", "-90 90", "-90 90", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin")
    arm = jointed((400, 300, 350), joints, rest="payload: {mass: 2 kg, force: [30 N, -40 N, 0 N]}\n")
    text = "subject_to: {mass: '<= 9 kg', reach: '== 1050 mm', link_length: [150 mm, 800 mm]}\n"
    problem = problem_of(tmp_path, arm, text)
    context = context_of(problem)
    p = numeric_beams(problem.arm, problem.load_cases)
    generator = np.random.default_rng(4)
    for signs in ((1.0, 1.0, 1.0), (-1.0, 1.0, -1.0)):
        q = tuple(float(x) for x in generator.uniform(-1.5, 1.5, 3))
        cut = ErrorCut(q, 0, signs, (0.0, 0.0, 0.0))
        rows = LengthRows(context).rows_of(Pool((cut,)), problem.arm, p, 1.0)
        assert rows is not None
        row = rows[-1]
        for _ in range(5):
            design = p.reshape(3, -1).copy()
            design[:, BEAM_FIELDS.index("length")] = generator.uniform(0.15, 0.8, 3)
            for name in ("mass_per_length", "flexural_rigidity_height", "axial_rigidity"):
                design[:, BEAM_FIELDS.index(name)] *= generator.uniform(0.3, 3.0, 3)
            y = np.zeros((3, len(COLUMNS)))
            features = features_of(design.ravel(), 3)
            y[:, : features.shape[1] - 1] = np.log(features[:, :-1])
            y[:, LENGTH] = np.log(design[:, BEAM_FIELDS.index("length")])
            arrays = context.model.cases[0].arrays(np.array([q]), design.reshape(1, -1))
            true = arrays.vector[0] + np.array(signs) @ arrays.intervals[0]
            assert row.value(y.ravel()) == pytest.approx(float(np.linalg.norm(true)), rel=1e-6)


def _sag(d: Array, lengths: Array, rows: Array, pair: tuple[int, int]) -> Array:
    """How far the tip of two horizontal rods sags (m); Gere & Goodno, Mechanics of Materials, table H-1."""
    (l1, l2), area = lengths, 0.25 * math.pi * d**2
    bend1, bend2 = (rows[k, 0] * math.pi * own**4 / 64 for k, own in zip(pair, d, strict=True))
    w1, w2 = (rows[k, 1] * own * GRAVITY for k, own in zip(pair, area, strict=True))
    tip, joint = 3.0 * GRAVITY, 2.0 * GRAVITY
    force, moment = tip + w2 * l2 + joint, tip * l2 + w2 * l2**2 / 2
    down = force * l1**3 / 3 / bend1 + moment * l1**2 / 2 / bend1 + w1 * l1**4 / 8 / bend1
    slope = force * l1**2 / 2 / bend1 + moment * l1 / bend1 + w1 * l1**3 / 6 / bend1
    base = moment + force * l1 + w1 * l1**2 / 2
    drives = base / 60e3 * (l1 + l2) + moment / 60e3 * l2
    return down + slope * l2 + tip * l2**3 / 3 / bend2 + w2 * l2**4 / 8 / bend2 + drives


def _least_sag(rows: Array, pair: tuple[int, int], mass: float, reach: float) -> float:
    """The least over lengths (between 0.3 and 0.7 m) and diameters (0.01 to 0.09 m), the mass used up."""

    def of_length(first: float) -> float:
        lengths = np.array([first, reach - first])
        share = np.linspace(0.02, 0.98, 4000) * mass
        parts = np.stack([share, mass - share])
        density = rows[list(pair), 1]
        d = np.clip(np.sqrt(parts / (0.25 * math.pi * density[:, None] * lengths[:, None])), 0.01, 0.09)
        return float(_sag(d, lengths, rows, pair).min())

    grid = np.linspace(0.3, reach - 0.3, 13)
    start = grid[int(np.argmin([of_length(x) for x in grid]))]
    step = float(grid[1] - grid[0])
    bounds = (max(0.3, start - step), min(reach - 0.3, start + step))
    result: Any = minimize_scalar(of_length, bounds=bounds, method="bounded")
    return float(result.fun)


def test_bound_is_below_every_pair_and_near_the_best(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken_for_many(monkeypatch)
    rows = materials(6, 5)
    arm = jointed((500, 400), ranged("-60 60", "0 60")) + "leave_out: [shear_deformation]\n"
    text = (
        f"choose: {{section: [circle], material: {named(rows)}}}\n"
        "subject_to: {mass: '<= 4 kg', reach: '== 900 mm', link_length: [300 mm, 700 mm], "
        "section_size: [10 mm, 90 mm]}\n"
    )
    result = optimise(problem_of(tmp_path, arm, text))
    every = [_least_sag(rows, pair, 4.0, 0.9) for pair in itertools.product(range(6), range(6))]
    assert result.objective == pytest.approx(min(every), rel=1e-3)
    assert result.lower_bound <= min(every) * (1.0 + 1e-4)
    assert result.bound_of == "all_designs"
    assert result.basis == "bounded"
    assert result.gap is not None
    assert result.gap <= 0.0101
