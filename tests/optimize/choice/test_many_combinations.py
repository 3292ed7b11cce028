"""More combinations than are tried one by one: the answer against every combination solved by formulas of its own."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.choice import combinations as chooser
from linkwright.core.optimize.choice.at_once.feasibility import Feasibility
from linkwright.core.optimize.choice.chooser import Chooser, Solved
from linkwright.core.optimize.choice.picks import Combination, combinations, count
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.infeasible.answer import Infeasible
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from tests.optimize.builders import jointed, problem_of, ranged

Integers = NDArray[np.intp]
GRAVITY = 9.81
LENGTHS, PAYLOAD, JOINT, STIFFNESS = (0.5, 0.4), 3.0, 2.0, 60e3


def materials(number: int, seed: int) -> Array:
    """Elastic modulus (Pa), density (kg/m^3) and price (EUR/kg) of so many materials that never were."""
    generator = np.random.default_rng(seed)
    rows = [
        (generator.uniform(40, 230), generator.uniform(1500, 8500), math.exp(generator.uniform(0, 4)))
        for _ in range(number)
    ]
    return np.array([(round(e, 3) * 1e9, round(d, 1), round(price, 3)) for e, d, price in rows])


def named(rows: Array) -> str:
    """The materials as a problem file has them."""
    entries = (
        f"{{name: m{k}, elastic_modulus: {e / 1e9:.3f} GPa, poisson_ratio: 0.3, density: {d:.1f} kg/m^3, "
        f"cost: {price:.3f} EUR/kg}}"
        for k, (e, d, price) in enumerate(rows)
    )
    return f"[{', '.join(entries)}]"


def two_rods(
    folder: Path, rows: Array, limits: str = "mass: '<= 4 kg', cost: '<= 20 EUR'", minimize: str = "max_error"
) -> Problem:
    """Two horizontal rods of any of the materials within limits, and between 10 and 90 mm thick."""
    arm = jointed((500, 400), ranged("-60 60", "0 60")) + "leave_out: [shear_deformation]\n"
    text = (
        f"minimize: {minimize}\nchoose: {{section: [circle], material: {named(rows)}}}\n"
        f"subject_to: {{{limits}, section_size: [10 mm, 90 mm]}}\n"
    )
    return problem_of(folder, arm, text)


def sag(first: Array, second: Array, rows: Array, one: Integers, other: Integers) -> Array:
    """How far the tip of two horizontal rods in line sags (m), by beam formulas: diameters (m), numbers of materials.

    Gere & Goodno, Mechanics of Materials, table H-1 (cantilever with a force, a moment and a uniform load).
    """
    (l1, l2), (area1, area2) = LENGTHS, (0.25 * math.pi * d**2 for d in (first, second))
    bend1, bend2 = (rows[k, 0] * math.pi * d**4 / 64 for k, d in ((one, first), (other, second)))
    w1, w2 = (rows[k, 1] * area * GRAVITY for k, area in ((one, area1), (other, area2)))
    tip = PAYLOAD * GRAVITY
    force = tip + w2 * l2 + JOINT * GRAVITY
    moment = tip * l2 + w2 * l2**2 / 2
    down = force * l1**3 / 3 / bend1 + moment * l1**2 / 2 / bend1 + w1 * l1**4 / 8 / bend1
    slope = force * l1**2 / 2 / bend1 + moment * l1 / bend1 + w1 * l1**3 / 6 / bend1
    own = tip * l2**3 / 3 / bend2 + w2 * l2**4 / 8 / bend2
    base = moment + force * l1 + w1 * l1**2 / 2
    return down + slope * l2 + own + base / STIFFNESS * (l1 + l2) + moment / STIFFNESS * l2


def least_sags(rows: Array, mass: float, cost: float, sizes: tuple[float, float]) -> Array:
    """The least sag (m) for each pair of materials within the limits: a grid over both diameters, then closer ones."""
    number = len(rows)
    one, other = (k.ravel()[:, None] for k in np.meshgrid(np.arange(number), np.arange(number), indexing="ij"))
    low, high = (np.full((number**2, 2), math.log(size)) for size in sizes)
    best = np.full(number**2, np.inf)
    for steps in (40, 16, 16, 16, 16):
        share = np.linspace(0.0, 1.0, steps)
        pairs = np.stack(np.meshgrid(share, share, indexing="ij"), axis=-1).reshape(-1, 2)
        d1, d2 = (np.exp(low[:, k, None] + (high - low)[:, k, None] * pairs[:, k]) for k in (0, 1))
        m1, m2 = (
            rows[k, 1] * 0.25 * math.pi * d**2 * length
            for k, d, length in zip((one, other), (d1, d2), LENGTHS, strict=True)
        )
        kept = (m1 + m2 <= mass) & (m1 * rows[one, 2] + m2 * rows[other, 2] <= cost)
        values = np.where(kept, sag(d1, d2, rows, one, other), np.inf)
        place = values.argmin(axis=1)
        best = np.minimum(best, values.min(axis=1))
        width = 1.5 * (high - low) / (steps - 1)
        middle = low + (high - low) * pairs[place]
        least, most = (math.log(size) for size in sizes)
        low, high = (np.clip(middle + sign * width, least, most) for sign in (-1.0, 1.0))
    return best.reshape(number, number)


def test_choice_among_1225_is_the_best_of_all(tmp_path: Path) -> None:
    """With a limit on the cost one link's material depends on the other's: going link by link ends 3 % worse."""
    rows = materials(35, 3)
    problem = two_rods(tmp_path, rows)
    assert count(problem) == 1225 > chooser.MOST_COMBINATIONS
    result = optimise(problem)
    by_hand = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    assert result.objective == pytest.approx(by_hand.min(), rel=1e-3)
    assert evaluate(result.arm, problem.workspace).max_error == pytest.approx(result.objective, rel=1e-4)
    place = np.unravel_index(int(by_hand.argmin()), by_hand.shape)
    assert [link.material and link.material.name for link in result.arm.links] == [f"m{k}" for k in place]
    assert (result.status, result.exhaustive, result.gap, result.combinations) == ("certified", True, 0.0, 1225)
    assert len(result.candidates) < 200


@pytest.mark.slow
def test_what_is_ruled_out_at_once_has_no_design(tmp_path: Path) -> None:
    """One combination without a design rules out others, and none of those has one by the formulas."""
    rows = materials(20, 5)
    least = least_sags(rows, 3.0, 12.0, (0.01, 0.09))
    asked = round(1e3 * float(np.quantile(least[np.isfinite(least)], 0.2)), 4)
    limits = f"mass: '<= 3 kg', max_error: '<= {asked} mm', cost: '<= 12 EUR'"
    problem = two_rods(tmp_path, rows, limits, "mass")
    context = context_of(problem)
    worker, told = Chooser(context, None, None), Feasibility(context)
    for pick in combinations(problem)[::7]:
        if not told.rules_out(pick):
            solved = worker.solve(pick, explain=True)
            if solved.relaxed is not None:
                told.learn(solved.exchange, solved.relaxed, pick, solved.pool)
    kept = least <= 1e-3 * asked
    assert not (told.impossible & kept).any()
    assert told.impossible.sum() > 0.8 * (~kept).sum()


@pytest.mark.slow
def test_all_near_ties_among_1156_are_solved(tmp_path: Path) -> None:
    """Materials that differ little, under a limit on the cost: every pair within 3 % of the best is listed."""
    generator = np.random.default_rng(11)
    rows = np.array(
        [
            (round(e, 3) * 1e9, round(d, 1), round(price, 3))
            for e, d, price in generator.uniform((55, 2500, 3), (75, 3500, 9), (34, 3))
        ]
    )
    problem = two_rods(tmp_path, rows)

    def stop(done: int, _: int, what: str) -> None:
        if what == "solving near ties" and done == 3:
            raise KeyboardInterrupt

    stopped = optimise(problem, progress=stop)
    assert stopped.interrupted
    assert len(stopped.near_ties) == 3
    result = optimise(problem)
    assert stopped.near_ties_left >= len(result.near_ties) - 3
    assert result.combinations == 1156 > chooser.MOST_COMBINATIONS
    by_hand = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    assert result.objective == pytest.approx(by_hand.min(), rel=1e-3)
    near = {(f"m{one}", f"m{other}") for one, other in np.argwhere(by_hand < by_hand.min() * 1.0299).tolist()}
    ties = {near_tie.materials: near_tie for near_tie in result.near_ties}
    assert len(near) > 5
    assert result.near_ties_left == 0
    assert set(ties) >= near - {tuple(link.material.name for link in result.arm.links if link.material is not None)}
    for names, tie in ties.items():
        one, other = (int(str(name)[1:]) for name in names)
        assert tie.objective == pytest.approx(by_hand[one, other], rel=1e-3)
        assert tie.mass <= 4.0 * (1.0 + 1e-6)
        assert tie.cost is not None
        assert tie.cost <= 20.0 * (1.0 + 1e-6)
        assert tie.first_frequency is not None


def test_what_a_limit_would_have_to_be_is_found_among_all(tmp_path: Path) -> None:
    """The least error that mass and cost allow, over pairs of materials most of which differ."""
    rows = materials(20, 3)
    least = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    limits = f"mass: '<= 4 kg', max_error: '<= {950 * least.min():.4f} mm', cost: '<= 20 EUR'"
    with pytest.raises(Infeasible) as caught:
        optimise(two_rods(tmp_path, rows, limits, "mass"))
    result = caught.value.infeasible
    assert result.verdict == "infeasible"
    needed = {limit.limit.name: limit.needed for limit in result.limits}
    assert needed["max_error"] == pytest.approx(least.min(), rel=2e-3)


def test_a_combination_that_fails_is_listed_and_the_gap_is_of_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The solver fails on the best one: what is known of the others stands, and nothing is called exhaustive."""
    rows = materials(15, 3)
    problem = two_rods(tmp_path, rows)
    least = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    lost = tuple(f"m{k}" for k in np.unravel_index(int(least.argmin()), least.shape))
    solve = Chooser.solve

    def fails(chooser: Chooser, pick: Combination, *, explain: bool = False) -> Solved:
        found = solve(chooser, pick, explain=explain)
        if tuple(material and material.name for material in pick.materials) != lost:
            return found
        chooser.note(pick, None, "unsolved")
        return replace(found, objective=None, solution=None, relaxed=None, unsolved=True)

    monkeypatch.setattr(Chooser, "solve", fails)
    result = optimise(problem)
    rest = np.where(least == least.min(), np.inf, least)
    assert result.objective == pytest.approx(rest.min(), rel=1e-3)
    assert [item.materials for item in result.unsolved] == [lost]
    assert (result.status, result.exhaustive, result.optimum) == ("searched", False, "local")
    assert result.gap is not None
    assert result.gap <= 1e-4
