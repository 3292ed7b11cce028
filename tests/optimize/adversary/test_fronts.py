"""Random fronts with mixed combinations, held point by point against `optimise` under the limit of the point."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.figures import FIGURES, Limit
from linkwright.core.optimize.choice.picks import combinations
from linkwright.core.optimize.exchange.exchange import Exchange
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.point import Search
from linkwright.core.optimize.tradeoff.question import question
from tests.optimize.adversary.fronts import WITHIN, front_of, held, random_front
from tests.optimize.builders import problem_of

FRONTS = int(os.environ.get("PROBLEMS", "0"))
"""Random fronts; none is one of them, on which links differ. `make problems` takes more, finer ones."""
ACCURACY, EVERY = (0.05, 3) if FRONTS else (0.3, 5)
TWO = """\
chain:
  - joint: {range: [-90 deg, 90 deg], mass: 3 kg, stiffness: 60000 N*m/rad}
    link: {length: 500 mm, section: {shape: tube, diameter: 70 mm, thickness: 4 mm}, material: aluminium-6061-t6}
  - joint: {range: [-120 deg, 120 deg], mass: 2 kg, stiffness: 30000 N*m/rad}
    link: {length: 400 mm, section: {shape: tube, diameter: 60 mm, thickness: 4 mm}, material: aluminium-6061-t6}
payload: {mass: 5 kg}
"""
MIXED = (
    "choose: {section: [tube, rectangular_tube], material: [aluminium-6061-t6, steel-s355]}\n"
    "subject_to: {mass: '<= 6 kg', cost: '<= 40 EUR', section_size: [20 mm, 90 mm], thickness: [2 mm, 10 mm]}\n"
)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(FRONTS) if FRONTS else (2,))
def test_points_are_what_optimise_finds(seed: int, tmp_path: Path) -> None:
    front = front_of(random_front(tmp_path, seed), ACCURACY)
    compared = held(front, every=EVERY)
    # One design may be best in both figures.
    assert compared or len(front.envelope.points) < 3
    assert all(abs(item.off) <= WITHIN for item in compared)


def test_a_mixed_combination_is_best_between_two_plain_ends(tmp_path: Path) -> None:
    """Light arms are of tubes, stiff ones of rectangular tubes; between them the links differ, and combinations that
    one end excludes are in the running."""
    asked = question(problem_of(tmp_path, TWO, MIXED), "mass", "max_error")
    search = Search(asked, asked.problem, lambda _: None)
    least = search.best(asked.x_limit, math.inf, [])
    most = search.best(asked.y_limit, asked.cap(asked.x_limit), [])
    assert least is not None
    assert most is not None
    # The least mass with nearly the best error excludes most combinations under that error, and only there.
    assert search.best(asked.x_limit, most.badness * (1.0 + 1e-4), [most]) is not None
    between = search.best(asked.y_limit, 0.42738, [least, most])
    assert between is not None
    assert (between.unsolved, between.combination.shapes) == (0, ("rectangular_tube", "tube"))
    assert between.badness == pytest.approx(8.2331e-3, rel=2e-4)
    rest = tuple(limit for limit in asked.given.limits if limit.name != "mass")
    best = optimise(replace(asked.given, minimize="max_error", limits=(*rest, Limit(FIGURES["mass"], "<=", 0.42738))))
    assert between.badness == pytest.approx(best.objective, rel=WITHIN)


def test_a_bound_excludes_only_under_its_own_limit_and_tighter_ones(tmp_path: Path) -> None:
    asked = question(problem_of(tmp_path, TWO, MIXED), "mass", "max_error")
    search = Search(asked, asked.problem, lambda _: None)
    pick = combinations(asked.problem)[0]
    on_x, on_y = asked.x_limit, asked.y_limit
    # No design with an error of at most 2 has a mass below 5: with a mass of at most 4 the error is above 2, no more.
    search.learn(on_x, pick, 2.0, 5.0)
    assert search.bound_on(on_x, pick, 2.0) == search.bound_on(on_x, pick, 1.0) == pytest.approx(5.0, rel=1e-7)
    assert search.bound_on(on_x, pick, 2.1) == 0.0
    assert search.bound_on(on_y, pick, 4.0) == pytest.approx(2.0, rel=1e-7)
    assert search.bound_on(on_y, pick, 5.0) == 0.0
    # A combination that cannot be at a mass of 1 whatever the error.
    search.learn(on_y, pick, 1.0, math.inf)
    assert search.bound_on(on_y, pick, 0.9) == math.inf
    assert search.bound_on(on_y, pick, 1.1) == pytest.approx(2.0, rel=1e-7)
    assert search.bound_on(on_x, pick, math.inf) == 1.0


def test_a_solver_that_fails_excludes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A combination on which it fails at one point is looked at again at the next, and counted until then."""
    asked = question(problem_of(tmp_path, TWO, MIXED), "mass", "max_error")
    search = Search(asked, asked.problem, lambda _: None)
    least = search.best(asked.x_limit, math.inf, [])
    assert least is not None
    bound = Exchange.bound
    lost = ("rectangular_tube", "tube")

    def fails(exchange: Exchange, *given: object, **more: object) -> object:
        if exchange.space.shapes == lost:
            exchange.infeasible = False
            return None
        return bound(exchange, *given, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(Exchange, "bound", fails)
    without = search.best(asked.y_limit, 0.45, [least])
    monkeypatch.undo()
    assert without is not None
    assert without.unsolved > 0
    assert without.combination.shapes != lost
    again = search.best(asked.y_limit, 0.42738, [least, without])
    assert again is not None
    assert (again.unsolved, again.combination.shapes) == (0, lost)
