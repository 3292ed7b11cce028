"""Shapes and materials: the choice against every combination finished by hand, and what `same` makes links agree in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material, PropertyName
from linkwright.core.optimize.choice.combinations import choose, combinations, count
from linkwright.core.optimize.exchange.design import design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Exchange, context_of, first_pool
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((500, 400), ranged("-100 100", "30 140"))
CASES = "load_cases:\n  - {payload: {mass: 3 kg}}\n  - {payload: {mass: 1 kg}, force: [90 N, 0 N, 0 N]}\n"
LIMITS = "subject_to: {mass: '<= 5 kg', section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]}\n"


def test_bounded_out_combinations_would_not_have_won(tmp_path: Path) -> None:
    text = "choose: {section: [circle, tube, rectangle], material: [aluminium-6061-t6, steel-s355]}\n" + CASES + LIMITS
    problem = problem_of(tmp_path, ARM, text)
    context = context_of(problem)
    choice = choose(context)
    assert choice is not None
    assert choice.exhaustive
    picks = combinations(problem)
    assert len(picks) == count(problem) == 36 == len(choice.candidates)
    finished: dict[tuple[object, ...], float] = {}
    for pick in picks:
        space = design_space(problem, pick.shapes)
        materials = material_row(pick.materials, problem)
        start = starting_points(space, materials, 1)[0]
        pool = first_pool(context, space, start, pick.materials)
        done = Exchange(context, space).run(materials, pick.materials, pool, start)
        if done is not None and done.converged:
            assert done.worst is not None
            finished[pick.shapes, tuple(m.name for m in pick.materials if m is not None)] = done.worst.error
    assert min(finished.values()) >= choice.objective * (1.0 - 1e-4)
    for candidate in choice.candidates:
        by_hand = finished.get((candidate.shapes, candidate.materials))
        if candidate.outcome == "infeasible":
            assert by_hand is None
        elif by_hand is not None:
            assert candidate.objective is not None
            assert candidate.objective <= by_hand * (1.0 + 1e-4)  # solved, or a bound from below
    assert {candidate.outcome for candidate in choice.candidates} >= {"best", "bounded out"}


WHERE = "choose: {section: [circle], material: %s}\nsubject_to: {mass: '<= 5 kg'%s}\n"


def bound(name: PropertyName, least: float, most: float) -> Callable[[Material], bool]:
    """Whether a material has a property between two values (SI)."""
    return lambda material: material.has(name) and least <= material.need(name) <= most


def of(*families: str) -> Callable[[Material], bool]:
    """Whether a material is of one of the families."""
    return lambda material: material.family in families


CONDITIONS: dict[str, tuple[Callable[[Material], bool], ...]] = {
    "{where: {family: aluminium}}": (of("aluminium"),),
    "{where: {family: [aluminium, stainless], magnetic: false}}": (
        of("aluminium", "stainless"),
        lambda material: material.magnetic is False,
    ),
    "{where: {density: '<= 3000 kg/m^3', elastic_modulus: '>= 40 GPa'}}": (
        bound("density", 0.0, 3000.0),
        bound("elastic_modulus", 40e9, 1e15),
    ),
    "{where: {service_temperature: '>= 50 degC'}}": (bound("highest_service_temperature", 323.15, 1e4),),
    "[invar-36, {where: {family: steel}}]": (of("steel", "invar"),),
}


@pytest.mark.parametrize("conditions", CONDITIONS)
def test_conditions_stand_for_names(conditions: str, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, WHERE % (conditions, ""))
    assert problem.materials is not None
    known = [m for m in load_catalogue() if m.has("elastic_modulus") and m.has("density") and m.has("shear_modulus")]
    assert sorted(m.name for m in problem.materials) == sorted(
        m.name for m in known if all(keeps(m) for keeps in CONDITIONS[conditions])
    )
    assert len(problem.materials) >= 1


def test_conditions_leave_out_what_a_limit_needs_and_is_not_known(tmp_path: Path) -> None:
    every = problem_of(tmp_path, ARM, WHERE % ("{where: {family: [aluminium, steel]}}", "")).materials
    priced = problem_of(
        tmp_path, ARM, WHERE % ("{where: {family: [aluminium, steel]}}", ", cost: '<= 50 EUR'")
    ).materials
    assert every is not None
    assert priced is not None
    assert [m.name for m in priced] == [m.name for m in every if m.has("cost")]
    assert len(priced) < len(every)


@pytest.mark.parametrize(
    ("conditions", "key"),
    [
        ("{family: aluminum}", r"family\[1\]: there is no family 'aluminum'; did you mean 'aluminium'"),
        ("{colour: red}", "unknown key 'colour'"),
        ("{density: '<= 1 kg/m^3'}", "no material of the catalogue keeps all conditions"),
    ],
)
def test_conditions_that_nothing_keeps_are_wrong_input(conditions: str, key: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=key):
        problem_of(tmp_path, ARM, WHERE % (f"{{where: {conditions}}}", ""))


@pytest.mark.parametrize(
    ("same", "expected"), [("", 16), ("section", 8), ("material", 8), ("section, material", 4), ("size", 8)]
)
def test_how_many_combinations_agree(same: str, expected: int, tmp_path: Path) -> None:
    text = f"choose: {{section: [circle, tube], material: [aluminium-6061-t6, steel-s355], same: [{same}]}}\n" + LIMITS
    problem = problem_of(tmp_path, ARM, text)
    picks = combinations(problem)
    assert len(picks) == count(problem) == expected
    for pick in picks:
        if "section" in same or same == "size":
            assert len(set(pick.shapes)) == 1
        if "material" in same:
            assert len({material.name for material in pick.materials if material is not None}) == 1


@pytest.mark.slow
def test_same_size_gives_all_links_one_section(tmp_path: Path) -> None:
    chosen = "choose: {section: [tube, rectangle], same: [size]}\n"
    alike = optimise(problem_of(tmp_path, ARM, chosen + CASES + LIMITS))
    one, other = (link.section for link in alike.arm.links)
    assert one.shape == other.shape
    assert one.given() == pytest.approx(other.given(), rel=1e-12)
    free = optimise(problem_of(tmp_path, ARM, chosen.replace("size", "section") + CASES + LIMITS))
    one, other = (link.section for link in free.arm.links)
    assert one.given() != pytest.approx(other.given(), rel=1e-2)
    assert free.objective < alike.objective


@pytest.mark.slow
def test_walls_and_sizes_of_the_winner_keep_their_bounds(tmp_path: Path) -> None:
    result = optimise(problem_of(tmp_path, ARM, "choose: {section: [rectangular_tube, i_section]}\n" + CASES + LIMITS))
    for link in result.arm.links:
        for name, value in link.section.given().items():
            low, high = (0.002, 0.008) if "thickness" in name else (0.02, 0.09)
            assert low * (1 - 1e-9) <= value <= high * (1 + 1e-9), name
    assert result.after.mass <= 5.0 * (1.0 + 1e-6)


def test_thickest_wall_does_not_forbid_slender_tubes(tmp_path: Path) -> None:
    """A wall of at most 50 mm says nothing about a tube of 30 mm; with it or without, the design is the same."""
    text = "minimize: mass\nchoose: {section: tube}\nsubject_to: {max_error: '<= 8 mm', section_size: [10 mm, 90 mm], "
    arm = jointed((500, 400), ranged("-100 100", "-100 100"))
    loose, fitting = (
        optimise(problem_of(tmp_path, arm, text + f"thickness: [1 mm, {most} mm]}}\n")) for most in (50, 4)
    )
    assert min(link.section.diameter for link in loose.arm.links) < 0.05
    assert loose.objective == pytest.approx(fitting.objective, rel=1e-5)
