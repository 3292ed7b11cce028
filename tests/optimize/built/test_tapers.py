"""Tapers that are chosen: against closed forms, quadrature, grids of designs, and their own uniform optimum."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from linkwright.core.arm.chain.beam import BendingFactors, Taper, elastic_beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.similar_taper import similar_beam
from linkwright.core.arm.chain.taper import tapered_beam
from linkwright.core.arm.errors.model import ErrorModel, beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import excess
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.materials.material import MaterialValues
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.rounding.options import read_rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.sections.taper import Tapered, similar, size_ratio
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import DRIVE, jointed, measured_price, problem_of, ranged

GRAVITY, E, RHO = 9.81, 71e9, 2700.0
METAL = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 200 MPa, cost: 4 EUR/kg}"
STIFF = MaterialValues("", 0.0, elastic_modulus=E, poisson_ratio=0.33, shear_modulus=27e9, density=RHO)
STILL = "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\n"
BENDING_ALONE = "leave_out: [shear_deformation, axial]\n"
SIZES = "section_size: [5 mm, 300 mm]"


def cantilever(folder: Path, load: str, limits: str, *, head: str = "", section: str = "") -> Problem:
    section = section or "{shape: circle, diameter: 60 mm}"
    arm = (
        f"{head}chain:\n  - joint: {{type: revolute, range: [0 deg, 0 deg]}}\n"
        f"    link: {{length: 1000 mm, section: {section}, material: {METAL}}}\n"
        f"payload: {{{load}}}\n{BENDING_ALONE}"
    )
    return problem_of(folder, arm, f"subject_to: {{{limits}}}\n")


def alike(found: Any, expected: Any, skip: frozenset[str] = frozenset()) -> None:
    """Every number of the two, down to the last."""
    if is_dataclass(found):
        for field in fields(found):
            if field.name not in skip:
                alike(getattr(found, field.name), getattr(expected, field.name), skip)
    elif isinstance(found, Mapping):
        assert found.keys() == expected.keys()
        for name in found:
            alike(found[name], expected[name], skip)
    elif isinstance(found, tuple):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            alike(one, other, skip)
    elif found is not None:
        assert float(found) == pytest.approx(float(expected), rel=3e-6, abs=1e-9)


@pytest.mark.parametrize("shape", ["circle", "tube", "i_section"])
@pytest.mark.parametrize("ratio", [0.12, 0.4, 0.97, 1.0, 2.5])
def test_factors_of_the_ratio_are_those_by_quadrature(shape: str, ratio: float) -> None:
    near = SHAPES[shape].start(2e-3, (0.02, 0.2), (0.002, 0.02))
    uniform = elastic_beam(0.7, near.properties(0.33), STIFF)
    result = similar_beam(uniform, math.log(ratio))
    if ratio == 1.0:
        assert result.taper.height == BendingFactors()
        alike(replace(result, taper=uniform.taper), uniform)
        return
    expected = tapered_beam(0.7, Tapered(near, near.scaled(ratio)), STIFF)
    alike(result, expected, frozenset({"parts"}))
    for own, other in zip(result.taper.parts, expected.taper.parts, strict=True):
        alike(own.rigidities, other.rigidities)
        # Of a part without weight of its own, only what a moment at its end does is ever asked.
        for name in ("moment_deflection", "moment_slope"):
            assert isinstance(other.taper, Taper)
            assert getattr(own.taper.height, name) == pytest.approx(getattr(other.taper.height, name), rel=1e-9)


def test_cantilever_of_the_textbook(tmp_path: Path) -> None:
    """F L^3/(3 E I) d/d_far at a mass of d^2 (1 + r + r^2)/3: least where 3 r^2 + r = 1."""
    limits = f"mass: '<= 5 kg', {SIZES}, taper: [0.2, 1]"
    result = optimise(cantilever(tmp_path, "force: [0 N, -100 N, 0 N]", limits, head=STILL))
    ratio = (math.sqrt(13.0) - 1.0) / 6.0
    diameter = math.sqrt(5.0 / (RHO * math.pi / 4.0 * (1.0 + ratio + ratio**2) / 3.0))
    section = result.arm.links[0].section
    assert section is not None
    assert size_ratio(section) == pytest.approx(ratio, rel=1e-4)
    expected = 100.0 / (3.0 * E * math.pi / 64.0 * diameter**4 * ratio)
    assert result.after.max_error == pytest.approx(expected, rel=1e-6)
    assert result.status == "certified"
    assert result.optimum == "local"
    assert result.lower_bound <= result.after.max_error * (1.0 + 1e-9)


def test_own_weight_against_a_grid_of_quadratures(tmp_path: Path) -> None:
    """A link that carries mostly itself: M(s)/(E I(s)) integrated twice for each ratio, with no code of ours."""
    limits = f"mass: '<= 12 kg', {SIZES}, taper: [0.1, 1]"
    result = optimise(cantilever(tmp_path, "mass: 1 kg", limits))

    def sag(ratio: float) -> float:
        diameter = math.sqrt(12.0 / (RHO * math.pi / 4.0 * (1.0 + ratio + ratio**2) / 3.0))

        def size(t: float) -> float:  # t m from the far end
            return diameter * (ratio + (1.0 - ratio) * t)

        def moment(t: float) -> float:
            def of_slice(u: float) -> float:
                return RHO * GRAVITY * math.pi / 4.0 * size(u) ** 2 * (t - u)

            return quad(of_slice, 0.0, t)[0] + 1.0 * GRAVITY * t

        def turned(t: float) -> float:
            return moment(t) * t / (E * math.pi / 64.0 * size(t) ** 4)

        return quad(turned, 0.0, 1.0)[0]

    ratios = np.linspace(0.1, 1.0, 46)
    grid = [sag(float(ratio)) for ratio in ratios]
    assert result.after.max_error <= min(grid) * (1.0 + 2e-4)
    assert result.after.max_error == pytest.approx(min(grid), rel=2e-3)
    section = result.arm.links[0].section
    assert section is not None
    assert size_ratio(section) == pytest.approx(float(ratios[int(np.argmin(grid))]), abs=0.03)


def two_links(folder: Path, shape: str, more: str) -> Problem:
    arm = jointed([450, 350], ranged("-60 60", "-100 100"))
    limits = f"mass: '<= 6 kg', section_size: [30 mm, 140 mm], thickness: [2 mm, 10 mm]{more}"
    return problem_of(folder, arm, f"choose: {{section: [{shape}]}}\nsubject_to: {{{limits}}}\n")


def test_no_design_of_a_grid_is_better(tmp_path: Path) -> None:
    """Ratios of both links and the share of mass between them; each design evaluated on its own."""
    problem = two_links(tmp_path, "circle", ", taper: [0.4, 1.2]")
    result = optimise(problem)
    arm, errors = problem.arm, []
    for one in np.linspace(0.4, 1.2, 4):
        for other in np.linspace(0.4, 1.2, 4):
            model = None
            for share in (0.6, 0.68, 0.76, 0.84):
                links = list(arm.links)
                for k, (ratio, mass) in enumerate(((one, 6.0 * share), (other, 6.0 * (1.0 - share)))):
                    volume = mass / (2700.0 * arm.links[k].length)  # aluminium 6061: 2700 kg/m^3
                    near = math.sqrt(volume / (math.pi / 4.0 * (1.0 + ratio + ratio**2) / 3.0))
                    if min(near, near * ratio) < 0.03:
                        break
                    section = similar(SHAPES["circle"].from_variables([near]), float(ratio))
                    links[k] = replace(arm.links[k], section=section)
                else:
                    design = replace(arm, links=tuple(links))
                    model = model or error_model(design)  # which depends on the ratios, and on no size
                    errors.append(_least_sure(model, design))
    assert len(errors) > 15
    assert result.after.max_error <= min(errors) * (1.0 + 1e-4)
    assert result.after.max_error > 0.97 * min(errors)


def _least_sure(model: ErrorModel, arm: Arm) -> float:
    """An error that the arm has at some pose: stretched along x is the worst but for a hair."""
    q = np.array([[0.0, 0.0], [0.05, -0.05], [-0.05, 0.05], [0.03, 0.0], [-0.03, 0.0]])
    return float(np.linalg.norm(model.cases[0].arrays(q, beam_values(beams_of(arm))).vector, axis=1).max())


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["circle", "tube"])
def test_limits_hold_and_uniform_links_are_never_better(tmp_path: Path, shape: str) -> None:
    limits = ", first_frequency: '>= 16.5 Hz', safety_factor: '>= 30'"
    plain = optimise(two_links(tmp_path, shape, limits))
    problem = two_links(tmp_path, shape, limits + ", taper: [0.5, 1]")
    result = optimise(problem)
    assert not result.doubts
    assert result.after.max_error < plain.after.max_error * (1.0 - 1e-3)
    assert all(excess(limit, limit.of(result.after)) < 2e-5 for limit in problem.limits)
    again = evaluate(result.arm, problem.workspace, problem.load_cases)
    assert again.max_error == pytest.approx(result.objective, rel=1e-6)
    for link in result.arm.links:
        section = link.section
        far = section.far if isinstance(section, Tapered) else section
        assert far is not None
        assert section is not None
        given = far.given()
        outer = [given[dimension.name] for dimension in far.dimensions if dimension.kind == "outer"]
        walls = [given[dimension.name] for dimension in far.dimensions if dimension.kind == "wall"]
        assert min(outer) >= 0.03 * (1.0 - 1e-6)
        assert min(walls, default=1.0) >= 0.002 * (1.0 - 1e-6)
        assert 0.5 - 1e-6 <= (size_ratio(section) or 0.0) <= 1.0 + 1e-6


def test_a_given_taper_is_one_of_the_designs(tmp_path: Path) -> None:
    section = "{shape: circle, diameter: [80 mm, 40 mm]}"
    held = f"mass: '<= 99 kg', {SIZES}"
    given = evaluate(cantilever(tmp_path, "mass: 1 kg", f"{held}, taper: [0.5, 1]", section=section).arm)
    limits = f"mass: '<= {given.mass:.6f} kg', {SIZES}, taper: [0.45, 1]"
    result = optimise(cantilever(tmp_path, "mass: 1 kg", limits, section=section))
    assert not result.doubts
    assert result.after.max_error <= given.max_error * (1.0 + 1e-5)


def test_a_far_end_and_a_taper_at_their_bounds_have_a_price(tmp_path: Path) -> None:
    load, head = "force: [0 N, -100 N, 0 N]", STILL
    problem = cantilever(tmp_path, load, "mass: '<= 5 kg', section_size: [35 mm, 300 mm], taper: [0.2, 1]", head=head)
    result = optimise(problem)
    (limit,) = (item for item in result.binding if item.name == "section_size")
    assert "far end" in limit.text
    assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.02)
    bounded = optimise(cantilever(tmp_path, load, f"mass: '<= 5 kg', {SIZES}, taper: [0.6, 1]", head=head))
    (limit,) = (item for item in bounded.binding if item.name == "taper")
    # The sag goes with (1 + r + r^2)^2/r.
    sums, ratio = 1.0 + 0.6 + 0.36, 0.6
    slope = 1e3 * bounded.objective * (2.0 * (1.0 + 2.0 * ratio) / sums - 1.0 / ratio)
    assert limit.price == pytest.approx(slope, rel=1e-3)


def test_the_same_size_is_the_same_taper(tmp_path: Path) -> None:
    arm = jointed([450, 350], [f"{DRIVE}, range: [-60 deg, 60 deg]", f"{DRIVE}, range: [-100 deg, 100 deg]"])
    text = "choose: {same: [size]}\nsubject_to: {mass: '<= 6 kg', taper: [0.4, 1]}\n"
    result = optimise(problem_of(tmp_path, arm, text))
    one, other = (link.section for link in result.arm.links)
    assert isinstance(one, Tapered)
    assert one == other
    assert "diameter: [" in arm_to_yaml(result.arm)


BAD = {
    "text": ("taper: yes", "taper"),
    "too slender": ("taper: [0.01, 1]", "0.1 and 10"),
    "a length": ("taper: [4 mm, 10 mm]", "taper"),
    "reversed": ("taper: [1, 0.5]", "taper"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_tapers_are_one_line(tmp_path: Path, name: str) -> None:
    text, told = BAD[name]
    with pytest.raises(InputError) as caught:
        cantilever(tmp_path, "mass: 1 kg", f"mass: '<= 5 kg', {text}")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_does_not_go_with_tapers_says_so(tmp_path: Path) -> None:
    wall = "{shape: tube, diameter: [100 mm, 60 mm], thickness: 4 mm}"
    with pytest.raises(InputError, match="alike"):
        cantilever(tmp_path, "mass: 1 kg", "mass: '<= 5 kg', taper: [0.4, 1]", section=wall)
    with pytest.raises(InputError, match=r"taper: \[0.4, 1\]"):
        cantilever(tmp_path, "mass: 1 kg", "mass: '<= 5 kg'", section=wall)
    problem = cantilever(tmp_path, "mass: 1 kg", "mass: '<= 5 kg', taper: [0.4, 1]")
    with pytest.raises(InputError, match="--round"):
        optimise_rounded(problem, read_rounding("stock"))
    arm = (tmp_path / "arm.yaml").read_text(encoding="utf-8")
    with pytest.raises(InputError, match="sizes"):
        problem_of(tmp_path, arm, "choose: {sizes: stock}\nsubject_to: {mass: '<= 5 kg', taper: [0.4, 1]}\n")
