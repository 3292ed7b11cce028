"""Limits as objects: slender walls, height over width and tip stiffness, and one more that only the test knows."""

from __future__ import annotations

import math
from dataclasses import replace
from io import StringIO
from pathlib import Path
from types import MappingProxyType

import casadi as ca
import numpy as np
import pytest
from rich.console import Console
from scipy.optimize import brentq

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES, Figure, Limit, OfLinks
from linkwright.core.arm.figures.tip_stiffness import least_stiffness, tip_compliance
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.rounding.options import Rounding
from linkwright.core.optimize.rounding.rounding import rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.optimize.tradeoff.tradeoff import trade_off
from linkwright.core.sections import Circle, Polygon, RectangularTube, Section
from linkwright.core.sections.shapes import EllipticalTube
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.json.design import evaluation_json, optimization_json
from linkwright.markdown.described import markdown
from linkwright.report.described import page_of
from linkwright.results.design import figures as told
from linkwright.results.optimization import describe
from linkwright.screen.described import show
from tests.optimize.builders import measured_price, problem_of

STEEL = load_catalogue(user=False).find("steel-s355")
CFRP = load_catalogue(user=False).find("cfrp-quasi-isotropic")
BOX = RectangularTube(0.3, 0.3, 0.001)
DRIVE = 6e4

TUBES = (
    "chain:\n" + "  - joint: {type: revolute, range: [-90 deg, 90 deg], stiffness: 60 kN*m/rad}\n"
    "    link: {length: 500 mm, section: {shape: rectangular_tube, width: 60 mm, height: 80 mm, thickness: 3 mm}, "
    "material: steel-s355}\n" * 2 + "payload: {mass: 5 kg}\n"
)
LIGHT = "minimize: mass\nsubject_to: {max_error: '<= 2.5 mm', section_size: [20 mm, 200 mm], thickness: [1 mm, 10 mm]"


def one_link(section: Section, material: Material = STEEL, length: float = 0.5) -> Arm:
    joint = Joint(range=(-1.0, 1.0), stiffness=DRIVE)
    return Arm("one link", (joint,), (Link(length, section=section, material=material),), payload=LoadCase(2.0))


# ---- slender walls


def test_slender_walls_by_hand() -> None:
    """c / t = 298 against 42 sqrt(235 / f_y * E / 210 GPa)."""
    result = evaluate(one_link(BOX))
    values = STEEL.at(result.arm.temperature)
    greatest = 42.0 * math.sqrt(235e6 / values.need("yield_strength") * values.need("elastic_modulus") / 210e9)
    assert FIGURES["wall_slenderness"].value(result) == pytest.approx(298.0 / greatest, rel=1e-12)
    assert not any("buckle" in line for line in result.warnings)  # under what it bears it is far from that


def test_a_wall_at_the_limit_yields_before_the_plate_buckles() -> None:
    """sigma_cr = 4 pi^2 E / (12 (1 - nu^2)) (t / c)^2 of a long plate held at both edges is above the yield strength at
    the limit, by 1 / lambda_p^2 with lambda_p = 42 / (28.4 sqrt 4) (EN 1993-1-5, 4.4)."""
    thickness, strength, modulus = 0.002, 355e6, 210e9
    clear = 42.0 * math.sqrt(235e6 / strength) * thickness
    critical = 4.0 * math.pi**2 * modulus / (12.0 * (1.0 - 0.3**2)) * (thickness / clear) ** 2
    assert critical / strength == pytest.approx((28.4 * 2.0 / 42.0) ** 2, rel=2e-3)


@pytest.mark.parametrize(
    ("section", "material", "word"),
    [
        (Polygon(((0.0, 0.0), (0.05, 0.0), (0.05, 0.05), (0.0, 0.05))), STEEL, "polygon"),
        (RectangularTube(0.05, 0.05, 0.003), CFRP, "yield strength"),
    ],
)
def test_walls_that_nobody_knows_are_unknown_never_solid(section: Section, material: Material, word: str) -> None:
    arm = one_link(section, material)
    result = evaluate(arm)
    assert FIGURES["wall_slenderness"].value(result) is None
    assert word in result.unknown["wall_slenderness"]
    assert evaluation_json(result)["wall_slenderness"] is None


def test_solid_links_have_no_slender_walls() -> None:
    result = evaluate(one_link(Circle(0.05)))
    assert FIGURES["wall_slenderness"].value(result) == 0.0
    assert "wall_slenderness" not in result.unknown


