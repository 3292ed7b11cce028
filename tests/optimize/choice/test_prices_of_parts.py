"""What joints, rigid links and machining cost: counted once, in evaluation, design, limits and the list of parts."""

import itertools
from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.chain.prices import price_dates
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures.sums import dates_in_words
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.drawings.parts import parts

ARM = """
name: priced
payload: {mass: 1 kg}
chain:
  - joint: {range: [-90 deg, 90 deg], cost: 310 EUR}
    link: {length: 400 mm, section: {shape: tube, diameter: 60 mm, thickness: 3 mm}, material: steel-s355, cost: 45 EUR}
  - joint: {range: [-90 deg, 90 deg]}
    link: {length: 200 mm, rigid: true, mass: 1 kg, cost: 120 EUR}
"""
PROBLEM = """
arm: arm.yaml
minimize: max_error
workspace: {{joints: range}}
subject_to: {{cost: "<= {most} EUR", section_size: [20 mm, 90 mm], thickness: [2 mm, 6 mm]}}
choose: {{section: [tube], material: [steel-s355]}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    return tmp_path


def by_hand(folder: Path) -> float:
    """The material by the kilogram, and what stands in the file."""
    arm = read_arm(folder / "arm.yaml")
    result, material = evaluate(arm), arm.links[0].material
    assert material is not None
    return result.link_masses[0] * material.need("cost", arm.temperature) + 310.0 + 45.0 + 120.0


def test_sum_and_list_of_parts(folder: Path):
    arm = read_arm(folder / "arm.yaml")
    result = evaluate(arm)
    assert result.cost == pytest.approx(by_hand(folder), rel=1e-12)
    assert parts(arm)["price_EUR"].sum() == pytest.approx(result.cost, rel=1e-8)
    again = folder / "again.yaml"
    again.write_text(arm_to_yaml(arm), encoding="utf-8")
    assert evaluate(read_arm(again)).cost == pytest.approx(result.cost, rel=1e-9)


def test_rigid_link_without_a_price_is_named(folder: Path):
    path = folder / "arm.yaml"
    path.write_text(ARM.replace(", cost: 120 EUR", ""), encoding="utf-8")
    result = evaluate(read_arm(path))
    assert result.cost is None
    assert "link 2, which is rigid" in result.unknown["cost"]
    (folder / "problem.yaml").write_text(PROBLEM.format(most=500), encoding="utf-8")
    with pytest.raises(InputError, match="link 2, which is rigid; `cost` in the arm file"):
        optimise(read_problem(folder / "problem.yaml"))


def test_limit_counts_all_of_it(folder: Path):
    """What is left for steel under 476.50 EUR is 1.50 EUR; under 474 there is none, whatever the section."""
    (folder / "problem.yaml").write_text(PROBLEM.format(most=476.5), encoding="utf-8")
    result = optimise(read_problem(folder / "problem.yaml"))
    assert result.after.cost == pytest.approx(476.5, rel=1e-5)
    mass = result.after.link_masses[0]
    material = result.after.arm.links[0].material
    assert material is not None
    assert mass * material.need("cost", result.after.arm.temperature) == pytest.approx(1.5, rel=0.01)
    (folder / "problem.yaml").write_text(PROBLEM.format(most=474), encoding="utf-8")
    with pytest.raises(NoAnswer, match="cost"):
        optimise(read_problem(folder / "problem.yaml"))


WORK = "machining: {per_kilogram: 6 EUR/kg, per_metre: 40 EUR/m, per_part: 25 EUR, date: 2026-03}\n"
WORKED = """
name: worked
payload: {mass: 2 kg}
chain:
  - joint: {range: [-90 deg, 90 deg], cost: {value: 300 EUR, date: 2026-02}}
    link: {length: 400 mm, section: {shape: tube, diameter: 80 mm, thickness: 4 mm}, material: aluminium-6061-t6}
  - joint: {range: [-90 deg, 90 deg]}
    link: {length: 300 mm, section: {shape: circle, diameter: 40 mm}, material: dear}
