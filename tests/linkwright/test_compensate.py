"""`linkwright compensate`: the table against closed forms, and what it does between its poses."""

import json
import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.compensation import (
    corrected,
    default_grid,
    grid_axes,
    model_error,
    remaining,
    table_at,
    table_over,
)
from linkwright.core.arm.effects import EFFECTS
from linkwright.face.compensation import Compensation
from linkwright.markdown.described import markdown

ARM = """\
name: rod
chain:
  - joint: {type: revolute, range: [-80 deg, 80 deg], stiffness: 20 kN*m/rad}
    link: {length: 1 m, rigid: true, mass: 0 kg}
payload: {mass: 10 kg}
"""


def rod(**joint):
    """One drive that gives, one stiff link of 1 m without weight, 10 kg at its end."""
    joint = {"range": (-1.4, 1.4), "stiffness": 2e4, **joint}
    return Arm("rod", (Joint(**joint),), (Link(1.0, mass=0.0),), payload=LoadCase(10.0))


def two_links():
    joints = tuple(Joint(range=(-1.2, 1.2), stiffness=k) for k in (4e4, 2e4))
    return Arm("two", joints, (Link(0.5, mass=2.0), Link(0.4, mass=1.0)), payload=LoadCase(5.0))


def sunk(q, mass):
    """By how much the rod's drive turns (rad) at a coordinate: where m g cos(q + turn) meets -K turn."""
    return brentq(lambda turn: 2e4 * turn + 9.81 * mass * math.cos(q + turn), -0.1, 0.1, xtol=1e-15)


def test_error_of_a_drive_that_gives():
    """It turns until its spring carries the load where that has come to hang, and the tip goes round with it."""
    q = np.linspace(-1.4, 1.4, 11)
    stands = q + np.array([sunk(item, 10.0) for item in q])
    expected = np.stack([np.cos(stands) - np.cos(q), np.sin(stands) - np.sin(q), 0.0 * q], axis=1)
    assert np.abs(model_error(rod(), q[:, None], 10.0) - expected).max() < 1e-10


def test_correction_is_what_the_drive_gives():
    """The joint must stand higher by what it sinks there; it sinks to q, so that the torque is the one at q."""
    q = np.linspace(-1.3, 1.3, 9)[:, None]
    _, moved, _ = corrected(rod(), q, 10.0)
    assert np.abs(moved[:, 0] - 98.1 * np.cos(q[:, 0]) / 2e4).max() < 1e-9


def test_corrections_take_the_error_away():
    """Two joints reach every small displacement in the plane, away from the stretched pose."""
    arm = two_links()
    q = np.stack([np.linspace(-1.0, 1.0, 7), np.full(7, 0.9)], axis=1)
    error, moved, _ = corrected(arm, q, 5.0)
    assert remaining(arm, q, moved, 5.0).max() < 1e-9
    assert np.linalg.norm(error, axis=1).min() > 1e-4


def test_what_is_left_is_what_the_model_says_there():
    """Where the last steps were too small to ask the model again, it would have said the same; near the stretched pose,
    where something stays, too."""
    arm = two_links()
    q = np.stack([np.linspace(-1.0, 1.0, 41), np.linspace(-0.9, 0.9, 41)], axis=1)
    error, moved, left = corrected(arm, q, 5.0)
    assert left == pytest.approx(remaining(arm, q, moved, 5.0), abs=3e-12)
    assert left.max() > 1e-6
    assert error == pytest.approx(model_error(arm, q, 5.0), abs=1e-15)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_correction_that_seats_the_play_the_other_way_is_found(way):
    """The second link hangs, or stands, within a hair of plumb, so that what brings the tip back turns the load on its
    drive, and its play lies on the other side: what is left is what the model says there. Standing there is no pose at
    which the tip is where it should be; hanging there is."""
    loose = (Joint(range=(-3.0, 3.0), stiffness=k, backlash=2e-3) for k in (4e4, 2e4))
    arm = replace(two_links(), joints=tuple(loose))
    q1 = np.linspace(-1.0, 1.0, 400)
    q = np.stack([q1, way * math.pi / 2 - q1 + np.linspace(-3e-3, 3e-3, 400)], axis=1)
    _, moved, left = corrected(arm, q, 5.0)
    assert left == pytest.approx(remaining(arm, q, moved, 5.0), abs=3e-12)
    assert (left.max() > 1e-4) == (way > 0.0)


