"""Commands on several arms on one torso: against plain matrices, and against the arm to one tip written out by itself,
what the other arm weighs as masses on the torso's end."""

import json
import math
from copy import deepcopy

import numpy as np
import pytest
import yaml

import linkwright as lw
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.units.quantities import InputError
from linkwright.face.planning.budget import describe
from tests import two_arms

LEFT_OF = {"origin": {"xyz": ["0 m", "50 mm", "0 m"]}}
RIGHT = (math.radians(25.0), math.radians(-70.0))
"""Where the right arm is held."""
TUBE = {"section": {"shape": "tube", "diameter": "90 mm", "thickness": "4 mm"}, "material": "steel-s355"}
SLIM = {"section": {"shape": "tube", "diameter": "60 mm", "thickness": "3 mm"}, "material": "steel-s355"}


def _rigid(length, mass):
    return {"length": length, "mass": mass, "rigid": True}


def flat_chains():
    joint = {"axis": "z", "stiffness": "60 kN*m/rad", "backlash": "0.2 mrad"}
    torso = [{"joint": {**joint, "range": ["20 deg", "120 deg"]}, "link": {"length": "500 mm", **deepcopy(TUBE)}}]
    left = [
        {
            "joint": {**joint, "mass": "4 kg", "range": ["-80 deg", "10 deg"]},
            "link": {"length": "400 mm", **deepcopy(SLIM)},
        },
        {"joint": {**joint, "range": ["-100 deg", "20 deg"]}, "link": {"length": "300 mm", **deepcopy(SLIM)}},
    ]
    held = [[f"{math.degrees(angle)} deg"] * 2 for angle in RIGHT]
    right = [
        {"joint": {"axis": "z", "mass": "3 kg", "range": held[0]}, "link": _rigid("300 mm", "2 kg")},
        {"joint": {"axis": "z", "mass": "1 kg", "range": held[1]}, "link": _rigid("200 mm", "1.5 kg")},
    ]
    return torso, left, right


@pytest.fixture
def both(tmp_path):
    """A torso that bends in the plane, a left arm of two joints, a right arm that is held where it is."""
    torso, left, right = flat_chains()
    branches = [
        {"name": "left", **LEFT_OF, "payload": {"mass": "5 kg"}, "chain": left},
        {"name": "right", "payload": {"mass": "2.5 kg"}, "chain": right},
    ]
    path = tmp_path / "two.yaml"
    path.write_text(yaml.safe_dump({"name": "two", "chain": torso, "branches": branches}))
    return path


@pytest.fixture
def alone(tmp_path):
    """The left arm with the right one as masses on the torso's end, by hand."""
    torso, left, _ = flat_chains()
    first, second = RIGHT[0], sum(RIGHT)
    elbow = 0.3 * np.array([math.cos(first), math.sin(first)])
    hand = elbow + 0.2 * np.array([math.cos(second), math.sin(second)])
    hung = [(3.0, np.zeros(2)), (2.0, 0.5 * elbow), (1.0, elbow), (1.5, 0.5 * (elbow + hand)), (2.5, hand)]
    torso[0]["link"]["masses"] = [
        {"mass": f"{mass} kg", "at": [f"{place[0]} m", f"{place[1]} m", "0 m"], "on": "end"} for mass, place in hung
    ]
    path = tmp_path / "one.yaml"
    path.write_text(
        yaml.safe_dump({"name": "one", "chain": [*torso, {**left[0], **LEFT_OF}, left[1]], "payload": {"mass": "5 kg"}})
    )
    return path


def test_a_seam_is_followed_as_by_the_arm_alone(both, alone):
    ends = ["-300 mm", "900 mm"], ["200 mm", "900 mm"]
    two, one = lw.seam(lw.read_arm(both, tip="left"), *ends, points=3), lw.seam(alone, *ends, points=3)
    assert two.check.verdict == one.check.verdict == "reachable"
    # The postures are sampled, and there are two joints more to sample.
    result, due = (item.table.iloc[:, 1:].to_numpy(dtype=float) for item in (two, one))
    assert result == pytest.approx(due, rel=2e-3)
    assert due.min() > 0.1


