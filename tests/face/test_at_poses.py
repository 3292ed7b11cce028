"""The error at poses that are asked for, against closed forms of a cantilever and of play."""

import json
import math

import numpy as np
import pytest

import linkwright as lw
from linkwright.markdown.described import markdown
from tests.costs import slow_but

F, L, SIDE, E = 100.0, 1.0, 0.03, 200e9
SECOND_MOMENT = SIDE**4 / 12.0
STEEL = {"elastic_modulus": "200 GPa", "poisson_ratio": 0.3, "density": "1e-6 kg/m^3"}


def cantilever(**joint):
    rod = lw.Link(length=L, section={"shape": "rectangle", "width": SIDE, "height": SIDE}, material=STEEL)
    arm_joint = lw.Joint(range=["-90 deg", "90 deg"], **joint)
    return lw.Arm(chain=[(arm_joint, rod)], payload={"mass": "0 kg", "force": ["0 N", f"{-F} N", "0 N"]})


def test_a_cantilever_bends_as_in_any_textbook():
    """F L^3 / 3 E I down, turned by F L^2 / 2 E I (S. Timoshenko, Strength of Materials I, 1955, art. 33)."""
    result = lw.evaluate(cantilever(), pose="0 deg")
    (error,) = result.at
    shear = next(part for part in error.by_effect if part.effect == "shear_deformation").vector[1]
    assert error.vector[1] - shear == pytest.approx(-F * L**3 / (3.0 * E * SECOND_MOMENT), rel=1e-9)
    assert error.rotation == pytest.approx((0.0, 0.0, -F * L**2 / (2.0 * E * SECOND_MOMENT)), rel=1e-9)
    assert error.orientation == pytest.approx(F * L**2 / (2.0 * E * SECOND_MOMENT), rel=1e-9)
    assert error.beyond == pytest.approx(lw.evaluate(cantilever()).found.beyond.at_worst, rel=1e-6)


def test_the_error_at_the_worst_pose_is_the_worst_error():
    """At the worst pose it is what the evaluation finds there by itself."""
    arm = lw.read_arm("examples/welding-arm/arm.yaml")
    worst = lw.evaluate(arm).found.worst.poses[0]
    (error,) = lw.evaluate(arm, pose=worst.q).at
    assert error.error == pytest.approx(worst.error, rel=1e-12)
    assert error.vector == pytest.approx(worst.vector, rel=1e-12)


def test_play_stands_where_it_counts_most():
    """Half of the backlash winds a drive further on the side on which the load has it: error and turn add up."""
    arm = cantilever(stiffness="10 kN*m/rad", backlash="2 mrad", clearance="0.05 mm")
    (error,) = lw.evaluate(arm, pose="0 deg").at
    parts = {part.effect: part for part in error.by_effect}
    assert parts["backlash"].vector == pytest.approx((0.0, -1e-3 * L, 0.0), abs=1e-15)
    assert parts["backlash"].rotation == pytest.approx((0.0, 0.0, -1e-3), abs=1e-15)
    assert parts["clearance"].vector == pytest.approx((0.0, -0.05e-3, 0.0), abs=1e-12)
    assert parts["clearance"].rotation == (0.0, 0.0, 0.0)
    assert parts["joint_compliance"].rotation[2] == pytest.approx(-F * L / 10e3)
    assert error.rotation[2] == pytest.approx(-(F * L**2 / (2.0 * E * SECOND_MOMENT) + F * L / 10e3 + 1e-3))


@pytest.mark.parametrize("play", slow_but(["worst", "loaded", "statistical"], "worst"))
def test_parts_add_up(tmp_path, play):
    """Over the effects, displacement, rotation and share are the whole's: in space, with every kind of play, from a
    calibrated state."""
    arm_file, problem = tmp_path / "arm.yaml", tmp_path / "problem.yaml"
    arm_file.write_text(
        f"""\
play: {play}
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {{type: revolute, range: [-90 deg, 90 deg], clearance: 0.02 mm, backlash: 1 arcmin, stiffness: 5e4 N*m/rad}}
    link: {{length: 300 mm, section: {{shape: circle, diameter: 60 mm}}, material: steel-s355}}
  - joint: {{type: revolute, axis: [0, 1, 0], range: [-90 deg, 90 deg], clearance: 0.03 mm, backlash: 2 arcmin}}
    link: {{length: 400 mm, section: {{shape: circle, diameter: 50 mm}}, material: steel-s355}}
  - joint: {{type: prismatic, range: [0 mm, 200 mm], stiffness: 5e6 N/m}}
    link: {{length: 200 mm, section: {{shape: circle, diameter: 40 mm}}, material: steel-s355}}
payload: {{mass: 5 kg}}
effects:
  - {{effect: encoder_offset, at: 2, offset: 0.02 deg}}
""",
        encoding="utf-8",
    )
    problem.write_text(
        "arm: arm.yaml\nload_cases: [{payload: {mass: 8 kg}}, {payload: {mass: 1 kg}}]\n"
        "relative_to: {payload: {mass: 5 kg}}\n",
        encoding="utf-8",
    )
    poses = [["20 deg", "30 deg", "100 mm"], [-1.0, 0.4, 0.05]]
    for asked in (None, problem):
        result = lw.evaluate(arm_file, asked, pose=poses)
        assert len(result.at) == len(result.at_poses) == (2 if asked is None else 4)
        for error in result.at:
            for name in ("vector", "rotation"):
                total = np.sum([getattr(part, name) for part in error.by_effect], axis=0)
                assert total == pytest.approx(getattr(error, name), abs=1e-15)
            assert sum(part.share for part in error.by_effect) == pytest.approx(1.0, abs=1e-9)
            assert error.error == pytest.approx(math.dist(error.vector, (0.0, 0.0, 0.0)))


def test_every_way_to_say_poses(tmp_path):
    """With units, in degrees, as a table; JSON has what the table has. What is outside a range is said, not refused."""
    (tmp_path / "poses.csv").write_text("q1_deg,q2_deg,q3_deg\n20,-30,5\n200,0,0\n", encoding="utf-8")
    arm = lw.read_arm("examples/welding-arm/arm.yaml")
    poses = ("20 deg, -30 deg, 5 deg", "20 -30, 5", tmp_path / "poses.csv")
    said = [lw.evaluate(arm, pose=pose).at[0] for pose in poses]
    assert all(error.vector == pytest.approx(said[0].vector, rel=1e-12) for error in said)
    result = lw.evaluate(arm, pose=tmp_path / "poses.csv")
    assert [error.outside for error in result.at] == [(), (1,)]
    assert "joint 1 is outside its range" in markdown(result.description)
    content = json.loads(result.to_json())["poses"]
    assert content[0]["q_deg"] == pytest.approx([20.0, -30.0, 5.0])
    assert content[0]["error_mm"] == pytest.approx(result.at_poses["error_mm"][0])
    assert sum(part["share"] for part in content[0]["by_effect"]) == pytest.approx(1.0)
    assert json.loads(lw.evaluate(arm).to_json())["poses"] == []


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        ("20 mm, 0, 0", "pose[1]: '20 mm' is a length"),
        ("20, 30", "3 values are needed"),
        ("20, 30, x", "'x' is not a number"),
        ("none.csv", "there is no such file"),
        ([["1 deg", "2 deg"]], "3 values are needed"),
    ],
)
def test_a_pose_that_is_none_is_told_in_a_line(pose, says):
    with pytest.raises(lw.InputError) as error:
        lw.evaluate("examples/welding-arm/arm.yaml", pose=pose)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