def test_stretched_pose_keeps_joints_near():
    """Stretched out the joints cannot move the tip along the arm: what lies there stays, and no joint runs away."""
    long = EffectEntry("encoder_offset", (2,), {"offset": 0.01})
    arm = replace(two_links(), effects=(long,), gravity=(0.0, 0.0, 0.0))
    _, moved, _ = corrected(arm, np.array([[0.3, 1e-4]]), 0.0)
    assert np.abs(moved).max() < 0.05


def test_table_holds_the_error_at_its_poses():
    """Rows are the grid's poses, joint by joint; the payload is that asked for."""
    table = table_over(two_links(), 5, (0.0, 5.0))
    assert table.q.shape == (50, 2)
    assert np.array_equal(table.payload, np.repeat([0.0, 5.0], 25))
    assert np.allclose(table.error[25:], model_error(two_links(), table.q[25:], 5.0), atol=0.0)


def test_interpolation_error_falls_with_the_square_of_the_step():
    """Linear interpolation of a smooth error: half the step, a quarter of what is left."""
    coarse, fine = (table_over(two_links(), points, (5.0,)).check for points in (9, 17))
    assert coarse.largest_without == pytest.approx(fine.largest_without)
    assert 3.0 < coarse.rms_subtracted / fine.rms_subtracted < 5.0
    assert 3.0 < coarse.rms_corrected / fine.rms_corrected < 5.0


def test_interpolated_check_is_what_a_controller_would_meet():
    """At one off-grid pose, by hand: the mean of both neighbours against the error there."""
    table = table_over(rod(), 2, (10.0,))
    q = np.array([[0.0]])
    left = np.linalg.norm(model_error(rod(), q, 10.0)[0] - table.error.mean(axis=0))
    assert table.check.largest_subtracted == pytest.approx(left, rel=0.01)


def test_play_lies_where_the_load_seats_it():
    """Backlash of 2 mrad under gravity: the tip hangs 1 mrad lower, as exactly as gravity pulls one way."""
    arm = rod(backlash=2e-3, stiffness=None)
    error = model_error(arm, np.zeros((1, 1)), 10.0)
    assert error[0] == pytest.approx([math.cos(1e-3) - 1.0, -math.sin(1e-3), 0.0], abs=1e-15)


def test_what_belongs_to_the_instrument_is_not_compensated():
    """A tracker that reads 100 ppm long moves no tip; an encoder that stands off by 1 mrad does."""
    instrument = EffectEntry("instrument_scale", (), {"scale": 1e-4})
    encoder = EffectEntry("encoder_offset", (1,), {"offset": 1e-3})
    q = np.array([[0.3]])
    stiff = rod(stiffness=None)
    assert np.array_equal(model_error(replace(stiff, effects=(instrument,)), q, 10.0), np.zeros((1, 3)))
    moved = model_error(replace(stiff, effects=(instrument, encoder)), q, 10.0)
    assert np.linalg.norm(moved) == pytest.approx(2.0 * math.sin(0.5e-3))


def test_what_the_instrument_brings_in_is_known():
    """What a corrected arm may carry without moving its tip."""
    results = {effect.id for effect in EFFECTS.values() if effect.recording.of_instrument}
    of_tips = {"frame_misalignment", "frame_drift", "instrument_scale", "latency", "stale_reading"}
    assert results == of_tips | {"torque_constant", "torque_offset", "torque_delay"}


def test_default_grid_stays_useful():
    """Never fewer than two coordinates a joint, never a table that no controller holds."""
    for joints in range(1, 8):
        points = default_grid(joints)
        assert points >= 2
        assert points == 2 or points**joints <= 20_000


def test_axes_span_the_ranges():
    axes = grid_axes(two_links(), 5)
    assert [(axis[0], axis[-1], len(axis)) for axis in axes] == [(-1.2, 1.2, 5)] * 2


