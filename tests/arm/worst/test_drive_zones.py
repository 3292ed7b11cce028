"""Drives that stiffen under load: their wind-up zone by zone, and worst cases certified in spite of the kinks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.actuators import load_actuators
from linkwright.core.arm.chain.chain import Arm, Calibrated, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.errors.drive_zones import zone_combinations
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Tube
from tests.optimize.builders import problem_of, scanned_error

CSG = load_actuators(user=False).find("CSG-25-100-2UH")  # K 31, 50, 57 kN*m/rad; T 14, 48 N*m


def joint(**more: object) -> Joint:
    own = Joint(range=(-3.1, 3.1), stiffness=CSG.stiffness, zones=CSG.zones, actuator=CSG)
    return replace(own, **more)


def rigid(*lengths: float, play: str = "worst", **more: object) -> Arm:
    """Weightless rigid links on drives with zones."""
    links = tuple(Link(length, mass=0.0) for length in lengths)
    return Arm("drives", tuple(joint(**more) for _ in links), links, play=play)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("torque", "turned"), [(10.0, 10 / 31), (30.0, 14 / 31 + 16 / 50), (87.0, 14 / 31 + 34 / 50 + 39 / 57)]
)
def test_a_drive_winds_up_by_the_zones_of_its_catalogue(torque: float, turned: float) -> None:
    """By hand, in mrad: 1.816 under the rated 87 N*m, where the softest zone alone would give 2.806, 55 % more."""
    result = evaluate(rigid(0.8), load_cases=[LoadCase(torque / 0.8 / 9.81)])
    assert result.max_error == pytest.approx(0.8e-3 * turned, rel=1e-9)
    assert result.worst.certified
    assert result.by_effect["joint_compliance"] == pytest.approx(result.max_error)


def test_two_drives_in_different_zones_are_certified_by_zones() -> None:
    """Each joint is seen in all its zones over the workspace; a scan of poses finds nothing worse."""
    arm, cases = rigid(0.5, 0.45, backlash=1e-4), [LoadCase(6.0), LoadCase(0.0, force=(60.0, 40.0, 0.0))]
    result = evaluate(arm, load_cases=cases)
    scanned = scanned_error(arm, cases, poses=40_000)
    assert result.worst.certified
    assert result.worst.upper_bound is not None
    assert scanned * (1.0 - 1e-9) <= result.max_error <= scanned * (1.0 + 2e-3)
    assert (
        result.max_error
        < 0.9 * evaluate(replace(arm, joints=(joint(zones=(), backlash=1e-4),) * 2), load_cases=cases).max_error
    )
    seated = evaluate(replace(arm, play="loaded"), load_cases=cases)
    assert seated.worst.certified
    assert seated.max_error <= result.max_error * (1.0 + 1e-9)


def test_too_many_ways_leave_a_bound_that_holds_and_says_its_gap() -> None:
    """512 // 2^7 = 4 ways for two drives with five zones each: the curves lie within bands about straight lines."""
    plays = tuple(EffectEntry("backlash", (k,), {"total": 1e-6}) for k in (1, 2, 1, 2, 1, 2, 1))
    arm = replace(rigid(0.5, 0.45), effects=plays)
    result = evaluate(arm, load_cases=[LoadCase(8.0)])
    exact = evaluate(replace(arm, effects=()), load_cases=[LoadCase(8.0)])
    assert not result.worst.certified
    assert result.worst.upper_bound is not None
    assert exact.max_error < result.max_error < result.worst.upper_bound < 1.25 * result.max_error


def test_a_band_holds_the_whole_curve() -> None:
    greatest = 87.0
    one, other = zone_combinations([CSG.zones], np.array([greatest]), 1.0, 2)
    first_end, first = CSG.zones[0]
    for load in np.linspace(0.0, greatest, 500):
        low, high = (item.weights[0] * load / first + item.weights[1] * first_end / first for item in (one, other))
        assert low * (1.0 + 1e-12) - 1e-15 <= CSG.wind_up(load) <= high * (1.0 + 1e-12)
    assert other.weights[1] * first_end / first < 0.08 * CSG.wind_up(greatest)


