"""Counterweights, motors away from their joints and springs: what drives then hold, by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.balance import IdealCounterbalance, PointMass, SpringCounterbalance
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects.loads.counterbalance import link_angle
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml, write_arm
from linkwright.core.arm.limits.modes import first_frequencies
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Circle
from linkwright.core.units.quantities import InputError
from tests.arm.builders import arm_of

STEEL = load_catalogue(user=False).find("steel-s355")
G, K = 9.81, 2e4
AT_EVERY_ANGLE = np.linspace(-3.0, 3.0, 13)


def rigid(*lengths: float, payload: float = 5.0, **joint: object) -> Arm:
    links = tuple(Link(length, mass=0.0) for length in lengths)
    return Arm("balanced", tuple(Joint(stiffness=K, **joint) for _ in links), links, payload=LoadCase(payload))  # type: ignore[arg-type]


def hung(arm: Arm, link: int, *masses: PointMass) -> Arm:
    links = list(arm.links)
    links[link] = replace(links[link], masses=masses)
    return arm.with_links(tuple(links))


def drive_loads(arm: Arm, *q: np.ndarray | float) -> list[np.ndarray]:
    return [joint.drive_load for joint in solve(arm, list(q), beams_of(arm)).joints]


def test_a_counterweight_takes_the_whole_load_off_its_drive() -> None:
    """8 kg at 0.3 m behind the joint and 40 mm beside the axis, against 4 kg at 0.6 m and 80 mm to the other side."""
    arm = hung(rigid(0.6, payload=0.0), 0, PointMass(8.0, (-0.3, 0.04, 0.0)), PointMass(4.0, (0.0, -0.08, 0.0), "end"))
    assert drive_loads(arm, AT_EVERY_ANGLE)[0] == pytest.approx(np.zeros(13), abs=1e-12)
    assert evaluate(arm).max_error == pytest.approx(0.0, abs=1e-15)
    assert evaluate(arm).total_mass == 12.0
    lone = hung(rigid(0.6, payload=0.0), 0, PointMass(4.0, (0.0, -0.08, 0.0), "end"))
    assert drive_loads(lone, 0.7)[0] == pytest.approx(-4.0 * G * (0.6 * math.cos(0.7) + 0.08 * math.sin(0.7)))


def test_what_hangs_at_the_joint_does_not_bend_its_link_and_what_hangs_beyond_the_end_does() -> None:
    rod = Link(0.5, section=Circle(0.03), material=STEEL)
    left = frozenset({"shear_deformation", "axial"})
    bare = Arm("rod", (Joint(range=(-0.1, 0.1)),), (rod,), payload=LoadCase(2.0), leave_out=left)
    rear = hung(bare, 0, PointMass(30.0, (-0.3, 0.0, 0.0)))
    assert evaluate(rear).max_error == pytest.approx(evaluate(bare).max_error, rel=1e-12)
    assert evaluate(rear).strength.stress == pytest.approx(evaluate(bare).strength.stress, rel=1e-12)
    front = evaluate(hung(bare, 0, PointMass(3.0, (0.1, 0.0, 0.0), "end")))
    rigidity = float(beams_of(bare)[0].flexural_rigidity_height)
    more = 3.0 * G * (0.5**3 / 3.0 + 0.1 * 0.5**2 / 2.0) / rigidity
    assert front.max_error == pytest.approx(evaluate(bare).max_error + more, rel=1e-9)
    assert front.beyond.at_worst is not None
    assert front.beyond.at_worst < 2e-3 * front.max_error


def test_a_motor_on_the_base_takes_its_weight_off_the_first_drive() -> None:
    """At the second joint its 6 kg turn the first drive by m g L1 / K, which the tip sees from 0.9 m."""
    at_joint = rigid(0.5, 0.4)
    at_joint = replace(at_joint, joints=(at_joint.joints[0], replace(at_joint.joints[1], mass=6.0)))
    on_base = rigid(0.5, 0.4)
    on_base = replace(on_base, joints=(on_base.joints[0], replace(on_base.joints[1], motor_on_base=6.0)))
    on_first = hung(rigid(0.5, 0.4), 0, PointMass(6.0, motor_of=2))
    results = [evaluate(arm) for arm in (at_joint, on_base, on_first)]
    assert results[0].max_error - results[1].max_error == pytest.approx(6.0 * G * 0.5 / K * 0.9, rel=1e-6)
    assert results[2].max_error == pytest.approx(results[1].max_error, rel=1e-9)  # at the first joint it has no lever
    assert [result.total_mass for result in results] == [11.0] * 3


@pytest.mark.parametrize(
    "balance",
    [
        IdealCounterbalance(5.0 * G * 0.6),
        SpringCounterbalance(5.0 * G * 0.6 / (0.1 * 0.3), on_link=0.1, on_base=0.3, base_at=0.5 * math.pi),
    ],
)
def test_a_spring_without_length_of_its_own_balances_a_payload_everywhere(
    balance: IdealCounterbalance | SpringCounterbalance,
) -> None:
    arm = rigid(0.6, counterbalance=balance)
    assert drive_loads(arm, AT_EVERY_ANGLE)[0] == pytest.approx(np.zeros(13), abs=1e-12)
    heavier = evaluate(arm, load_cases=[LoadCase(7.0)])
    assert heavier.max_error == pytest.approx(2.0 * G * 0.6 / K * 0.6, rel=1e-9)
    assert heavier.worst.certified


def test_a_spring_turns_its_link_as_its_energy_falls() -> None:
    """The torque is -dU/dq of U = k (l - l0)^2/2 + F l, by differences."""
    spring = SpringCounterbalance(9e3, on_link=0.11, on_base=0.34, base_at=1.9, free_length=0.2, preload=-150.0)

    def energy(q: np.ndarray) -> np.ndarray:
        anchors = np.array([0.34 * math.cos(1.9), 0.34 * math.sin(1.9)])
        length = np.hypot(0.11 * np.cos(q) - anchors[0], 0.11 * np.sin(q) - anchors[1])
        return 4.5e3 * (length - 0.2) ** 2 - 150.0 * length

    slope = (energy(AT_EVERY_ANGLE + 1e-6) - energy(AT_EVERY_ANGLE - 1e-6)) / 2e-6
    assert spring.turning(AT_EVERY_ANGLE) == pytest.approx(-slope, rel=1e-6, abs=1e-4)
    result = evaluate(rigid(0.6, counterbalance=spring))
    assert result.worst.upper_bound is None  # no polynomial, and not called one
    loads = -5.0 * G * 0.6 * np.cos(np.linspace(-math.pi, math.pi, 20_001))
    loads += spring.turning(np.linspace(-math.pi, math.pi, 20_001))
    assert result.max_error == pytest.approx(0.6 * np.abs(loads).max() / K, rel=1e-6)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.48, -0.6, 0.64)])
def test_a_balancing_spring_does_no_work_over_a_whole_turn(axis: tuple[float, float, float]) -> None:
    """Its torque is the slope of an energy: none about a plumb axis is the same at every angle, as a zero is."""
    link = Link(0.4, direction=(0.36, 0.48, 0.8), mass=0.0)
    arm = Arm("leans", (Joint(axis=axis),), (link,), gravity=(0.0, 0.0, -G), payload=LoadCase(5.0))
    turn = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    for along in link_angle(solve(arm, [turn], beams_of(arm)), 0):
        assert np.mean(np.broadcast_to(along, turn.shape)) == pytest.approx(0.0, abs=1e-12)


def test_a_counterweight_slows_the_arm_by_its_moment_of_inertia() -> None:
    arm = hung(rigid(0.6, payload=4.0), 0, PointMass(9.0, (-0.2, 0.1, 0.0)))
    inertia = 4.0 * 0.6**2 + 9.0 * (0.2**2 + 0.1**2)
    result = first_frequencies(arm, beams_of(arm), 4.0, np.zeros((1, 1)))
    assert result[0] == pytest.approx(math.sqrt(K / inertia) / (2.0 * math.pi), rel=1e-6)
    assert Beam(0.6).mass == 0.0


FILE = """
chain:
  - joint: {range: [-90 deg, 90 deg], stiffness: 50 kN*m/rad, balancer: {torque: 40 N*m, greatest_at: 10 deg}}
    link: {length: 500 mm, rigid: true, mass: 3 kg, masses: [{mass: 4 kg, at: [-200 mm, 30 mm, 0 mm]}]}
  - joint:
      range: [-90 deg, 90 deg]
      stiffness: 20 kN*m/rad
      motor: {mass: 2.5 kg, on: 1}
      balancer: {stiffness: 3 kN/m, free_length: 120 mm, on_link: 90 mm, on_base: 250 mm, base_at: 80 deg}
    link:
      {length: 400 mm, section: {shape: circle, diameter: 40 mm}, material: steel-s355, masses: [{mass: 1 kg, on: end}]}
  - joint: {range: [-90 deg, 90 deg], motor: {mass: 1.5 kg, on: base}}
    link: {length: 100 mm, rigid: true, mass: 0.5 kg}
