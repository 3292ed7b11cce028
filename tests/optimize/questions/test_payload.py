"""The largest payload: against every combination with a bisection of its own, and a bar with an analytic answer."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.command_line import outcome
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.payload import with_payload
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.optimize.builders import problem_of

E, RHO, GRAVITY, LENGTH, STIFFNESS = 70e9, 2700.0, 9.81, 0.5, 20e3
BAR = (
    "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg], stiffness: 20 kN*m/rad}\n"
    "    link: {length: 500 mm, section: {shape: circle, diameter: 40 mm},\n"
    "      material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3}}\n"
    "payload: {mass: 1 kg}\nleave_out: [shear_deformation]\n"
)
LINK = "    link: {{length: {} mm, section: {{shape: tube, diameter: 50 mm, thickness: 3 mm}}, material: {}}}\n"
JOINT = "  - joint: {type: revolute, range: [-60 deg, 60 deg], stiffness: 60 kN*m/rad, mass: 1 kg}\n"
METAL = "aluminium-6061-t6"
ARM = f"chain:\n{JOINT}{LINK.format(400, METAL)}{JOINT}{LINK.format(300, METAL)}payload: {{mass: 2 kg}}\n"
LISTED = (
    "maximize: payload\nsubject_to: {max_error: '<= 0.6 mm', mass: '<= 2.6 kg', safety_factor: '>= 3'}\n"
    "choose: {section: [tube], sizes: {diameter: [40 mm, 60 mm, 80 mm], thickness: [3 mm]}}\n"
)


def bar_error(mass: float, payload: float) -> float:
    """Sag under both weights, and the drive's turn under their moment."""
    flexural = E * (4.0 * mass / (RHO * LENGTH)) ** 2 / (64.0 * math.pi)
    bent = payload * GRAVITY * LENGTH**3 / (3.0 * flexural) + mass * GRAVITY * LENGTH**3 / (8.0 * flexural)
    return bent + (payload + mass / 2.0) * GRAVITY * LENGTH**2 / STIFFNESS


def bar_payload(mass: float, error: float) -> float:
    """The payload at which a bar of that mass errs so much."""
    at_none = bar_error(mass, 0.0)
    return (error - at_none) / (bar_error(mass, 1.0) - at_none)


def test_a_bar_carries_what_its_sag_allows(tmp_path: Path) -> None:
    """The thickest bar that its mass allows; prices are derivatives of the same formula."""
    text = "maximize: payload\nsubject_to: {max_error: '<= 1.5 mm', mass: '<= 1.2 kg', section_size: [10 mm, 80 mm]}\n"
    result = optimise(problem_of(tmp_path, BAR.replace("40 mm", "30 mm"), text))
    assert result.objective == pytest.approx(bar_payload(1.2, 1.5e-3), rel=1e-4)
    assert result.objective <= result.lower_bound <= result.objective * (1.0 + 1.01e-3)
    assert result.before.load_cases[0].mass == pytest.approx(
        bar_payload(RHO * math.pi * 0.015**2 * LENGTH, 1.5e-3), rel=1e-5
    )
    prices = {item.name: item.price for item in result.binding}
    by_error = (bar_payload(1.2, 1.51e-3) - bar_payload(1.2, 1.49e-3)) / 0.02
    by_mass = (bar_payload(1.21, 1.5e-3) - bar_payload(1.19, 1.5e-3)) / 0.02
    assert prices["max_error"] == pytest.approx(-by_error, rel=0.01)
    assert prices["mass"] == pytest.approx(-by_mass, rel=0.02)


def test_nothing_among_all_combinations_carries_more(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, LISTED)
    result = optimise(problem)
    assert problem.sizes is not None

    def keeps(picks: tuple[int, ...], payload: float) -> bool:
        sizes = [sizes[k] for sizes, k in zip(problem.sizes or (), picks, strict=True)]
        links = [replace(link, section=item.section) for link, item in zip(problem.arm.links, sizes, strict=True)]
        arm, cases = replace(problem.arm, links=tuple(links)), (LoadCase(mass=payload),)
        beams = beams_of(arm, cases)
        if sum(float(beam.mass) for beam in beams) > 2.6:
            return False
        if WorstSearch(error_model(arm, cases), problem.workspace).worst(beam_values(beams)).error > 0.6e-3:
            return False
        return (FIGURES["safety_factor"].value(evaluate(arm, problem.workspace, cases)) or 0.0) >= 3.0

    picks = list(itertools.product(range(3), repeat=2))
    able = [pick for pick in picks if keeps(pick, 0.995 * result.objective)]
    assert able
    low, high = 0.995 * result.objective, 1.005 * result.objective
    for _ in range(3):
        middle = 0.5 * (low + high)
        kept = [pick for pick in able if keeps(pick, middle)]
        low, high, able = (middle, high, kept) if kept else (low, middle, able)
    assert low <= result.objective * (1.0 + 1.1e-3)
    assert high >= result.objective * (1.0 - 1e-6)


def test_cases_without_a_mass_keep_none() -> None:
    cases = (LoadCase(mass=2.0), LoadCase(force=(0.0, 0.0, -50.0)))
    assert [case.mass for case in with_payload(cases, 5.0)] == [5.0, 0.0]
    assert [case.mass for case in with_payload(cases[1:], 5.0)] == [5.0]


def test_commands_say_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem_of(tmp_path, BAR, "maximize: payload\nsubject_to: {max_error: '<= 1.5 mm', mass: '<= 1.2 kg'}\n")
    problem, target = tmp_path / "problem.yaml", tmp_path / "out.json"
    assert outcome(["optimize", str(problem), "--json", str(target), "--out", str(tmp_path / "out")]) == 0
    assert "largest payload" in capsys.readouterr().out
    told = json.loads(target.read_text(encoding="utf-8"))
    assert told["objective"]["unit"] == "kg"
    assert told["objective"]["value"] == pytest.approx(bar_payload(1.2, 1.5e-3), rel=1e-4)
    assert outcome(["evaluate", str(tmp_path / "out" / "arm.yaml"), "--problem", str(problem)]) == 0
    assert f"{told['objective']['value']:.4g} kg" in capsys.readouterr().out
    assert outcome(["optimize", str(problem), "--round", "1 mm"]) == 2
    assert "payload goes without --round" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("minimize: payload\n", "write maximize: payload"),
        ("maximize: payload\nsubject_to: {mass: '<= 2 kg'}\n", "no limit holds the payload back"),
        ("maximize: payload\nsubject_to: {max_error: '<= 1 mm', payload: '>= 2 kg'}\n", "payload"),
        (
            "maximize: payload\nsubject_to: {max_error: '<= 1 mm'}\nrobust: worst\nuncertain: {stiffness: 5 %}\n",
            "goes without maximize: payload",
        ),
    ],
)
def test_nonsense_is_one_line(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message) as caught:
        optimise(problem_of(tmp_path, BAR, text))
    assert "\n" not in str(caught.value)


def test_an_error_that_own_weight_exceeds_has_no_payload(tmp_path: Path) -> None:
    text = "maximize: payload\nsubject_to: {max_error: '<= 0.001 mm', mass: '<= 1.2 kg'}\n"
    with pytest.raises(NoAnswer, match="even with no payload"):
        optimise(problem_of(tmp_path, BAR, text))
