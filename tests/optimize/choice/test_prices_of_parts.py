"""What joints, rigid links and machining cost: counted once, in evaluation, design, limits and the list of parts."""

from pathlib import Path

import pytest

from arm.evaluation import evaluate
from arm.files.read import read_arm
from arm.files.write import arm_to_yaml
from linkwright.drawings.parts import parts
from optimize.problem import read_problem
from optimize.run import optimise
from units.quantities import InputError, NoAnswer

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
    found, material = evaluate(arm), arm.links[0].material
    assert material is not None
    return found.link_masses[0] * material.need("cost", arm.temperature) + 310.0 + 45.0 + 120.0


def test_sum_and_list_of_parts(folder: Path):
    arm = read_arm(folder / "arm.yaml")
    found = evaluate(arm)
    assert found.cost == pytest.approx(by_hand(folder), rel=1e-12)
    assert parts(arm)["price_EUR"].sum() == pytest.approx(found.cost, rel=1e-8)
    again = folder / "again.yaml"
    again.write_text(arm_to_yaml(arm), encoding="utf-8")
    assert evaluate(read_arm(again)).cost == pytest.approx(found.cost, rel=1e-9)


def test_rigid_link_without_a_price_is_named(folder: Path):
    path = folder / "arm.yaml"
    path.write_text(ARM.replace(", cost: 120 EUR", ""), encoding="utf-8")
    found = evaluate(read_arm(path))
    assert found.cost is None
    assert "link 2, which is rigid" in found.unknown["cost"]
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
