"""Problems for the tests, written to files and read back as people's are; brute force to hold the answers against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.optimize.choice import combinations as chooser
from linkwright.core.optimize.choice.combinations import choose, combinations
from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Exchange, Exchanged, context_of, first_pool
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.result import BindingLimit
from linkwright.core.sections.numeric import Array
from tests.arm.builders import PAPER_MATERIAL, rod_lines

ALUMINIUM = "aluminium-6061-t6"
DRIVE = ", mass: 2 kg, stiffness: 60 kN*m/rad"
IN_MM = ("max_error", "reach", "section_size", "thickness", "link_length")

PAPER_ARM = rod_lines([400, 420, 420]) + "payload: {mass: 0.77472 kg}\nleave_out: [shear_deformation]\n"


def problem_of(folder: Path, arm: str, problem: str) -> Problem:
    """The problem that the two texts describe; `arm.yaml` is named for it."""
    (folder / "arm.yaml").write_text(arm, encoding="utf-8")
    path = folder / "problem.yaml"
    path.write_text("arm: arm.yaml\n" + problem, encoding="utf-8")
    return read_problem(path)


def jointed(lengths_mm: Sequence[float], joints: Sequence[str], *, material: str = ALUMINIUM, rest: str = "") -> str:
    """An arm file of rods whose joints have keys of their own; it carries 3 kg unless `rest` says otherwise."""
    lines = "".join(
        f"  - joint: {{type: revolute{joint}}}\n"
        f"    link: {{length: {length:g} mm, section: {{shape: circle, diameter: 60 mm}}, material: {material}}}\n"
        for length, joint in zip(lengths_mm, joints, strict=True)
    )
    return "chain:\n" + lines + (rest or "payload: {mass: 3 kg}\n")


def ranged(*ranges: str, more: str = DRIVE) -> list[str]:
    """Joint keys: the ranges in degrees, each with the same further keys."""
    return [f"{more}, range: [{low} deg, {high} deg]" for low, high in (pair.split() for pair in ranges)]


def taken_for_many(monkeypatch: pytest.MonkeyPatch) -> None:
    """However few combinations there are, they are searched as too many to try each: no number of them is few."""
    monkeypatch.setattr(chooser, "MOST_EACH", 0)
    monkeypatch.setattr(chooser, "MOST_COMBINATIONS", 0)


def scanned_error(arm: Arm, loads: Sequence[LoadCase], *, poses: int = 60_000, seed: int = 3) -> float:
    """The worst error (m) over a full grid and as many random poses: never above the true worst."""
    ranges = np.array([joint.range for joint in arm.joints])
    random = np.random.default_rng(seed).uniform(ranges[:, 0], ranges[:, 1], (poses, arm.size))
    each = round(poses ** (1.0 / arm.size))
    grid = np.stack(np.meshgrid(*[np.linspace(*pair, each) for pair in ranges], indexing="ij"), axis=-1)
    return worst_at(arm, loads, np.vstack([random, grid.reshape(-1, arm.size)]))


def worst_at(arm: Arm, loads: Sequence[LoadCase], q: Array) -> float:
    """The worst error (m) over poses q (N, n) and load cases."""
    model, p = error_model(arm, loads), beam_values(beams_of(arm))
    results = [
        played(case.arrays(q, p), case.radii, arm.play, planar=model.planar, statistics=arm.statistics).error.max()
        for case in model.cases
    ]
    return float(max(results))


def best_value(problem: Problem) -> float:
    """The least objective, in mm, kg or EUR."""
    result = choose(context_of(problem))
    assert result is not None
    return result.objective * (1e3 if problem.minimize == "max_error" else 1.0)


def one_exchange(problem: Problem) -> tuple[Arm, Exchanged]:
    """The design and the exchange of a problem's first combination, from a single start."""
    context, pick = context_of(problem), combinations(problem)[0]
    space = design_space(problem, pick.shapes)
    materials = material_row(pick.materials, problem)
    start = starting_points(space, materials, 1)[0]
    pool = first_pool(context, space, start, pick.materials)
    done = Exchange(context, space).run(materials, pick.materials, pool, start)
    assert done is not None
    assert done.worst is not None
    return arm_of(space, done.x, pick.materials), done


def loosened(problem: Problem, limit: BindingLimit, step: float) -> Problem:
    """The problem with one limit moved by `step` of its units (mm, kg, EUR, Hz)."""
    by = step / (problem.figures[limit.name].factor if limit.name in problem.figures else 1e3)
    if limit.name in ("section_size", "thickness", "link_length"):
        low, high = problem.ranges[0].spans[limit.name]
        moved = (low, high + by) if "<=" in limit.text else (low + by, high)
        return problem.with_ranges(**{limit.name: moved})
    return replace(
        problem,
        limits=tuple(replace(x, value=x.value + by) if x.text == limit.text else x for x in problem.limits),
    )


def measured_price(problem: Problem, limit: BindingLimit, relative: float = 1e-3) -> float:
    """The price of a limit by central differences of problems optimised anew."""
    step = relative * limit.limit
    above, below = (best_value(loosened(problem, limit, sign * step)) for sign in (1.0, -1.0))
    return (above - below) / (2.0 * step)


__all__ = ["ALUMINIUM", "DRIVE", "PAPER_ARM", "PAPER_MATERIAL"]
