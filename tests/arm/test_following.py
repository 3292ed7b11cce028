"""Joints that follow others, against closed forms of a palletiser whose wrist stays level, and by reciprocity."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.compensation import table_over
from linkwright.core.arm.errors.first_order import beyond_first_order
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, carried_to_tip, rotation_at_tip
from linkwright.core.arm.evaluation import compliance_at
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.limits.modes import compliance_matrices, segmented
from linkwright.core.arm.worst.inverse import inverse
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from tests.arm.builders import arm_of
from tests.arm.worst.test_worst_case import errors, search_of

G = 9.81
L1, L2, L3 = 0.8, 0.7, 0.2
K1, K2 = 4e5, 2e5
TUBE = "section: {shape: tube, diameter: 120 mm, thickness: 6 mm}, material: steel-s355"
RIGID = "rigid: true, mass: 0 kg"
LEVEL = 'follows: "-(q1 + q2)"'


def palletiser(folder: Path, links: str = RIGID, wrist: str = LEVEL, forearm: str = "", more: str = "") -> Arm:
    text = f"""chain:
  - joint: {{range: [20 deg, 110 deg], stiffness: 400 kN*m/rad}}
    link: {{length: 800 mm, {links}}}
  - joint: {{range: [-130 deg, -20 deg], stiffness: 200 kN*m/rad{forearm}}}
    link: {{length: 700 mm, {links}}}
  - joint: {{{wrist}}}
    link: {{length: 200 mm, {RIGID}}}
payload: {{mass: 20 kg}}
{more}"""
    return arm_of(text, folder)


def motion(arm: Arm, q: list[float]) -> tuple[Array, Array]:
    state = solve(arm, q, beams_of(arm))
    twists = [twist for effect in active_effects(arm) for twist in effect.effect.twists(state, effect.settings)]
    return np.array(carried_to_tip(state, twists)), np.array(rotation_at_tip(state, twists))


def test_the_wrist_of_a_palletiser_stays_level(tmp_path: Path) -> None:
    q = np.array([[0.6, -1.1, 0.0], [1.5, -0.4, 0.3]])  # what is said of the follower does not count
    both = q[:, 0] + q[:, 1]
    tips = tip_position(palletiser(tmp_path), q)
    assert tips[:, 0] == pytest.approx(L1 * np.cos(q[:, 0]) + L2 * np.cos(both) + L3, rel=1e-14)
    assert tips[:, 1] == pytest.approx(L1 * np.sin(q[:, 0]) + L2 * np.sin(both), rel=1e-14)


def test_drives_hold_a_palletiser_and_give_as_virtual_work_says(tmp_path: Path) -> None:
    """The payload rises by L1 sin q1 + L2 sin(q1 + q2): the platform's length is in no torque."""
    arm, q = palletiser(tmp_path), [0.6, -1.1, 0.0]
    state, weight, both = solve(arm, q, beams_of(arm)), 20.0 * G, q[0] + q[1]
    torques = [-weight * (L1 * math.cos(q[0]) + L2 * math.cos(both)), -weight * L2 * math.cos(both), -weight * L3]
    assert [joint.drive_load for joint in state.joints] == pytest.approx(torques, rel=1e-12)
    first, second = torques[0] / K1, torques[1] / K2
    shoulder = np.array([-L1 * math.sin(q[0]) - L2 * math.sin(both), L1 * math.cos(q[0]) + L2 * math.cos(both)])
    elbow = L2 * np.array([-math.sin(both), math.cos(both)])
    shift, turn = motion(arm, q)
    assert shift[:2] == pytest.approx(first * shoulder + second * elbow, rel=1e-12)
    assert turn == pytest.approx(0.0, abs=1e-18)


def test_bent_links_leave_the_platform_level(tmp_path: Path) -> None:
    """Rods hold it against the base, so that bending does not tilt it; without them it tilts."""
    q = [0.6, -1.1, 0.5]
    assert motion(palletiser(tmp_path, TUBE), q)[1] == pytest.approx(0.0, abs=1e-18)
    assert abs(motion(palletiser(tmp_path, TUBE, "range: [-3 rad, 3 rad]"), q)[1][2]) > 1e-4


def test_rods_take_the_platforms_moment_off_the_links(tmp_path: Path) -> None:
    """The forearm's end carries the payload's weight and no moment: a cantilever under an end force alone."""
    arm = palletiser(tmp_path, TUBE)
    state = solve(arm, [0.6, -1.1, 0.0], beams_of(arm))
    assert state.links[1].moment[2] == pytest.approx(0.0, abs=1e-12)
    assert state.links[1].force[1] == pytest.approx(-20.0 * G, rel=1e-12)
    parallel_to_link_1 = palletiser(tmp_path, TUBE, 'follows: "-q2"')  # rods to link 1, which gets the moment back
    state = solve(parallel_to_link_1, [0.6, -1.1, 0.0], beams_of(arm))
    assert state.links[1].moment[2] == pytest.approx(0.0, abs=1e-12)
    lever = L2 * math.cos(-0.5) + L3 * math.cos(0.6)
    own = float(beams_of(arm)[1].mass) * G * 0.5 * L2 * math.cos(-0.5)
    assert state.links[0].moment[2] == pytest.approx(-20.0 * G * lever - own, rel=1e-12)