def test_an_elliptical_tube_counts_where_it_is_flattest() -> None:
    """As a round tube of the curvature radius there: 2 a^2 / b across the short axis."""
    result = evaluate(one_link(EllipticalTube(0.04, 0.1, 0.001)))
    values = STEEL.at(result.arm.temperature)
    square = 235e6 / values.need("yield_strength") * values.need("elastic_modulus") / 210e9
    assert FIGURES["wall_slenderness"].value(result) == pytest.approx(
        0.1**2 / 0.04 / 0.001 / (90.0 * square), rel=1e-12
    )


def test_slender_walls_are_limited_where_that_is_asked_for(tmp_path: Path) -> None:
    limited = optimise(problem_of(tmp_path, TUBES, LIGHT + ", wall_slenderness: '<= 1'}\n"))
    free = optimise(problem_of(tmp_path, TUBES, LIGHT + ", wall_slenderness: off}\n"))
    slack = optimise(problem_of(tmp_path, TUBES, LIGHT + ", wall_slenderness: '<= 1.5'}\n"))
    worst = [FIGURES["wall_slenderness"].value(result.after) for result in (limited, slack, free)]
    assert worst[0] == pytest.approx(1.0, abs=1e-6)
    assert worst[1] == pytest.approx(1.5, abs=1e-6)
    assert worst[2] is not None
    assert worst[2] > 1.5
    assert free.objective < slack.objective < limited.objective
    assert "wall_slenderness <= 1" in limited.limits
    assert not any("wall_slenderness" in text for text in free.limits)
    assert free.objective == optimise(problem_of(tmp_path, TUBES, LIGHT + "}\n")).objective


def test_walls_that_nobody_can_judge_are_told_of_a_new_design(tmp_path: Path) -> None:
    in_place = "{elastic_modulus: 70 GPa, shear_modulus: 5 GPa, density: 1600 kg/m^3, isotropic: false}"
    result = optimise(problem_of(tmp_path, TUBES.replace("steel-s355", in_place), LIGHT + "}\n"))
    said = markdown(describe(result))
    assert "new design: local buckling is not known: link 1: the stiffness of" in said
    assert "not known: a link's material has no yield strength" in said


def test_price_of_slender_walls_is_what_optimising_anew_gives(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TUBES, LIGHT + ", wall_slenderness: '<= 1'}\n")
    (limit,) = [item for item in optimise(problem).binding if item.name == "wall_slenderness"]
    assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.02)


def test_solid_shapes_bring_no_limit_on_walls(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TUBES, "choose: {section: [circle, rectangle]}\nsubject_to: {mass: '<= 5 kg'}\n")
    assert [limit.name for limit in problem.limits] == ["mass"]


def test_only_what_is_assumed_can_be_switched_off(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mass: holds only where it is asked for"):
        problem_of(tmp_path, TUBES, "subject_to: {mass: off}\n")


# ---- height over width


def test_aspect_holds_the_height_of_a_bar(tmp_path: Path) -> None:
    """The stiffest bar of a given area is as high as it may be: h = sqrt(3 A)."""
    text = "subject_to: {mass: '== 3 kg', aspect: '<= 3', section_size: [5 mm, 300 mm]}\n"
    arm = TUBES.replace("rectangular_tube", "rectangle").replace(", thickness: 3 mm", "")
    problem = problem_of(tmp_path, arm, text)
    result = optimise(problem)
    for link in result.arm.links:
        area = link.section.width * link.section.height
        assert link.section.height == pytest.approx(math.sqrt(3.0 * area), rel=1e-6)
    (limit,) = [item for item in result.binding if item.name == "aspect"]
    assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.02)


# ---- tip stiffness


