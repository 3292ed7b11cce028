"""Rounded designs: on the grid or in stock, every limit kept, and the best there is by brute force."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.cli import run
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES, figures_of
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.exchange.exchange import CERTIFICATE_GAP
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.rounding.options import GRADES, comes_in, multiples, read_rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded, rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Circle, load_stock
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but
from tests.optimize.builders import ALUMINIUM, DRIVE, jointed, problem_of, ranged

STEEL = "steel-s355"
TWO = jointed([400, 300], ranged("-120 120", "-150 150"))
PLAYED = jointed([400, 300], ranged("-120 120", "-150 150", more=DRIVE + ", backlash: 1 arcmin, clearance: 0.02 mm"))


def with_sections(arm: Arm, sections, lengths=None, materials=None) -> Arm:
    """The arm with other sections, lengths (m) and materials."""
    catalogue = load_catalogue(user=False)
    links = list(arm.links)
    for k, section in enumerate(sections):
        material = links[k].material if materials is None else catalogue.find(materials[k])
        length = links[k].length if lengths is None else lengths[k]
        links[k] = replace(links[k], section=section, length=length, material=material, section_name=None)
    return arm.with_links(tuple(links))


def search_of(problem: Problem) -> WorstSearch:
    """A search for worst poses; what a model holds of sections and plain materials is the beams' figures alone."""
    assert not any(active.effect.id.startswith("thermal") for active in active_effects(problem.arm))
    return WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)


def error_of(search: WorstSearch, arm: Arm, problem: Problem) -> float:
    """The worst error (m), searched for this arm alone."""
    return search.worst(beam_values(beams_of(arm, problem.load_cases)), certify=False).error


def mass_of(arm: Arm) -> float:
    """The mass of the links, kg, from area, length and density."""
    return sum(
        link.length * float(link.section.properties(0.3).area) * link.material.need("density") for link in arm.links
    )


# ---- against brute force


@pytest.mark.parametrize("arm", [pytest.param(TWO, marks=pytest.mark.slow), PLAYED], ids=["drives", "play"])
def test_rounded_bars_are_the_best_of_all_on_the_grid(arm: str, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, arm, "subject_to: {mass: '<= 6 kg', section_size: [20 mm, 90 mm]}\n")
    result = optimise_rounded(problem, read_rounding("5 mm")).rounded
    assert result is not None
    best, search = np.inf, search_of(problem)
    for sizes in itertools.product(np.arange(30, 91, 5) * 1e-3, repeat=2):
        other = with_sections(problem.arm, [Circle(float(size)) for size in sizes])
        if mass_of(other) <= 6.0:
            best = min(best, error_of(search, other, problem))
    assert result.objective == pytest.approx(best, rel=1e-5)
    assert result.exhaustive
    assert result.certified


@pytest.mark.slow
def test_a_light_design_within_an_error_is_the_lightest_on_the_grid(tmp_path: Path) -> None:
    text = "minimize: mass\nsubject_to: {max_error: '<= 1.5 mm', safety_factor: '>= 3', section_size: [20 mm, 90 mm]}\n"
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("4 mm")).rounded
    assert result is not None
    lightest, search = np.inf, search_of(problem)
    for sizes in itertools.product(np.arange(20, 69, 4) * 1e-3, repeat=2):
        other = with_sections(problem.arm, [Circle(float(size)) for size in sizes])
        if mass_of(other) < lightest and error_of(search, other, problem) <= 1.5e-3:
            strong = evaluate(other, problem.workspace, problem.load_cases).strength.least_safety_factor
            lightest = mass_of(other) if strong is not None and strong >= 3.0 else lightest
    assert result.objective == pytest.approx(lightest, rel=1e-9)


