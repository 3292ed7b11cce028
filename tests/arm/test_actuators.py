"""Actuators: what a joint takes from the catalogue, what wins beside it, and what the drives hold."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from linkwright.core.arm.actuators import (
    USER_ACTUATORS,
    Actuator,
    load_actuators,
    read_actuators,
    shipped_actuators,
)
from linkwright.core.arm.chain.chain import EffectEntry, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures.torque import drive_case, greatest_drive_loads
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, parse_yaml

BAR = "link: {length: 500 mm, section: {shape: circle, diameter: 50 mm}, material: aluminium-6061-t6}"
OWN = """\
format_version: 1
maker: Somebody
references: {list: "Somebody's price list"}
actuators:
  TURNER 1: {gear: planetary, rated_torque: 20 N*m, stiffness: 5 kN*m/rad, backlash: 3 arcmin, mass: 2 kg, source: list,
             cost: {value: 800 EUR, spread: [700 EUR, 950 EUR], date: 2026-01}}
"""


def arm_with(folder: Path, *joints: str, rest: str = "payload: {mass: 3 kg}\n"):
    """An arm of equal bars whose joints have these keys."""
    lines = "".join(f"  - joint: {{range: [-120 deg, 120 deg]{joint}}}\n    {BAR}\n" for joint in joints)
    path = folder / "arm.yaml"
    path.write_text(f"chain:\n{lines}{rest}", encoding="utf-8")
    return read_arm(path)


def read_text(text: str) -> dict[str, Actuator]:
    return read_actuators(Mapping(parse_yaml(text, file="own.yaml"), file="own.yaml"))


# ---- the shipped catalogue


def test_csg_ratings_are_those_of_csf_raised_by_thirty_per_cent() -> None:
    # Harmonic Drive LLC, CSF & CSG Series: CSG has 30 % more torque capacity. CSF at ratio 100, rated, peak, by size.
    csf = {14: (7.8, 28), 17: (24, 54), 20: (40, 82), 25: (67, 157), 32: (137, 333), 40: (265, 568), 45: (353, 755)}
    for size, (rated, peak) in csf.items():
        result = load_actuators(user=False).find(f"CSG-{size}-100-2UH")
        assert result.rated_torque == pytest.approx(1.3 * rated, abs=0.6)
        assert result.peak_torque == pytest.approx(1.3 * peak, abs=0.6)


def test_shipped_actuators_are_sound() -> None:
    result = shipped_actuators()
    assert len(result) >= 40
    for maker in ("Harmonic Drive", "Nabtesco"):
        own = [item for item in result.values() if item.maker == maker]
        for smaller, larger in itertools.pairwise(own):
            assert larger.rated_torque > smaller.rated_torque
            assert larger.stiffness > smaller.stiffness
            assert larger.mass > smaller.mass
    for each in result.values():
        if not each.lacks("rated_torque", "peak_torque"):
            assert 1.6 < each.peak_torque / each.rated_torque < (6.0 if each.gear == "servo" else 4.0)
        # Gears of one kind wind up alike under their rated torque, whatever their size: a slipped digit would show.
        if each.stiffnesses and each.rated_torque is not None:
            assert 0.5e-3 < each.wind_up(each.rated_torque) < 2.3e-3
        assert each.stiffnesses == tuple(sorted(each.stiffnesses))
        assert each.source


def test_torques_and_masses_of_servos_go_together() -> None:
    """Of one maker's metal or plastic servos a slipped digit or gram would show: N*m of stall torque for each kg."""
    for actuator in shipped_actuators().values():
        if actuator.gear == "servo" and not actuator.lacks("mass", "peak_torque"):
            assert 8.0 < actuator.peak_torque / actuator.mass < 70.0
        if actuator.gear == "servo" and actuator.backlash is not None:
            assert 1e-3 < actuator.backlash < 20e-3


@given(
    name=st.sampled_from(
        sorted(n for n, item in shipped_actuators().items() if not item.lacks("stiffness", "rated_torque"))
    ),
    shares=st.tuples(st.floats(0.0, 3.0), st.floats(0.0, 3.0)),
)
def test_no_gear_gives_more_than_its_stiffness_says(name: str, shares: tuple[float, float]) -> None:
    gear = shipped_actuators()[name]
    low, high = sorted(share * gear.rated_torque for share in shares)
    assert gear.wind_up(high) <= high / gear.stiffness + 1e-15
    assert gear.wind_up(low) <= gear.wind_up(high)
    assert gear.wind_up(-high) == -gear.wind_up(high)