@pytest.mark.parametrize(("shape", "wall"), [("rectangle", math.inf), ("rectangular_tube", 2e-3)])
def test_lightest_column_is_square(shape: str, wall: float, tmp_path: Path) -> None:
    """Upright under 40 kg and its weight, held at its foot: of all sections as heavy a square one holds most."""
    length, density, modulus = 0.8, 2700.0, 70e9

    def mass_and_factor(side: float) -> tuple[float, float]:
        inner = max(side - 2.0 * wall, 0.0)
        mass = density * (side**2 - inner**2) * length
        euler = math.pi**2 / 4.0 * modulus * (side**4 - inner**4) / 12.0 / length**2
        return mass, euler / (9.81 * (40.0 + math.pi**2 / 4.0 / 7.837 * mass))

    side = brentq(lambda size: mass_and_factor(size)[1] - 3.0, 5e-3, 0.1)
    arm = (
        "chain:\n  - joint: {type: revolute, range: [80 deg, 100 deg]}\n"
        "    link: {length: 800 mm, section: {shape: rectangle, width: 30 mm, height: 40 mm},\n"
        "      material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.33}}\n"
        "payload: {mass: 40 kg}\n"
    )
    sizes = "section_size: [5 mm, 100 mm], thickness: [2 mm, 10 mm], local_buckling: off"
    text = f"workspace: {{poses: [[90 deg]]}}\nminimize: mass\nchoose: {{section: [{shape}]}}\n"
    result = optimise(problem_of(tmp_path, arm, f"{text}subject_to: {{buckling: '>= 3', {sizes}}}\n"))
    assert result.status == "converged"
    assert result.objective == pytest.approx(mass_and_factor(side)[0], rel=2e-4)


def test_tip_stiffness_of_one_link_by_hand() -> None:
    """Across the link 1 / k = L^2 / k_drive + L^3 / (3 E I), shear left out; along it nothing but the strain."""
    bar, length = Circle(0.05), 0.5
    arm = replace(one_link(bar, length=length), leave_out=frozenset({"shear_deformation"}))
    result = evaluate(arm)
    modulus = STEEL.at(arm.temperature).need("elastic_modulus")
    across = length**2 / DRIVE + length**3 / (3.0 * modulus * math.pi * 0.05**4 / 64.0)
    assert result.stiffness is not None
    assert result.stiffness.value == pytest.approx(1.0 / across, rel=1e-9)
    assert evaluation_json(result)["tip_stiffness_N_per_mm"] == pytest.approx(1e-3 / across, rel=1e-9)


def test_no_pose_is_softer(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, TUBES, "subject_to: {mass: '<= 5 kg'}\n")
    result = evaluate(problem.arm).stiffness
    assert result is not None
    poses = np.random.default_rng(4).uniform(-math.pi / 2, math.pi / 2, (5000, 2))
    p = beam_values(beams_of(problem.arm))
    scanned = least_stiffness(tip_compliance(problem.arm, planar=True), poses, p)
    assert scanned is not None
    assert result.value <= scanned.value * (1.0 + 1e-9)
    assert result.value == pytest.approx(scanned.value, rel=5e-3)


def test_a_cut_is_exact_where_it_was_made_and_no_bound_is_too_tight(tmp_path: Path) -> None:
    """|C u| is the softness at its own direction, below it for any other; its gradient is that of differences."""
    arm = problem_of(tmp_path, TUBES, "subject_to: {mass: '<= 5 kg'}\n").arm
    compliance, p = tip_compliance(arm, planar=True), beam_values(beams_of(arm))
    own = least_stiffness(compliance, [(0.2, 0.9)], p)
    assert own is not None
    q, beams = compliance.inputs
    force = np.array(own.direction)
    moved = ca.norm_2(ca.mtimes(ca.reshape(compliance.outputs[0], 2, 2), ca.DM(force)))
    softness = ca.Function("softness", [q, beams], [moved, ca.gradient(moved, beams)])
    value, gradient = (np.array(item).ravel() for item in softness(own.q, p))
    assert float(value[0]) == pytest.approx(1.0 / own.value, rel=1e-9)
    matrix = compliance.matrices(np.array([own.q]), p)[0]
    for angle in np.linspace(0.0, math.pi, 30):
        assert np.linalg.norm(matrix @ [math.cos(angle), math.sin(angle)]) <= value[0] * (1.0 + 1e-12)
    for k in np.flatnonzero(gradient):
        step = np.zeros(len(p))
        step[k] = 1e-5 * p[k]
        ends = [least_stiffness(compliance, [own.q], p + sign * step) for sign in (1.0, -1.0)]
        assert ends[0] is not None
        assert ends[1] is not None
        slope = (1.0 / ends[0].value - 1.0 / ends[1].value) / (2.0 * step[k])
        assert gradient[k] == pytest.approx(slope, rel=1e-4, abs=1e-9 * abs(value[0] / p[k]))


AT_POSES = "{at_least: 47 N/mm, poses: [[0 deg, 30 deg], [20 deg, 80 deg]]}"


