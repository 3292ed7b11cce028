"""Ranges of sizes said link by link, against the same said once and against a scan."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.problem_summary import limits_in_words
from linkwright.core.optimize.rounding.options import on_grid, read_rounding
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Circle, Tube
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-60 90", "-90 90"))


def asked(folder: Path, limits: str, more: str = "choose: {section: [tube]}\n") -> Problem:
    return problem_of(folder, ARM, f"subject_to: {{{limits}}}\n{more}")


def test_dimensions_stay_in_the_ranges_of_their_link(tmp_path: Path) -> None:
    """With mass to spare the stiffest tube is the largest and thickest of each link's range."""
    sizes = "section_size: {1: [30 mm, 70 mm], others: [20 mm, 40 mm]}, thickness: {2: [1 mm, 3 mm], 1: [2 mm, 5 mm]}"
    problem = asked(tmp_path, f"{sizes}, mass: '<= 20 kg'")
    assert limits_in_words(problem)[-2:] == (
        "section_size link 1: 30 mm to 70 mm; link 2: 20 mm to 40 mm",
        "thickness link 1: 2 mm to 5 mm; link 2: 1 mm to 3 mm",
    )
    result = optimise(problem)
    results = [link.section.given() for link in result.arm.links if link.section is not None]
    assert [own["diameter"] for own in results] == pytest.approx([0.07, 0.04], rel=1e-4)
    assert [own["thickness"] for own in results] == pytest.approx([0.005, 0.003], rel=1e-3)
    binding = {item.text for item in result.binding}
    assert any(text.startswith("section_size <= 70 mm (link 1") for text in binding)
    assert any(text.startswith("section_size <= 40 mm (link 2") for text in binding)


@pytest.mark.parametrize("aim", ["average_error", "max_error", "mass"])
def test_ranges_of_one_value_leave_materials_alone_to_choose(aim: str, tmp_path: Path) -> None:
    """Tubes and rods whose dimensions are all said: the answer is the best of the arms that can be made of them."""
    sizes = "section_size: {1: [69.1 mm, 69.1 mm], 2: [67.6 mm, 67.6 mm]}"
    sizes += ", thickness: {1: [4.6 mm, 4.6 mm], 2: [3 mm, 3 mm]}"
    names = ["aluminium-6061-t6", "steel-s355"]
    own = f"choose: {{section: {{1: [tube], 2: [circle]}}, material: [{', '.join(names)}]}}\n"
    problem = asked(tmp_path, f"{sizes}, mass: '<= 8 kg', max_error: '<= 2 mm'", f"{own}minimize: {aim}\n")
    sections = Tube(0.0691, 0.0046), Circle(0.0676)
    trials: list[Evaluation] = []
    for pair in itertools.product([load_catalogue().find(name) for name in names], repeat=2):
        made = zip(problem.arm.links, sections, pair, strict=True)
        links = tuple(replace(link, section=section, material=item) for link, section, item in made)
        trials.append(evaluate(problem.arm.with_links(links), problem.workspace, problem.load_cases))
    kept = [trial for trial in trials if trial.mass <= 8.0 and trial.max_error <= 2e-3]
    assert 0 < len(kept) < len(trials)
    result = optimise(problem)
    values = [problem.objective.value(item) for item in kept]
    assert result.objective == pytest.approx(min(value for value in values if value is not None), rel=2e-4)
    assert not any(candidate.outcome == "unsolved" for candidate in result.candidates)


def test_the_same_for_each_link_is_the_same_as_once_for_all(tmp_path: Path) -> None:
    once = asked(tmp_path, "section_size: [20 mm, 60 mm], taper: [0.5, 1], mass: '<= 3 kg'")
    each = "section_size: {1: [20 mm, 60 mm], 2: [20 mm, 60 mm]}, taper: {others: [0.5, 1]}, mass: '<= 3 kg'"
    assert replace(asked(tmp_path, each), file=once.file) == once


def test_tapers_by_link(tmp_path: Path) -> None:
    result = optimise(
        asked(tmp_path, "taper: {1: [1, 1], 2: [0.5, 0.8]}, mass: '<= 3 kg', section_size: [20 mm, 80 mm]")
    )
    first, second = (link.section for link in result.arm.links)
    assert not isinstance(first, Tapered)
    assert isinstance(second, Tapered)
    ratio = float(second.far.given()["diameter"] / second.near.given()["diameter"])
    assert 0.5 - 1e-6 <= ratio <= 0.8 + 1e-6


