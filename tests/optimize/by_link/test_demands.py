"""Limits that ask different things of links, and the room for cables."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import INNER_SIZE, SAFETY_FACTOR
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES, Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many

ARM = jointed((400, 300), ranged("-60 90", "-90 90"), rest="payload: {mass: 40 kg}\n")
SOFT = "max_error: '<= 40 mm'"
SIZES = "section_size: [20 mm, 90 mm], thickness: [1 mm, 6 mm]"


def asked(folder: Path, limits: str, choose: str, aim: str = "mass") -> Problem:
    return problem_of(folder, ARM, f"minimize: {aim}\nsubject_to: {{{limits}, {SIZES}}}\nchoose: {choose}\n")


def factors(problem: Problem, arm: object) -> list[float]:
    result = evaluate(arm, problem.workspace, problem.load_cases).strength.safety_factor  # type: ignore[arg-type]
    return [float(item) for item in result if item is not None]


def widest_circle(section: Section) -> float:
    """The diameter of the largest circle within the hole of an outline, by a search for its centre."""
    hole = np.array(section.outline()[1])
    ends = np.roll(hole, -1, axis=0)
    keep = np.linalg.norm(ends - hole, axis=1) > 1e-12
    hole, ends = hole[keep], ends[keep]
    center, step = hole.mean(axis=0), 0.25 * float(np.ptp(hole))

    def room(at: np.ndarray) -> float:
        along = ends - hole
        share = np.clip(((at - hole) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        return float(np.linalg.norm(hole + share[:, None] * along - at, axis=1).min())

    while step > 1e-9:
        near = [center + step * np.array(item) for item in itertools.product((-1.0, 0.0, 1.0), repeat=2)]
        best = max(near, key=room)
        center, step = (best, step) if room(best) > room(center) else (center, 0.5 * step)
    return 2.0 * room(center)


@pytest.mark.parametrize(
    "shape",
    ["tube", "rectangular_tube", "elliptical_tube", "octagonal_tube", "hexagonal_tube", "triangular_tube"],
)
def test_inner_size_is_the_largest_circle_in_the_hollow(shape: str) -> None:
    sizes = {"diameter": 0.08, "width": 0.06, "height": 0.09, "thickness": 0.004}
    section = SHAPES[shape](
        **{dimension.name: sizes[dimension.name] for dimension in SHAPES[shape].dimensions if dimension.name in sizes}
    )
    assert section.inner_diameter == pytest.approx(widest_circle(section), rel=2e-3)
    assert section.inner_diameter == min(section.inner_widths or ())


def test_nothing_goes_through_what_is_not_closed(tmp_path: Path) -> None:
    problem = asked(tmp_path, "max_error: '<= 5 mm'", "{section: [tube]}")
    for shape in ("circle", "rectangle", "i_section", "channel"):
        section = SHAPES[shape].start(1e-3, (0.02, 0.09), (0.001, 0.006))
        arm = problem.arm.with_links(tuple(replace(link, section=section) for link in problem.arm.links))
        assert INNER_SIZE.of_links(arm) == 0.0


@pytest.mark.parametrize("many", slow_but([False, True], True))
def test_room_for_cables_by_link(many: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A light arm of tubes and rods that has to let cables through is of tubes, as wide as they need."""
    if many:
        taken_for_many(monkeypatch)
    limits = "inner_size: {1: '>= 60 mm', others: '>= 45 mm'}, max_error: '<= 60 mm'"
    problem = asked(tmp_path, limits, "{section: [circle, tube, i_section]}")
    (limit,) = problem.limit("inner_size")
    assert limit.text == "inner_size >= 45 mm (link 1: 60 mm)"
    result = optimise(problem)
    assert result.doubts == ()
    sections = [link.section for link in result.arm.links if link.section is not None]
    assert [section.shape for section in sections] == ["tube", "tube"]
    wide = [float(section.inner_diameter) for section in sections]
    # Rods let nothing through, whatever their sizes: that is known, no failure.
    assert not any(candidate.outcome == "unsolved" for candidate in result.candidates)
    assert wide[0] >= 0.06 * (1.0 - 1e-6)
    assert wide[1] >= 0.045 * (1.0 - 1e-6)
    assert INNER_SIZE.value(result.after) == pytest.approx(min(wide), rel=1e-12)
    assert any(item.name == "inner_size" for item in result.binding)


def test_tapered_links_have_room_at_their_far_ends(tmp_path: Path) -> None:
    limits = "inner_size: '>= 40 mm', taper: [0.4, 1], max_error: '<= 8 mm'"
    result = optimise(asked(tmp_path, limits, "{section: [tube]}"))
    for link in result.arm.links:
        far = link.section.far if isinstance(link.section, Tapered) else link.section
        assert far is not None
        assert float(far.inner_diameter) >= 0.04 * (1.0 - 1e-6)