payload: {mass: 2 kg}
"""


def test_an_arm_file_keeps_what_hangs_on_it(tmp_path: Path) -> None:
    arm = arm_of(FILE, tmp_path)
    assert arm.links[0].masses == (PointMass(4.0, (-0.2, 0.03, 0.0)), PointMass(2.5, motor_of=2))
    assert arm.links[1].masses == (PointMass(1.0, on="end"),)
    assert arm.carried_mass == 9.0
    write_arm(arm, tmp_path / "again.yaml")
    again = read_arm(tmp_path / "again.yaml")
    assert (again.joints, again.links) == (arm.joints, arm.links)
    assert arm_to_yaml(again) == arm_to_yaml(arm)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("on: 1}", "on: 4}", "number of the link that carries it, 1 to 3"),
        ("{torque: 40 N*m, greatest_at: 10 deg}", "{greatest_at: 10 deg}", "greatest_at|neither a torque"),
        ("on_base: 250 mm", "on_base: 90 mm", "no length where both meet"),
        ("mass: 4 kg, at: [-200 mm, 30 mm, 0 mm]", "mass: 4 kg, at: [-200 mm, 30 mm]", "at"),
        ("mass: 4 kg, at:", "mass: 4, at:", "kg"),
        ("on: end}", "on: tip}", "joint"),
        (
            "{range: [-90 deg, 90 deg], motor",
            "{type: prismatic, range: [0 mm, 9 mm], balancer: {torque: 1 N*m}, motor",
            "slide",
        ),
    ],
)
def test_what_makes_no_balance_is_refused_in_one_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        arm_of(FILE.replace(old, new), tmp_path)
    assert "\n" not in str(caught.value)