def test_calibration_takes_the_wind_up_of_its_own_zone() -> None:
    """From 20 N*m on to 60 N*m, by the catalogue's own curve."""
    case = LoadCase(60.0 / 0.8 / 9.81, relative_to=Calibrated(LoadCase(20.0 / 0.8 / 9.81)))
    arm = replace(rigid(0.8), joints=(joint(range=(-0.02, 0.02)),))
    result = evaluate(arm, load_cases=[case])
    assert result.max_error == pytest.approx(0.8 * (CSG.wind_up(60.0) - CSG.wind_up(20.0)), rel=1e-9)
    assert result.worst.certified


def test_a_stiffness_beside_the_actuator_has_no_zones(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    link = "link: {length: 800 mm, rigid: true, mass: 0 kg}\npayload: {mass: 10 kg}\n"
    errors: list[float] = []
    for more in ("", ", stiffness: 31 kN*m/rad"):
        path.write_text(f"chain:\n  - joint: {{actuator: CSG-25-100-2UH{more}}}\n    {link}", encoding="utf-8")
        errors.append(evaluate(read_arm(path)).max_error)
        write_arm(read_arm(path), path)
        assert evaluate(read_arm(path)).max_error == errors[-1]
    torque = 10.0 * 9.81 * 0.8
    assert errors == pytest.approx([0.8 * CSG.wind_up(torque), 0.8 * torque / 31e3], rel=1e-9)


ARM = """
chain:
  - joint: {range: [-60 deg, 60 deg], actuator: CSG-25-100-2UH}
    link: {length: 450 mm, section: {shape: circle, diameter: 50 mm}, material: aluminium-6061-t6}
  - joint: {range: [-60 deg, 60 deg], actuator: CSG-17-100-2UH}
    link: {length: 350 mm, section: {shape: circle, diameter: 50 mm}, material: aluminium-6061-t6}
payload: {mass: 3 kg}
"""


def test_an_optimum_on_such_drives_is_certified_and_called_local(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, ARM, "subject_to: {mass: '<= 4 kg', section_size: [10 mm, 120 mm]}\n")
    result = optimise(problem)
    assert result.status == "certified"
    assert result.optimum == "local"
    assert result.objective >= scanned_error(result.arm, problem.load_cases, poses=4000) * (1.0 - 2e-4)
    assert result.objective < result.before.max_error


TUBES = """
chain:
  - joint: {range: [-30 deg, 90 deg], actuator: CSG-32-100-2UH}
    link: {length: 600 mm, section: {shape: tube, diameter: 90 mm, thickness: 4 mm}, material: aluminium-6061-t6}
  - joint: {range: [-120 deg, 0 deg], actuator: CSG-25-100-2UH}
    link: {length: 500 mm, section: {shape: tube, diameter: 80 mm, thickness: 3 mm}, material: aluminium-6061-t6}
payload: {mass: 5 kg}
"""
CORNERS = """
workspace: {path: [[700 mm, 200 mm], [900 mm, 200 mm]]}
relative_to: {payload: {mass: 2 kg}}
subject_to: {mass: "<= 6 kg", section_size: [20 mm, 140 mm], thickness: [2 mm, 10 mm]}
"""


@pytest.mark.slow
def test_corners_between_zones_do_not_end_a_search(tmp_path: Path) -> None:
    """The load of the calibration grows with the links and passes from zone to zone, where the error has no derivative:
    a design of round sizes tells how far a search has to come."""
    problem = problem_of(tmp_path, TUBES, CORNERS)
    sizes = ((0.14, 0.0054), (0.127, 0.0043))
    links = [replace(k, section=Tube(*own)) for k, own in zip(problem.arm.links, sizes, strict=True)]
    known = evaluate(problem.arm.with_links(tuple(links)), problem.workspace, problem.load_cases)
    result = optimise(problem)
    assert known.mass <= 6.0
    assert result.status == "certified"
    assert result.objective <= known.max_error
    assert result.objective == pytest.approx(known.max_error, rel=0.02)