def test_zones_of_stiffness_add_up() -> None:
    # Harmonic Drive's own example of the method: T1/K1 + (T2 - T1)/K2 + (T - T2)/K3.
    gear = load_actuators(user=False).find("CSG-25-100-2UH")
    by_hand = 14.0 / 31e3 + (48.0 - 14.0) / 50e3 + (87.0 - 48.0) / 57e3
    assert gear.wind_up(87.0) == pytest.approx(by_hand, rel=1e-12)
    assert gear.wind_up(10.0) == pytest.approx(10.0 / 31e3, rel=1e-12)


def test_a_belt_gives_by_its_spans_and_its_motor() -> None:
    """Two springs EA/L at the pulley's radius, behind a motor whose torque is a sine over four of its steps."""
    belt = load_actuators(user=False).find("NEMA17-GT2-60-20")
    large, small = (teeth * 2e-3 / (2.0 * math.pi) for teeth in (60, 20))

    def too_long(distance: float) -> float:
        lean = math.asin((large - small) / distance)
        return 2.0 * distance * math.cos(lean) + math.pi * (large + small) + 2.0 * lean * (large - small) - 0.2

    span = math.sqrt(brentq(too_long, 0.03, 0.1) ** 2 - (large - small) ** 2)
    motor = 0.59 * 2.0 * math.pi / math.radians(4.0 * 1.8) * belt.ratio**2
    low, typical, high = (1.0 / (span / (2.0 * rigidity * large**2) + 1.0 / motor) for rigidity in (10e3, 20e3, 40e3))
    assert belt.stiffness == pytest.approx(typical, rel=0.01)
    assert f"{low:.0f} to {high:.0f} N*m/rad" in dict(belt.unconfirmed)["stiffness"]
    assert belt.peak_torque == pytest.approx(0.59 * belt.ratio)


# ---- in an arm file


def test_a_joint_takes_its_actuators_figures(tmp_path: Path) -> None:
    joint = arm_with(tmp_path, ", actuator: RV-20E").joints[0]
    arcmin = math.radians(1.0 / 60.0)
    assert joint.stiffness == pytest.approx(49.0 / arcmin, rel=1e-12)
    assert joint.backlash == pytest.approx(arcmin, rel=1e-12)
    assert joint.mass == 4.7


def test_keys_beside_an_actuator_win_and_are_written_back(tmp_path: Path) -> None:
    stiff = ", actuator: RV-6E, stiffness: 50 kN*m/rad"
    arm = arm_with(tmp_path, ", actuator: RV-20E, backlash: 0 deg, mass: 6 kg", stiff)
    assert (arm.joints[0].backlash, arm.joints[0].mass) == (0.0, 6.0)
    assert arm.joints[1].stiffness == 50e3
    text = arm_to_yaml(arm)
    (tmp_path / "again.yaml").write_text(text, encoding="utf-8")
    assert read_arm(tmp_path / "again.yaml") == arm
    first = text.split("joint: ")[1].splitlines()[0]
    assert "actuator: RV-20E" in first
    assert "stiffness" not in first
    assert "backlash: 0" in first


def test_the_error_is_that_of_the_figures_given_by_hand(tmp_path: Path) -> None:
    named = arm_with(tmp_path, ", actuator: RV-20E", ", actuator: CSG-17-100-2UH")
    inner = ", stiffness: 49 N*m/arcmin, backlash: 1 arcmin, mass: 4.7 kg"
    softest = arm_with(tmp_path, inner, ", stiffness: 10 kN*m/rad, mass: 0.68 kg")
    zones = {"stiffness_1": 1e4, "stiffness_2": 1.4e4, "stiffness_3": 1.6e4, "torque_1": 3.9, "torque_2": 12.0}
    by_hand = replace(
        arm_with(tmp_path, inner, ", mass: 0.68 kg"), effects=(EffectEntry("joint_hardening", (2,), zones),)
    )
    one, other = evaluate(named), evaluate(by_hand)
    assert one.max_error == pytest.approx(other.max_error, rel=1e-12)
    assert one.worst.certified
    assert other.worst.certified
    assert one.total_mass == other.total_mass
    assert evaluate(softest).max_error > 1.1 * one.max_error


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        (", actuator: RV-20", "did you mean 'RV-20E'"),
        (", actuator: 5", "needs a text"),
        (", type: prismatic, actuator: RV-20E", "slide"),
    ],
)
def test_an_actuator_that_cannot_be_is_refused(joint: str, message: str, tmp_path: Path) -> None:
    if "prismatic" in joint:
        joint = joint.replace(", type", "").replace("prismatic", "x")
        path = tmp_path / "arm.yaml"
        path.write_text(f"chain:\n  - joint: {{type: prismatic, range: [0 mm, 9 mm], actuator: RV-20E}}\n    {BAR}\n")
        with pytest.raises(InputError, match=message):
            read_arm(path)
        return
    with pytest.raises(InputError, match=message) as error:
        arm_with(tmp_path, joint)
    assert error.value.key == "chain[1].joint.actuator"