@pytest.mark.parametrize("asked", ["'>= 45 N/mm'", pytest.param(AT_POSES, marks=pytest.mark.slow)])
def test_stiffness_is_kept_and_priced(tmp_path: Path, asked: str) -> None:
    text = f"minimize: mass\nsubject_to: {{tip_stiffness: {asked}, section_size: [20 mm, 200 mm]}}\n"
    problem = problem_of(tmp_path, TUBES, text)
    result = optimise(problem)
    (limit,) = problem.limit("tip_stiffness")
    assert limit.of(result.after) == pytest.approx(limit.value, rel=3e-5)
    (binding,) = [item for item in result.binding if item.name == "tip_stiffness"]
    assert binding.unit == "N/mm"
    assert binding.price == pytest.approx(measured_price(problem, binding), rel=0.02)


def test_more_stiffness_than_there_is_says_how_much_there_is(tmp_path: Path) -> None:
    text = "minimize: mass\nsubject_to: {tip_stiffness: '>= 5000 N/mm'}\n"
    with pytest.raises(NoAnswer, match=r"tip_stiffness >= 5000 N/mm would have to be >= \d+\.?\d* N/mm"):
        optimise(problem_of(tmp_path, TUBES, text))


@pytest.mark.parametrize(
    ("asked", "word"),
    [
        ("{at_least: 500 N/mm, poses: [[0 deg]]}", "a coordinate for each of the 2 joints"),
        ("{at_most: 500 N/mm}", "can only be limited by >="),
        ("{poses: [[0 deg, 1 deg]]}", "needs at_least"),
        ("'>= 500 mm'", "N/um"),
    ],
)
def test_wrong_limits_on_stiffness_name_the_key(tmp_path: Path, asked: str, word: str) -> None:
    with pytest.raises(InputError, match="tip_stiffness") as caught:
        problem_of(tmp_path, TUBES, f"subject_to: {{tip_stiffness: {asked}}}\n")
    assert word in str(caught.value)


# ---- a limit that only this test knows

GIRTH = Figure(
    name="girth",
    title="greatest girth",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=("<=",),
    key="girth_mm",
    follows=OfLinks(lambda section, _: (2.0 * (section.given()["width"] + section.given()["height"]),)),
    note="around any section",
)
WITH_GIRTH = MappingProxyType({**FIGURES, "girth": GIRTH})


def test_a_new_limit_is_one_object(tmp_path: Path) -> None:
    """Read, solved, priced, explained, rounded, traded; on the screen, in JSON and in the report: nothing else knows
    it."""
    problem_of(tmp_path, TUBES, LIGHT + "}\n")
    path = tmp_path / "problem.yaml"
    path.write_text(path.read_text().replace("section_size", "girth: '<= 130 mm', section_size"))
    with pytest.raises(InputError, match="girth"):
        read_problem(path)
    problem = read_problem(path, figures=WITH_GIRTH)
    result = optimise(problem)
    girths = [2e3 * (link.section.width + link.section.height) for link in result.arm.links]
    assert max(girths) == pytest.approx(130.0, rel=1e-6)
    (limit,) = [item for item in result.binding if item.name == "girth"]
    assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.02)
    console = Console(record=True, width=120, file=StringIO())
    show(console, describe(result))
    for text in (console.export_text(), markdown(describe(result))):
        assert "greatest girth" in text
        assert "130 mm" in text
    assert [note for name, _, note in told(result.after, WITH_GIRTH) if name == "greatest girth"] == [GIRTH.note]
    content = optimization_json(result)
    assert content["girth_mm"] == pytest.approx(130.0, rel=1e-6)
    assert content["before"]["girth_mm"] == pytest.approx(280.0)
    assert "girth &lt;= 130 mm" in page_of(describe(result))
    made = rounded(problem, result, Rounding(0.5e-3))
    assert max(2.0 * (x.section.width + x.section.height) for x in made.arm.links) <= 0.13 * (1.0 + 1e-9)
    impossible = replace(problem, limits=(*problem.limits[:1], replace(problem.limit("girth")[0], value=0.05)))
    with pytest.raises(NoAnswer, match="girth <= 50 mm would have to be"):
        optimise(impossible)
    front = trade_off(question(problem, "mass", "girth"), accuracy=0.5)
    first, last = front.points[0], front.points[-1]
    assert first.x < last.x
    assert first.y > last.y
    assert all(point.figures["girth"] == pytest.approx(point.y) for point in front.points)


def test_limits_of_the_house_are_found_by_name() -> None:
    limit = Limit(FIGURES["tip_stiffness"], ">=", 5e5)
    assert limit.text == "tip_stiffness >= 500 N/mm"