def test_lengths_by_link(tmp_path: Path) -> None:
    """A reach to keep, with a first link between 300 and 420 mm: no better than the best of a scan of it, with the
    sections that were found."""
    lengths = "link_length: {1: [300 mm, 420 mm], 2: [250 mm, 500 mm]}, reach: '== 700 mm'"
    problem = asked(tmp_path, f"{lengths}, section_size: [20 mm, 60 mm], mass: '<= 2 kg'")
    result = optimise(problem)
    assert 0.3 * (1.0 - 1e-6) <= result.arm.lengths[0] <= 0.42 * (1.0 + 1e-6)
    for first in np.linspace(0.3, 0.42, 7):
        links = (
            replace(link, length=length)
            for link, length in zip(result.arm.links, (float(first), 0.7 - float(first)), strict=True)
        )
        trial = evaluate(result.arm.with_links(tuple(links)), problem.workspace, problem.load_cases)
        if trial.mass <= 2.0:
            assert trial.max_error >= result.objective * (1.0 - 2e-4)


def test_links_of_one_size_are_in_the_ranges_of_all(tmp_path: Path) -> None:
    sizes = "section_size: {1: [30 mm, 70 mm], 2: [20 mm, 50 mm]}, mass: '<= 20 kg'"
    result = optimise(asked(tmp_path, sizes, "choose: {section: [circle], same: [size]}\n"))
    results = [link.section.given()["diameter"] for link in result.arm.links if link.section is not None]
    assert results == pytest.approx([0.05, 0.05], rel=1e-4)
    with pytest.raises(InputError, match=r"subject_to\.section_size: has ranges that no size is in.*loosen"):
        asked(tmp_path, "section_size: {1: [60 mm, 70 mm], 2: [20 mm, 50 mm]}", "choose: {same: [size]}\n")


def test_listed_sizes_outside_of_a_links_range_are_left_out(tmp_path: Path) -> None:
    listed = "choose: {section: [circle], sizes: {diameter: [30 mm, 40 mm, 50 mm, 60 mm]}}\n"
    problem = asked(tmp_path, "section_size: {1: [35 mm, 70 mm], 2: [20 mm, 45 mm]}", listed)
    assert problem.sizes is not None
    results = [[round(1e3 * float(item.section.given()["diameter"])) for item in own] for own in problem.sizes]
    assert results == [[40, 50, 60], [30, 40]]


def test_grids_are_drawn_in_link_by_link(tmp_path: Path) -> None:
    problem = asked(tmp_path, "section_size: {1: [31 mm, 69 mm], 2: [20 mm, 42 mm]}, thickness: [2 mm, 4 mm]")
    drawn = on_grid(problem, read_rounding("2 mm"))
    assert [own.section_size for own in drawn.ranges] == [(0.032, 0.068), (0.02, 0.042)]


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ("section_size: {1: [20 mm, 60 mm]}", r"subject_to\.section_size: says nothing of link 2; add others"),
        ("thickness: {3: [2 mm, 6 mm]}", r"subject_to\.thickness\.3: is no link with a section; those are 1, 2"),
        ("link_length: {1: 400, 2: [300 mm, 400 mm]}", r"subject_to\.link_length\.1: needs a range of two"),
        ("taper: {1: [0.01, 1], others: [1, 1]}", r"subject_to\.taper\.1: holds sizes of the far end"),
        ("section_size: {1: [20 mm, 60 mm], 2: [8 mm, 9 mm]}, thickness: [5 mm, 6 mm]", r"subject_to\.thickness: "),
        ("link_length: {1: [0 mm, 1 mm], 2: [1 mm, 2 mm]}", r"subject_to\.link_length\.1: must be above zero"),
    ],
)
def test_one_line_tells_what_is_wrong(limits: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        asked(tmp_path, limits)


def test_both_sides_of_a_hollow_hold_where_they_are_equal() -> None:
    """The lesser of them alone has a corner there, at which the solver went to and fro to its last iteration."""
    problem = read_problem("examples/bench-arm/by-link.yaml")
    assert problem.lists is not None
    lists = tuple(replace(own, shapes=None, materials=(own.materials or ())[-1:]) for own in problem.lists)
    result = optimise(replace(problem, shapes=("rectangular_tube",), lists=lists))
    assert [candidate.outcome for candidate in result.candidates] == ["best"]
    assert [link.material.name for link in result.arm.links if link.material] == ["aluminium-6082-t6", "steel-s355"]
    for link, least in zip(result.arm.links, (0.03, 0.02), strict=True):
        assert link.section is not None
        assert min(link.section.inner_widths or ()) >= least * (1.0 - 1e-6)
