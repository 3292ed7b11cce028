"""Several arms on one torso: kinematics, the weights that the torso carries, the file, the worst case over both."""

import numpy as np
import pytest
import yaml

import linkwright as lw
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.vectors import ZERO
from linkwright.core.arm.compensation import model_error
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml, write_arm
from linkwright.core.units.quantities import InputError
from tests import two_arms

LOW, HIGH = np.radians(np.array(two_arms.RANGES)).T
SOFT = 50e-6
"""rad/(N*m), the pitch axis."""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(two_arms.arm_text())
    return path


@pytest.fixture
def soft(tmp_path):
    path = tmp_path / "soft.yaml"
    path.write_text(
        two_arms.arm_text() + "effects:\n  - {effect: joint_compliance, at: 2, compliance: 50 urad/(N*m)}\n"
    )
    return path


def poses(count: int, seed: int = 1):
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, len(LOW)))


@pytest.mark.parametrize(("tip", "which"), [("left", 0), ("right", 1)])
def test_tips_and_what_weighs_on_the_torso(file, tip, which):
    arm = read_arm(file, tip=tip)
    for q in poses(20):
        state = solve(arm, q.tolist(), beams_of(arm))
        assert np.asarray(state.tip()) == pytest.approx(two_arms.tips(q)[which], abs=1e-12)
        assert state.joints[1].drive_load == pytest.approx(two_arms.pitch_torque(q), abs=1e-10)


@pytest.mark.parametrize(("tip", "which"), [("left", 0), ("right", 1)])
def test_a_torso_that_gives_is_where_the_equilibrium_of_all_weights_is(soft, tip, which):
    made = lw.simulate(lw.read_arm(soft, tip=tip), poses=8, repeats=1, noise=0.0, sides="one", seed=3)
    result = made.found
    due = np.array([two_arms.tips(q, compliance=SOFT)[which] for q in result.q])
    assert np.abs(result.tip - due).max() < 5e-9


def test_the_weight_on_the_torso_against_mujoco(file):
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(two_arms.mujoco_text())
    data, arm = mujoco.MjData(model), read_arm(file, tip="right")
    for q in poses(5, seed=7):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        state = solve(arm, q.tolist(), beams_of(arm))
        # MuJoCo's bias force is what a drive holds, ours what weighs on it.
        assert state.joints[1].drive_load == pytest.approx(-data.qfrc_bias[1], abs=1e-9)
        assert state.joints[6].drive_load == pytest.approx(-data.qfrc_bias[6], abs=1e-9)


def test_no_effect_of_another_branch_moves_the_tip(file):
    arm = read_arm(file, tip="left")
    q = poses(6)
    state = solve(arm, list(q.T), beams_of(arm))
    tried = 0
    for effect in EFFECTS.values():
        if effect.place not in ("joint", "link"):
            continue
        values = {
            parameter.name: 0.5 * (parameter.typical[0] + parameter.typical[1])
            for parameter in effect.parameters
            if any(parameter.typical)
        }
        values |= {"expansion": 12e-6} if "expansion" in values else {}
        for index in (5, 6):
            moved = seen(state, effect, Settings((index,), values), Asked(len(q))).tip
            assert not np.any(moved), effect.id
            tried += 1
    assert tried > 40
    assert state.joints[5].axis == ZERO
    assert {active_effect.effect.id for active_effect in active_effects(arm)}


def test_play_of_another_branch_does_not_count(tmp_path):
    path = tmp_path / "arm.yaml"
    loose = "joint: {clearance: 0.1 mm, backlash: 1 mrad,"
    path.write_text(two_arms.arm_text().replace("joint: {type: revolute,", loose))
    arm = read_arm(path, tip="right")
    result = tip_error(solve(arm, poses(1)[0].tolist(), beams_of(arm)), active_effects(arm))
    assert [disc.joint for disc in result.discs] == [0, 1, 5, 6]
    moving = [
        interval.joint for interval in result.intervals if np.linalg.norm(np.array(interval.vector, dtype=float)) > 0.0
    ]
    assert moving == [0, 1, 5, 6]


def test_the_file_comes_back_as_it_was(soft, tmp_path):
    arm = read_arm(soft, tip="right")
    assert [(branch.name, branch.first, branch.end) for branch in arm.branches] == [("left", 2, 5), ("right", 5, 7)]
    write_arm(arm, tmp_path / "back.yaml")
    assert read_arm(tmp_path / "back.yaml", tip="right") == arm
    assert arm_to_yaml(arm.on("left")) == arm_to_yaml(arm)
    assert arm.on("left").payload.mass == 1.0
    assert arm.payload.mass == 2.0