@pytest.fixture
def rod_file(bench):
    (bench / "rod.yaml").write_text(ARM, encoding="utf-8")
    return bench


def test_command_writes_a_table_that_a_controller_can_subtract(linkwright, rod_file):
    """The CSV in degrees and mm; the tip comes to where it should be when dq is added."""
    status, out, err = linkwright("compensate", "rod.yaml", "--grid", 9, "--out", "t.csv", "--json", "t.json")
    assert (status, err) == (0, "")
    assert "interpolated displacement subtracted" in out
    table = pd.read_csv(rod_file / "t.csv")
    assert list(table.columns) == ["q1_deg", "payload_kg", "dx_mm", "dy_mm", "dq1_deg", "left_mm"]
    level = table[table.q1_deg == 0.0].iloc[0]
    assert level.dy_mm == pytest.approx(math.sin(sunk(0.0, 10.0)) * 1e3, rel=1e-6)
    q = np.radians(table[["q1_deg"]].to_numpy() + table[["dq1_deg"]].to_numpy())
    reached = tip_position(rod(), q) + model_error(rod(), q, 10.0)
    goal = tip_position(rod(), np.radians(table[["q1_deg"]].to_numpy()))
    # A drive that gives moves the tip along the very circle on which its joint does.
    assert np.abs(reached - goal).max() < 1e-8
    content = json.loads((rod_file / "t.json").read_text(encoding="utf-8"))
    assert content["columns"] == list(table.columns)
    assert np.allclose(content["rows"], table.to_numpy())
    assert content["between"]["max_subtracted_mm"] < 0.1 * content["between"]["max_without_mm"]


def test_a_joint_without_limits_is_taken_over_one_turn_and_that_is_said(linkwright, rod_file):
    text = (rod_file / "rod.yaml").read_text(encoding="utf-8").replace("range: [-80 deg, 80 deg], ", "")
    (rod_file / "free.yaml").write_text(text, encoding="utf-8")
    status, out, _ = linkwright("compensate", "free.yaml", "--out", "t.csv")
    assert status == 0
    assert "grid: joint 1 from −180° to 180° every 25.71°" in out
    table = pd.read_csv(rod_file / "t.csv")
    assert (table.q1_deg.min(), table.q1_deg.max()) == (-180.0, 180.0)


def test_command_takes_poses_and_payloads(linkwright, rod_file):
    (rod_file / "poses.csv").write_text("name,q1_deg\na,0\nb,60\n", encoding="utf-8")
    arguments = ("--poses", "poses.csv", "--payload", "0 kg", "--payload", "20 kg", "--out", "t.csv")
    status, out, _ = linkwright("compensate", "rod.yaml", *arguments)
    assert status == 0
    assert "between them" not in out
    table = pd.read_csv(rod_file / "t.csv")
    q = [0.0, math.pi / 3]
    expected = [1e3 * (math.sin(item + sunk(item, 20.0)) - math.sin(item)) for item in q]
    assert table.dy_mm.tolist() == pytest.approx([0.0, 0.0, *expected], rel=1e-6)


WRONG = [
    (("--grid", "1"), "--grid"),
    (("--grid", "2000000"), "rows"),
    (("--payload", "2"), "needs a unit"),
    (("--payload", "-2 kg"), "negative"),
    (("--payload", "2 kg", "--payload", "2000 g"), "twice"),
    (("--poses", "none.csv"), "none.csv"),
    (("--poses", "rod.yaml"), "no table"),
    (("--poses", "other.csv"), "q1_deg"),
    (("--poses", "bad.csv"), "row 2"),
    (("--poses", "bad.csv", "--grid", "3"), "--grid"),
    (("--out", "rod.yaml"), "input"),
]


@pytest.mark.parametrize(("arguments", "named"), WRONG, ids=lambda value: str(value)[:30])
def test_wrong_input_is_one_line(linkwright, rod_file, arguments, named):
    (rod_file / "bad.csv").write_text("q1_deg\n1\nx\n", encoding="utf-8")
    (rod_file / "other.csv").write_text("angle\n1\n", encoding="utf-8")
    status, _, err = linkwright("compensate", "rod.yaml", *arguments)
    assert status == 2
    assert len(err.splitlines()) == 1
    assert named in err