def test_a_budget_is_that_of_the_arm_alone(both, alone):
    sheet = {"tolerances": [{"effect": "encoder_offset", "at": [1, 2], "offset": "0.3 mrad"}], "draws": 60}
    two, one = lw.budget(lw.read_arm(both, tip="left"), sheet=sheet), lw.budget(alone, sheet=sheet)
    assert two.found.nominal == pytest.approx(one.found.nominal, rel=1e-6)
    assert two.worst_mm == pytest.approx(one.worst_mm, rel=1e-3)
    assert [item.owner for item in two.found.halved[:3]] == [item.owner for item in one.found.halved[:3]]
    assert describe(two.found).title == "two, tip of left: error budget"


@pytest.mark.slow
def test_a_budget_of_both_is_the_worse_of_the_two(tmp_path):
    path = tmp_path / "arm.yaml"
    loose = two_arms.arm_text().replace("joint: {type: revolute,", "joint: {backlash: 1 mrad,")
    path.write_text(loose + "effects:\n  - {effect: joint_compliance, at: 2, compliance: 50 urad/(N*m)}\n")
    sheet = {"tolerances": [{"effect": "link_length", "length": "0.2 mm"}], "draws": 30}
    each = [lw.budget(lw.read_arm(path, tip=tip), sheet=sheet) for tip in ("left", "right")]
    result = lw.budget(path, sheet=sheet)
    assert result.found.nominal == pytest.approx(max(one.found.nominal for one in each), rel=1e-6)
    assert result.worst_mm == pytest.approx(max(one.worst_mm for one in each), rel=1e-3)
    assert json.loads(result.to_json())["worst_pose"]["tip"] == "left"
    assert "at left's tip, load case 1" in repr(describe(result.found))