def test_safety_by_link(tmp_path: Path) -> None:
    limits = "safety_factor: {1: '>= 6', 2: '>= 3'}, max_error: '<= 40 mm'"
    problem = asked(tmp_path, limits, "{section: [tube], material: [steel-s355]}")
    first, second = factors(problem, optimise(problem).arm)
    assert (first, second) == (pytest.approx(6.0, rel=2e-3), pytest.approx(3.0, rel=2e-3))


@pytest.mark.parametrize("many", slow_but([False, True], True))
def test_safety_by_material(many: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A choice of materials with a factor for each is the better of the two alone, each with its own factor."""
    if many:
        taken_for_many(monkeypatch)
    alone = [
        optimise(asked(tmp_path, f"safety_factor: '>= {factor}', {SOFT}", f"{{section: [tube], material: [{name}]}}"))
        for name, factor in (("steel-s355", 2), ("aluminium-6061-t6", 6))
    ]
    limits = "safety_factor: {aluminium-6061-t6: '>= 6', others: '>= 2'}, " + SOFT
    choose = "{section: [tube], material: [steel-s355, aluminium-6061-t6], same: [material]}"
    result = optimise(asked(tmp_path, limits, choose))
    assert result.doubts == ()
    assert result.objective == pytest.approx(min(item.objective for item in alone), rel=1e-4)
    (limit,) = asked(tmp_path, limits, choose).limit("safety_factor")
    assert limit.of(result.after) == pytest.approx(2.0, rel=2e-3)
    assert SAFETY_FACTOR.value(result.after) >= 2.0 * (1.0 - 1e-6)


BY_LINK = "{1: '>= 2', 2: '>= 5'}"


@pytest.mark.parametrize("material", slow_but(["{steel-s355: '>= 2', others: '>= 5'}", BY_LINK], BY_LINK))
def test_listed_sizes_are_those_of_every_combination(material: str, tmp_path: Path) -> None:
    """Against all 36 designs one by one: evaluated is what lets the cables through and is lighter than what was."""
    sizes = "sizes: {diameter: [50 mm, 60 mm, 80 mm], thickness: 3 mm}"
    listed = f"{{section: [tube], material: [steel-s355, aluminium-6061-t6], {sizes}}}"
    cables = "inner_size: {1: '>= 50 mm', 2: '>= 30 mm'}"
    problem = asked(tmp_path, f"safety_factor: {material}, {cables}, max_error: '<= 20 mm'", listed)
    result = optimise(problem)
    assert problem.sizes is not None
    best = np.inf
    options = [itertools.product(own, problem.materials_of(k)) for k, own in enumerate(problem.sizes)]
    for picks in itertools.product(*options):
        links = (
            replace(link, section=item.section, material=stuff)
            for link, (item, stuff) in zip(problem.arm.links, picks, strict=True)
        )
        arm = problem.arm.with_links(tuple(links))
        wide = [float(item.section.inner_diameter) for item, _ in picks]
        mass = sum(
            link.length * float(item.section.properties(0.3).area) * stuff.need("density")
            for link, (item, stuff) in zip(arm.links, picks, strict=True)
        )
        if wide[0] < 0.05 or wide[1] < 0.03 or mass >= best:
            continue
        found = evaluate(arm, problem.workspace, problem.load_cases)
        assert found.mass == pytest.approx(mass, rel=1e-9)
        needed = [2.0 if item.name == "steel-s355" else 5.0 for _, item in picks]
        if "1:" in material:
            needed = [2.0, 5.0]
        safe = all(own >= due for own, due in zip(found.strength.safety_factor, needed, strict=True))
        if safe and found.max_error <= 0.02:
            best = mass
    assert np.isfinite(best)
    assert result.objective == pytest.approx(best, rel=1e-9)


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ("inner_size: {1: '>= 30 mm'}", r"subject_to\.inner_size: says nothing of link 2; add others"),
        ("inner_size: {1: '<= 30 mm', 2: '>= 3 mm'}", r"subject_to\.inner_size\.1: can only be limited by >="),
        ("safety_factor: {steel-s355: '>= 4'}", r"subject_to\.safety_factor: says nothing of aluminium-6061-t6; add"),
        ("safety_factor: {steel-s3555: '>= 4', others: '>= 2'}", r"safety_factor\.steel-s3555: is no material that"),
        ("first_frequency: {1: '>= 4 Hz', 2: '>= 3 Hz'}", r"subject_to\.first_frequency: "),
        (
            "inner_size: {steel-s355: '>= 4 mm', others: '>= 3 mm'}",
            r"inner_size: takes one limit, or one by link",
        ),
        (
            "safety_factor: ['>= 2', {1: '>= 3', 2: '>= 4'}]",
            r"safety_factor: asks different things of links",
        ),
    ],
)
def test_one_line_tells_what_is_wrong(limits: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        asked(
            tmp_path, f"{limits}, max_error: '<= 5 mm'", "{section: [tube], material: [steel-s355, aluminium-6061-t6]}"
        )
