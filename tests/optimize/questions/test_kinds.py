"""How many different materials and parts a design may have: against every design that keeps it, singly."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES, broken
from linkwright.core.optimize.choice import large_choice
from linkwright.core.optimize.choice.agreement import codes_of, number_of, parts, table, within
from linkwright.core.optimize.choice.picks import combinations, count
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import best_value, jointed, problem_of, ranged, taken_for_many

MATERIALS = ("aluminium-6061-t6", "steel-s355", "cfrp-quasi-isotropic")
ARM = jointed((400, 350, 300), ranged("-60 60", "0 60", "0 60"))
LIMITS = "mass: '<= 2.5 kg', cost: '<= 30 EUR', section_size: [10 mm, 90 mm]"
SIZES = "{diameter: [22 mm, 28 mm, 34 mm]}"


def asked(names: tuple[str, ...], more: str = "", sizes: str = "") -> str:
    chosen = f"section: [circle], material: [{', '.join(names)}]" + (f", sizes: {sizes}" if sizes else "")
    return f"subject_to: {{{LIMITS}{more}}}\nchoose: {{{chosen}}}\n"


def test_so_many_materials_are_the_best_of_all_sets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every combination of few; a bound for each; and all bounded at once."""
    values: dict[int, float] = {}
    for most in (1, 2):
        sets = list(itertools.combinations(MATERIALS, most))
        best = min(best_value(problem_of(tmp_path, ARM, asked(some))) for some in sets)
        problem = problem_of(tmp_path, ARM, asked(MATERIALS, f", materials: '<= {most}'"))
        result = optimise(problem)
        assert 1e3 * result.objective == pytest.approx(best, rel=1e-4)
        ties = [len({link.material for link in item.arm.links}) for item in result.near_ties]
        assert max(ties, default=1) <= most
        values[most] = result.objective
    assert values[1] > 1.01 * values[2]
    problem = problem_of(tmp_path, ARM, asked(MATERIALS, ", materials: '<= 1'"))
    taken_for_many(monkeypatch)
    assert optimise(problem).objective == pytest.approx(values[1], rel=1e-4)
    monkeypatch.setattr(large_choice, "MOST_AT_ONCE", 0)
    assert optimise(problem).objective == pytest.approx(values[1], rel=1e-2)


def test_two_parts_of_listed_sizes_are_the_best_of_all_designs(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, asked(MATERIALS[:1], ", parts: '<= 2'", SIZES).replace("2.5 kg", "2 kg"))
    assert problem.sizes is not None
    options = [(item.section, material) for material in problem.materials_of(0) for item in problem.sizes[0]]
    others = [limit for limit in problem.limits if limit.name != "parts"]
    values: dict[int, list[float]] = {1: [], 2: [], 3: []}
    for pick in itertools.product(options, repeat=3):
        pairs = zip(problem.arm.links, pick, strict=True)
        links = tuple(
            link.__class__(link.length, section=section, material=material) for link, (section, material) in pairs
        )
        arm = problem.arm.with_links(links)
        whole = evaluate(arm, problem.workspace, problem.load_cases)
        if not broken(others, whole):
            values[len(set(pick))].append(whole.max_error)
    result = optimise(problem)
    assert result.objective == pytest.approx(min(*values[1], *values[2]), rel=1e-4)
    assert FIGURES["parts"].value(result.after) == 2.0
    assert min(values[3]) < 0.99 * result.objective
    assert "parts <= 2" in [limit.text for limit in problem.limits]


def test_one_part_of_free_dimensions_is_the_same_in_all_links(tmp_path: Path) -> None:
    one = optimise(problem_of(tmp_path, ARM, asked(MATERIALS[:2], ", parts: '<= 1'")))
    text = asked(MATERIALS[:2]).replace("choose: {", "choose: {same: [section, material, size], ")
    assert one.objective == pytest.approx(optimise(problem_of(tmp_path, ARM, text)).objective, rel=1e-9)
    assert len({(link.section, link.material) for link in one.arm.links}) == 1
    with pytest.raises(InputError, match=r"subject_to.parts.*choose: \{sizes"):
        problem_of(tmp_path, ARM, asked(MATERIALS[:2], ", parts: '<= 2'"))


def test_links_that_cannot_agree_are_said(tmp_path: Path) -> None:
    text = "subject_to: {mass: '<= 6 kg', section_size: [10 mm, 90 mm], materials: '<= 1'}\n"
    text += "choose: {section: [circle], material: {1: [steel-s355], others: [aluminium-6061-t6]}}\n"
    with pytest.raises(NoAnswer, match=r"materials <= 1; what links can be: link 1: circle of steel-s355; link 2"):
        optimise(problem_of(tmp_path, ARM, text))


def test_limits_that_none_keeps_are_told_with_what_stays(tmp_path: Path) -> None:
    text = asked(MATERIALS[:2], ", materials: '<= 1', max_error: '<= 0.4 mm'").replace("cost: '<= 30 EUR', ", "")
    with pytest.raises(NoAnswer) as why:
        optimise(problem_of(tmp_path, ARM, text))
    assert "materials <= 1" in str(why.value)
    assert "max_error" in str(why.value)


@given(st.lists(st.lists(st.integers(0, 3), min_size=1, max_size=4), min_size=1, max_size=4), st.integers(1, 3))
def test_parts_hold_all_designs_that_agree(kinds: list[list[int]], most: int) -> None:
    codes, sizes = codes_of(kinds), [len(link) for link in kinds]
    every = set(itertools.product(*map(range, sizes)))
    agreed = {pick for pick in every if len({kinds[k][o] for k, o in enumerate(pick)}) <= most}
    held = {
        pick for part in parts([(codes, most)], sizes) for pick in itertools.product(*(ids.tolist() for ids in part))
    }
    assert held == agreed
    assert number_of([(codes, most)], sizes) == len(agreed)
    rows = np.array(sorted(every))
    assert {tuple(row) for row in rows[within(codes, rows, most)].tolist()} == agreed
    assert {tuple(row) for row in np.argwhere(table(codes, most)).tolist()} == agreed


def test_combinations_are_those_that_agree(tmp_path: Path) -> None:
    text = asked(MATERIALS, ", materials: '<= 2'").replace("[circle]", "[circle, tube]")
    problem = problem_of(tmp_path, ARM, text)
    every = combinations(problem)
    assert len(every) == len(set(every)) == count(problem) == 8 * (3 + 3 * 6)
    assert all(len({material.name for material in pick.materials if material}) <= 2 for pick in every)