def test_a_forearm_driven_from_the_base_asks_nothing_of_the_shoulder(tmp_path: Path) -> None:
    """Joint 2 turns by q2 - q1: its drive stands on the base, and q2 is the forearm's own angle."""
    arm = palletiser(tmp_path, wrist='follows: "-q2"', forearm=', follows: "q2 - q1"')
    q = [0.9, -0.3, 0.0]
    assert tip_position(arm, q)[0][:2] == pytest.approx(
        [L1 * math.cos(0.9) + L2 * math.cos(-0.3) + L3, L1 * math.sin(0.9) + L2 * math.sin(-0.3)], rel=1e-14
    )
    loads = [joint.drive_load for joint in solve(arm, q, beams_of(arm)).joints]
    assert loads[:2] == pytest.approx([-20.0 * G * L1 * math.cos(0.9), -20.0 * G * L2 * math.cos(-0.3)], rel=1e-12)


SPATIAL = f"""gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {{axis: z, stiffness: 90 kN*m/rad}}
    link: {{length: 300 mm, {TUBE}}}
  - joint: {{axis: y, stiffness: 70 kN*m/rad, range: [-2 rad, 1 rad]}}
    link: {{length: 500 mm, {TUBE}}}
  - joint: {{axis: -y, stiffness: 50 kN*m/rad, follows: "q3 - 0.5*q2"}}
    link: {{length: 400 mm, {TUBE}}}
  - joint: {{axis: x, follows: "2*q3 - q1/4 + 10 deg", stiffness: 30 kN*m/rad}}
    link: {{length: 200 mm, {TUBE}}}
  - joint: {{axis: y, follows: "q2 + q3"}}
    link: {{length: 100 mm, {TUBE}}}
  - joint: {{type: prismatic, axis: x, range: [0 mm, 300 mm], stiffness: 900 N/mm}}
    link: {{length: 100 mm, {RIGID}}}
  - joint: {{type: prismatic, axis: x, follows: q6}}
    link: {{length: 100 mm, {RIGID}}}
tool: {{xyz: [20 mm, 50 mm, 0 mm]}}
payload: {{mass: 5 kg}}
"""


def test_coupled_arms_are_reciprocal_and_their_tips_follow_the_jacobian(tmp_path: Path) -> None:
    """Maxwell: the compliance is symmetric, at the tip and among all points of the arm, whatever is coupled to what;
    it is so only if loads and motions pass the couplings by the same factors."""
    arm = arm_of(SPATIAL, tmp_path)
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (2, arm.size))
    for row in q:
        matrix = np.array(compliance_at(arm, beams_of(arm), row.tolist(), planar=False).matrix)
        assert matrix == pytest.approx(matrix.T, abs=1e-12 * np.abs(matrix).max())
    nodes = compliance_matrices(segmented(arm), beams_of(arm), q)
    assert nodes == pytest.approx(nodes.transpose(0, 2, 1), abs=1e-10 * float(np.abs(nodes).max()))
    moved, step = jacobian(arm, q), 1e-6
    for joint in range(arm.size):
        there = step * np.eye(arm.size)[joint]
        slope = (tip_position(arm, q + there) - tip_position(arm, q - there)) / (2.0 * step)
        assert moved[:, joint] == pytest.approx(slope, abs=1e-8)


def test_finite_motions_come_to_the_first_order_where_loads_are_small(tmp_path: Path) -> None:
    """A hundredth of the weight leaves a ten-thousandth of what lies beyond first order."""
    arm = arm_of(SPATIAL, tmp_path)
    q = np.random.default_rng(4).uniform(-1.0, 0.9, (3, arm.size))
    beyond: list[float] = []
    for share in (1.0, 0.01):
        light = replace(arm, gravity=(0.0, 0.0, -G * share))
        result = beyond_first_order(light, (light.payload,), (q[0].tolist(), 0), q)
        assert result.largest is not None
        beyond.append(result.largest)
    assert 0.0 < beyond[1] < 3e-4 * beyond[0]