"""
OWN = """
format_version: 1
references: {own: an offer}
materials:
  dear: {source: own, elastic_modulus: 210 GPa, density: 8000 kg/m^3, poisson_ratio: 0.3, shear_modulus: 80.77 GPa,
         cost: {value: 2 EUR/kg, date: 2025}, machining_cost: 11 EUR/kg}
"""


@pytest.fixture
def worked(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (folder / "arm.yaml").write_text(WORKED + WORK, encoding="utf-8")
    (folder / "own.yaml").write_text(OWN, encoding="utf-8")
    monkeypatch.setenv("LINKWRIGHT_CATALOGUE", str(folder / "own.yaml"))
    return folder


def test_work_by_kilogram_metre_and_part(worked: Path):
    """A material's own price of work takes the place of the arm's by the kilogram, not of the others."""
    arm = read_arm(worked / "arm.yaml")
    result = evaluate(arm)
    first = result.link_masses[0] * (2.64 + 6.0) + 0.4 * 40.0 + 25.0
    steel = 8000.0 * 0.3 * 3.141592653589793 * 0.02**2
    assert parts(arm)["price_EUR"].tolist() == pytest.approx([300.0, first, steel * 13.0 + 12.0 + 25.0], rel=1e-8)
    assert result.cost == pytest.approx(300.0 + first + steel * 13.0 + 37.0, rel=1e-12)
    assert price_dates(arm) == ("", "2024", "2025", "2026-02", "2026-03")
    assert dates_in_words(price_dates(arm)) == "prices of 2024 to 2026-03, some without a date"
    again = worked / "again.yaml"
    again.write_text(arm_to_yaml(arm), encoding="utf-8")
    assert read_arm(again).machining == arm.machining
    assert price_dates(read_arm(again)) == price_dates(arm)


@pytest.mark.parametrize(
    ("was", "now", "message"),
    [
        ("6 EUR/kg", "6 EUR", "machining.per_kilogram"),
        ("25 EUR,", "-25 EUR,", "machining.per_part: cannot be negative"),
        ("date: 2026-03", "date: March", "machining.date: is a year, month or day"),
        ("per_metre", "per_meter", "did you mean 'per_metre'"),
    ],
)
def test_work_with_a_mistake(worked: Path, was: str, now: str, message: str):
    (worked / "arm.yaml").write_text(WORKED + WORK.replace(was, now), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_arm(worked / "arm.yaml")


@pytest.mark.slow
def test_the_cheapest_design_counts_work(worked: Path):
    """Against shapes and materials on a grid of sizes: none that keeps the limit is cheaper, and the bound holds."""
    (worked / "problem.yaml").write_text(
        "arm: arm.yaml\nminimize: cost\nsubject_to: {max_error: '<= 0.3 mm', section_size: [20 mm, 90 mm]}\n"
        "choose: {section: [circle, rectangle], material: [aluminium-6061-t6, dear],"
        " same: [section, material, size]}\n",
        encoding="utf-8",
    )
    problem = read_problem(worked / "problem.yaml")
    result = optimise(problem)
    assert result.after.cost is not None
    assert result.after.max_error <= 0.3e-3 * (1.0 + 1e-6)
    assert parts(result.after.arm)["price_EUR"].sum() == pytest.approx(result.after.cost, rel=1e-8)
    assert result.lower_bound is not None
    assert result.lower_bound <= result.after.cost * (1.0 + 1e-6)
    known = problem.arm
    stuffs = [known.links[0].material, known.links[1].material]
    sections = [SHAPES["circle"](diameter=d * 1e-3) for d in range(30, 61, 6)]  # type: ignore[call-arg]
    sections += [
        SHAPES["rectangle"](width=w * 1e-3, height=h * 1e-3)  # type: ignore[call-arg]
        for w, h in itertools.product((20, 30), (30, 40, 50))
    ]
    cheapest = []
    for section, item in itertools.product(sections, stuffs):
        links = tuple(replace(link, section=section, material=item, section_name=None) for link in known.links)
        found = evaluate(known.with_links(links))
        if found.max_error <= 0.3e-3:
            cheapest.append(found.cost)
    assert len(cheapest) > 4
    assert result.after.cost <= min(cheapest)
    assert result.after.cost >= 0.8 * min(cheapest)
