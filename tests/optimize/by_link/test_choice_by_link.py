"""Shapes and materials said link by link: the same as every allowed combination on its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.optimize.choice.picks import combinations, count
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.problem_summary import choices_in_words
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many

ARM = jointed((400, 300), ranged("-60 90", "-90 90"))
LIMITS = "subject_to: {section_size: [20 mm, 90 mm], thickness: [2 mm, 6 mm], mass: '<= 6 kg'}\n"
FIRST_SOLID = "{section: {1: [circle], others: [tube, rectangle]}, material: {2: [steel-s355], 1: [aluminium-6061-t6]}}"


def asked(folder: Path, choose: str, limits: str = LIMITS) -> Problem:
    return problem_of(folder, ARM, f"choose: {choose}\n{limits}")


def alone(problem: Problem) -> list[float]:
    """The optimum of each combination that the problem allows, which is then no choice."""
    results: list[float] = []
    for pick in combinations(problem):
        sections = [
            SHAPES[str(shape)].start(0.3, *own.sizes) for shape, own in zip(pick.shapes, problem.ranges, strict=True)
        ]
        parts = zip(problem.arm.links, sections, pick.materials, strict=True)
        links = tuple(replace(link, section=section, material=material) for link, section, material in parts)
        own = replace(problem, arm=problem.arm.with_links(links), shapes=None, materials=None, lists=None)
        results.append(optimise(own).objective)
    return results


def test_each_link_has_its_own_list(tmp_path: Path) -> None:
    problem = asked(tmp_path, FIRST_SOLID)
    picks = [
        (pick.shapes, tuple(material.name for material in pick.materials if material)) for pick in combinations(problem)
    ]
    assert picks == [(("circle", other), ("aluminium-6061-t6", "steel-s355")) for other in ("tube", "rectangle")]
    assert count(problem) == 2
    told = (
        "section: link 1: circle; link 2: tube, rectangle",
        "material: link 1: aluminium-6061-t6; link 2: steel-s355",
    )
    assert choices_in_words(problem) == told
    result = optimise(problem)
    assert result.objective == pytest.approx(min(alone(problem)), rel=1e-5)
    first, second = result.arm.links
    assert (first.section.shape, first.material.name) == ("circle", "aluminium-6061-t6")
    assert second.material.name == "steel-s355"


def test_what_must_agree_is_what_all_lists_hold(tmp_path: Path) -> None:
    problem = asked(tmp_path, "{section: {1: [circle, tube], 2: [rectangle, tube]}, same: [section]}")
    assert [pick.shapes for pick in combinations(problem)] == [("tube", "tube")]
    assert count(problem) == 1
    assert [link.section.shape for link in optimise(problem).arm.links] == ["tube", "tube"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", slow_but(range(6), 1, 4))
def test_random_lists_against_every_combination(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each tried, and as one of many that are bounded."""
    rng = np.random.default_rng(seed)
    shapes = ("circle", "tube", "rectangle", "ellipse")
    metals = ("aluminium-6061-t6", "steel-s355", "titanium-ti-6al-4v")
    lists = [[str(x) for x in rng.choice(shapes, rng.integers(1, 3), replace=False)] for _ in range(2)]
    stuffs = [[str(x) for x in rng.choice(metals, rng.integers(1, 3), replace=False)] for _ in range(2)]
    own = ", ".join(f"{k}: [{', '.join(item)}]" for k, item in enumerate(lists, start=1))
    of = ", ".join(f"{k}: [{', '.join(item)}]" for k, item in enumerate(stuffs, start=1))
    problem = asked(tmp_path, f"{{section: {{{own}}}, material: {{{of}}}}}")
    least = min(alone(problem))
    assert optimise(problem).objective == pytest.approx(least, rel=2e-4)
    taken_for_many(monkeypatch)
    assert optimise(problem).objective == pytest.approx(least, rel=2e-4)


@pytest.mark.parametrize(
    ("choose", "said"),
    [
        ("{section: {1: [circle]}}", r"choose\.section: says nothing of link 2; add others"),
        ("{section: {1: [circle], 5: [tube], others: [tube]}}", r"choose\.section\.5: is no link with a section"),
        ("{section: {1: [circle], 2: [tube], others: [tube]}}", r"choose\.section\.others: is of no link"),
        ("{section: {1: [circle], 2: [tub]}}", r"choose\.section\.2\[1\]: there is no shape 'tub'"),
        ("{material: {1: [steel-s356], others: [steel-s355]}}", r"choose\.material\.1"),
    ],
)
def test_a_mapping_that_leaves_something_open_is_refused(choose: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        asked(tmp_path, choose)


def test_fronts_by_material_need_one_list(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs one list for all links"):
        question(asked(tmp_path, FIRST_SOLID), "mass", "max_error", by="material")