def test_poses_that_put_one_of_the_tips_at_a_point(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(two_arms.arm_text())
    point = (0.3, -0.3, 1.0)
    result = lw.inverse(lw.read_arm(path, tip="right"), *point)
    for pose in result.found:
        assert two_arms.tips(pose.q)[1] == pytest.approx(point, abs=1e-9)
        assert pose.q[2:5] == pytest.approx(np.mean(np.radians(two_arms.RANGES[2:5]), axis=1))
    # Four joints for three coordinates, whatever the other arm has.
    assert not any(pose.isolated for pose in result.found)
    planted = path.read_text().replace("range: [-170 deg, 170 deg]", "range: [-40 deg, -40 deg]")
    path.write_text(planted)
    assert any(pose.isolated for pose in lw.inverse(lw.read_arm(path, tip="right"), *two_arms.tips(
        np.radians([-40, 10, 0, 0, 0, -30, 25]))[1]).found)  # fmt: skip
    with pytest.raises(InputError, match=r"end in several tips \(left, right\), and this takes one; name one of them"):
        lw.inverse(path, *point)


@pytest.mark.slow
def test_the_other_arm_is_kept_clear_of_boxes(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(two_arms.arm_text())
    arm = lw.read_arm(path, tip="left")
    box = [[0.2, -2.0, 0.0], [2.0, 2.0, 0.7]]
    result = lw.plan(arm, poses=8, for_=["joint_compliance:2"], repeats=1, avoid=[box])
    low, high = np.array(box)
    for q in result.found.visits.q:
        for tip in two_arms.tips(q):
            assert not np.all((tip >= low) & (tip <= high))
    assert list(result.visits)[3:10] == [*(f"left_q{k}_deg" for k in (1, 2, 3)), *(f"right_q{k}_deg" for k in (1, 2)),
                                       "dir1", "dir2"]  # fmt: skip
    assert 'tip: "left"' in result.settings


def test_a_plan_promises_what_least_squares_would(tmp_path):
    """The least compliance of the torso that shows, over its standard error by plain matrices, is the quantile that the
    test and its power ask for: some five."""
    path = tmp_path / "arm.yaml"
    path.write_text(two_arms.arm_text())
    arm = lw.read_arm(path, tip="right")
    result = lw.plan(arm, poses=10, for_=["joint_compliance:2"], repeats=2, sigma="15 um")
    step = 1e-9
    moved = [(two_arms.tips(q, compliance=step)[1] - two_arms.tips(q)[1]) / step for q in result.found.recording.q]
    deviation = 15e-6 / np.linalg.norm(moved)
    (smallest,) = result.shown["smallest"]
    assert 4.0 < smallest / deviation < 6.5


@pytest.mark.slow
def test_what_one_arm_has_recorded_counts_for_the_plan_of_the_other(tmp_path):
    """The least that shows of the torso after both, by plain matrices: information of both recordings adds up."""
    (tmp_path / "arm.yaml").write_text(two_arms.arm_text())
    (tmp_path / "left.csv").write_text(two_arms.recorded("left", 12, 3, noise=15e-6, compliance=50e-6))
    (tmp_path / "left.yaml").write_text("tip: left\n")
    without = [item for item in EFFECTS if item not in QUICK]
    before = lw.diagnose(tmp_path / "arm.yaml", tmp_path / "left.csv", without=without)
    arm = lw.read_arm(tmp_path / "arm.yaml", tip="right")
    result = lw.plan(arm, poses=8, for_=["joint_compliance:2"], repeats=1, after=before, sigma="15 um")
    step, moved = 1e-9, []
    for which, q in ((0, before.found.recording.q), (1, result.found.recording.q)):
        moved += [(two_arms.tips(row, compliance=step)[which] - two_arms.tips(row)[which]) / step for row in q]
    (smallest,) = result.shown["smallest"]
    assert 4.0 < smallest / (15e-6 / np.linalg.norm(moved)) < 6.5


QUICK = ("joint_compliance", "encoder_offset", "link_length")


@pytest.fixture
def recordings(tmp_path):
    (tmp_path / "arm.yaml").write_text(two_arms.arm_text())
    for number, compliance in enumerate((50e-6, 50e-6, 50e-6, 70e-6, 70e-6, 70e-6)):
        for tip in ("left", "right"):
            (tmp_path / f"{tip}{number}.csv").write_text(
                two_arms.recorded(tip, 20, 10 * number + len(tip), compliance=compliance)
            )
            (tmp_path / f"{tip}{number}.yaml").write_text(f"tip: {tip}\ndate: 2026-03-{number + 1:02d}\n")
    return tmp_path


@pytest.mark.slow
def test_a_torso_that_softened_is_seen_by_one_of_the_arms(recordings):
    without = [item for item in EFFECTS if item not in QUICK]
    arm = recordings / "arm.yaml"
    result = lw.compare(arm, recordings / "right1.csv", recordings / "right4.csv", without=without)
    (change,) = result.found.changes
    assert (change.effect, change.first.at) == ("joint_compliance", (2,))
    assert change.changed
    assert change.difference == pytest.approx(20e-6, rel=0.02)
    with pytest.raises(InputError, match=r"of different tips \(left and right\); compare two recordings of one"):
        lw.compare(arm, recordings / "left1.csv", recordings / "right4.csv", without=without)


@pytest.mark.slow
def test_a_torso_is_watched_by_the_recordings_of_both(recordings):
    days = [recordings / f"{tip}{k}.csv" for k, tip in enumerate(("left", "right", "left", "left", "right", "left"))]
    without = [item for item in EFFECTS if item not in QUICK]
    result = lw.watch(recordings / "arm.yaml", days, for_=["joint_compliance"], without=without)
    steps = result.alarms[result.alarms["effect"] == "joint_compliance"]
    assert [tuple(at) for at in steps["at"]] == [(2,)]
    assert [str(step) for step in steps["from"]] == ["2026-03-03"]
    assert steps["change"].iloc[0] == pytest.approx(20e-6, rel=0.02)


@pytest.mark.slow
def test_step_has_the_torso_once_and_both_arms(both):
    pytest.importorskip("build123d")
    from linkwright.drawings.step import solids

    content = yaml.safe_load(both.read_text())
    for entry in content["branches"][1]["chain"]:
        entry["link"] = {"length": entry["link"]["length"], **deepcopy(SLIM)}
    both.write_text(yaml.safe_dump(content))
    arm = lw.read_arm(both)
    result = solids(arm.model)
    assert list(result) == [f"link {k}" for k in range(1, 6)]
    for tip, last in (("left", "link 3"), ("right", "link 5")):
        end = 1e3 * tip_position(arm.model.on(tip), [0.0] * 5)[0]
        box = result[last].bounding_box()
        assert float(box.max.X) == pytest.approx(end[0], abs=1e-6)
        assert float(box.center().Y) == pytest.approx(end[1], abs=1e-6)
    assert "link 5" in lw.export_arm(both, to="step").found.text
