"""Free lengths over a box: all of it must be reached, or it is said what of it is not and what lengths would do."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.choice.combinations import combinations
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Exchange, context_of
from linkwright.core.optimize.exchange.other_lengths import with_lengths
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reaching import start_that_reaches
from linkwright.core.optimize.rounding.options import read_rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.core.units.quantities import NoAnswer
from linkwright.json.design import optimization_json
from linkwright.output.tradeoff_folder import tradeoff_csv, tradeoff_json
from linkwright.results.design import bound_words
from linkwright.results.figures_in_words import percent
from linkwright.results.optimization import status_words
from linkwright.results.tradeoff import describe, unreached_words
from tests.optimize.builders import jointed, one_exchange, problem_of, ranged
from tests.optimize.regions.test_regions import ARM, BOX, FREE, MASS, poses_in_region

REACHING = jointed((450, 450), ranged("-120 120", "-10 150"))
LIGHT = "minimize: mass\n"
ACCURATE = "subject_to: {max_error: '<= 2 mm', section_size: [5 mm, 200 mm], link_length: [200 mm, 900 mm]}\n"


def test_free_lengths_reach_all_of_a_box(tmp_path: Path) -> None:
    """The lightest links are as short as the farthest corner allows, and no shorter: what is not reached would have no
    error to be judged by."""
    result = optimise(problem_of(tmp_path, REACHING, BOX + LIGHT + ACCURATE))
    assert result.status == "certified"
    assert result.after.unreached is None
    assert sum(result.arm.lengths) == pytest.approx(np.hypot(0.7, 0.3), rel=1e-6)
    problem = problem_of(tmp_path, REACHING, BOX + LIGHT + ACCURATE)
    assert len(poses_in_region(result, problem)) >= 81**2 - 2  # rounding may take the two corners


def test_search_from_lengths_that_miss_the_box_comes_to_some_that_reach_it(tmp_path: Path) -> None:
    """A place that neither the start nor the first design reaches is reached by the arm as given."""
    problem = problem_of(tmp_path, REACHING, BOX + LIGHT + ACCURATE)
    context, pick = context_of(problem), combinations(problem)[0]
    space, materials = design_space(problem, pick.shapes), material_row(pick.materials, problem)
    short = with_lengths(space, starting_points(space, materials, 1)[0], [0.3, 0.3])
    done = Exchange(context, space).run(materials, pick.materials, Pool(), short)
    assert done is not None
    assert done.converged
    assert sum(arm_of(space, done.x, pick.materials).lengths) == pytest.approx(np.hypot(0.7, 0.3), rel=1e-6)


SHORT = jointed((375, 375), ranged("-120 120", "-10 150"))
"""Stops 12 mm short of two corners of the box alone; lengths that reach them are within what is allowed."""


def test_lengths_to_start_from_reach_all_of_a_box(tmp_path: Path) -> None:
    start = start_that_reaches(problem_of(tmp_path, SHORT, BOX + FREE))
    assert start is not None
    assert "the tip stays 11.6 mm away" in start.why
    assert sum(start.problem.arm.lengths) > np.hypot(0.7, 0.3)
    assert start_that_reaches(problem_of(tmp_path, REACHING, BOX + FREE)) is None


@pytest.mark.slow
def test_search_begins_with_lengths_that_reach_all_of_a_box(tmp_path: Path) -> None:
    result = optimise(problem_of(tmp_path, SHORT, BOX + FREE))
    assert result.start is not None
    assert "of the box cannot be reached" in result.start
    assert "the tip stays 11.6 mm away" in result.start
    assert result.status == "certified"
    assert (result.before.unreached, result.after.unreached) == (None, None)


@pytest.mark.slow
def test_box_that_no_lengths_reach_is_no_certified_answer(tmp_path: Path) -> None:
    """The far corner is 762 mm away and two links of at most 370 mm come to 740 mm; longer ones would do."""
    limits = FREE.replace("900 mm", "370 mm")
    problem = problem_of(tmp_path, jointed((360, 360), ranged("-120 120", "-10 150")), BOX + limits)
    with pytest.raises(NoAnswer) as caught:
        optimise(problem)
    told = str(caught.value)
    assert "\n" not in told
    assert "link_length 200 to 370 mm" in told
    assert "21.58 mm away from (700, " in told
    lengths = re.search(r"links of ([\d.]+) and ([\d.]+) mm would", told)
    assert lengths is not None
    would = replace(problem, arm=jointed_with(problem, [1e-3 * float(group) for group in lengths.groups()]))
    assert evaluate(would.arm, would.workspace).unreached is None


@pytest.mark.slow
def test_lengths_that_reach_the_box_but_are_not_allowed_are_told(tmp_path: Path) -> None:
    """The corner is 762 mm away; the arm as given reaches it, and a reach of 750 mm does not."""
    limits = FREE.replace("link_length", "reach: '<= 750 mm', link_length")
    with pytest.raises(NoAnswer, match=r"not allowed; no lengths were found within .*, reach <= 750 mm that reach all"):
        optimise(problem_of(tmp_path, REACHING, BOX + limits))


def jointed_with(problem: Problem, lengths: list[float]) -> Arm:
    """The arm of a problem with other lengths, a hair longer than they were written."""
    links = [replace(link, length=length + 1e-4) for link, length in zip(problem.arm.links, lengths, strict=True)]
    return problem.arm.with_links(tuple(links))


def test_fixed_lengths_that_leave_part_of_a_box_are_certified_over_the_rest_alone(tmp_path: Path) -> None:
    box = "workspace: {box: [[100 mm, -300 mm], [1100 mm, 300 mm]]}\n"
    result = optimise(problem_of(tmp_path, ARM, box + MASS))
    assert result.after.unreached is not None
    missed = percent(result.after.unreached.share)
    assert result.status == "certified_where_reached"
    assert f"certified over the part reached (all but {missed} of the box)" in status_words(result)
    content = optimization_json(result)
    assert bound_words(result.after).startswith("certified over the part reached: ")
    assert content["status"] == "certified_where_reached"
    assert content["unreached_share"] == result.after.unreached.share


@pytest.mark.slow
def test_place_to_reach_leaves_joints_to_spare_as_they_like(tmp_path: Path) -> None:
    """Three links, of which only their sum counts where the corner is: a pose that held on to it as it stood would
    keep them longer."""
    arm = jointed((400, 400, 400), ranged("-120 120", "-150 150", "-150 150"))
    result, done = one_exchange(problem_of(tmp_path, arm, BOX + LIGHT + ACCURATE))
    assert done.converged
    assert sum(result.lengths) == pytest.approx(np.hypot(0.7, 0.3), rel=1e-6)


@pytest.mark.slow
def test_rounded_lengths_reach_all_of_a_box_too(tmp_path: Path) -> None:
    """Rounded down, the lengths of the optimum would stop short of the corner."""
    rounding = read_rounding("1 mm", "10 mm")
    result = optimise_rounded(problem_of(tmp_path, REACHING, BOX + LIGHT + ACCURATE), rounding)
    assert result.rounded is not None
    assert result.rounded.evaluation.unreached is None
    assert sum(result.rounded.arm.lengths) == pytest.approx(0.77, abs=1e-9)


@pytest.mark.slow
def test_points_of_a_trade_off_reach_all_of_a_box(tmp_path: Path) -> None:
    """From an arm that does not, and with the lightest links as short as the corner allows."""
    short = jointed((375, 375), ranged("-120 120", "-10 150"))
    limits = ACCURATE.replace("2 mm'", "2 mm', mass: '<= 2.2 kg'")
    front = trade_off(question(problem_of(tmp_path, short, BOX + limits), "mass", "max_error"), accuracy=0.4)
    assert front.start is not None
    assert len(front.points) > 2
    for point in front.points:
        assert point.unreached_share == 0.0
        # A place is reached where a tip comes within 0.1 um of it.
        assert sum(point.arm.lengths) >= np.hypot(0.7, 0.3) - 1e-7
    assert sum(front.points[0].arm.lengths) == pytest.approx(np.hypot(0.7, 0.3), rel=1e-6)
    assert all(item["unreached_share"] == 0.0 for item in tradeoff_json(front)["points"])


@pytest.mark.slow
def test_trade_off_with_holes_in_a_box_says_so(tmp_path: Path) -> None:
    box = "workspace: {box: [[400 mm, -300 mm], [960 mm, 300 mm]]}\n"
    result = trade_off(question(problem_of(tmp_path, ARM, box + MASS), "mass", "max_error"), accuracy=0.4)
    missed = evaluate(result.asked.given.arm, result.asked.given.workspace).unreached
    assert missed is not None
    assert {point.unreached_share for point in result.points} == {missed.share}
    (told,) = unreached_words(result)
    assert "of the box is not reached by any point" in told.text
    assert told in describe(result).items
    rows = list(csv.DictReader(io.StringIO(tradeoff_csv(result))))
    assert {float(row["unreached_share"]) for row in rows} == {missed.share}