def test_what_a_product_cannot_say_of_another_payload_is_said():
    """The drive of `rod` known only by its sag under the arm's own 10 kg."""
    sag = EffectEntry("joint_compliance", (1,), MappingProxyType({"unit_sag": 98.1 / 2e4}))
    weight = EffectEntry("unknown_weight", (1,), MappingProxyType({"mass": 1.0, "along": 1.0}))
    arm = replace(rod(stiffness=None), links=(Link(1.0, mass=None),), effects=(weight, sag))
    for payloads, missing in (((10.0,), []), ((10.0, 15.0), ["15 kg"])):
        table = table_at(arm, np.zeros((1, 1)), payloads)
        result = Compensation(lw.Arm.of(arm), table)
        said = json.loads(result.to_json())["warnings"]
        assert len(said) == len(missing)
        assert all(part in item for part, item in zip(missing, said, strict=True))
        assert ("**Warning:** " in markdown(result.description)) == bool(missing)


def coarse(points, payloads=(0.0,), poses=None, ranges=((-2.0 * math.pi, 2.0 * math.pi), (-1.2, 1.2))):
    """What a table of a two-joint arm with a wrong length says, over a grid or at poses."""
    long = EffectEntry("link_length", (1,), {"length": 0.01})
    joints = tuple(replace(joint, range=given) for joint, given in zip(two_links().joints, ranges, strict=True))
    arm = replace(two_links(), joints=joints, effects=(long,))
    found = table_over(arm, points, payloads) if poses is None else table_at(arm, poses, payloads)
    return Compensation(lw.Arm.of(arm), found)


def said(result):
    """The warnings as people read them, beside those of the JSON, which are the same."""
    shown = [item.text for item in result.description.items if getattr(item, "tone", "") == "warning"]
    assert [f"{warning}." for warning in json.loads(result.to_json())["warnings"]] == shown
    return " ".join(shown)


def test_a_table_says_what_it_leaves_and_warns_where_that_is_much():
    """1 cm too long over two turns by steps of half a turn: all of it stays; by the steps that are proposed, little."""
    worst = coarse(5)
    check = worst.found.check
    stays = min(check.largest_subtracted, check.largest_corrected)
    assert stays > 0.5 * check.largest_without
    assert f"leaves at most {1e3 * stays:.3g} mm of {1e3 * check.largest_without:.3g} mm between them" in (
        worst.description.headline
    )
    words = said(worst)
    assert f"{100.0 * stays / check.largest_without:.0f} % of the largest error stays between the poses" in words
    assert "range: [-180 deg, 180 deg] of joint 1 in the arm file" in words
    assert "--into your URDF" in words
    again = coarse(int(words.partition("--grid ")[2].split()[0]))
    check = again.found.check
    assert check.largest_subtracted < 0.2 * check.largest_without < check.largest_corrected
    assert "displacements subtracted" in again.description.headline
    assert "joint corrections added. Use the table with displacements subtracted:" in said(again)


def test_a_grid_that_cannot_be_finer_is_not_proposed(monkeypatch):
    monkeypatch.setattr("linkwright.face.compensation._MOST_ROWS", 25)
    assert "No grid can be finer over these ranges." in said(coarse(5))
    monkeypatch.setattr("linkwright.face.compensation._MOST_ROWS", 40)
    assert "--grid 6 makes it finer, the most that it can be." in said(coarse(5))


def test_poses_where_the_joints_cannot_correct_are_told():
    """Stretched out the joints do not move the tip along the arm, where all of the error lies."""
    result = coarse(0, poses=np.array([[0.3, 1e-4], [0.3, 0.9]]))
    assert result.description.headline.endswith("It leaves at most 10 mm of 10.1 mm at them, joint corrections added")
    assert "at 1 of the table's poses joint corrections leave more than 20 % of the largest error" in said(result)
    assert said(coarse(0, poses=np.array([[0.3, 0.9]]))) == ""
