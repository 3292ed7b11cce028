"""Walls that buckle at the stress they bear: by hand, in optima, their prices, their rounding and what is told."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.figures.local_buckling import Buckling, link_modes, loads_case
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.rounding.options import read_rounding
from linkwright.core.optimize.rounding.rounding import rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Circle, ISection, Polygon, RectangularTube, Section, Tube
from linkwright.core.sections.taper import Tapered
from linkwright.json.design import evaluation_json
from linkwright.markdown.described import markdown
from linkwright.results.optimization import describe
from tests.optimize.builders import measured_price, problem_of

CATALOGUE = load_catalogue(user=False)
STEEL, CARBON = CATALOGUE.find("steel-s355"), CATALOGUE.find("cfrp-unidirectional")
LENGTH, CARRIED, GRAVITY = 0.5, 2.0, 9.81
TUBES = (
    "chain:\n"
    "  - joint: {type: revolute, range: [-90 deg, 90 deg]}\n"
    "    link: {length: 600 mm, section: {shape: SHAPE, thickness: 3 mm}, material: MATERIAL}\n"
    "  - joint: {type: revolute, range: [-90 deg, 90 deg]}\n"
    "    link: {length: 500 mm, section: {shape: SHAPE, thickness: 3 mm}, material: MATERIAL}\n"
    "payload: {mass: 30 kg}\n"
)
ROUND, BOX = "tube, diameter: 80 mm", "rectangular_tube, width: 60 mm, height: 80 mm"
LIGHT = "minimize: mass\nsubject_to: {max_error: '<= 3 mm', section_size: [20 mm, 400 mm], thickness: [0.2 mm, 10 mm]"


Lightest = Callable[[str], OptimizationResult]


def one_link(section: Section, material: Material = STEEL) -> Arm:
    joint = Joint(range=(-1.0, 1.0), stiffness=6e4)
    return Arm("one link", (joint,), (Link(LENGTH, section=section, material=material),), payload=LoadCase(CARRIED))


def tubes(shape: str, material: str) -> str:
    return TUBES.replace("SHAPE", shape).replace("MATERIAL", material)


# ---- by hand


def test_a_level_box_by_hand() -> None:
    """Its top at the joint: M z / I over 4 pi^2 E / (12 (1 - nu^2)) (t / c)^2."""
    box = RectangularTube(0.3, 0.3, 0.001)
    joint = replace(one_link(box).joints[0], range=(-1e-9, 1e-9))
    result = evaluate(replace(one_link(box), joints=(joint,))).local_buckling
    values, section = STEEL.at(), box.properties(0.3)
    weight = values.need("density") * section.area * LENGTH * GRAVITY
    moment = CARRIED * GRAVITY * LENGTH + 0.5 * weight * LENGTH
    stress = moment * 0.1495 / section.second_moment_y
    plate = math.pi**2 * values.need("elastic_modulus") / (12.0 * (1.0 - values.need("poisson_ratio") ** 2))
    (link,) = result.links
    assert link.factor is not None
    # The bottom is pressed where the link sags; the top is its mirror image.
    assert link.factor == pytest.approx(4.0 * plate * (1.0 / 298.0) ** 2 / stress, rel=1e-4)
    assert (link.wall, link.share) == ("top and bottom", 0.0)
    assert link.factor > 40.0  # though eight times more slender than walls that yield first


def test_what_presses_along_a_link_counts() -> None:
    """Upright, a link bears its weight and what it carries alone."""
    tube = Tube(0.05, 0.0005)
    joint = replace(one_link(tube).joints[0], range=(0.5 * math.pi - 1e-9, 0.5 * math.pi + 1e-9))
    (link,) = evaluate(replace(one_link(tube), joints=(joint,))).local_buckling.links
    values, area = STEEL.at(), tube.properties(0.3).area
    slender = 0.02475 / 0.0005
    factor = 1.0 - 0.901 * (1.0 - math.exp(-math.sqrt(slender) / 16.0))
    poisson = values.need("poisson_ratio")
    critical = factor * values.need("elastic_modulus") / math.sqrt(3.0 * (1.0 - poisson**2)) / slender
    pressing = (CARRIED + values.need("density") * area * LENGTH) * GRAVITY
    assert link.factor == pytest.approx(critical * area / pressing, rel=1e-4)


@pytest.mark.parametrize(
    ("section", "material", "word"),
    [
        (Polygon(((0.0, 0.0), (0.05, 0.0), (0.05, 0.05), (0.0, 0.05))), STEEL, "polygon"),
        (
            RectangularTube(0.05, 0.05, 0.003),
            replace(CARBON, properties={k: v for k, v in CARBON.properties.items() if k != "transverse_modulus"}),
            "stiffness of cfrp-unidirectional across its walls",
        ),
    ],
)
def test_walls_that_nobody_knows_are_unknown_never_solid(section: Section, material: Material, word: str) -> None:
    result = evaluate(one_link(section, material))
    assert result.local_buckling.least is None
    assert word in result.unknown["local_buckling"]
    assert evaluation_json(result)["local_buckling"] is None


def test_solid_links_have_nothing_that_buckles_so() -> None:
    result = evaluate(one_link(Circle(0.05)))
    assert result.local_buckling.least is None
    assert "local_buckling" not in result.unknown
    assert not FIGURES["local_buckling"].is_reported(result)


def test_walls_that_buckle_are_a_warning() -> None:
    result = evaluate(replace(one_link(ISection(0.2, 0.2, 0.0003, 0.0003)), payload=LoadCase(50.0)))
    (warning,) = [line for line in result.warnings if "walls buckle" in line]
    assert warning.startswith("link 1: walls buckle under 0.")
    assert FIGURES["local_buckling"].value(result) == result.local_buckling.least


def test_no_pose_is_nearer_to_buckling() -> None:
    arm = one_link(RectangularTube(0.06, 0.08, 0.0005))
    arm = Arm("two", arm.joints * 2, arm.links * 2, payload=LoadCase(5.0, force=(20.0, 30.0, 0.0)))
    result = evaluate(arm).local_buckling
    poses = np.random.default_rng(3).uniform(-1.0, 1.0, (5000, 2))
    beams = beams_of(arm)
    walls = Buckling((loads_case(arm, arm.payload),), tuple(link_modes(arm, k, beams[k]) for k in range(2)))
    scanned = 1.0 / walls.greatest(0, poses, beam_values(beams)).max(axis=0)
    for link, least in zip(result.links, scanned, strict=True):
        assert link.factor is not None
        assert link.factor <= least * (1.0 + 1e-9)
        assert link.factor == pytest.approx(least, rel=5e-3)


def test_a_taper_of_alike_ends_is_its_cuts() -> None:
    """At the far end a small section, at the joint the great one: each cut is judged by itself."""
    near = RectangularTube(0.06, 0.08, 0.001)
    uniform, tapered = (
        evaluate(one_link(section)).local_buckling.links[0] for section in (near, Tapered(near, near.scaled(0.2)))
    )
    assert uniform.share == 0.0
    assert 0.2 < tapered.share < 1.0
    assert uniform.factor is not None
    assert tapered.factor is not None
    assert tapered.factor < uniform.factor


# ---- optima


@pytest.fixture(scope="module")
def lightest(tmp_path_factory: pytest.TempPathFactory) -> Lightest:
    """The lightest tubes of a shape within an error, walls limited as they are where nothing is said of them."""

    @cache
    def found(shape: str) -> OptimizationResult:
        return optimise(problem_of(tmp_path_factory.mktemp("tubes"), tubes(shape, "steel-s355"), LIGHT + "}\n"))

    return found


@pytest.mark.parametrize("shape", [ROUND, pytest.param(BOX, marks=pytest.mark.slow)])
def test_walls_are_limited_unless_switched_off(tmp_path: Path, shape: str, lightest: Lightest) -> None:
    problem = problem_of(tmp_path, tubes(shape, "steel-s355"), LIGHT + "}\n")
    limited = lightest(shape)
    free = optimise(problem_of(tmp_path, tubes(shape, "steel-s355"), LIGHT + ", local_buckling: off}\n"))
    assert limited.after.local_buckling.least == pytest.approx(2.0, rel=1e-4)
    assert free.after.local_buckling.least is not None
    assert free.after.local_buckling.least < 1.5
    assert free.objective < 0.95 * limited.objective
    assert "local_buckling >= 2" in limited.limits
    assert not any("local_buckling" in text for text in free.limits)
    (limit,) = [item for item in limited.binding if item.name == "local_buckling"]
    assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.02)


def test_a_taper_that_is_chosen_keeps_its_walls(tmp_path: Path, lightest: Lightest) -> None:
    text = LIGHT + ", taper: [0.3, 1]}\n"
    tapered = optimise(problem_of(tmp_path, tubes(ROUND, "steel-s355"), text))
    assert tapered.after.local_buckling.least == pytest.approx(2.0, rel=1e-4)
    assert tapered.objective < 0.97 * lightest(ROUND).objective


@pytest.mark.slow
def test_large_thin_tubes_that_bear_little_are_not_refused(tmp_path: Path) -> None:
    """A steel tube of 300 mm and 1 mm, 4 m long: were walls to yield first, it would weigh twice as much."""
    arm = (
        "chain:\n  - joint: {type: revolute, range: [-90 deg, 90 deg]}\n    link: {length: 4 m, "
        "section: {shape: tube, diameter: 200 mm, thickness: 4 mm}, material: steel-s355}\npayload: {mass: 20 kg}\n"
    )
    sizes = "section_size: [50 mm, 300 mm], thickness: [1 mm, 10 mm]"
    given = evaluate(problem_of(tmp_path, arm.replace("200 mm", "300 mm").replace("4 mm}", "1 mm}"), "").arm)
    text = f"minimize: mass\nsubject_to: {{max_error: '<= {1e3 * given.max_error:.6f} mm', {sizes}"
    best = optimise(problem_of(tmp_path, arm, text + "}\n"))
    yielding = optimise(problem_of(tmp_path, arm, text + ", wall_slenderness: '<= 1'}\n"))
    assert best.objective == pytest.approx(given.mass, rel=1e-3)
    assert best.after.local_buckling.least is not None
    assert best.after.local_buckling.least > 2.0
    assert yielding.objective > 2.0 * best.objective


@pytest.mark.slow
def test_tubes_of_plies_along_them_are_lighter_than_steel(tmp_path: Path) -> None:
    """They buckle at a sixth of what their modulus along the link says, and bear a small part of that."""
    steel, carbon = (
        optimise(problem_of(tmp_path, tubes(ROUND, name), LIGHT.replace("0.2 mm", "1 mm") + "}\n"))
        for name in (STEEL.name, CARBON.name)
    )
    assert carbon.objective < 0.5 * steel.objective
    assert carbon.after.local_buckling.least is not None
    assert carbon.after.local_buckling.least >= 2.0 * (1.0 - 1e-4)


def test_laminates_are_limited_by_how_their_plies_lie(tmp_path: Path) -> None:
    """A laminate has no yield strength and needs none; the wall of a box, pressed evenly, holds by sqrt(D11 D22) + D12
    + 2 D66 of its plies in their order."""
    results: list[float] = []
    for angles in ("[0 deg, 45 deg, -45 deg, 0 deg]", "[45 deg, 0 deg, 0 deg, -45 deg]"):
        material = f"{{laminate: {{ply: cfrp-unidirectional, angles: {angles}}}}}"
        problem = problem_of(tmp_path, tubes(BOX, material), LIGHT + "}\n")
        made = problem.arm.links[0].material
        assert made is not None
        assert made.bending is not None
        bends = made.bending
        plate = (math.sqrt(bends.along * bends.around) + bends.both + 2.0 * bends.shear) / 12.0
        walls = made.at().walls
        assert walls is not None
        assert 1.0 / walls.pressed == pytest.approx(2.0 * math.pi**2 * plate, rel=1e-12)
        results.append(evaluate(problem.arm).local_buckling.least or 0.0)
    # Plies at 45 degrees, which hold most against buckling, count for more outside.
    assert results[1] > 1.1 * results[0]
    result = optimise(problem)
    assert "local_buckling" not in result.after.unknown
    assert result.after.local_buckling.least == pytest.approx(2.0, rel=1e-4)


def test_rounding_keeps_the_walls(tmp_path: Path, lightest: Lightest) -> None:
    problem = problem_of(tmp_path, tubes(BOX, "steel-s355"), LIGHT + "}\n")
    result = rounded(problem, lightest(BOX), read_rounding("0.1 mm"))
    after = result.evaluation.local_buckling.least
    assert after is not None
    assert after >= 2.0


def test_a_default_that_binds_says_what_it_costs(lightest: Lightest) -> None:
    text = markdown(describe(lightest(BOX)))
    assert "local\\_buckling &gt;= 2 was not asked for and binds: one more would cost 0.13" in text


def test_a_material_that_drops_out_says_by_which_limit(tmp_path: Path) -> None:
    """Within 120 mm no tube of plastic is stiff enough."""
    chosen = "choose: {material: [steel-s355, nylon-66], same: [material]}\n"
    sizes = "section_size: [20 mm, 120 mm], thickness: [1 mm, 10 mm]"
    text = f"subject_to: {{max_error: '<= 3 mm', mass: '<= 6 kg', {sizes}}}\n{chosen}minimize: mass\n"
    result = optimise(problem_of(tmp_path, tubes(ROUND, "steel-s355"), text))
    (dropped,) = result.dropped
    assert (dropped.kind, dropped.name) == ("material", "nylon-66")
    assert dropped.limits == ("max_error <= 3 mm",)
    assert "the material nylon-66 drops out: what comes nearest of it breaks" in markdown(describe(result))