def test_the_worst_case_is_over_the_other_arm_too(soft):
    result = lw.evaluate(lw.read_arm(soft, tip="left"))
    # To first order: what the pitch axis turns by, on its lever.
    q = np.array(result.found.worst.poses[0].q)
    assert result.upper_bound_mm is not None

    def error(q):
        tips, _, (at, axis) = two_arms.posture(q)
        return 1e3 * SOFT * abs(two_arms.pitch_torque(q)) * np.linalg.norm(np.cross(axis, tips[0] - at))

    assert error(q) == pytest.approx(1e3 * result.found.worst.error, rel=1e-9)
    # Whatever the other arm does: 2,000 poses, and the worst with the other arm at rest, are below.
    assert max(error(pose) for pose in poses(2000)) < 1e3 * result.found.worst.error
    assert error(np.array([*q[:5], 0.0, 0.0])) < 0.97 * 1e3 * result.found.worst.error
    assert result.upper_bound_mm > 1e3 * result.found.worst.error


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("name: right", "name: left", "'left' is there twice"),
        ("name: right", "name: 2nd", "letters and digits"),
        ("name: right\n", "name: right\n    at: 1\n", "can be 2 only"),
        ("chain:\n", "payload: {mass: 1 kg}\nchain:\n", "is each branch's own"),
        ("chain:\n", "angles: absolute\nchain:\n", "only without branches"),
        ("payload: {mass: 2.0 kg}", "payload: {mass: 2 kg, force: [1 N, 0 N]}", "unknown key 'force'"),
        ("payload: {mass: 2.0 kg}", "payload: {mass: -2 kg}", "cannot be negative"),
    ],
)
def test_files_that_cannot_be(tmp_path, old, new, said):
    path = tmp_path / "arm.yaml"
    path.write_text(two_arms.arm_text().replace(old, new, 1))
    with pytest.raises(InputError, match=said):
        read_arm(path, tip="left")


def test_what_takes_no_several_tips_says_so(file):
    whole = lw.read_arm(file)
    assert whole.model.every_tip
    assert [case.tip for case in whole.model.cases] == ["left", "right"]
    with pytest.raises(InputError, match=r"end in several tips \(left, right\), and this takes one; name one of them"):
        lw.simulate(whole)
    with pytest.raises(InputError, match="no tip 'lefd', but left, right; did you mean 'left'"):
        read_arm(file, tip="lefd")
    with pytest.raises(InputError, match="and this takes one; name one of them"):
        lw.plan(whole)


def test_without_a_tip_the_worst_of_all_counts(soft):
    each = {tip: lw.evaluate(lw.read_arm(soft, tip=tip)) for tip in ("left", "right")}
    result = lw.evaluate(lw.read_arm(soft))
    assert result.max_error_mm == pytest.approx(max(one.max_error_mm for one in each.values()), rel=1e-9)
    assert result.found.total_mass == pytest.approx(each["left"].found.total_mass)
    stiff = [one.found.stiffness.value for one in each.values()]
    assert result.found.stiffness.value == pytest.approx(min(stiff), rel=1e-6)


WRIST = """      - joint: {axis: y, range: [-80 deg, 10 deg], stiffness: 6 kN*m/rad}
        link: {length: 400 mm, rigid: true, mass: 2 kg}
      - joint: {axis: y, range: [10 deg, 100 deg], stiffness: 5 kN*m/rad}
        link: {length: 300 mm, rigid: true, mass: 1 kg}
      - joint: {axis: y, follows: "-(q1 + q2)", stiffness: 2 kN*m/rad}
        link: {length: 150 mm, rigid: true, mass: 0.5 kg}
"""
FOLLOWING = """
name: level wrists
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: z, range: [-90 deg, 90 deg], stiffness: 30 kN*m/rad}
    link: {length: 500 mm, direction: [0, 0, 1], rigid: true, mass: 8 kg}
branches:
  - name: left
    origin: {xyz: [0 m, 0.2 m, 0 m]}
    payload: {mass: 3 kg}
    chain:
ARM  - name: right
    origin: {xyz: [0 m, -0.2 m, 0 m]}
    payload: {mass: 3 kg}
    chain:
ARM""".replace("ARM", WRIST)


def test_a_branch_may_follow_itself(tmp_path):
    """Each arm alone, its torso a joint of its own, errs as within the two; its tip stays level."""
    path, alone = tmp_path / "two.yaml", tmp_path / "one.yaml"
    path.write_text(FOLLOWING)
    lines = yaml.safe_load(FOLLOWING)
    branch = lines.pop("branches")[1]
    chain = [*lines["chain"], *branch["chain"]]
    chain[1]["origin"] = branch["origin"]
    chain[3]["joint"]["follows"] = "-(q2 + q3)"
    alone.write_text(yaml.safe_dump({**lines, "chain": chain, "payload": branch["payload"]}))
    two, one = read_arm(path, tip="right"), read_arm(alone)
    write_arm(two, tmp_path / "back.yaml")
    assert "follows: -q1 - q2" in (tmp_path / "back.yaml").read_text()
    assert read_arm(tmp_path / "back.yaml", tip="right") == two
    q = np.random.default_rng(4).uniform([-1.5, -1.4, 0.2, 0.0], [1.5, 0.2, 1.7, 0.0], (20, 4))
    whole = np.insert(q, [1, 1, 1], [0.3, 0.9, 0.0], axis=1)
    there, here = (model_error(arm, at, 3.0) for arm, at in ((two, whole), (one, q)))
    assert np.abs(there).max() > 1e-4
    # The torso turns about the plumb axis, so that the other arm's weight moves nothing.
    assert there == pytest.approx(here, abs=1e-12)
    drop = np.array(tip_position(two, whole))[:, 2]
    assert drop == pytest.approx(0.5 - 0.4 * np.sin(q[:, 1]) - 0.3 * np.sin(q[:, 1] + q[:, 2]), abs=1e-12)


def test_a_branch_cannot_follow_what_it_has_not(tmp_path):
    path = tmp_path / "arm.yaml"
    for given, said in (
        ("q4", r"branches\[1\].chain\[3\].joint.follows: names q4, but the arm has 3 joints"),
        ("q3 - q1 + 2*q3", r"branches\[1\].chain\[3\].joint.follows: has its own coordinate q3 3 times"),
    ):
        path.write_text(FOLLOWING.replace("-(q1 + q2)", given))
        with pytest.raises(InputError, match=said):
            read_arm(path)
