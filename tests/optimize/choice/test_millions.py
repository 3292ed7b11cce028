"""More combinations than can have a bound each: one bound for all, against every combination solved by formulas."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.optimize.choice import large_choice, near_ties
from linkwright.core.optimize.choice.at_once.branching import Branching
from linkwright.core.optimize.choice.chooser import Chooser
from linkwright.core.optimize.choice.picks import count
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.run import optimise
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many
from tests.optimize.choice.test_many_combinations import least_sags, materials, two_rods

CATALOGUE = """[aluminium-2024-t3, aluminium-5083-h111, aluminium-6061-t6, aluminium-6063-t6, aluminium-6082-t6,
  aluminium-7075-t6, steel-s235, steel-s275, steel-s355, steel-s460n, titanium-ti-6al-4v, magnesium-az31b]"""


def test_bound_on_all_is_below_every_combination_and_near_the_best(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken_for_many(monkeypatch)
    monkeypatch.setattr(large_choice, "MOST_AT_ONCE", 0)
    rows = materials(12, 3)
    result = optimise(two_rods(tmp_path, rows))
    every = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    assert result.objective == pytest.approx(every.min(), rel=1e-3)
    assert result.bound_of == "all_designs"
    assert 0.97 * every.min() <= result.lower_bound <= every.min() * (1.0 + 1e-4)
    assert result.lower_bound_gap == pytest.approx(1.0 - result.lower_bound / result.objective)
    near = np.argwhere(every < every.min() * 1.0299)
    found = {tie.materials for tie in result.near_ties} | {
        tuple(link.material.name for link in result.arm.links if link.material is not None)
    }
    assert result.near_ties_left == 0
    assert found >= {(f"m{one}", f"m{other}") for one, other in near.tolist()}
    for near_tie in result.near_ties:
        one, other = (int(str(name)[1:]) for name in near_tie.materials)
        assert near_tie.objective == pytest.approx(every[one, other], rel=1e-3)


def test_near_ties_that_are_given_up_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where one combination after another keeps no limit the search for near ties ends; what it leaves is said."""
    taken_for_many(monkeypatch)
    monkeypatch.setattr(large_choice, "MOST_AT_ONCE", 0)
    rows = materials(20, 6)
    problem = two_rods(tmp_path, rows)
    every = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    near = int((every < every.min() * 1.0299).sum()) - 1
    monkeypatch.setattr(near_ties, "_IN_VAIN", 0)
    result = optimise(problem)
    assert near > 0
    assert not result.near_ties
    assert result.near_ties_left >= near
    assert result.objective == pytest.approx(every.min(), rel=1e-2)


def test_what_one_combination_could_reach_is_told_from_what_it_could_not(tmp_path: Path) -> None:
    """No combination that reaches an objective is held to be out of its reach, and most of the hopeless are."""
    rows = materials(12, 3)
    branching = Branching(Chooser(context_of(two_rods(tmp_path, rows)), None, None), large_choice.WANTED)
    assert branching.run(20) is not None
    every = least_sags(rows, 4.0, 20.0, (0.01, 0.09))
    names = [item.name for _, item in branching.relaxation.cells[0].options]
    enough = 1.2 * float(every.min())
    could = np.zeros(every.shape, dtype=bool)
    for place, _ in np.ndenumerate(every):
        chosen = [names.index(f"m{number}") for number in place]
        could[place] = branching.could_reach(branching.options.combination(chosen), enough)
    assert could[every < enough * (1.0 - 1e-3)].all()  # the closest grid of diameters is a thousandth coarse
    assert np.mean(~could[every > 2.0 * enough]) > 0.5


def test_thirteen_millions_are_bounded_at_once(tmp_path: Path) -> None:
    text = (
        f"choose: {{section: [circle, tube, rectangle, triangle, ellipse], material: {CATALOGUE}}}\n"
        "subject_to: {mass: '<= 6 kg', section_size: [20 mm, 120 mm], thickness: [2 mm, 10 mm]}\n"
    )
    arm = jointed((400, 420, 420, 200), ranged(*["-90 90"] * 4))
    problem = problem_of(tmp_path, arm, text)
    assert count(problem) == 60**4 > large_choice.MOST_AT_ONCE
    worker = Chooser(context_of(problem), None, None)
    proof = Branching(worker, large_choice.WANTED).run(20)
    assert proof is not None
    assert proof.reached
    assert proof.bound <= worker.objective <= proof.bound * 1.0101