def test_ones_own_actuators_add_to_the_shipped_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "own.yaml").write_text(OWN, encoding="utf-8")
    monkeypatch.setenv(USER_ACTUATORS.variable, str(tmp_path / "own.yaml"))
    arm = arm_with(tmp_path, ", actuator: TURNER 1")
    result = evaluate(arm)
    links = result.mass * arm.links[0].material.need("cost")  # type: ignore[union-attr]
    assert result.cost == pytest.approx(links + 800.0, rel=1e-12)
    assert len(load_actuators()) == len(shipped_actuators()) + 1
    assert evaluate(arm_with(tmp_path, ", actuator: RV-6E")).cost is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rated_torque: 20 N*m", "rated_torque: 20 N", "rated_torque"),
        ("rated_torque: 20 N*m", "rated_torque: 20 N*m, peak_torque: 10 N*m", "peak_torque.*below"),
        ("stiffness: 5 kN*m/rad", "stiffness: [5 kN*m/rad, 6 kN*m/rad]", "zone_torques"),
        ("stiffness: 5 kN*m/rad", "stiffness: [5 kN*m/rad, 6 kN*m/rad], zone_torques: [1 N*m, 2 N*m]", "zone_torques"),
        ("backlash: 3 arcmin", "backlash: -3 arcmin", "backlash.*negative"),
        ("source: list", "source: elsewhere", "not among"),
        (", date: 2026-01", "", "date"),
        ("spread: [700 EUR, 950 EUR]", "spread: [900 EUR, 950 EUR]", "spread"),
        ("gear: planetary", "gear: chain", "gear"),
        ("mass: 2 kg", "mas: 2 kg", "mass"),
    ],
)
def test_entries_that_cannot_be_are_refused(old: str, new: str, message: str) -> None:
    assert "TURNER 1" in read_text(OWN)
    with pytest.raises(InputError, match=message):
        read_text(OWN.replace(old, new))


# ---- what the drives hold


def test_a_stretched_arm_is_held_by_its_moments_of_weight(tmp_path: Path) -> None:
    arm = arm_with(tmp_path, ", actuator: RV-20E", ", actuator: RV-6E")
    result = evaluate(arm)
    assert result.drives is not None
    g, length, bar, payload = 9.81, 0.5, result.link_masses[0], 3.0
    outer = g * length * (payload + 0.5 * bar)
    inner = g * length * (2.0 * payload + 1.5 * bar + 0.5 * bar + 2.5)  # the outer gear, 2.5 kg, sits at its joint
    assert result.drives.greatest == pytest.approx((inner, outer), rel=1e-9)
    assert result.drives.use == pytest.approx((inner / 167.0, outer / 58.0), rel=1e-9)


def test_greatest_loads_are_above_every_pose_of_a_scan(tmp_path: Path) -> None:
    arm = arm_with(tmp_path, ", actuator: RV-20E", ", actuator: RV-6E")
    cases = (LoadCase(1.0, (40.0, -15.0, 0.0)), LoadCase(2.0, (-30.0, 60.0, 0.0)))
    p = beam_values(beams_of(arm))
    drives = [drive_case(arm, case) for case in cases]
    search = WorstSearch(error_model(arm, cases), Workspace())
    result = greatest_drive_loads(arm, drives, search.poses(p, 256), p, search)
    q = np.random.default_rng(4).uniform(-math.radians(120), math.radians(120), (20_000, 2))
    scanned = np.max([np.abs(case.vectorised(q, p)[0]) for case in drives], axis=(0, 1))
    assert np.all(scanned <= np.array(result.greatest) * (1.0 + 1e-9))
    assert np.all(scanned >= np.array(result.greatest) * 0.995)


def test_an_overloaded_gear_is_told_and_a_strong_one_is_not(tmp_path: Path) -> None:
    weak = evaluate(arm_with(tmp_path, ", actuator: CSG-14-100-2UH"))
    strong = evaluate(arm_with(tmp_path, ", actuator: RV-6E"))
    assert any("CSG-14-100-2UH" in line and "rated 10 N*m" in line for line in weak.warnings)
    assert not strong.warnings
    assert evaluate(arm_with(tmp_path, "")).drives is None
