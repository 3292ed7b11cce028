"""What a new design does worse is said: any figure, registered ones too, and what a planar model does not see."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES, Figure, OfLinks
from linkwright.core.arm.figures.tip_stiffness import SIDEWAYS, sideways_compliance
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Constant, Material, MissingProperty, Property
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.worse import softened_links, worse_figures
from linkwright.core.sections import Circle, ISection, Rectangle, Section
from linkwright.core.units.quantities import InputError
from linkwright.json.design import evaluation_json, optimization_json
from linkwright.markdown.described import markdown
from linkwright.report.described import page_of
from linkwright.results.evaluation import describe as describe_evaluation
from linkwright.results.optimization import describe
from tests.optimize.builders import measured_price, problem_of

STEEL = load_catalogue(user=False).find("steel-s355")
THIN = ISection(width=0.02, height=0.15, flange_thickness=0.01, web_thickness=0.005)


def arm_with(*sections: Section, material: Material = STEEL, **more: object) -> Arm:
    """Links of 400 and 300 mm; drives that give in the plane must not count across it."""
    joint = Joint(range=(-math.pi / 2, math.pi / 2), stiffness=6e4)
    lengths = (0.4, 0.3)[: len(sections)]
    links = tuple(
        Link(length, section=section, material=material) for length, section in zip(lengths, sections, strict=True)
    )
    return replace(Arm("planar", (joint,) * len(links), links, payload=LoadCase(2.0)), **more)


# ---- what a planar model does not see


def test_sideways_compliance_of_a_bent_arm_by_castigliano() -> None:
    """F across the plane at the end of an elbow bent by 90 deg: link 2 bends about its other axis, link 1 bends and is
    twisted by F L2, both shear: C = sum L^3 / (3 E I_z) + L2^2 L1 / (G J) + sum L / (G A_y)."""
    sections = (Rectangle(0.04, 0.06), Rectangle(0.01, 0.05))
    arm, values = arm_with(*sections), STEEL.at(293.15)
    modulus, shear = values.need("elastic_modulus"), values.shear_modulus
    assert shear is not None
    one, two = (section.properties(values.need("poisson_ratio")) for section in sections)
    bending = 0.4**3 / (3.0 * modulus * one.second_moment_z) + 0.3**3 / (3.0 * modulus * two.second_moment_z)
    twisting = 0.3**2 * 0.4 / (shear * one.torsion_constant)
    shearing = 0.4 / (shear * one.shear_area_y) + 0.3 / (shear * two.shear_area_y)
    p = beam_values(beams_of(arm, [SIDEWAYS]))
    result = sideways_compliance(arm).matrices(np.array([[0.3, math.pi / 2]]), p)
    assert result[0, 0, 0] == pytest.approx(bending + twisting + shearing, rel=1e-9)


def test_the_softest_pose_across_the_plane_is_found() -> None:
    """No pose of a fine grid is softer; a straight arm of one link has L^3 / (3 E I_z) + L / (G A_y)."""
    arm = arm_with(Rectangle(0.04, 0.06), Rectangle(0.01, 0.05))
    result = evaluate(arm)
    grid = (
        np.array(np.meshgrid(np.linspace(-1.5, 1.5, 7), np.linspace(-math.pi / 2, math.pi / 2, 181))).reshape(2, -1).T
    )
    softest = sideways_compliance(arm).matrices(grid, beam_values(beams_of(arm, [SIDEWAYS]))).max()
    assert result.sideways is not None
    assert result.sideways.value == pytest.approx(1.0 / softest, rel=1e-4)
    assert result.sideways.value <= (1.0 + 1e-9) / softest
    assert evaluation_json(result)["sideways_stiffness_N_per_mm"] == pytest.approx(1e-3 * result.sideways.value)


def test_an_arm_in_space_has_no_sideways() -> None:
    """Its tip stiffness counts every direction; nothing is told of one of them."""
    result = evaluate(arm_with(Rectangle(0.04, 0.06), gravity=(0.0, 0.0, -9.81)))
    assert result.sideways is None
    assert not FIGURES["sideways_stiffness"].is_reported(result)
    assert "sideways" not in markdown(describe_evaluation(result))


def test_what_the_plane_does_without_and_the_side_needs_is_named() -> None:
    """In the plane, without shear, no shear modulus is needed; links that twist need one."""
    bare = Material("bare", {"elastic_modulus": Property(Constant(2e11)), "density": Property(Constant(7800.0))})
    arm = arm_with(Rectangle(0.04, 0.06), material=bare, leave_out=frozenset({"shear_deformation"}))
    result = evaluate(arm)
    assert result.sideways is None
    assert "shear_modulus" in result.unknown["sideways_stiffness"]
    with pytest.raises(MissingProperty):
        beams_of(arm, [SIDEWAYS])


# ---- what became worse


def test_all_that_became_worse_is_listed_and_nothing_else() -> None:
    before, after = evaluate(arm_with(Circle(0.06), Circle(0.05))), evaluate(arm_with(Circle(0.06), THIN))
    told = {worse_figure.figure.name for worse_figure in worse_figures(FIGURES, before, after)}
    back = {worse_figure.figure.name for worse_figure in worse_figures(FIGURES, after, before)}
    assert {"sideways_stiffness", "aspect", "wall_slenderness"} <= told
    assert not told & back
    for name, figure in FIGURES.items():
        one, other = figure.value(before), figure.value(after)
        if one is None or other is None or one == pytest.approx(other, rel=1e-3):
            continue
        assert (name in told) == ((other < one) if figure.more_is_better else (other > one)), name
    assert worse_figures(FIGURES, before, before) == ()
    ((link, share),) = softened_links(before, after)
    ratio = THIN.properties(0.3).second_moment_z / Circle(0.05).properties(0.3).second_moment_z
    assert (link, share) == (1, pytest.approx(ratio, rel=1e-9))


def test_a_figure_that_only_this_test_knows_follows(tmp_path: Path) -> None:
    """In the headline of screen, page and Markdown, and in JSON."""
    slim = Figure(
        name="slim",
        title="least width",
        kind="length",
        unit="mm",
        factor=1e3,
        senses=(">=",),
        key="slim_mm",
        follows=OfLinks(lambda section, _: (section.given()["width"],)),
        more_is_better=True,
    )
    arm = (
        "chain:\n  - joint: {type: revolute, range: [-90 deg, 90 deg], stiffness: 60 kN*m/rad}\n"
        "    link: {length: 500 mm, section: {shape: rectangle, width: 60 mm, height: 60 mm}, material: steel-s355}\n"
        "payload: {mass: 5 kg}\n"
    )
    problem_of(tmp_path, arm, "subject_to: {mass: '<= 5 kg', section_size: [5 mm, 200 mm]}\n")
    problem = read_problem(tmp_path / "problem.yaml", figures=MappingProxyType({**FIGURES, "slim": slim}))
    result = optimise(problem)
    section = result.arm.links[0].section
    assert isinstance(section, Rectangle)
    width = 1e3 * section.width
    (entry,) = [item for item in optimization_json(result)["worse"] if item["name"] == "slim"]
    assert entry == {"name": "slim", "before": pytest.approx(60.0), "after": pytest.approx(width), "unit": "mm"}
    words = f"least width from 60 to {width:.4g} mm"
    described = describe(result)
    for text in (described.headline, markdown(described), page_of(describe(result))):
        assert words in text.replace("\N{NO-BREAK SPACE}", " ")
        assert "sideways stiffness from" in text
    (share,) = optimization_json(result)["softer_sideways"]
    assert share["link"] == 1
    assert "across its plane the tip gives" in markdown(described)


# ---- it can be limited

BENT = (
    "chain:\n" + "  - joint: {type: revolute, range: [-90 deg, 90 deg], stiffness: 60 kN*m/rad}\n"
    "    link: {length: 500 mm, section: {shape: rectangle, width: 60 mm, height: 80 mm}, material: steel-s355}\n"
    * 2
    + "payload: {mass: 5 kg}\n"
)


def test_sideways_stiffness_is_kept_and_priced(tmp_path: Path) -> None:
    limits = "max_error: '<= 2 mm', sideways_stiffness: '>= 40 N/mm', section_size: [5 mm, 200 mm]"
    text = f"minimize: mass\nsubject_to: {{{limits}}}\n"
    problem = problem_of(tmp_path, BENT, text)
    result = optimise(problem)
    (limit,) = problem.limit("sideways_stiffness")
    assert limit.of(result.after) == pytest.approx(4e4, rel=3e-5)
    (binding,) = [item for item in result.binding if item.name == "sideways_stiffness"]
    assert binding.unit == "N/mm"
    assert "across its plane" not in markdown(describe(result))  # somebody thought of it
    assert binding.price == pytest.approx(measured_price(problem, binding), rel=0.02)


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        ("gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\n", "moves in space: use tip_stiffness"),
        ("leave_out: [shear_deformation]\n", "leave out torsion too"),
    ],
)
def test_where_it_cannot_be_limited_it_says_why(tmp_path: Path, rest: str, words: str) -> None:
    text = "minimize: mass\nsubject_to: {sideways_stiffness: '>= 40 N/mm'}\n"
    with pytest.raises(InputError, match=words):
        optimise(problem_of(tmp_path, BENT + rest, text))