@pytest.mark.slow
def test_stock_tubes_are_the_best_of_all_that_can_be_bought(tmp_path: Path) -> None:
    text = (
        "subject_to: {mass: '<= 4 kg', section_size: [40 mm, 65 mm], thickness: [2 mm, 5 mm], "
        "wall_slenderness: '<= 1'}\n"
        f"choose: {{section: [tube], material: [{ALUMINIUM}, {STEEL}]}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("stock")).rounded
    assert result is not None
    tubes = [size for size in load_stock() if size.shape == "tube" and 0.04 <= size.dimensions["diameter"] <= 0.065]
    rows = [size for size in tubes if 0.002 <= size.dimensions["thickness"] <= 0.005]
    options = [(size, ALUMINIUM if size.family == "ALU TUBE" else STEEL) for size in rows]
    assert len(options) > 20
    best, search = np.inf, search_of(problem)
    for pair in itertools.product(options, repeat=2):
        other = with_sections(problem.arm, [size.section for size, _ in pair], materials=[name for _, name in pair])
        slenderness = FIGURES["wall_slenderness"].of_links(other)
        assert slenderness is not None
        if mass_of(other) <= 4.0 and slenderness <= 1.0:
            best = min(best, error_of(search, other, problem))
    assert result.objective == pytest.approx(best, rel=1e-5)


def test_a_link_without_stock_sizes_stays_and_the_others_are_rounded(tmp_path: Path) -> None:
    """No stock bar is of steel: link 2, whose size the problem says, stays. Link 1 is the best of all stock tubes."""
    text = (
        "subject_to: {mass: '<= 4 kg', section_size: {1: [40 mm, 65 mm], 2: [20 mm, 20 mm]}, thickness: [2 mm, 5 mm]}\n"
        f"choose: {{section: {{1: [tube], 2: [circle]}}, material: {{1: [{ALUMINIUM}], 2: [{STEEL}]}}}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("stock")).rounded
    assert result is not None
    assert result.kept == (f"link 2: no stock size of shape circle comes in {STEEL}",)
    search, bar = search_of(problem), Circle(0.02)
    tubes = [size for size in load_stock() if size.family == "ALU TUBE" and size.shape == "tube"]
    rows = [
        size
        for size in tubes
        if 0.04 <= size.dimensions["diameter"] <= 0.065 and 0.002 <= size.dimensions["thickness"] <= 0.005
    ]
    made = [with_sections(problem.arm, [size.section, bar], materials=[ALUMINIUM, STEEL]) for size in rows]
    assert len(made) > 5
    least = min(error_of(search, arm, problem) for arm in made if mass_of(arm) <= 4.0)
    assert result.objective == pytest.approx(least, rel=1e-5)
    assert result.arm.links[0].section_name is not None
    assert result.arm.links[1].section_name is None


def test_a_size_that_the_problem_says_is_on_no_grid(tmp_path: Path) -> None:
    """A bar of 20.5 mm stays beside one that is rounded to whole millimetres."""
    text = (
        "subject_to: {mass: '<= 6 kg', section_size: {1: [20 mm, 90 mm], 2: [20.5 mm, 20.5 mm]}}\n"
        f"choose: {{section: [circle], material: [{ALUMINIUM}]}}\n"
    )
    result = optimise_rounded(problem_of(tmp_path, TWO, text), read_rounding("1 mm")).rounded
    assert result is not None
    first, second = (link.section for link in result.arm.links)
    assert second == Circle(0.0205)
    assert isinstance(first, Circle)
    assert first.diameter == pytest.approx(round(first.diameter, 3), abs=1e-12)


@pytest.mark.slow
def test_the_same_material_for_all_links_holds_in_stock(tmp_path: Path) -> None:
    text = (
        "subject_to: {mass: '<= 4 kg', section_size: [30 mm, 80 mm], thickness: [2 mm, 5 mm]}\n"
        f"choose: {{section: [tube, rectangular_tube], material: [{ALUMINIUM}, {STEEL}], same: [material, size]}}\n"
    )
    result = optimise_rounded(problem_of(tmp_path, TWO, text), read_rounding("stock")).rounded
    assert result is not None
    assert len({(link.section_name, link.material.name) for link in result.arm.links if link.material}) == 1


# ---- what a rounded design is


BOX = (
    "subject_to: {mass: '<= 2 kg', reach: '== 700 mm', link_length: [200 mm, 500 mm], section_size: [20 mm, 81 mm],\n"
    "             thickness: [2.2 mm, 8 mm], safety_factor: '>= 2', first_frequency: '>= 5 Hz'}\n"
    f"choose: {{section: [rectangular_tube], material: [{ALUMINIUM}]}}\n"
)


def test_sizes_and_lengths_are_on_their_grids_and_every_limit_is_kept(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TWO, BOX)
    result = optimise_rounded(problem, read_rounding("0.5 mm", "4 mm"))
    found = result.rounded
    assert found is not None
    for link in found.arm.links:
        given = link.section.given()
        sizes = np.array(list(given.values())) / 0.5e-3
        assert np.abs(sizes - sizes.round()).max() < 1e-9
        assert abs(link.length / 4e-3 - round(link.length / 4e-3)) < 1e-9
        assert min(given["width"], given["height"]) >= 0.02
        assert max(given["width"], given["height"]) <= 0.081
        assert min(given["flange_thickness"], given["web_thickness"]) >= 2.5e-3
    # Judged anew, as `evaluate` would judge the written arm.
    write_arm(found.arm, tmp_path / "rounded.yaml")
    anew = evaluate(read_arm(tmp_path / "rounded.yaml"), problem.workspace, problem.load_cases)
    figures = figures_of(anew, FIGURES)
    assert anew.max_error == pytest.approx(found.objective, rel=1e-9)
    assert anew.worst.certified
    assert figures["mass"] <= 2.0
    assert figures["reach"] == pytest.approx(0.7, rel=1e-12)
    assert figures["safety_factor"] >= 2.0
    assert figures["first_frequency"] >= 5.0


@pytest.mark.parametrize("step", slow_but(["0.5 mm", "2 mm", "10 mm"], "2 mm"))
def test_rounding_never_beats_the_optimum_of_a_convex_problem(step: str, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TWO, "subject_to: {mass: '<= 5 kg', section_size: [20 mm, 90 mm]}\n")
    result = optimise_rounded(problem, read_rounding(step))
    assert result.rounded is not None
    assert result.rounded.objective >= result.objective * (1.0 - 2.0 * CERTIFICATE_GAP)
    assert result.rounded.before == result.objective


def test_a_finer_grid_that_holds_the_coarser_one_is_no_worse(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TWO, "subject_to: {mass: '<= 5 kg', section_size: [20 mm, 90 mm]}\n")
    result = optimise(problem)
    coarse, fine = (rounded(problem, result, read_rounding(step)).objective for step in ("8 mm", "2 mm"))
    assert fine <= coarse * (1.0 + 1e-9)


@pytest.mark.slow
def test_stock_rows_are_stock_and_come_in_their_material(tmp_path: Path) -> None:
    text = (
        "minimize: mass\n"
        "subject_to: {max_error: '<= 1.2 mm', reach: '== 700 mm', link_length: [200 mm, 500 mm]}\n"
        f"choose: {{section: [tube, rectangular_tube, i_section], material: [{ALUMINIUM}, {STEEL}]}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("stock")).rounded
    assert result is not None
    assert result.evaluation.max_error <= 1.2e-3
    assert result.evaluation.reach == pytest.approx(0.7, rel=1e-12)
    for link in result.arm.links:
        size = load_stock().find(link.section_name or "")
        assert size.section == link.section
        assert link.material is not None
        assert comes_in(size, link.material)
        assert (link.material.name == ALUMINIUM) == size.name.startswith("ALU")
    write_arm(result.arm, tmp_path / "rounded.yaml")
    assert f"section: {result.arm.links[0].section_name}" in (tmp_path / "rounded.yaml").read_text()
    assert read_arm(tmp_path / "rounded.yaml") == result.arm


@pytest.mark.slow
def test_poses_of_a_place_in_space_follow_other_lengths(tmp_path: Path) -> None:
    text = (
        "workspace: {path: [[450 mm, 100 mm], [500 mm, 250 mm]]}\n"
        "subject_to: {mass: '<= 4 kg', reach: '== 700 mm', link_length: [250 mm, 450 mm],\n"
        "             section_size: [20 mm, 90 mm]}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("1 mm", "10 mm"))
    found = result.rounded
    assert found is not None
    assert found.evaluation.reach == pytest.approx(0.7, rel=1e-12)
    best, search = np.inf, search_of(problem)
    near = {k: multiples(link.section.diameter, 1e-3, (0.02, 0.09), 2) for k, link in enumerate(result.arm.links)}
    for length in multiples(result.arm.links[0].length, 1e-2, (0.25, 0.45), 1):
        for sizes in itertools.product(near[0], near[1]):
            other = with_sections(problem.arm, [Circle(size) for size in sizes], [length, 0.7 - length])
            if mass_of(other) <= 4.0:
                best = min(best, error_of(search, other, problem))
    assert result.objective * (1.0 - 1e-3) <= found.objective <= best * (1.0 + 1e-4)


# ---- options


def test_every_grade_of_a_standard_is_in_the_catalogue() -> None:
    names = load_catalogue(user=False).names
    assert all(name in names for grades in GRADES.values() for name in grades)
    for size in load_stock(user=False):
        extruded = size.family == "HFS"
        assert comes_in(size, load_catalogue(user=False).find("aluminium-6063-t6")) == (
            extruded or size.family.startswith("ALU")
        )
        assert comes_in(size, load_catalogue(user=False).find(ALUMINIUM)) == size.family.startswith("ALU")
        assert comes_in(size, load_catalogue(user=False).find(STEEL)) != (extruded or size.family.startswith("ALU"))


@pytest.mark.parametrize(
    ("value", "step", "expected"),
    [(10.2, 0.5, [10.0, 10.5]), (10.0, 0.5, [9.5, 10.0, 10.5]), (20.0, 1.0, [19.0, 20.0]), (3.1, 3.0, [3.0, 6.0])],
)
def test_multiples_are_those_next_to_a_value(value: float, step: float, expected: list[float]) -> None:
    assert multiples(value, step, (3.0, 20.0), 1) == expected


@pytest.mark.parametrize("text", ["0.5", "half", "0 mm", "-1 mm", "2 m", "0.5 kg"])
def test_a_grid_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--round"):
        read_rounding(text)


# ---- no answer


NONE = {
    "mass ==": ("mass: '== 5.1234 kg', section_size: [20 mm, 90 mm]", "5 mm", r"mass == 5\.1234 kg"),
    "mass": ("mass: '<= 2.7 kg', section_size: [42 mm, 90 mm]", "25 mm", "mass <= 2.7 kg"),
    "no multiple": ("mass: '<= 6 kg', section_size: [52 mm, 58 mm]", "10 mm", "section_size .* no multiple of 10 mm"),
    "reach": ("mass: '<= 6 kg', reach: '== 700.5 mm', link_length: [200 mm, 500 mm]", "1 mm", r"reach == 700\.5 mm"),
    "stock": (
        "mass: '<= 6 kg', section_size: [20 mm, 21 mm], thickness: [4 mm, 5 mm]",
        "stock",
        "nearest, ALU TUBE 20x3, ",
    ),
}


@pytest.mark.parametrize("name", slow_but(NONE, "mass", "stock"))
def test_the_limit_that_no_rounded_design_keeps_is_named_and_the_optimum_kept(name: str, tmp_path: Path) -> None:
    limits, step, message = NONE[name]
    shape = "tube" if name == "stock" else "circle"
    text = f"subject_to: {{{limits}}}\nchoose: {{section: [{shape}], material: [{ALUMINIUM}]}}\n"
    result = optimise_rounded(problem_of(tmp_path, TWO, text), read_rounding(step))
    assert result.rounded is None
    assert result.built == result.arm
    assert result.not_rounded is not None
    assert re.search(message, result.not_rounded.reason)


def test_the_nearest_design_is_that_of_brute_force(tmp_path: Path) -> None:
    """Bars in steps of 16 mm that may weigh 6 kg and err by 0.66 mm: of all pairs the one whose worst excess over a
    limit is least."""
    text = (
        "minimize: cost\nsubject_to: {mass: '<= 6 kg', max_error: '<= 0.66 mm', section_size: [20 mm, 90 mm]}\n"
        f"choose: {{section: [circle], material: [{ALUMINIUM}]}}\n"
    )
    problem = problem_of(tmp_path, TWO, text)
    result = optimise_rounded(problem, read_rounding("16 mm"))
    assert result.rounded is None
    missing = result.not_rounded
    assert missing is not None
    assert missing.nearest is not None
    search = search_of(problem)

    def excess(pick: tuple[float, ...]) -> float:
        made = with_sections(problem.arm, [Circle(size) for size in pick])
        return max(mass_of(made) / 6.0, error_of(search, made, problem) / 0.66e-3) - 1.0

    least = min(excess(pick) for pick in itertools.product((0.032, 0.048, 0.064, 0.08), repeat=2))
    assert least > 0.0
    assert missing.excess == pytest.approx(least, rel=1e-4)
    assert max(limit.exceeded for limit in missing.limits) == missing.excess
    assert missing.proven


def test_the_command_writes_the_optimum_where_nothing_rounded_will_do(tmp_path: Path, capsys) -> None:
    """Status 0: what was found is there; screen, JSON and page say that it is not rounded and what comes near."""
    problem_of(tmp_path, TWO, "subject_to: {mass: '== 5.1234 kg', section_size: [20 mm, 90 mm]}\n")
    out = tmp_path / "out"
    assert run(["optimize", str(tmp_path / "problem.yaml"), "--round", "5 mm", "--out", str(out)]) == 0
    screen = capsys.readouterr().out
    assert "WARNING: not rounded to sizes in steps of 5 mm: no design" in screen
    assert "keeps mass == 5.1234 kg" in screen
    assert "the nearest design of sizes in steps of 5 mm breaks a limit by" in screen
    result = json.loads((out / "result.json").read_text())
    assert result["rounded"] is None
    (limit,) = result["not_rounded"]["nearest"]["limits"]
    assert not limit["kept"]
    assert limit["exceeded_by"] == pytest.approx(abs(limit["value"] / 5.1234 - 1.0))
    assert result["not_rounded"]["nearest"]["exceeds_a_limit_by"] == limit["exceeded_by"]
    assert sum(link["mass_kg"] for link in result["links"]) == pytest.approx(5.1234, rel=1e-5)
    assert evaluate(read_arm(out / "arm.yaml")).mass == pytest.approx(5.1234, rel=1e-5)
    assert "Not rounded to sizes in steps of 5 mm" in (out / "report.html").read_text()


# ---- interrupted


@pytest.mark.slow
def test_an_interrupt_while_sizes_are_compared_keeps_the_optimum(tmp_path: Path) -> None:
    """Before a rounded design there is the optimum alone; after one, that too."""
    text = f"subject_to: {{mass: '<= 6 kg', section_size: [20 mm, 90 mm]}}\nchoose: {{material: [{ALUMINIUM}]}}\n"
    problem = problem_of(tmp_path, TWO, text)
    calls: list[str] = []

    def at_call(number: int):
        def heard(done: int, total: int, words: str) -> None:
            del done, total
            calls.append(words)
            if sum(call.startswith("comparing rounded") for call in calls) == number:
                raise KeyboardInterrupt

        calls.clear()
        return heard

    result = optimise_rounded(problem, read_rounding("4 mm"), progress=at_call(1))
    assert result.interrupted
    assert result.rounded is None
    assert result.not_rounded is not None
    assert result.not_rounded.reason.startswith("interrupted")
    assert result.status != "interrupted"  # the optimum itself was finished
    result = optimise_rounded(problem, read_rounding("4 mm"), progress=at_call(3))
    assert result.interrupted
    assert result.rounded is not None
    assert not result.rounded.exhaustive
    assert result.rounded.evaluation.mass <= 6.0