def test_worst_poses_of_coupled_arms_are_certified(tmp_path: Path) -> None:
    """Only what has a drive spans the poses; the follower is told where it stands."""
    play = "effects: [{effect: backlash, at: [1, 2, 3], total: 0.4 mrad}]"
    forearm = palletiser(tmp_path, wrist='follows: "-q2"', forearm=', follows: "q2 - q1"')
    for arm in (palletiser(tmp_path, TUBE, more=play), forearm):
        search, p = search_of(arm)
        worst = search.worst(p)
        lower, upper = np.array([joint.range for joint in arm.joints]).T
        q = np.random.default_rng(0).uniform(lower, upper, (20_000, arm.size))
        brute = float(errors(search, p, q).max())
        assert worst.certified
        assert worst.upper_bound is not None
        assert 0.99 * worst.error <= brute <= worst.error * (1.0 + 1e-9) <= worst.upper_bound * (1.0 + 2e-9)
        for pose in worst.poses:
            assert pose.q == pytest.approx(arm.whole_pose([*pose.q[:2], 7.0]), abs=1e-12)


def test_points_have_single_poses_and_tables_no_column_of_their_own(tmp_path: Path) -> None:
    """In the plane two drives meet a point in one way each; a table for a controller spans what it can command."""
    arm = palletiser(tmp_path, TUBE)
    result = inverse(arm, (0.9, 0.3))
    assert [pose.isolated for pose in result] == [True]
    table = table_over(arm, 4, (20.0,))
    assert len(table.q) == 16
    assert table.q[:, 2] == pytest.approx(-table.q[:, 0] - table.q[:, 1], abs=1e-12)
    assert table.correction[:, 2] == pytest.approx(0.0, abs=1e-15)
    assert table.check is not None
    assert table.check.rms_corrected < 0.1 * table.check.rms_without


def test_what_joints_follow_is_written_as_it_is_read(tmp_path: Path) -> None:
    arm = arm_of(SPATIAL, tmp_path)
    path = tmp_path / "again.yaml"
    path.write_text(arm_to_yaml(arm), encoding="utf-8")
    again = read_arm(path)
    assert [joint.follows for joint in again.joints] == [joint.follows for joint in arm.joints]
    assert arm.joints[3].range == pytest.approx(
        (math.radians(10.0) - 2.25 * math.pi, math.radians(10.0) + 2.25 * math.pi)
    )


@pytest.mark.parametrize(
    ("wrist", "said"),
    [
        ('follows: "-(q1 + q9)"', "q9"),
        ('follows: "q1*q2"', "follows"),
        ('follows: "q1 + 3"', "bare number"),
        ('follows: "__import__"', "follows"),
        ('follows: "2*q3"', "q3"),
        ('follows: "-q1", range: [0 deg, 1 deg]', "range"),
    ],
)
def test_bad_couplings_are_told_in_one_line(tmp_path: Path, wrist: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        palletiser(tmp_path, wrist=wrist)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_recordings_hold_the_driven_joints_or_all_of_them_and_agree(tmp_path: Path) -> None:
    arm = palletiser(tmp_path, TUBE)
    path = tmp_path / "recording.csv"
    header = "q1_deg,q2_deg,{}x_mm,y_mm\n"
    rows = [(60.0, -70.0), (45.0, -80.0), (100.0, -60.0)]
    tips = 1e3 * tip_position(arm, np.radians([[*row, 0.0] for row in rows]))
    path.write_text(
        header.format("") + "".join(f"{a},{b},{x:.4f},{y:.4f}\n" for (a, b), (x, y, _) in zip(rows, tips, strict=True)),
        encoding="utf-8",
    )
    assert np.degrees(read_recording(path, arm).q[:, 2]) == pytest.approx([10.0, 35.0, -40.0])
    path.write_text(header.format("q3_deg,") + "60,-70,10,1000,200\n45,-80,30,900,100\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"q3_deg.*30.*35"):
        read_recording(path, arm)
    simulated = simulate(arm, Plan(poses=8)).recording
    assert simulated.q[:, 2] == pytest.approx(-simulated.q[:, 0] - simulated.q[:, 1], abs=1e-12)


def test_a_stage_that_follows_weighs_with_its_carriage(tmp_path):
    """Virtual work of a two-stage lift: the drive raises the second stage, its carriage with it, twice as far."""
    path = tmp_path / "lift.yaml"
    path.write_text(
        """
name: lift
chain:
  - joint: {type: prismatic, axis: y, range: [0 m, 1 m], stiffness: 1 kN/mm, mass: 4 kg}
    link: {length: 0.5 m, direction: [0, 1, 0], rigid: true, mass: 8 kg}
  - joint: {type: prismatic, axis: y, follows: q1, mass: 3 kg}
    link: {length: 0.5 m, direction: [0, 1, 0], rigid: true, mass: 5 kg}
payload: {mass: 10 kg}
"""
    )
    arm = read_arm(path)
    state = solve(arm, [0.4, 0.0], beams_of(arm))
    assert state.joints[0].drive_load == pytest.approx(-9.81 * (4 + 8 + 2 * (3 + 5 + 10)), rel=1e-12)
