"""Trade-offs: fronts against designs optimised one by one, finite differences, and designs drawn at random."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.errors.model import error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES, Limit
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.choice.combinations import combinations
from linkwright.core.optimize.exchange.design import arm_of, design_space, numeric_beams
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.front import Tradeoff
from linkwright.core.optimize.tradeoff.point import Search
from linkwright.core.optimize.tradeoff.question import Question, axes_of, question
from linkwright.core.optimize.tradeoff.refinement import (
    Refined,
    Stretch,
    envelope,
    knee,
    logarithmic,
    refine,
    undominated,
)
from linkwright.core.optimize.tradeoff.trace import Progress
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import best_value, jointed, measured_price, problem_of, ranged

ARM = jointed((500, 400), ranged("-100 100", "30 140"))
SIZES = "section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]"
LIMITS = f"subject_to: {{mass: '<= 2 kg', max_error: '<= 1.5 mm', {SIZES}}}\n"
TWO = "choose: {section: [tube, rectangle], same: [section]}\n" + LIMITS
BOTH = "choose: {material: [aluminium-6061-t6, steel-s355], same: [material]}\n"
COARSE = 0.04


def asked_of(folder: Path, text: str, x: str, y: str, **more: str) -> Question:
    return question(problem_of(folder, ARM, text), x, y, **more)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("tradeoff")


@pytest.fixture(scope="module")
def traced(folder: Path) -> Tradeoff:
    """Error against mass, over two shapes."""
    return trade_off(asked_of(folder, TWO, "mass", "max_error"), accuracy=0.01)


@pytest.fixture(scope="module")
def at_the_limit(traced: Tradeoff) -> OptimizationResult:
    """What the optimiser finds where the front ends."""
    return optimise(replace(traced.asked.given, minimize="max_error"))


def test_end_at_the_limit_is_what_optimise_finds(traced: Tradeoff, at_the_limit: OptimizationResult) -> None:
    last = traced.of(traced.envelope)[-1]
    assert traced.envelope.capped
    assert last.x == pytest.approx(2.0, rel=1e-6)
    assert last.y == pytest.approx(at_the_limit.objective, rel=1e-4)


def test_other_end_is_the_least_mass(traced: Tradeoff, tmp_path: Path) -> None:
    first = traced.of(traced.envelope)[0]
    problem = replace(traced.asked.given, minimize="mass")
    limits = tuple(limit for limit in problem.limits if limit.name != "mass")
    assert first.x == pytest.approx(best_value(replace(problem, limits=limits)), rel=1e-4)
    assert first.y == pytest.approx(1.5e-3, rel=1e-3)
    # Nothing but the least sizes holds the mass: tubes 20 mm wide with walls of 2 mm.
    asked = asked_of(tmp_path, f"choose: {{section: tube}}\nsubject_to: {{{SIZES}}}\n", "mass", "max_error")
    least = Search(asked, asked.problem, lambda _: None).best(asked.x_limit, math.inf, [])
    assert least is not None
    assert least.badness == pytest.approx(2700.0 * math.pi / 4.0 * (0.020**2 - 0.016**2) * 0.9, rel=1e-3)


def test_figures_are_those_of_evaluate_and_keep_the_limits(traced: Tradeoff) -> None:
    given = traced.asked.given
    for point in traced.points[:: max(1, len(traced.points) // 6)]:
        again = evaluate(point.arm, given.workspace, given.load_cases)
        assert (point.x, point.y) == pytest.approx((again.mass, again.max_error), rel=1e-9)
        assert again.mass <= 2.0 * (1.0 + 1e-6)
        assert point.converged
        assert point.certified


def test_no_point_is_dominated_by_another(traced: Tradeoff) -> None:
    for front in (*traced.fronts, traced.envelope):
        points = traced.of(front)
        for one, other in pairwise(points):
            assert one.x < other.x
            assert one.y > other.y


@pytest.mark.slow
def test_straight_lines_between_points_are_right(traced: Tradeoff) -> None:
    """New problems between the points, a third of the way, where the refinement never looked."""
    points, steps = traced.of(traced.envelope), traced.envelope.steps
    assert traced.envelope.error <= 0.01
    for k in range(1, len(points), max(1, len(points) // 5)):
        left, right = points[k - 1], points[k]
        if (left.number, right.number) in steps:
            continue
        mass = left.x + (right.x - left.x) / 3.0
        limits = (*[x for x in traced.asked.given.limits if x.name != "mass"], Limit(FIGURES["mass"], "<=", mass))
        best = 1e-3 * best_value(replace(traced.asked.given, minimize="max_error", limits=limits))
        straight = left.y + (right.y - left.y) / 3.0
        assert straight == pytest.approx(best, rel=0.01)


def test_no_random_design_lies_below_the_front(traced: Tradeoff) -> None:
    """Random dimensions of either shape; worst errors by the search, without certificate: never above the true ones."""
    problem = traced.asked.given
    search = WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)
    points = traced.of(traced.envelope)
    x, y = np.array([point.x for point in points]), np.array([point.y for point in points])
    random, met = np.random.default_rng(11), 0
    for pick in combinations(problem):
        space = design_space(problem, pick.shapes)
        lower, upper = space.bounds()
        for _ in range(150):
            with np.errstate(invalid="ignore"):
                arm = arm_of(space, random.uniform(lower, upper), pick.materials)
            mass = sum(link.length * link.section.properties(0.3).area * 2700.0 for link in arm.links if link.section)
            if any(link.section is None or link.section.check() for link in arm.links) or not x[0] < mass < x[-1]:
                continue
            met += 1
            error = search.worst(numeric_beams(arm, problem.load_cases), certify=False).error
            # Lines between points lie above a convex front by no more than the accuracy.
            assert error >= np.interp(mass, x, y) * (1.0 - 0.012)
    assert met > 25


@pytest.mark.parametrize(
    ("x", "y", "extra"),
    [
        pytest.param("mass", "max_error", "", marks=pytest.mark.slow),
        ("max_error", "mass", ""),
        pytest.param("mass", "first_frequency", "", marks=pytest.mark.slow),
        pytest.param("first_frequency", "mass", "", marks=pytest.mark.slow),
        ("reach", "max_error", ", link_length: [300 mm, 600 mm], mass: '<= 4 kg'"),
    ],
)
def test_slope_from_the_multiplier_is_that_of_finite_differences(x: str, y: str, extra: str, tmp_path: Path) -> None:
    asked = asked_of(tmp_path, f"choose: {{section: tube}}\nsubject_to: {{{SIZES}{extra}}}\n", x, y)
    search = Search(asked, asked.problem, lambda _: None)
    least = search.best(asked.x_limit, math.inf, [])
    most = search.best(asked.y_limit, math.inf, [])
    assert least is not None
    assert most is not None

    def attained(name: str, numbers: tuple[float, ...]) -> float:
        arm = arm_of(search.exchange(least.combination.shapes).space, np.array(numbers), least.combination.materials)
        done = evaluate(arm, asked.given.workspace, asked.given.load_cases)
        assert done.frequency is not None
        figures = {"mass": done.mass, "max_error": done.max_error, "reach": done.reach}
        return {**figures, "first_frequency": done.frequency.value}[name]

    level = math.sqrt(least.badness * asked.x.badness(attained(x, most.numbers)))
    step = 1e-3
    below, here, above = (search.best(asked.y_limit, level * (1.0 + k * step), [least, most]) for k in (-1.0, 0.0, 1.0))
    assert below is not None
    assert here is not None
    assert above is not None
    measured = math.log(above.badness / below.badness) / math.log((1.0 + step) / (1.0 - step))
    assert here.elasticity is not None
    assert here.elasticity < -1e-3
    assert here.elasticity == pytest.approx(measured, rel=0.01)


def test_price_along_the_front_is_that_of_the_optimiser(traced: Tradeoff, at_the_limit: OptimizationResult) -> None:
    """mm/kg at the limit of the problem, where `optimise` tells it too, and by its own finite differences."""
    problem = replace(traced.asked.given, minimize="max_error")
    (limit,) = [limit for limit in at_the_limit.binding if limit.name == "mass"]
    slope = traced.of(traced.envelope)[-1].slope
    assert slope is not None
    assert 1e3 * slope == pytest.approx(limit.price, rel=1e-3)
    assert 1e3 * slope == pytest.approx(measured_price(problem, limit), rel=0.01)


@pytest.mark.slow
def test_swapped_axes_give_the_same_front(traced: Tradeoff, folder: Path) -> None:
    """Least mass for an error is the least error for a mass."""
    swapped = trade_off(asked_of(folder, TWO, "max_error", "mass"), accuracy=COARSE)
    points = traced.of(traced.envelope)
    x, y = [point.x for point in points], [point.y for point in points]
    for point in swapped.of(swapped.envelope):
        if x[2] < point.y < x[-2]:
            assert point.x == pytest.approx(np.interp(point.y, x, y), rel=0.02)


@pytest.mark.slow
def test_maximised_figures_grow_towards_better(tmp_path: Path) -> None:
    text = f"choose: {{section: tube}}\nsubject_to: {{{SIZES}, mass: '<= 1 kg', first_frequency: '>= 11 Hz'}}\n"
    result = trade_off(asked_of(tmp_path, text, "mass", "first_frequency"), accuracy=0.2)
    points = result.of(result.envelope)
    assert len(points) >= 4
    for one, other in pairwise(points):
        assert one.x < other.x
        assert one.y < other.y
        assert one.figures["first_frequency"] == one.y
    assert points[0].slope is None or points[0].slope > 0.0


@pytest.mark.slow
def test_reach_goes_either_way(tmp_path: Path) -> None:
    text = f"choose: {{section: tube}}\nsubject_to: {{mass: '<= 4 kg', link_length: [300 mm, 600 mm], {SIZES}}}\n"
    long = trade_off(asked_of(tmp_path, text, "reach", "max_error"), accuracy=0.2)
    points = long.of(long.envelope)
    assert points[0].x == pytest.approx(1.2, rel=1e-4)
    assert all(one.x > other.x and one.y > other.y for one, other in pairwise(points))
    short = trade_off(asked_of(tmp_path, text, "reach", "max_error", reach="short"), accuracy=0.2)
    # The shortest arm is also the stiffest: one design is best in both.
    assert len(short.points) == 1
    assert short.points[0].x == pytest.approx(0.6, rel=1e-4)


@pytest.mark.slow
def test_envelope_is_the_best_of_the_fronts(tmp_path: Path) -> None:
    # Rods of at most 40 mm: aluminium is the lighter, steel the stiffer where there is no more room.
    rigid = jointed((500, 400), ranged("-100 100", "30 140", more=""))
    limits = "subject_to: {max_error: '<= 2 mm', section_size: [20 mm, 40 mm]}\n"
    asked = question(problem_of(tmp_path, rigid, BOTH + limits), "mass", "max_error", by="material")
    result = trade_off(asked, accuracy=0.04)
    assert [front.name for front in result.fronts] == ["aluminium-6061-t6", "steel-s355"]
    for front in result.fronts:
        assert all(set(point.materials) == {front.name} for point in result.of(front))
    on = result.of(result.envelope)
    assert {point.front for point in on} == {"aluminium-6061-t6", "steel-s355"}
    for point in result.points:
        assert not any(other.x < point.x and other.y < point.y for other in on if point in on)
    # Where steel takes over the straight line was measured as well: both materials solved anew in between.
    (change,) = [(a, b) for a, b in pairwise(on) if a.front != b.front][:1]
    mass = 0.5 * (change[0].x + change[1].x)
    free = replace(asked.given, minimize="max_error", limits=(Limit(FIGURES["mass"], "<=", mass),))
    best = 1e-3 * best_value(free)
    straight = 0.5 * (change[0].y + change[1].y)
    assert straight == pytest.approx(best, rel=0.04)


def test_an_interrupt_leaves_the_points_that_are_done(folder: Path) -> None:
    asked = asked_of(folder, "choose: {section: tube}\n" + LIMITS, "mass", "max_error")
    seen: list[Progress] = []

    def stop(progress: Progress) -> None:
        seen.append(progress)
        if progress.error is not None:
            raise KeyboardInterrupt

    front = trade_off(asked, accuracy=COARSE, notify=stop)
    assert front.interrupted
    assert len(front.points) >= 4
    assert not front.envelope.complete
    shares = [item.share for item in seen]
    assert all(0.0 <= share <= 1.0 for share in shares)
    assert any(0.0 < share < 1.0 for share in shares)


WRONG = {
    "unknown figure": ("weight", "max_error", "", "mass"),
    "twice the same": ("mass", "mass", "", "two figures"),
    "a constant apart": ("mass", "total_mass", "", "constant"),
    "fixed lengths": ("reach", "max_error", "", "link_length"),
    "fixed figure": ("reach", "mass", "reach: '== 900 mm', link_length: [300 mm, 600 mm]", "=="),
}


@pytest.mark.parametrize("name", WRONG)
def test_nothing_to_trade_is_wrong_input(name: str, tmp_path: Path) -> None:
    x, y, limits, words = WRONG[name]
    with pytest.raises(InputError, match=words):
        asked_of(tmp_path, f"subject_to: {{{limits}}}\n", x, y)


@pytest.mark.parametrize("by", ["material", "shape"])
def test_fronts_by_what_is_not_chosen_are_wrong_input(by: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="choose"):
        asked_of(tmp_path, "", "mass", "max_error", by=by)


def test_limits_that_no_design_keeps_have_no_answer(tmp_path: Path) -> None:
    text = f"choose: {{section: tube}}\nsubject_to: {{mass: '<= 1 kg', max_error: '<= 0.05 mm', {SIZES}}}\n"
    with pytest.raises(NoAnswer, match="would have to be"):
        trade_off(asked_of(tmp_path, text, "mass", "max_error"))


def traced_curve(curve: Callable[[float], float], ends: tuple[float, float], accuracy: float) -> Refined[Dot]:
    """A known curve refined between its ends."""
    axes = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["max_error"])
    first, last = (Dot(level, curve(level)) for level in ends)

    def solve(stretch: Stretch[Dot]) -> Dot:
        assert stretch.left.level < stretch.level < stretch.right.level
        assert stretch.expected > 0.0
        return Dot(stretch.level, curve(stretch.level))

    return refine(axes, [first, last], [(first, last)], solve, accuracy, most=5000)


class Dot:
    """A point of a known curve."""

    def __init__(self, level: float, y: float) -> None:
        self.level, self.x, self.y = level, level, y


@given(st.floats(0.2, 4.0), st.floats(0.005, 0.05))
def test_refined_curve_is_right_everywhere(power: float, accuracy: float) -> None:
    """y = x^-p: the straight lines are within the accuracy at every x, not only where they were measured."""
    done = traced_curve(lambda level: level**-power, (1.0, 20.0), accuracy)
    assert done.complete
    assert done.steps == ()
    assert done.error <= accuracy
    x, y = np.array([dot.x for dot in done.nodes]), np.array([dot.y for dot in done.nodes])
    fine = np.geomspace(1.0, 20.0, 4001)
    assert np.all(np.abs(np.interp(fine, x, y) / fine**-power - 1.0) <= accuracy)


def test_jump_is_found_as_a_step() -> None:
    axes = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["max_error"])
    done = traced_curve(lambda level: 3.0 if level < 4.0 else 1.0, (1.0, 9.0), 0.01)
    ((left, right),) = done.steps
    assert left.level < 4.0 <= right.level
    assert right.level / left.level < 1.001
    assert [dot.level for dot in undominated(axes, done.nodes)] == pytest.approx([1.0, 4.0], rel=1e-3)


def test_envelope_leaves_out_what_lies_above_another_front() -> None:
    """Between the points of one front those of another may be undominated and yet above its straight line."""
    axes = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["max_error"])
    low = [Dot(1.0, 4.0), Dot(3.0, 2.0), Dot(5.0, 1.0)]
    high = [Dot(2.0, 3.1), Dot(4.0, 1.4), Dot(6.0, 0.5)]
    assert envelope(axes, [low, high]) == [low[0], low[1], high[1], high[2]]
    assert undominated(axes, [*low, *high]) == [low[0], high[0], low[1], high[1], low[2], high[2]]


@given(st.floats(1.5, 50.0))
def test_knee_of_a_hyperbola_is_in_its_middle(ratio: float) -> None:
    """x y = 1 between 1/r and r is symmetrical about x = y, where its tangent is parallel to the chord."""
    axes = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["max_error"])
    x = np.geomspace(1.0 / ratio, ratio, 201).tolist()
    y = [1.0 / value for value in x]
    assert knee(axes, x, y, (False, False)) == 100
    assert knee(axes, x, y, (True, True)) is None  # straight in logarithms
    # With frequency upwards the same front, mirrored.
    up = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["first_frequency"])
    assert knee(up, x, [ratio + 1.0 / ratio - value for value in y], (False, False)) == 100


def test_front_that_bulges_has_no_knee() -> None:
    axes = (axes_of(FIGURES)["mass"], axes_of(FIGURES)["max_error"])
    x = np.linspace(0.0, 1.0, 50)
    assert knee(axes, x.tolist(), np.sqrt(1.0 - x**2).tolist(), (False, False)) is None
    assert logarithmic([1.0, 11.0])
    assert not logarithmic([1.0, 9.0])
