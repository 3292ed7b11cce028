"""Every kind of price against problems optimised anew with the limit moved a little."""

from __future__ import annotations

from pathlib import Path

import pytest

from linkwright.core.optimize.run import optimise
from tests.costs import slow_but
from tests.optimize.builders import PAPER_ARM, jointed, measured_price, problem_of, ranged

SIMPLE = jointed([400, 420, 420], ranged("-100 100", "-100 100", "-100 100"))
PLAYING = jointed(
    [400, 420, 420],
    ranged("-100 100", "-100 100", "-100 100", more=", stiffness: 60 kN*m/rad, clearance: 0.02 mm, backlash: 1 arcmin"),
)
TUBE = "choose: {section: tube}\n"
PRICED = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, cost: 5 EUR/kg}"

CASES = {
    "mass, reach and shortest link": (
        PAPER_ARM,
        "subject_to: {mass: '<= 26.296 kg', reach: '== 1240 mm', link_length: [350 mm, 700 mm]}\n",
        {"mass", "reach", "link_length >="},
    ),
    "tube: size and both walls, all three at once": (
        PAPER_ARM,
        TUBE + "subject_to: {mass: '<= 10 kg', section_size: [20 mm, 140 mm], thickness: [2 mm, 10 mm]}\n",
        {"section_size <=", "thickness <=", "thickness >="},
    ),
    "ellipse: both sizes": (
        PAPER_ARM,
        "choose: {section: ellipse}\nsubject_to: {mass: '<= 26 kg', section_size: [20 mm, 140 mm]}\n",
        {"section_size <=", "section_size >="},
    ),
    "rectangular tube: walls are variables": (
        PAPER_ARM,
        "choose: {section: rectangular_tube}\n"
        "subject_to: {mass: '<= 10 kg', section_size: [20 mm, 140 mm], thickness: [2 mm, 10 mm]}\n",
        {"section_size <=", "thickness <=", "thickness >="},
    ),
    "longest link": (
        SIMPLE,
        "load_cases:\n  - {payload: {mass: 3 kg}}\n  - {force: [60 N, 0 N, 0 N]}\n"
        "subject_to: {mass: '<= 10 kg', reach: '== 1240 mm', link_length: [200 mm, 600 mm]}\n",
        {"mass", "reach", "link_length <="},
    ),
    "error when mass is minimised": (
        PLAYING,
        "minimize: mass\nsubject_to: {max_error: '<= 6 mm'}\n",
        {"max_error"},
    ),
    "first frequency": (SIMPLE, "minimize: mass\nsubject_to: {first_frequency: '>= 9 Hz'}\n", {"first_frequency"}),
    "safety factor": (
        SIMPLE,
        "minimize: mass\nsubject_to: {safety_factor: '>= 8', section_size: [5 mm, 140 mm]}\n",
        {"safety_factor"},
    ),
    "buckling": (
        SIMPLE,
        "minimize: mass\nsubject_to: {buckling: '>= 80', section_size: [5 mm, 140 mm]}\n",
        {"buckling"},
    ),
    "total mass": (PAPER_ARM, "subject_to: {total_mass: '<= 15 kg'}\n", {"total_mass"}),
    "cost": (
        PAPER_ARM,
        f"choose: {{material: [{PRICED}]}}\nsubject_to: {{cost: '<= 60 EUR'}}\n",
        {"cost"},
    ),
}


@pytest.mark.parametrize("name", slow_but(CASES, "mass, reach and shortest link"))
def test_price_is_what_a_moved_limit_buys(name: str, tmp_path: Path) -> None:
    arm, text, expected = CASES[name]
    problem = problem_of(tmp_path, arm, text)
    result = optimise(problem)
    named = {
        " ".join(limit.text.split()[:2]) if limit.name in ("section_size", "thickness", "link_length") else limit.name
        for limit in result.binding
    }
    assert expected <= named
    for limit in result.binding:
        # First order: a step of a thousandth leaves a curvature below a per cent, a step of ten times the
        # exchange's tolerance about as much noise.
        assert limit.price == pytest.approx(measured_price(problem, limit), rel=0.01), limit.text


def test_binding_limits_are_met_and_loose_ones_cost_nothing(tmp_path: Path) -> None:
    text = "subject_to: {mass: '<= 10 kg', first_frequency: '>= 1 Hz', cost: '<= 9000 EUR'}\n"
    arm = PAPER_ARM.replace("2700 kg/m^3}", "2700 kg/m^3, cost: 5 EUR/kg}")
    result = optimise(problem_of(tmp_path, arm, text))
    assert [limit.name for limit in result.binding] == ["mass"]
    assert result.binding[0].price < 0.0
    assert result.binding[0].value == pytest.approx(10.0, rel=1e-6)
